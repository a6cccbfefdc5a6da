//! The verdict and the outcome of a search, from its rounds.

use crate::design::detectability::detection_limit::DetectionLimit;
use crate::design::detectability::detection_limits;
use crate::design::discriminating_experiment::discriminating_experiment;
use crate::design::discriminating_experiment::{DiscriminatingExperiment, Rival};
use crate::effects::candidate::Candidate;
use crate::effects::effect_sites::EffectSites;
use crate::fit::fitted_model::FittedModel;
use crate::fit::intervals::with_standard_errors;
use crate::fit::model::ModelError;
use crate::fit::overload::first_overload;
use crate::fit::problem::Problem;
use crate::fit::starts::agreement_of_starts;
use crate::fit::step_size::step_refinement;
use crate::localise::localisation::{Localisation, largest_evidence};
use crate::localise::localise;
use crate::residuals::correlation::residual_correlations;
use crate::residuals::residual_analysis::coloured_residual;
use crate::residuals::residual_analysis::slow_sensor_noise;
use crate::search::inconclusive::Inconclusive;
use crate::search::inconclusive::why_inconclusive;
use crate::search::outcome::{Outcome, is_residual_substantial, taken_rounds};
use crate::search::progress::{Progress, SearchPhase};
use crate::search::range_extension::{RangeExtension, extend_ranges};
use crate::search::refinement::backward_eliminate;
use crate::search::round::Round;
use crate::search::settings::SearchSettings;
use crate::search::state::SearchState;
use crate::search::verdict::Verdict;

/// A force curve over a signal refutes the named effects if its unexplained fraction is less than this multiple of
/// theirs, both in squares.
const REFUTING_CURVE_RATIO: f64 = 0.5;
/// Maximum fraction of the excess rms that one named effect may leave. With n effects the limit is sqrt(n) times as
/// large.
///
/// The real law of an effect differs from that of the library. In docs/measured.md, friction leaves 32 % on a slide.
/// In docs/hidden-effects.md, ten of 130 unknown effects get a name at this limit. At 30 % it was one to eight.
const MAX_REMAINING_FRACTION: f64 = 0.35;

/// Derives the verdict from the final state, and collects everything that the report needs.
///
/// # Errors
/// If the patch cannot be simulated with the drives of the records.
pub(crate) fn judge(
    problem: &Problem,
    base: FittedModel,
    state: SearchState,
    settings: &SearchSettings<'_>,
    progress: &mut (impl FnMut(Progress) + Send),
) -> Result<Outcome, ModelError> {
    let SearchState { mut rounds, effects, model: final_model, search_log } =
        backward_eliminate(problem, &base, state, settings)?;
    // Detection limits are needed only if no effect was found.
    let empty_round = rounds.first().filter(|_| effects.is_empty());
    let limits = empty_round.map(|round| limits_of_round(problem, round)).transpose()?;
    let detection_limits = limits.unwrap_or_default();
    let added: Vec<_> = effects.iter().map(Candidate::placed_effect).collect();
    let mut progress = |phase: Progress| progress(Progress { added: added.clone(), ..phase });
    let conclusion = conclude(problem, &base, &final_model, &rounds, &detection_limits, &mut progress)?;
    let range_extension = extend_ranges(problem, &base, &final_model)?;
    let conclusion = conclusion.considering(range_extension.as_ref());
    let Conclusion { verdict, inconclusive, localisations } =
        conclusion.considering_solver_error(problem, &base, &final_model)?;
    let is_ambiguous = verdict == Verdict::Ambiguous;
    let discriminating_experiment = if is_ambiguous { discriminate(problem, &rounds)? } else { None };
    add_errors_of_rivals(problem, &mut rounds)?;
    let reported = if verdict.has_names() { &final_model } else { &base };
    Ok(Outcome {
        verdict,
        agrees_within_noise: false,
        seed: settings.seed,
        step_refinement: step_refinement(problem, reported)?,
        overload: first_overload(problem, reported)?,
        agreement: agreement_of_starts(problem, &base, settings.seed)?,
        correlations: residual_correlations(problem, &base)?,
        effect_sites: EffectSites::of(base.variant.patch(), &problem.drives, settings.library)?,
        remaining_fraction: final_model.excess_rms() / base.excess_rms(),
        base: with_standard_errors(problem, base)?,
        rounds,
        effects,
        search_log,
        final_model,
        localisations,
        detection_limits,
        range_extension,
        inconclusive,
        discriminating_experiment,
    })
}

/// Computes the standard errors of the best rival of every round.
fn add_errors_of_rivals(problem: &Problem, rounds: &mut [Round]) -> Result<(), ModelError> {
    for round in rounds {
        if let Some(rival) = round.rival_index() {
            round.trials[rival].model = with_standard_errors(problem, round.trials[rival].model.clone())?;
        }
    }
    Ok(())
}

/// A verdict with its reasons.
struct Conclusion {
    verdict: Verdict,
    /// Why the data are inconclusive. It is a reason to doubt the data even if the verdict is another.
    inconclusive: Option<Inconclusive>,
    /// The missing force at every junction. Empty if nothing is missing.
    localisations: Vec<Localisation>,
}

impl Conclusion {
    /// The conclusion if the fit with wider ranges is considered as well. It has a reason only if its verdict is that
    /// the data are inconclusive.
    fn considering(self, extension: Option<&RangeExtension>) -> Conclusion {
        let sufficient = extension.filter(|extension| extension.has_white_residual());
        let inconclusive = sufficient.map(|_| Inconclusive::RangeExtension).or(self.inconclusive);
        let verdict = extension.map_or(self.verdict, |extension| extension.adjust_verdict(self.verdict));
        let inconclusive = inconclusive.filter(|_| verdict == Verdict::CannotJudge);
        Conclusion { verdict, inconclusive, localisations: self.localisations }
    }

    /// The conclusion if the solver error of the reported model is considered as well. If it exceeds the noise, the data
    /// are inconclusive.
    ///
    /// # Errors
    /// If the patch cannot be simulated with the drives of the records.
    fn considering_solver_error(
        self,
        problem: &Problem,
        base: &FittedModel,
        final_model: &FittedModel,
    ) -> Result<Conclusion, ModelError> {
        let reported = if self.verdict.has_names() { final_model } else { base };
        let refinement = step_refinement(problem, reported)?;
        if self.verdict == Verdict::CannotJudge || !refinement.exceeds_noise() {
            return Ok(self);
        }
        let inconclusive = Some(Inconclusive::SolverError(refinement));
        Ok(Conclusion { verdict: Verdict::CannotJudge, inconclusive, localisations: Vec::new() })
    }
}

/// The verdict of the rounds, the reason why the data are inconclusive if they are, and the missing forces if one is
/// missing.
fn conclude(
    problem: &Problem,
    base: &FittedModel,
    final_model: &FittedModel,
    rounds: &[Round],
    limits: &[DetectionLimit],
    progress: &mut (impl FnMut(Progress) + Send),
) -> Result<Conclusion, ModelError> {
    let remaining_fraction = final_model.excess_rms() / base.excess_rms();
    let coloured = coloured_residual(problem, final_model)?;
    let is_noise = !final_model.residuals_are_coloured() || coloured.is_some();
    let taken = taken_rounds(rounds).count();
    let inconclusive = match coloured {
        Some(residual) => Some(Inconclusive::ColouredResidual(residual)),
        None if taken == 0 && is_noise => why_inconclusive(problem, base, rounds, limits)?,
        None => None,
    };
    let verdict = verdict_of(rounds, remaining_fraction, is_noise, inconclusive.is_some());
    if matches!(verdict, Verdict::NothingMissing | Verdict::CannotJudge) {
        return Ok(Conclusion { verdict, inconclusive, localisations: Vec::new() });
    }
    progress(Progress::of(SearchPhase::Localisation));
    let localisations = localise(problem, base)?;
    let slow_noise = match verdict == Verdict::UnknownEffect && taken == 0 {
        true => slow_sensor_noise(problem, base, largest_evidence(&localisations)),
        false => None,
    };
    if let Some(noise) = slow_noise {
        let inconclusive = Some(Inconclusive::SlowSensorNoise(noise));
        return Ok(Conclusion { verdict: Verdict::CannotJudge, inconclusive, localisations: Vec::new() });
    }
    let is_substantial = is_residual_substantial(final_model, remaining_fraction);
    let is_doubtful = verdict.has_names() && !is_noise && (taken > 1 || is_substantial);
    let is_unknown = is_doubtful
        && !is_convincing(base, final_model, rounds)
        && is_curve_far_better(&localisations, remaining_fraction);
    let verdict = if is_unknown { Verdict::UnknownEffect } else { verdict };
    Ok(Conclusion { verdict, inconclusive, localisations })
}

/// The detection limits of all effects that a round tried, the most detectable first.
fn limits_of_round(problem: &Problem, round: &Round) -> Result<Vec<DetectionLimit>, ModelError> {
    let tried: Vec<_> = round.trials.iter().map(|trial| (&trial.candidate, &trial.model.variant)).collect();
    detection_limits(problem, &round.before, round.acceptance_criterion(), &tried)
}

/// The experiment that distinguishes the best trial from its best rival, in the first taken round with a rival.
fn discriminate(problem: &Problem, rounds: &[Round]) -> Result<Option<DiscriminatingExperiment>, ModelError> {
    let tied = taken_rounds(rounds).find_map(|round| Some((round, [&round.trials[0], round.rival()?])));
    let Some((round, trials)) = tied else { return Ok(None) };
    let rivals = trials.map(|trial| Rival { candidate: &trial.candidate, model: &trial.model });
    discriminating_experiment(problem, rivals, round.acceptance_criterion().effective_variance())
}

/// The outcome for data in which no effect is searched, with the reason for this.
///
/// # Errors
/// If the patch cannot be simulated with the drives of the records.
pub(crate) fn inconclusive_outcome(
    problem: &Problem,
    base: FittedModel,
    reason: Inconclusive,
    seed: u64,
) -> Result<Outcome, ModelError> {
    let outcome = agreeing_outcome(problem, base, seed)?;
    let verdict = Verdict::CannotJudge;
    Ok(Outcome { verdict, agrees_within_noise: false, inconclusive: Some(reason), ..outcome })
}

/// The outcome for a patch whose residual is below the declared noise, so that no effect is searched.
///
/// # Errors
/// If the patch cannot be simulated with the drives of the records.
pub(crate) fn agreeing_outcome(
    problem: &Problem,
    base: FittedModel,
    seed: u64,
) -> Result<Outcome, ModelError> {
    let base = with_standard_errors(problem, base)?;
    Ok(Outcome {
        verdict: Verdict::NothingMissing,
        agrees_within_noise: true,
        seed,
        step_refinement: step_refinement(problem, &base)?,
        overload: first_overload(problem, &base)?,
        agreement: agreement_of_starts(problem, &base, seed)?,
        correlations: residual_correlations(problem, &base)?,
        final_model: base.clone(),
        base,
        rounds: Vec::new(),
        effects: Vec::new(),
        search_log: Vec::new(),
        remaining_fraction: 1.0,
        localisations: Vec::new(),
        detection_limits: Vec::new(),
        range_extension: None,
        inconclusive: None,
        discriminating_experiment: None,
        effect_sites: EffectSites::default(),
    })
}

/// The verdict of rounds whose effects leave `remaining_fraction` of the excess rms. `is_noise` says that the final
/// residual is explained by noise, `is_inconclusive` that there is a reason to doubt the data.
pub(crate) fn verdict_of(
    rounds: &[Round],
    remaining_fraction: f64,
    is_noise: bool,
    is_inconclusive: bool,
) -> Verdict {
    let taken = taken_rounds(rounds);
    let most = MAX_REMAINING_FRACTION * (taken.clone().count() as f64).sqrt();
    match (taken.clone().count(), is_noise) {
        (0, true) if is_inconclusive => Verdict::CannotJudge,
        (0, true) => Verdict::NothingMissing,
        (0, false) => Verdict::UnknownEffect,
        (_, false) if remaining_fraction > most => Verdict::UnknownEffect,
        _ if taken.clone().any(|round| round.tied > 1) => Verdict::Ambiguous,
        _ => Verdict::Named,
    }
}

/// Whether a named effect is accepted in spite of a coloured residual.
///
/// It must be the only one and far better than all others. Its strength must be inside its range. It must not push a
/// parameter of the patch to the end of its range.
fn is_convincing(base: &FittedModel, final_model: &FittedModel, rounds: &[Round]) -> bool {
    let is_only = taken_rounds(rounds).count() == 1;
    let is_inside_range = |round: &Round| !final_model.is_at_max_strength(&round.trials[0].candidate);
    is_only
        && rounds[0].has_distinct_best()
        && is_inside_range(&rounds[0])
        && final_model.indices_newly_at_range_end(base).next().is_none()
}

/// Whether a force over a signal explains far more than effects that leave `remaining_fraction` of the excess rms.
fn is_curve_far_better(localisations: &[Localisation], remaining_fraction: f64) -> bool {
    let best = localisations.first().and_then(|best| best.best_curve.map(|curve| &best.curves[curve]));
    best.is_some_and(|curve| {
        1.0 - curve.explained_fraction < REFUTING_CURVE_RATIO * remaining_fraction * remaining_fraction
    })
}
