//! Amplifiers that are overloaded where the data lead a patch.

use crate::fit::fitted_model::Stage;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use patchcord_core::trace::Overload;

/// The first overload of a fitted model as it runs along its records.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordOverload {
    /// Name of the record, that is, its file.
    pub record: String,
    /// The amplifier.
    pub element: String,
    /// When it was first asked for more than 100 V, in seconds by the clock of the record.
    pub time: f64,
    /// The largest voltage that it was asked for, in V, without sign.
    pub peak: f64,
}

/// The first overload of a stage beside its records; nothing where there is none.
///
/// # Errors
/// When the patch cannot be run beside the records.
pub(crate) fn first_overload(problem: &Problem, stage: &Stage) -> Result<Option<RecordOverload>, ModelError> {
    let parts = [(&problem.train, &stage.train.point), (&problem.test, &stage.test.point)];
    for (records, point) in parts {
        let model = problem.model(&stage.version, records, &problem.outputs)?;
        let overloaded = records
            .iter()
            .enumerate()
            .find_map(|(place, record)| Some((record, model.overload(place, &point.choice(place))?)));
        let Some((record, Overload { element, time, peak, .. })) = overloaded else { continue };
        let (record, time) = (record.name.clone(), record.begin + time);
        return Ok(Some(RecordOverload { record, element, time, peak }));
    }
    Ok(None)
}
