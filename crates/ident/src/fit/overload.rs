//! Amplifiers that are overloaded where the data lead a patch.

use crate::fit::fitted_model::Stage;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use patchcord_analysis::instruments::number;
use patchcord_core::trace::Overload;

/// The first overload of a stage beside its records, in a sentence; nothing where there is none.
///
/// # Errors
/// When the patch cannot be run beside the records.
pub(crate) fn first_overload(problem: &Problem, stage: &Stage) -> Result<Option<String>, ModelError> {
    let parts = [(&problem.train, &stage.train.point), (&problem.test, &stage.test.point)];
    for (records, point) in parts {
        let model = problem.model(&stage.version, records, &problem.outputs)?;
        let overloaded = records
            .iter()
            .enumerate()
            .find_map(|(place, record)| Some((record, model.overload(place, &point.choice(place))?)));
        let Some((record, Overload { element, time, peak, .. })) = overloaded else { continue };
        return Ok(Some(format!(
            "Beside {} the amplifier {element} is overloaded at {} s, asked for {} V: beyond 100 V the patch is not what it stands for. Let a volt of its scale stand for more, and search again.",
            record.name,
            number(record.begin + time),
            number(peak)
        )));
    }
    Ok(None)
}
