//! The trajectories of all signals and drives of a fitted model.

use crate::fit::fitted_model::FittedModel;
use crate::fit::model::{ModelError, OutputTrajectory};
use crate::fit::problem::Problem;

/// The names of all signals and drives, and for every training record their trajectories in this order. The
/// trajectories of a record are empty if its run fails.
///
/// # Errors
/// If the patch cannot be run along the records at all.
pub(crate) fn all_trajectories(
    problem: &Problem,
    fitted: &FittedModel,
) -> Result<(Vec<String>, Vec<OutputTrajectory>), ModelError> {
    let patch = fitted.variant.patch();
    let names = patch.signals.keys().chain(patch.drives.keys()).cloned().collect::<Vec<_>>();
    let model = problem.model(&fitted.variant, &problem.train, &names)?;
    let trajectories = (0..problem.train.len()).map(|record| {
        model.run(record, &[fitted.train.estimate.run_values(record)]).pop().flatten().unwrap_or_default()
    });
    let trajectories = trajectories.collect();
    Ok((names, trajectories))
}
