//! The trials of a round.
//!
//! Every effect is first fitted quickly at every site. The best trials are then fitted completely, and with them
//! other forms and simpler effects that may overtake the best. If all residuals are large, the best trials are also
//! fitted to growing parts of the records. At the end the solver steps and the validation of the trials near the best
//! are checked.

use std::cmp::Reverse;
use std::sync::{Mutex, PoisonError};

use crate::effects::PlacedEffect;
use crate::effects::attach::EffectPlacement;
use crate::effects::candidate::Candidate;
use crate::fit::base_fit::finish;
use crate::fit::extended_model::find_sites;
use crate::fit::extended_model::fit_trial;
use crate::fit::extended_model::{SkipReason, SkippedTrial, TrialRequest};
use crate::fit::fitted_model::FittedModel;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::fit::schedule::Effort;
use crate::fit::signal_extents::SignalExtents;
use crate::fit::signal_extents::signal_extents;
use crate::search::progress::{Progress, SearchPhase, TrialResult};
use crate::search::round::{Round, can_be_visible};
use crate::search::settings::SearchSettings;
use patchcord_analysis::parallel;

/// Number of best trials that are fitted to growing parts of the records, if all residuals are large.
const GROWING_TRIALS: usize = 6;
/// Number of trials that are fitted completely after the quick fits.
const FULL_TRIALS: usize = 12;
/// The same in a round that repeats the search for an effect next to others. That effect is always fitted completely.
const REPEATED_FULL_TRIALS: usize = 6;
/// A trial with fewer parameters than the best is fitted completely if its chi2 is less than this multiple of the
/// best.
const SIMPLER_CHI2_RATIO: f64 = 3.0;
/// A trial is near the best if its chi2 is less than this multiple of the best. All forms of such an effect are
/// fitted completely, and its solver steps and its validation are checked.
const NEAR_CHI2_RATIO: f64 = 1.5;

/// An effect wired in, and the patch with it, fitted.
type FittedTrial = (Candidate, FittedModel);
/// A fitted trial. None if the effect cannot be tried at its site.
type TrialSlot = Option<FittedTrial>;
/// The trial with the smallest chi2 so far, as its index, and this chi2. None before the first fit.
type BestTrial = Mutex<Option<(usize, f64)>>;
/// Receives the phase, the number of completed trials, the number of all trials of the phase, and the trial that was
/// completed just now.
type ReportProgress<'p> = dyn FnMut(SearchPhase, u64, usize, Option<TrialResult>) + Send + 'p;

/// Fits every effect at every site to one patch.
pub(crate) struct TrialRunner<'a> {
    /// The data.
    pub problem: &'a Problem,
    /// The patch without the effects that are tried.
    pub model: &'a FittedModel,
    /// Largest values of the signals, by which effects are scaled.
    pub peaks: &'a SignalExtents,
    /// Every effect at every site. Trials are identified by their index in this list.
    pub placements: &'a [EffectPlacement<'a>],
    /// An earlier fit of one of the effects, if this round repeats the search for it.
    pub previous: Option<&'a PreviousFit<'a>>,
    /// The best trial so far, for reports on the progress.
    best: &'a BestTrial,
}

impl TrialRunner<'_> {
    /// Runs all trials. Returns the fitted ones in the order of `placements`, and the effects that could not be tried.
    ///
    /// # Errors
    /// If the patch cannot be simulated with the drives of the records, or the search is cancelled.
    pub(crate) fn run(
        &self,
        report: &mut ReportProgress<'_>,
    ) -> Result<(Vec<FittedTrial>, Vec<SkippedTrial>), ModelError> {
        let (mut slots, skipped) = self.fit_quickly(report)?;
        let full = if self.previous.is_some() { REPEATED_FULL_TRIALS } else { FULL_TRIALS };
        let mut fitted = self.survivors(&slots, full);
        self.fit_harder(&mut slots, &fitted, Effort::FULL, SearchPhase::Full, report)?;
        loop {
            let more = self.overlooked(&slots, &fitted);
            if more.is_empty() {
                break;
            }
            self.fit_harder(&mut slots, &more, Effort::FULL, SearchPhase::Full, report)?;
            fitted.extend(more);
        }
        let is_far = fitted.iter().flat_map(|trial| &slots[*trial]).all(|(_, model)| model.is_poor());
        if is_far && !self.problem.is_cut {
            let growing = self.survivors(&slots, GROWING_TRIALS);
            self.fit_harder(&mut slots, &growing, Effort::GROWING, SearchPhase::Growing, report)?;
        }
        Ok((self.finish_near_best(slots.into_iter().flatten().collect())?, skipped))
    }

    /// Fits a trial, and remembers it if it is the best so far.
    ///
    /// # Errors
    /// If the search is cancelled before the trial or during it. A trial that was cut short has no result.
    fn fit(
        &self,
        trial: usize,
        request: TrialRequest<'_>,
    ) -> Result<Result<FittedTrial, SkipReason>, ModelError> {
        self.problem.cancellation.check()?;
        let fitted = fit_trial(self.problem, self.model, &self.placements[trial], self.peaks, request);
        self.problem.cancellation.check()?;
        if let Ok((_, model)) = &fitted {
            let mut best = self.best.lock().unwrap_or_else(PoisonError::into_inner);
            remember_best(&mut best, trial, model.train.chi2);
        }
        Ok(fitted)
    }

    /// A completed trial with the smallest residual of these fits.
    fn trial_result<'m>(&self, trial: usize, fits: impl Iterator<Item = &'m FittedTrial>) -> TrialResult {
        let residuals = fits.map(|(_, model)| model.train.normalised_rms()).filter(|rms| rms.is_finite());
        let effect = self.placements[trial].placed_effect();
        TrialResult { effect, residual_rms: residuals.min_by(f64::total_cmp) }
    }

    /// Fits all trials quickly.
    ///
    /// # Errors
    /// If the search is cancelled.
    fn fit_quickly(
        &self,
        report: &mut ReportProgress<'_>,
    ) -> Result<(Vec<TrialSlot>, Vec<SkippedTrial>), ModelError> {
        let trials: Vec<usize> = (0..self.placements.len()).collect();
        let target_chi2 = self.model.train.chi2;
        let fit = |trial: &usize| {
            let effect_values =
                self.previous.and_then(|previous| previous.values_of(&self.placements[*trial]));
            self.fit(
                *trial,
                TrialRequest { effort: Effort::QUICK, target_chi2, previous: None, effect_values },
            )
        };
        report(SearchPhase::Quick, 0, trials.len(), None);
        let results = parallel::try_map(&trials, fit, |done, trial, result| {
            let result = self.trial_result(*trial, result.iter());
            report(SearchPhase::Quick, done, trials.len(), Some(result));
        })?;
        let mut skipped = Vec::new();
        let slots = self.placements.iter().zip(results).map(|(placement, result)| {
            result.map_err(|reason| skipped.push(SkippedTrial::new(placement, reason))).ok()
        });
        let slots = slots.collect();
        Ok((slots, skipped))
    }

    /// The `count` best trials, and the trial of the previous fit in addition.
    fn survivors(&self, slots: &[TrialSlot], count: usize) -> Vec<usize> {
        let mut best = best_trials(slots, count);
        let is_previous = |placement| self.previous.is_some_and(|previous| previous.is_of(placement));
        let previous = self.placements.iter().position(is_previous);
        best.extend(previous.filter(|trial| !best.contains(trial) && slots[*trial].is_some()));
        best
    }

    /// Fits some trials with more effort. A slot keeps its earlier fit if the new one fails or is worse.
    ///
    /// # Errors
    /// If the search is cancelled.
    fn fit_harder(
        &self,
        slots: &mut [TrialSlot],
        trials: &[usize],
        effort: Effort,
        phase: SearchPhase,
        report: &mut ReportProgress<'_>,
    ) -> Result<(), ModelError> {
        let without = self.model.train.chi2;
        let first = best_trials(slots, 1).first().copied();
        // A fit that cannot reach the chi2 of the best trial may stop early.
        let best = first.and_then(|trial| slots[trial].as_ref());
        let smallest = best.map_or(without, |(_, model)| model.train.chi2.min(without));
        // The longest fits run first, so that no thread waits for one at the end.
        let mut order = trials.to_vec();
        order.sort_by_key(|trial| {
            Reverse(slots[*trial].as_ref().map_or(0, |(_, model)| model.variant.cost()))
        });
        let fit = |trial: &usize| {
            let target_chi2 = if Some(*trial) == first { without } else { smallest };
            let previous = slots[*trial].as_ref().map(|(_, model)| model);
            let request = TrialRequest { effort, target_chi2, previous, effect_values: None };
            self.fit(*trial, request).map(Result::ok)
        };
        report(phase, 0, order.len(), None);
        let refits = parallel::try_map(&order, fit, |done, trial, refit| {
            let result = self.trial_result(*trial, slots[*trial].iter().chain(refit));
            report(phase, done, order.len(), Some(result));
        })?;
        for (trial, refit) in order.iter().zip(refits) {
            let is_complete = refit.is_some();
            slots[*trial] = better_of(slots[*trial].take(), refit);
            slots[*trial].iter_mut().for_each(|(_, model)| model.is_thorough |= is_complete);
        }
        Ok(())
    }

    /// Trials outside `fitted` that may still overtake the best one, although their quick fits are not among the
    /// best: other forms of effects near the best at the same junction, and effects with fewer parameters than the
    /// best. Empty if even the best trial improves the fit too little to be visible.
    fn overlooked(&self, slots: &[TrialSlot], fitted: &[usize]) -> Vec<usize> {
        let trial_at = |trial: usize| Some((&self.placements[trial], &slots[trial].as_ref()?.1));
        let best = best_trials(slots, 1).first().and_then(|best| trial_at(*best));
        let best = best.filter(|(_, model)| can_be_visible(self.model, model, slots.len()));
        let Some((_, best)) = best else { return Vec::new() };
        let is_within = |model: &FittedModel, ratio: f64| model.train.chi2 < ratio * best.train.chi2;
        let near = fitted.iter().filter_map(|trial| trial_at(*trial));
        let near = near.filter(|(_, model)| is_within(model, NEAR_CHI2_RATIO));
        let near: Vec<&EffectPlacement<'_>> = near.map(|(placement, _)| placement).collect();
        let may_overtake = |trial: &usize| {
            let Some((placement, model)) = trial_at(*trial).filter(|_| !fitted.contains(trial)) else {
                return false;
            };
            let is_form_of = |near: &&EffectPlacement<'_>| {
                placement.effect.name == near.effect.name && placement.site_name() == near.site_name()
            };
            let has_fewer = model.variant.fit.len() < best.variant.fit.len();
            near.iter().any(is_form_of) || has_fewer && is_within(model, SIMPLER_CHI2_RATIO)
        };
        (0..self.placements.len()).filter(may_overtake).collect()
    }

    /// Refines the solver steps and repeats the validation of the trials near the best, if necessary.
    fn finish_near_best(&self, trials: Vec<FittedTrial>) -> Result<Vec<FittedTrial>, ModelError> {
        let best = trials.iter().map(|(_, model)| model.train.chi2).fold(f64::INFINITY, f64::min);
        let finish = |(_, model): &FittedTrial| match model.train.chi2 < NEAR_CHI2_RATIO * best {
            true => finish(self.problem, model),
            false => Ok(None),
        };
        let finished = parallel::map(&trials, finish, |_| ());
        let pairs = trials.into_iter().zip(finished);
        pairs.map(|((candidate, model), finished)| Ok((candidate, finished?.unwrap_or(model)))).collect()
    }
}

/// Remembers a trial if it is better than the best so far. Of trials with the same chi2 the first in the list is better,
/// so the order in which threads complete them does not matter. A chi2 that is not finite is ignored.
fn remember_best(best: &mut Option<(usize, f64)>, trial: usize, chi2: f64) {
    let is_better = best.is_none_or(|(index, smallest)| (chi2, trial) < (smallest, index));
    if chi2.is_finite() && is_better {
        *best = Some((trial, chi2));
    }
}

/// The chi2 of a fit, for comparisons; infinity if it is not a number.
fn comparable_chi2(model: &FittedModel) -> f64 {
    if model.train.chi2.is_nan() { f64::INFINITY } else { model.train.chi2 }
}

/// The `count` trials with the smallest chi2, the best first. Empty slots do not count.
fn best_trials(slots: &[TrialSlot], count: usize) -> Vec<usize> {
    let chi2 =
        |trial: &usize| slots[*trial].as_ref().map_or(f64::INFINITY, |(_, model)| comparable_chi2(model));
    let mut order: Vec<usize> = (0..slots.len()).filter(|trial| slots[*trial].is_some()).collect();
    order.sort_by(|a, b| chi2(a).total_cmp(&chi2(b)));
    order.truncate(count);
    order
}

/// The trial with the smaller chi2.
fn better_of(one: TrialSlot, other: TrialSlot) -> TrialSlot {
    one.into_iter().chain(other).min_by(|(_, a), (_, b)| comparable_chi2(a).total_cmp(&comparable_chi2(b)))
}

/// Runs a round on a patch that already has `effects`. `previous` is an earlier fit of an effect whose search is
/// repeated.
///
/// # Errors
/// If the patch cannot be simulated with the drives of the records, or the search is cancelled.
pub(crate) fn run_round(
    problem: &Problem,
    model: &FittedModel,
    effects: &[Candidate],
    previous: Option<&PreviousFit<'_>>,
    settings: &SearchSettings<'_>,
    progress: &mut (impl FnMut(Progress) + Send),
) -> Result<Round, ModelError> {
    let sites = find_sites(problem, model)?;
    let peaks = signal_extents(problem, model)?;
    let is_new = |placement: &EffectPlacement<'_>| {
        placement.effect.is_repeatable() || effects.iter().all(|effect| !effect.is_placed_as(placement))
    };
    let placements = settings.library.iter().flat_map(|effect| EffectPlacement::all(effect, &sites));
    let placements: Vec<EffectPlacement<'_>> = placements.filter(is_new).collect();
    let number = effects.len() + 1;
    let added: Vec<PlacedEffect> = effects.iter().map(Candidate::placed_effect).collect();
    let best = BestTrial::default();
    let mut report = |phase, done, total: usize, trial: Option<TrialResult>| {
        let best = *best.lock().unwrap_or_else(PoisonError::into_inner);
        let best = best.map(|(trial, _)| placements[trial].placed_effect());
        let (total, added) = (total as u64, added.clone());
        progress(Progress { round: number, phase, done, total, added, best, trial });
    };
    let runner =
        TrialRunner { problem, model, peaks: &peaks, placements: &placements, previous, best: &best };
    let (trials, skipped) = runner.run(&mut report)?;
    let mut round = Round::new(model, added, trials);
    round.skipped = skipped;
    Ok(round)
}

/// An effect and its parameter values in an earlier fit.
pub(crate) struct PreviousFit<'a> {
    effect: &'a Candidate,
    /// The values of the effect's parameters, in their order.
    pub(crate) values: Vec<f64>,
}

impl<'a> PreviousFit<'a> {
    /// The values of an effect in a fitted model that contains it.
    pub(crate) fn new(effect: &'a Candidate, model: &FittedModel) -> Self {
        PreviousFit { effect, values: model.effect_parameters(effect).map(|(_, value, _)| value).collect() }
    }

    /// Whether this is a fit of the same effect in the same form at the same site.
    pub(crate) fn is_of(&self, placement: &EffectPlacement<'_>) -> bool {
        self.effect.is_placed_as(placement)
    }

    /// The values if the effect is the same. None otherwise.
    pub(crate) fn values_of(&self, placement: &EffectPlacement<'_>) -> Option<&[f64]> {
        self.is_of(placement).then_some(&*self.values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_trial_does_not_depend_on_the_order() {
        let trials = [(3, f64::NAN), (5, 2.0), (4, 1.0), (2, 1.0), (1, f64::INFINITY), (0, 1.5)];
        let best_of = |trials: &mut dyn Iterator<Item = (usize, f64)>| {
            let mut best = None;
            trials.for_each(|(trial, chi2)| remember_best(&mut best, trial, chi2));
            best
        };
        assert_eq!(best_of(&mut trials.into_iter()), Some((2, 1.0)));
        assert_eq!(best_of(&mut trials.into_iter().rev()), Some((2, 1.0)));
    }
}
