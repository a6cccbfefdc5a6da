//! Drives between their samples: linear interpolation of a smooth drive causes residuals that look like a force.

use crate::data::experiment::MeasuredDrive;
use crate::data::experiment_document::Hold;
use crate::fit::estimation::refit;
use crate::fit::fitted_model::FittedModel;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::fit::step_size::difference_between;

/// Repeats a fit with smooth instead of linear interpolation of the drives. Returns the new fit and the names of these
/// drives.
///
/// `None` if no drive is interpolated linearly, if the difference is too small to explain the residuals, or if the
/// residuals of the new fit are still coloured.
///
/// # Errors
/// If the patch cannot be run along the records.
pub(crate) fn refit_smoothly(
    problem: &Problem,
    fitted: &FittedModel,
) -> Result<Option<(FittedModel, Vec<String>)>, ModelError> {
    let is_linear = |drive: &&MeasuredDrive| drive.hold == Hold::Linear;
    let names: Vec<String> =
        problem.drives.iter().filter(is_linear).map(|drive| drive.drive.clone()).collect();
    if names.is_empty() {
        return Ok(None);
    }
    let with_smooth_hold = |drive: &MeasuredDrive| match drive.hold {
        Hold::Linear => MeasuredDrive { hold: Hold::Smooth, ..drive.clone() },
        Hold::Smooth | Hold::Previous => drive.clone(),
    };
    let smooth_problem =
        Problem { drives: problem.drives.iter().map(with_smooth_hold).collect(), ..problem.clone() };
    // A new fit can only reduce the difference that the interpolation causes.
    if difference_between(problem, &smooth_problem, fitted)? < fitted.excess_rms() {
        return Ok(None);
    }
    let refitted = refit(&smooth_problem, fitted, fitted.variant.clone(), fitted.train.estimate.clone())?;
    Ok(refitted.filter(|refitted| !refitted.residuals_are_coloured()).map(|refitted| (refitted, names)))
}
