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
    /// Name of the amplifier.
    pub element: String,
    /// The first time at which the demanded output exceeds 100 V, in seconds of the record's clock.
    pub time: f64,
    /// The largest demanded output without sign, in V.
    pub peak: f64,
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
        let Some((record, Overload { element, time, peak, .. })) = overloaded else { continue };
        let (record, time) = (record.name.clone(), record.begin + time);
        return Ok(Some(RecordOverload { record, element, time, peak }));
    }
    Ok(None)
}
