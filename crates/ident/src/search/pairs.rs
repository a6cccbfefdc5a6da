//! Effects of which one hides the other: pairs.

use crate::fit::fitted_model::Stage;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::residuals::residual_analysis::is_drive_noise;
use crate::search::means::Means;
use crate::search::progress::Progress;
use crate::search::refinement::refine;
use crate::search::search_log::Action;
use crate::search::state::Come;
use crate::search::trials::run_round;

/// Where no effect is taken alone, each of those that close most is gone on from as if it had been: of two the one may hide the
/// other. The first that holds together with what is found beside it, and leaves but noise, is it.
pub(crate) fn search_pairs(
    problem: &Problem,
    base: &Stage,
    mut come: Come,
    with: &Means<'_>,
    progress: &mut impl FnMut(Progress),
) -> Result<Come, ModelError> {
    for place in come.hopes() {
        let pair = complete_pair(problem, base, come.hoping(place), with, progress)?;
        if pair.effects.len() > 1 && pair.all_hold() && !pair.stage.leaves_structure() {
            return Ok(pair);
        }
        come = come.after(&pair, Action::BacktrackFromPair);
    }
    Ok(come)
}

/// What is found beside an effect that is gone on from; that alone where nothing is, or where it leaves noise of the drives.
fn complete_pair(
    problem: &Problem,
    base: &Stage,
    mut hope: Come,
    with: &Means<'_>,
    progress: &mut impl FnMut(Progress),
) -> Result<Come, ModelError> {
    if is_drive_noise(problem, &hope.stage, with.threads)? {
        return Ok(hope);
    }
    let round = run_round(problem, &hope.stage, &hope.effects, None, with, progress)?;
    match hope.goes_on_with(round) {
        true => refine(problem, base, hope, false, with, progress),
        false => Ok(hope),
    }
}
