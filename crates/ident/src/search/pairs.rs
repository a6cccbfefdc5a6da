//! The search for pairs of effects of which one hides the other.

use crate::fit::fitted_model::FittedModel;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::residuals::residual_analysis::is_drive_noise;
use crate::search::progress::Progress;
use crate::search::refinement::refine;
use crate::search::search_log::Action;
use crate::search::settings::SearchSettings;
use crate::search::state::SearchState;
use crate::search::trials::run_round;

/// Searches for a second effect next to each tentative effect of the first round. Returns the first pair that is
/// confirmed jointly and leaves only noise, or else `state` with the attempts in its log.
///
/// A single effect of a pair can fail, because the other one hides it in the residual. So an effect that was not
/// taken is treated here as if it had been.
///
/// # Errors
/// If the patch cannot be simulated with the drives of the records.
pub(crate) fn search_pairs(
    problem: &Problem,
    base: &FittedModel,
    mut state: SearchState,
    settings: &SearchSettings<'_>,
    progress: &mut (impl FnMut(Progress) + Send),
) -> Result<SearchState, ModelError> {
    for trial in state.tentative_candidates() {
        let pair = complete_pair(problem, base, state.with_tentative(trial), settings, progress)?;
        if pair.effects.len() > 1 && pair.is_jointly_confirmed() && !pair.model.residuals_are_coloured() {
            return Ok(pair);
        }
        state = pair.backtrack_to(state, Action::BacktrackFromPair);
    }
    Ok(state)
}

/// Runs one round with a tentative effect in the patch and refines the pair. The state keeps its one effect if the
/// round accepts none, or if the residual is only noise of the drives.
fn complete_pair(
    problem: &Problem,
    base: &FittedModel,
    mut state: SearchState,
    settings: &SearchSettings<'_>,
    progress: &mut (impl FnMut(Progress) + Send),
) -> Result<SearchState, ModelError> {
    if is_drive_noise(problem, &state.model)? {
        return Ok(state);
    }
    let round = run_round(problem, &state.model, &state.effects, None, settings, progress)?;
    match state.add_round(round) {
        true => refine(problem, base, state, false, settings, progress),
        false => Ok(state),
    }
}
