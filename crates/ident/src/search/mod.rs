//! The search: every effect at every place that it fits, everything refitted, the best confirmed on what was held back; and
//! again, until what is left looks like noise or nothing more can be named.

pub mod inconclusive;
pub(crate) mod judgement;
pub(crate) mod means;
pub mod outcome;
pub(crate) mod pairs;
pub mod progress;
pub mod range_extension;
pub(crate) mod refinement;
pub mod round;
pub mod search_log;
pub(crate) mod state;
pub(crate) mod trials;
pub mod verdict;

use crate::fit::base_fit::fit_base;
use crate::fit::base_fit::refit_from_trial;
use crate::fit::fitted_model::Stage;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::residuals::divergence::divergence_of;
use crate::residuals::misspecification::misspecification_of;
use crate::residuals::residual_analysis::is_drive_noise;
use crate::search::inconclusive::Blind;
use crate::search::inconclusive::is_noise_alone;
use crate::search::judgement::judge;
use crate::search::judgement::unjudged;
use crate::search::pairs::search_pairs;
use crate::search::progress::{Part, Progress};
use crate::search::refinement::refine;
use crate::search::round::Round;
use crate::search::state::Come;
use crate::search::trials::run_round;
use patchcord_analysis::{pool, spare};
use patchcord_core::patch::Patch;

pub use means::Means;
pub use outcome::Outcome;
pub use verdict::Verdict;

/// From where so many of the best trials came to the patch is fitted again.
const LOOKED_AT: usize = 3;
/// So often a round is made again because the patch before it could be fitted better.
const MOST_BETTERED: usize = 3;
/// How many effects are looked for at most.
const MOST_EFFECTS: usize = 3;

/// Searches for what a patch lacks. `progress` is told how far it has come.
///
/// # Errors
/// When the patch cannot be run beside the records.
pub fn search(
    problem: &Problem,
    patch: &Patch,
    fit: &[String],
    with: &Means<'_>,
    mut progress: impl FnMut(Progress),
) -> Result<Option<Outcome>, ModelError> {
    spare::with_threads(with.threads, || search_on_threads(problem, patch, fit, with, &mut progress))
}

/// What comes of it, on the threads that it has.
fn search_on_threads(
    problem: &Problem,
    patch: &Patch,
    fit: &[String],
    with: &Means<'_>,
    progress: &mut impl FnMut(Progress),
) -> Result<Option<Outcome>, ModelError> {
    progress(Progress::of(Part::Base));
    let Some(base) = fit_base(problem, patch, fit, with.seed)? else { return Ok(None) };
    if is_noise_alone(problem) {
        return unjudged(problem, base, Blind::Still, with.seed).map(Some);
    }
    if let Some(runaway) = divergence_of(problem, &base)? {
        return unjudged(problem, base, Blind::Runaway(runaway), with.seed).map(Some);
    }
    if let Some(mistold) = misspecification_of(problem, &base, patch, fit, with.seed)? {
        return unjudged(problem, base, Blind::Mistold(mistold), with.seed).map(Some);
    }
    let (base, come, before_promise) = run_rounds(problem, base, with, progress)?;
    let come = match before_promise {
        None => refine(problem, &base, come, true, with, progress)?,
        Some(before) => refine(problem, &base, come, false, with, progress)?.or(before),
    };
    let come = search_pairs(problem, &base, come, with, progress)?;
    judge(problem, base, come, with, progress).map(Some)
}

/// Round after round, as long as something is taken: the patch as it was, which a trial may have shown to fit better, where that
/// leads, and where it had led before something was gone on from that is not confirmed.
fn run_rounds(
    problem: &Problem,
    mut base: Stage,
    with: &Means<'_>,
    progress: &mut impl FnMut(Progress),
) -> Result<(Stage, Come, Option<Come>), ModelError> {
    let mut come = Come::begun(base.clone());
    let (mut bettered, mut before_promise) = (0, None);
    while come.rounds.len() < MOST_EFFECTS {
        if is_drive_noise(problem, &come.stage, with.threads)? {
            break;
        }
        let round = run_round(problem, &come.stage, &come.effects, None, with, progress)?;
        // A trial may have found what the patch alone could have been fitted to.
        let better = match bettered < MOST_BETTERED {
            true => better_base(problem, &come.stage, &round, with.threads)?,
            false => None,
        };
        if better.is_some_and(|better| come.is_bettered_by(better)) {
            if come.rounds.is_empty() {
                base = come.stage.clone();
            }
            bettered += 1;
            continue;
        }
        if round.promising && before_promise.is_none() {
            before_promise = Some(come.and(&round));
        }
        if !come.goes_on_with(round) || !come.stage.leaves_structure() {
            break;
        }
    }
    Ok((base, come, before_promise))
}

/// The patch of a stage fitted better, from where the best trials came to.
fn better_base(
    problem: &Problem,
    stage: &Stage,
    round: &Round,
    threads: usize,
) -> Result<Option<Stage>, ModelError> {
    let looked_at = &round.trials[..round.trials.len().min(LOOKED_AT)];
    let again =
        pool::each(looked_at, threads, |trial| refit_from_trial(problem, stage, &trial.stage), |_| ());
    again.into_iter().find_map(Result::transpose).transpose()
}
