//! What was found out by all that was tried.

use crate::design::detectability::detection_limit::Limit;
use crate::design::detectability::detection_limits;
use crate::design::discriminating_experiment::discriminating_experiment;
use crate::design::discriminating_experiment::{Rival, Separating};
use crate::effects::places::Places;
use crate::fit::fitted_model::Stage;
use crate::fit::intervals::with_errors;
use crate::fit::model::ModelError;
use crate::fit::overload::first_overload;
use crate::fit::problem::Problem;
use crate::fit::starts::agreement_of_starts;
use crate::fit::step_size::fineness_of;
use crate::localise::force::{Whereabouts, likeliest};
use crate::localise::localise;
use crate::residuals::correlation::correlations_of;
use crate::residuals::residual_analysis::coloured_residual;
use crate::residuals::residual_analysis::slow_sensor_noise;
use crate::search::inconclusive::Blind;
use crate::search::inconclusive::why_inconclusive;
use crate::search::means::Means;
use crate::search::outcome::{Outcome, leaves_much, taken};
use crate::search::progress::{Part, Progress};
use crate::search::range_extension::extend_ranges;
use crate::search::refinement::backward_eliminate;
use crate::search::round::{Round, Trial};
use crate::search::state::Come;
use crate::search::verdict::Verdict;

/// What is missing is no effect of the library if a force over what the patch does leaves less than this share, in squares, of what
/// the named effects leave.
const CURVE: f64 = 0.5;
/// So large a share of the gap may be left of an effect whose law has another shape than the library's; what several leave
/// adds up in squares. By docs/measured.md friction leaves 32 % on a slide; by docs/hidden-effects.md ten of 130 unknown effects get
/// a name so, where 30 % gave one to eight.
const MOST_LEFT: f64 = 0.35;

/// What was found out by all that was tried.
pub(crate) fn judge(
    problem: &Problem,
    base: Stage,
    come: Come,
    with: &Means<'_>,
    progress: &mut impl FnMut(Progress),
) -> Result<Outcome, ModelError> {
    let Come { mut rounds, effects, stage: last, way } = backward_eliminate(problem, &base, come, with)?;
    let left = last.gap() / base.gap();
    // What could be there unseen is asked where nothing was found.
    let nothing_in = rounds.first().filter(|_| effects.is_empty());
    let limits =
        nothing_in.map(|round| undetected(problem, round, with.threads)).transpose()?.unwrap_or_default();
    let (mut verdict, blind, whereabouts) =
        conclude(problem, &base, &last, &rounds, &limits, with, progress)?;
    let beyond = extend_ranges(problem, &base, &last)?;
    let blind = beyond.as_ref().filter(|own| own.leaves_noise()).map(|_| Blind::Beyond).or(blind);
    if let Some(own) = &beyond {
        verdict = own.weighed(verdict);
    }
    let is_ambiguous = verdict == Verdict::Ambiguous;
    let separating = if is_ambiguous { discriminate(problem, &rounds)? } else { None };
    for round in &mut rounds {
        if let Some(rival) = round.rival_place() {
            round.trials[rival].stage = with_errors(problem, round.trials[rival].stage.clone())?;
        }
    }
    let told = if verdict.has_names() { &last } else { &base };
    Ok(Outcome {
        verdict,
        fineness: fineness_of(problem, told)?,
        overload: first_overload(problem, told)?,
        agreement: agreement_of_starts(problem, &base, with.seed)?,
        correlations: correlations_of(problem, &base)?,
        places: Places::of(base.version.patch(), &problem.drives, with.library)?,
        base: with_errors(problem, base)?,
        rounds,
        effects,
        way,
        last,
        left,
        whereabouts,
        limits,
        beyond,
        blind: blind.filter(|_| verdict == Verdict::CannotJudge),
        separating,
    })
}

/// What rounds come to, why the data cannot judge where they cannot, and where something is missing where it is.
fn conclude(
    problem: &Problem,
    base: &Stage,
    last: &Stage,
    rounds: &[Round],
    limits: &[Limit],
    with: &Means<'_>,
    progress: &mut impl FnMut(Progress),
) -> Result<(Verdict, Option<Blind>, Vec<Whereabouts>), ModelError> {
    let left = last.gap() / base.gap();
    let not_white = coloured_residual(problem, last, with.threads)?;
    let leaves_noise = !last.leaves_structure() || not_white.is_some();
    let taken = taken(rounds).count();
    let blind = match not_white {
        Some(own) => Some(Blind::NotWhite(own)),
        None if taken == 0 && leaves_noise => why_inconclusive(problem, base, rounds, limits)?,
        None => None,
    };
    let verdict = verdict(rounds, left, leaves_noise, blind.is_some());
    if matches!(verdict, Verdict::NothingMissing | Verdict::CannotJudge) {
        return Ok((verdict, blind, Vec::new()));
    }
    progress(Progress::of(Part::Where));
    let whereabouts = localise(problem, base, with.threads)?;
    let slow = match verdict == Verdict::UnknownEffect && taken == 0 {
        true => slow_sensor_noise(problem, base, likeliest(&whereabouts)),
        false => None,
    };
    if let Some(slow) = slow {
        return Ok((Verdict::CannotJudge, Some(Blind::Slow(slow)), Vec::new()));
    }
    let is_doubtful = verdict.has_names() && !leaves_noise && (taken > 1 || leaves_much(last, left));
    let is_other = is_doubtful && !is_sure(base, last, rounds) && is_a_curve(&whereabouts, left);
    Ok((if is_other { Verdict::UnknownEffect } else { verdict }, blind, whereabouts))
}

/// The weakest effects that would have been seen of all that a round tried, those that show best first.
fn undetected(problem: &Problem, round: &Round, threads: usize) -> Result<Vec<Limit>, ModelError> {
    let tried: Vec<_> = round.trials.iter().map(|trial| (&trial.candidate, &trial.stage.version)).collect();
    detection_limits(problem, &round.before, round.bar(), &tried, threads)
}

/// The experiment that would tell the first two effects apart that a round took and the data cannot tell from each other.
fn discriminate(problem: &Problem, rounds: &[Round]) -> Result<Option<Separating>, ModelError> {
    let tied = taken(rounds).find_map(|round| Some((round, [&round.trials[0], round.rival()?])));
    let Some((round, trials)) = tied else { return Ok(None) };
    let names = trials.map(Trial::named);
    let rivals = [0, 1].map(|place| Rival { name: &names[place], stage: &trials[place].stage });
    discriminating_experiment(problem, rivals, round.bar().variance())
}

/// What comes of data that no effect is sought in.
pub(crate) fn unjudged(problem: &Problem, base: Stage, why: Blind, seed: u64) -> Result<Outcome, ModelError> {
    let base = with_errors(problem, base)?;
    Ok(Outcome {
        verdict: Verdict::CannotJudge,
        fineness: fineness_of(problem, &base)?,
        overload: first_overload(problem, &base)?,
        agreement: agreement_of_starts(problem, &base, seed)?,
        correlations: correlations_of(problem, &base)?,
        last: base.clone(),
        base,
        rounds: Vec::new(),
        effects: Vec::new(),
        way: Vec::new(),
        left: 1.0,
        whereabouts: Vec::new(),
        limits: Vec::new(),
        beyond: None,
        blind: Some(why),
        separating: None,
        places: Places::default(),
    })
}

/// What rounds come to that leave such a share of the gap.
pub(crate) fn verdict(rounds: &[Round], left: f64, leaves_noise: bool, is_blind: bool) -> Verdict {
    let taken = taken(rounds);
    let most_left = MOST_LEFT * (taken.clone().count() as f64).sqrt();
    match (taken.clone().count(), leaves_noise) {
        (0, true) if is_blind => Verdict::CannotJudge,
        (0, true) => Verdict::NothingMissing,
        (0, false) => Verdict::UnknownEffect,
        (_, false) if left > most_left => Verdict::UnknownEffect,
        _ if taken.clone().any(|round| round.tied > 1) => Verdict::Ambiguous,
        _ => Verdict::Named,
    }
}

/// Whether what leaves structure is to be believed all the same: one effect alone, that stands out, that is no stronger than it may
/// be, and beside which the patch does not ask for values beyond their ranges.
fn is_sure(base: &Stage, last: &Stage, rounds: &[Round]) -> bool {
    let is_alone = taken(rounds).count() == 1;
    let is_within = |round: &Round| !last.is_strongest(&round.trials[0].candidate);
    is_alone && rounds[0].stands_out() && is_within(&rounds[0]) && last.newly_at_end(base).next().is_none()
}

/// Whether a force over what the patch does explains far more than effects that leave such a share of the gap.
fn is_a_curve(whereabouts: &[Whereabouts], left: f64) -> bool {
    let best = whereabouts.first().and_then(|best| best.best.map(|place| &best.curves[place]));
    best.is_some_and(|curve| 1.0 - curve.explains < CURVE * left * left)
}
