//! What fed drives do between their samples: straight lines through what is round bring what looks like a force.

use crate::data::document::Hold;
use crate::data::experiment::Feed;
use crate::fit::estimation::refit;
use crate::fit::fitted_model::Stage;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::fit::step_size::difference_of;

/// A stage that leaves structure fitted again with its fed drives going on smoothly, where straight lines are drawn between their
/// samples, with the names of these; nothing where that still leaves structure, or can make no such difference.
///
/// # Errors
/// When the patch cannot be run beside the records.
pub(crate) fn refit_smoothly(
    problem: &Problem,
    stage: &Stage,
) -> Result<Option<(Stage, Vec<String>)>, ModelError> {
    let is_straight = |feed: &&Feed| feed.hold == Hold::Linear;
    let names: Vec<String> =
        problem.drives.iter().filter(is_straight).map(|feed| feed.drive.clone()).collect();
    if names.is_empty() {
        return Ok(None);
    }
    let smooth = |feed: &Feed| match feed.hold {
        Hold::Linear => Feed { hold: Hold::Smooth, ..feed.clone() },
        Hold::Smooth | Hold::Previous => feed.clone(),
    };
    let smoothly = Problem { drives: problem.drives.iter().map(smooth).collect(), ..problem.clone() };
    // What is fitted again only takes of the difference away.
    if difference_of(problem, &smoothly, stage)? < stage.gap() {
        return Ok(None);
    }
    let again = refit(&smoothly, stage, stage.version.clone(), stage.train.point.clone())?;
    Ok(again.filter(|own| !own.leaves_structure()).map(|own| (own, names)))
}
