//! Overloads of amplifiers in a fitted model. If an amplifier is overloaded, the fit is not meaningful.

use crate::fit::fitted_model::FittedModel;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use patchcord_core::trace::Overload;

/// The first overload of a fitted model along its records.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordOverload {
    /// Name of the record, which is its file.
    pub record: String,
    /// The overload. Its time is in seconds of the record's clock.
    pub overload: Overload,
}

/// The first overload of a fitted model, in the training records or else in the validation records. `None` if there is
/// no overload.
///
/// # Errors
/// If the patch cannot be run along the records.
pub(crate) fn first_overload(
    problem: &Problem,
    fitted: &FittedModel,
) -> Result<Option<RecordOverload>, ModelError> {
    let parts =
        [(&problem.train, &fitted.train.estimate), (&problem.validation, &fitted.validation.estimate)];
    for (records, estimate) in parts {
        let model = problem.model(&fitted.variant, records, &problem.outputs)?;
        let overloaded = records.iter().enumerate().find_map(|(index, record)| {
            Some((record, model.first_overload(index, &estimate.run_values(index))?))
        });
        let Some((record, overload)) = overloaded else { continue };
        let overload = Overload { time: record.begin + overload.time, ..overload };
        return Ok(Some(RecordOverload { record: record.name.clone(), overload }));
    }
    Ok(None)
}
