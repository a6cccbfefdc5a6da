//! The search for missing effects.
//!
//! 1. The patch is fitted without any effect. The search ends if the data are only noise, the residual is below the
//!    declared noise, the fit diverges, a sign or unit is wrong, or the solver error exceeds the noise.
//! 2. A round tries every effect of the library at every site, and fits each extended patch (module `trials`).
//! 3. The best trial is accepted if its `delta_bic` is large enough and the validation records confirm it
//!    (module `round`).
//! 4. Rounds repeat until the residual looks like noise, no trial is accepted, or three effects are found.
//! 5. Every accepted effect is tried again next to the others, and dropped if it is no longer needed
//!    (module `refinement`).
//! 6. If no effect is accepted, pairs of effects are tried, because one may hide the other (module `pairs`).
//! 7. The verdict is derived (module `judgement`).

pub mod inconclusive;
pub(crate) mod judgement;
pub mod outcome;
pub(crate) mod pairs;
pub mod progress;
pub mod range_extension;
pub(crate) mod refinement;
pub mod round;
pub mod search_log;
pub(crate) mod settings;
pub(crate) mod state;
pub(crate) mod trials;
pub mod verdict;

use crate::data::experiment::Experiment;
use crate::fit::base_fit::{fit_base, refit_from_trial};
use crate::fit::fitted_model::FittedModel;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::fit::step_size::step_refinement;
use crate::residuals::divergence::find_divergence;
use crate::residuals::misspecification::{find_long_times, find_misspecification};
use crate::residuals::residual_analysis::is_drive_noise;
use crate::search::inconclusive::{Inconclusive, agrees_within_noise, has_motion_above_noise, is_noise_only};
use crate::search::judgement::{agreeing_outcome, inconclusive_outcome, judge};
use crate::search::pairs::search_pairs;
use crate::search::progress::{Progress, SearchPhase};
use crate::search::refinement::refine;
use crate::search::round::Round;
use crate::search::state::SearchState;
use crate::search::trials::run_round;
use patchcord_analysis::parallel;

pub use outcome::Outcome;
pub use settings::SearchSettings;
pub use verdict::Verdict;

/// Number of trials of a round, best first, whose estimates are used as further starts of the patch without their
/// effects.
const REFIT_STARTS: usize = 3;
/// Maximum number of rounds that are repeated because a trial leads to a better fit of the patch before the round.
const MAX_REFITS: usize = 3;
/// Maximum number of missing effects that a search looks for.
const MAX_EFFECTS: usize = 3;

/// Searches for the effects that the patch of an experiment lacks. `problem` is that of the experiment, and `progress`
/// is called before and during each phase. Returns None if the patch can be run from none of the starts.
///
/// # Errors
/// If the patch cannot be simulated with the drives of the records, or the search is cancelled.
///
/// # Examples
///
/// ```no_run
/// use patchcord_ident::{Experiment, Library, Problem, SearchSettings, search};
///
/// let experiment = Experiment::read("../../examples/05_missing_effect/spring.experiment.json")?;
/// let (problem, library) = (Problem::of(&experiment)?, Library::shipped());
/// let settings = SearchSettings::new(&library).with_threads(2);
/// let outcome = search(&experiment, &problem, &settings, |progress| println!("{progress:?}"))?;
/// let outcome = outcome.ok_or("the patch cannot be run from any start")?;
/// assert_eq!(outcome.verdict.as_str(), "named");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn search(
    experiment: &Experiment,
    problem: &Problem,
    settings: &SearchSettings<'_>,
    mut progress: impl FnMut(Progress) + Send,
) -> Result<Option<Outcome>, ModelError> {
    let outcome = parallel::with_threads(settings.threads, || {
        search_on_threads(experiment, problem, settings, &mut progress)
    });
    // The results of a cancelled search are incomplete.
    problem.cancellation.check()?;
    outcome
}

/// The search itself, on the threads that [`search`] provides.
fn search_on_threads(
    experiment: &Experiment,
    problem: &Problem,
    settings: &SearchSettings<'_>,
    progress: &mut (impl FnMut(Progress) + Send),
) -> Result<Option<Outcome>, ModelError> {
    let Experiment { patch, fit, .. } = experiment;
    progress(Progress::of(SearchPhase::Base));
    let Some(base) = fit_base(problem, patch, fit, settings.seed)? else { return Ok(None) };
    if is_noise_only(problem) {
        return inconclusive_outcome(problem, base, Inconclusive::NoMotion, settings.seed).map(Some);
    }
    if agrees_within_noise(experiment, &base) {
        return match has_motion_above_noise(problem) {
            true => agreeing_outcome(problem, base, settings.seed),
            false => inconclusive_outcome(problem, base, Inconclusive::NoiseAboveMotion, settings.seed),
        }
        .map(Some);
    }
    if let Some(divergence) = find_divergence(problem, &base)? {
        let reason = Inconclusive::Divergence(divergence);
        return inconclusive_outcome(problem, base, reason, settings.seed).map(Some);
    }
    let refinement = step_refinement(problem, &base)?;
    // If the solver cannot follow the patch, times that are too long are the usual cause, and other fits take minutes.
    let find = if refinement.exceeds_noise() { find_long_times } else { find_misspecification };
    if let Some(misspecification) = find(problem, &base, patch, fit, settings.seed)? {
        let reason = Inconclusive::Misspecification(misspecification);
        return inconclusive_outcome(problem, base, reason, settings.seed).map(Some);
    }
    if refinement.exceeds_noise() {
        let reason = Inconclusive::SolverError(refinement);
        return inconclusive_outcome(problem, base, reason, settings.seed).map(Some);
    }
    let (base, state, before_tentative) = run_rounds(problem, base, settings, progress)?;
    let state = match before_tentative {
        None => refine(problem, &base, state, true, settings, progress)?,
        Some(before) => refine(problem, &base, state, false, settings, progress)?.prefer_longer(before),
    };
    let state = search_pairs(problem, &base, state, settings, progress)?;
    judge(problem, base, state, settings, progress).map(Some)
}

/// Runs rounds as long as an effect is added.
///
/// Returns three things: the fit of the patch as it is, which a trial may have improved; the state after the last
/// round; and the state before the first tentative effect, if one was added.
fn run_rounds(
    problem: &Problem,
    mut base: FittedModel,
    settings: &SearchSettings<'_>,
    progress: &mut (impl FnMut(Progress) + Send),
) -> Result<(FittedModel, SearchState, Option<SearchState>), ModelError> {
    let mut state = SearchState::new(base.clone());
    let (mut refits, mut before_tentative) = (0, None);
    while state.rounds.len() < MAX_EFFECTS {
        if is_drive_noise(problem, &state.model)? {
            break;
        }
        let round = run_round(problem, &state.model, &state.effects, None, settings, progress)?;
        // The estimate of a trial may be a better start for the patch without its effect.
        let better = match refits < MAX_REFITS {
            true => better_base(problem, &state.model, &round)?,
            false => None,
        };
        if better.is_some_and(|better| state.adopt_better_fit(better)) {
            if state.rounds.is_empty() {
                base = state.model.clone();
            }
            refits += 1;
            continue;
        }
        if round.tentative && before_tentative.is_none() {
            before_tentative = Some(state.with_round(&round));
        }
        if !state.add_round(round) || !state.model.residuals_are_coloured() {
            break;
        }
    }
    Ok((base, state, before_tentative))
}

/// A better fit of `model` from the estimates of the best trials. None if no trial leads to one.
fn better_base(
    problem: &Problem,
    model: &FittedModel,
    round: &Round,
) -> Result<Option<FittedModel>, ModelError> {
    let starts = &round.trials[..round.trials.len().min(REFIT_STARTS)];
    let refits = parallel::map(starts, |trial| refit_from_trial(problem, model, &trial.model), |_| ());
    refits.into_iter().find_map(Result::transpose).transpose()
}
