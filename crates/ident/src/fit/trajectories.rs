//! What all signals and drives of a fitted model do.

use crate::fit::fitted_model::Stage;
use crate::fit::model::{Course, ModelError};
use crate::fit::problem::Problem;

/// The names of all signals and drives of a stage, and of every training record what they do, as it is fitted.
pub(crate) fn all_trajectories(
    problem: &Problem,
    stage: &Stage,
) -> Result<(Vec<String>, Vec<Course>), ModelError> {
    let patch = stage.version.patch();
    let names = patch.signals.keys().chain(patch.drives.keys()).cloned().collect::<Vec<_>>();
    let model = problem.model(&stage.version, &problem.train, &names)?;
    let courses = (0..problem.train.len()).map(|record| {
        model.run(record, &[stage.train.point.choice(record)]).pop().flatten().unwrap_or_default()
    });
    let courses = courses.collect();
    Ok((names, courses))
}
