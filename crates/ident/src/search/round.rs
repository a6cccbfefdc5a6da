//! A round of a search: trials on one patch, their comparison, and the decision whether the best one is added.
//!
//! Trials are sorted by `delta_bic`. The best one is then compared with every other trial on the training and
//! validation records, block by block. A trial that is better on all records, simpler, or better validated moves to
//! the front. The best trial is taken if its `delta_bic` is large enough and the validation records confirm it.

use std::mem;

use crate::effects::PlacedEffect;
use crate::effects::candidate::Candidate;
use crate::fit::estimate::FitResult;
use crate::fit::extended_model::SkippedTrial;
use crate::fit::fitted_model::FittedModel;
use crate::statistics::acceptance::{AcceptanceCriterion, CONFIRMATION_Z, RIVAL_Z, required_delta_bic};
use crate::statistics::block_comparison::{Advantage, advantage};

/// A patch extended by one effect, fitted.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Trial {
    /// The effect at its site.
    pub candidate: Candidate,
    /// The patch with the effect, fitted.
    pub model: FittedModel,
    /// Decrease of the Bayesian information criterion (Schwarz) by the effect:
    /// (chi2 without - chi2 with) / (s2 m) - k ln(n / m).
    ///
    /// Here n is the number of samples and k the number of additional parameters. Initial voltages do not count,
    /// since their effect decays and more data do not determine them better. The variance s2 and the autocorrelation
    /// time m, in samples, are those of the best trial's residual.
    pub delta_bic: f64,
    /// Advantage of the best trial over this one: how much less it leaves of the records.
    pub best_advantage: Advantage,
}

/// The trials of one round on one patch.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Round {
    /// The patch without the effects of this round.
    pub before: FittedModel,
    /// Effects of other rounds in that patch. Empty in the first round, until the refinement repeats it.
    pub other_effects: Vec<PlacedEffect>,
    /// All trials, the best first.
    pub trials: Vec<Trial>,
    /// Effects that could not be tried at a site.
    pub skipped: Vec<SkippedTrial>,
    /// Advantage of the best trial over `before` on the validation records.
    pub validation_advantage: Advantage,
    /// The `delta_bic` that the best trial needs. It increases with the number of trials.
    pub required_delta_bic: f64,
    /// Number of trials that the data cannot distinguish from the best, which is counted too. Zero without trials.
    pub tied: usize,
    /// Whether the best trial is taken.
    pub taken: bool,
    /// Whether the best trial is not taken, but may be part of a pair of missing effects.
    pub tentative: bool,
    /// Decrease of chi2 that an additional parameter must bring.
    chi2_per_parameter: f64,
}

/// Maximum reduced chi2 of the validation records for a trial that predicts them. The value leaves room for chance.
const MAX_VALIDATION_CHI2: f64 = 1.2;
/// A trial with more parameters than the best is a rival only if its `delta_bic` is lower by less than this. A
/// difference of 6 is strong evidence by the usual scale for BIC.
const TIE_DELTA_BIC: f64 = 6.0;
/// Minimum advantage of a trial over an alias with fewer parameters, in standard errors. With less, it counts as its
/// alias.
const MIN_ALIAS_ADVANTAGE: f64 = 1.0;
/// Minimum fraction of the excess chi2 that an effect must explain next to others, unless its residual is white.
pub(crate) const MIN_EXPLAINED_FRACTION: f64 = 0.5;
/// Factor on the required `delta_bic` of an effect next to others. An inexact law of another effect leaves a residual
/// that a second effect can follow.
const ADDITIONAL_EFFECT_FACTOR: f64 = 2.0;
/// Minimum advantage on the validation records for a tentative effect, in standard errors.
const MIN_TENTATIVE_ADVANTAGE: f64 = 1.0;
/// Maximum number of tentative candidates from which pairs are tried.
const MAX_TENTATIVE: usize = 3;
/// Ratio of excess reduced chi2 from which one model is far better than another.
const DISTINCT_EXCESS_RATIO: f64 = 3.0;

impl Trial {
    /// The names of the effect and of the element that it acts on.
    pub fn placed_effect(&self) -> PlacedEffect {
        self.candidate.placed_effect()
    }

    /// Number of fitted parameters.
    fn parameter_count(&self) -> usize {
        self.model.variant.fit.len()
    }

    /// Whether the residual is white and the validation records leave no more than noise.
    fn predicts_validation(&self) -> bool {
        !self.model.residuals_are_coloured() && self.model.validation.reduced_chi2() < MAX_VALIDATION_CHI2
    }

    /// Whether `other` is an alias with fewer parameters that is about as good, given this trial's advantage over it
    /// in standard errors. If the residual is coloured, the additional parameters only follow what neither law
    /// explains.
    fn is_redundant_alias(&self, other: &Trial, advantage_ratio: f64) -> bool {
        let is_richer =
            self.parameter_count() > other.parameter_count() && self.model.residuals_are_coloured();
        is_richer && advantage_ratio < MIN_ALIAS_ADVANTAGE && self.candidate.has_alias(&other.candidate)
    }

    /// Advantage of `other` over this trial on all records.
    ///
    /// A change of the real system before the validation records blurs this comparison. So the training records alone
    /// decide if they favour `other` more clearly, `other` has no more parameters and a coloured residual, and all
    /// records favour it too.
    fn advantage_of(&self, other: &Trial) -> Advantage {
        let train = advantage(&self.model.train.residuals, &other.model.train.residuals);
        let all =
            train.combined(advantage(&self.model.validation.residuals, &other.model.validation.residuals));
        let is_fair =
            other.parameter_count() <= self.parameter_count() && other.model.residuals_are_coloured();
        if is_fair && all.sum > 0.0 && train.z_score() > all.z_score() { train } else { all }
    }
}

impl Round {
    /// A round with trials on the patch `before`, compared and judged.
    pub(crate) fn new(
        before: &FittedModel,
        other_effects: Vec<PlacedEffect>,
        tried: Vec<(Candidate, FittedModel)>,
    ) -> Round {
        let (variance, autocorrelation_time) = score_unit(tried.iter().map(|(_, model)| model));
        let per_parameter = libm::log(before.train.data_count as f64 / autocorrelation_time);
        let delta_bic = |model: &FittedModel| {
            let parameters = (model.variant.fit.len() - before.variant.fit.len()) as f64;
            (before.train.chi2 - model.train.chi2) / (variance * autocorrelation_time)
                - parameters * per_parameter
        };
        let no_advantage = Advantage { sum: 0.0, standard_error: 0.0, degrees_of_freedom: 0 };
        let trial = |(candidate, model): (Candidate, FittedModel)| Trial {
            delta_bic: delta_bic(&model),
            candidate,
            model,
            best_advantage: no_advantage,
        };
        let mut trials: Vec<Trial> = tried.into_iter().map(trial).collect();
        trials.sort_by(|a, b| b.delta_bic.total_cmp(&a.delta_bic));
        let required = required_delta_bic(trials.len());
        let required = if other_effects.is_empty() { required } else { ADDITIONAL_EFFECT_FACTOR * required };
        let mut round = Round {
            before: before.clone(),
            other_effects,
            trials,
            skipped: Vec::new(),
            validation_advantage: no_advantage,
            required_delta_bic: required,
            tied: 0,
            taken: false,
            tentative: false,
            chi2_per_parameter: variance * autocorrelation_time * per_parameter,
        };
        round.judge();
        round
    }

    /// Judges the trials again with a better fit of the best one, and returns the new best trial.
    ///
    /// Returns None, and keeps the round, if the new best is neither taken nor, in a round that was tentative,
    /// tentative again.
    pub(crate) fn rejudge(&mut self, better: FittedModel) -> Option<Trial> {
        let mut tried: Vec<(Candidate, FittedModel)> =
            self.trials.iter().map(|trial| (trial.candidate.clone(), trial.model.clone())).collect();
        tried.first_mut()?.1 = better;
        let rejudged = Round::new(&self.before, self.other_effects.clone(), tried);
        let is_accepted = rejudged.taken || (self.tentative && rejudged.tentative);
        let best = is_accepted.then(|| rejudged.trials[0].clone())?;
        *self = Round { skipped: mem::take(&mut self.skipped), ..rejudged };
        Some(best)
    }

    /// The trials that may be half of a pair, as indices, the best first: at most one per effect and at most three.
    /// The best trial is left out if the round is tentative, since the search has continued with it.
    pub(crate) fn tentative_candidates(&self) -> Vec<usize> {
        let names: Vec<&str> = self.trials.iter().map(|trial| trial.candidate.effect.as_str()).collect();
        let is_candidate = |index: &usize| {
            let trial = &self.trials[*index];
            let is_sufficient = trial.delta_bic > self.required_delta_bic
                && trial.model.explained_fraction(&self.before) > MIN_EXPLAINED_FRACTION;
            is_sufficient && trial.model.residuals_are_coloured() && !names[..*index].contains(&names[*index])
        };
        (usize::from(self.tentative)..names.len()).filter(is_candidate).take(MAX_TENTATIVE).collect()
    }

    /// Whether the search adds the best effect, as taken or as tentative.
    pub(crate) fn has_accepted_effect(&self) -> bool {
        self.taken || self.tentative
    }

    /// Fraction of the excess chi2 of `before` that the best trial explains, at most 1. Zero without trials.
    pub fn explained_fraction(&self) -> f64 {
        self.trials.first().map_or(0.0, |best| best.model.explained_fraction(&self.before))
    }

    /// Whether the best trial explains enough next to the effects of other rounds: half of the excess chi2, or all of
    /// it up to white noise. An effect whose real law differs from that of the library always leaves a residual.
    pub fn has_sufficient_effect(&self) -> bool {
        let is_white = self.trials.first().is_some_and(|best| !best.model.residuals_are_coloured());
        self.other_effects.is_empty() || is_white || self.explained_fraction() > MIN_EXPLAINED_FRACTION
    }

    /// The trials that the data cannot distinguish from the best one, without that.
    pub fn rivals(&self) -> impl Iterator<Item = &Trial> {
        self.trials.iter().skip(1).filter(|trial| self.is_tied(trial))
    }

    /// The best of the [`Self::rivals`]. None if there are none.
    pub fn rival(&self) -> Option<&Trial> {
        self.rival_index().map(|index| &self.trials[index])
    }

    /// The index of [`Self::rival`] in the trials.
    pub(crate) fn rival_index(&self) -> Option<usize> {
        (1..self.trials.len()).find(|index| self.is_tied(&self.trials[*index]))
    }

    /// The variance and autocorrelation time in `delta_bic`, and its required value.
    pub(crate) fn acceptance_criterion(&self) -> AcceptanceCriterion {
        let (noise_variance, autocorrelation_time) = score_unit(self.trials.iter().map(|trial| &trial.model));
        AcceptanceCriterion {
            noise_variance,
            autocorrelation_time,
            required_delta_bic: self.required_delta_bic,
        }
    }

    /// Finds the best trial and decides whether it is taken.
    fn judge(&mut self) {
        self.update_advantages();
        // A trial that explains the training and validation records better is better than its delta_bic says.
        let better = (1..self.trials.len()).filter(|index| self.is_better_overall(&self.trials[*index]));
        let ratio = |index: &usize| self.trials[*index].best_advantage.z_score();
        self.move_to_front(better.min_by(|a, b| ratio(a).total_cmp(&ratio(b))));
        // A trial with fewer parameters that is no worse on all records is preferred.
        let simpler = (1..self.trials.len()).find(|index| self.is_simpler(&self.trials[*index]));
        self.move_to_front(simpler);
        // Among trials with about the same delta_bic, one that predicts the validation records is preferred.
        let validated = (1..self.trials.len()).find(|index| self.is_better_validated(&self.trials[*index]));
        self.move_to_front(validated);
        let Some(best) = self.trials.first() else { return };
        self.validation_advantage =
            advantage(&self.before.validation.residuals, &best.model.validation.residuals);
        let is_visible = best.delta_bic > self.required_delta_bic && self.has_sufficient_effect();
        let is_predicted = best.predicts_validation()
            && self.validation_advantage.sum > self.required_delta_bic * best.model.autocorrelation_time;
        self.taken = is_visible && (self.validation_advantage.z_score() > CONFIRMATION_Z || is_predicted);
        let is_plausible = self.validation_advantage.z_score() > MIN_TENTATIVE_ADVANTAGE
            && self.explained_fraction() > MIN_EXPLAINED_FRACTION;
        self.tentative = is_visible && !self.taken && is_plausible && best.model.residuals_are_coloured();
        self.tied = 1 + self.rivals().count();
    }

    /// Moves a trial to the front, if there is one, and compares all trials with it.
    fn move_to_front(&mut self, index: Option<usize>) {
        if let Some(index) = index {
            self.trials[..=index].rotate_right(1);
            self.update_advantages();
        }
    }

    fn update_advantages(&mut self) {
        let advantages: Vec<Advantage> =
            self.trials.iter().map(|trial| trial.advantage_of(&self.trials[0])).collect();
        self.trials
            .iter_mut()
            .zip(advantages)
            .for_each(|(trial, best_advantage)| trial.best_advantage = best_advantage);
    }

    /// Whether a trial is significantly better than the best one on all records, by more than its additional
    /// parameters cost.
    fn is_better_overall(&self, trial: &Trial) -> bool {
        let added = trial.parameter_count() as f64 - self.trials[0].parameter_count() as f64;
        let cost = self.chi2_per_parameter * added;
        let advantage = trial.best_advantage;
        trial.delta_bic > self.required_delta_bic && advantage.z_score() < -RIVAL_Z && -advantage.sum > cost
    }

    /// Whether a trial needs fewer parameters than the best one, is no worse, and the best one leaves a coloured
    /// residual.
    fn is_simpler(&self, trial: &Trial) -> bool {
        let best = &self.trials[0];
        let has_fewer =
            trial.parameter_count() < best.parameter_count() && best.model.residuals_are_coloured();
        let is_no_worse =
            trial.best_advantage.sum <= 0.0 || best.is_redundant_alias(trial, trial.best_advantage.z_score());
        has_fewer && trial.delta_bic > self.required_delta_bic && is_no_worse
    }

    /// Whether a trial has about the `delta_bic` of the best one and predicts the validation records, which the best
    /// one does not.
    fn is_better_validated(&self, trial: &Trial) -> bool {
        let best = &self.trials[0];
        let is_near =
            trial.delta_bic > self.required_delta_bic && best.delta_bic - trial.delta_bic < TIE_DELTA_BIC;
        is_near && trial.predicts_validation() && !best.predicts_validation()
    }

    /// Whether every trial of another effect leaves more than three times the excess reduced chi2 of the best trial.
    pub(crate) fn has_distinct_best(&self) -> bool {
        let Some(best) = self.trials.first() else { return false };
        let others = self.trials.iter().filter(|trial| trial.candidate.effect != best.candidate.effect);
        let least = others.map(|trial| trial.model.train.excess_reduced_chi2()).fold(f64::INFINITY, f64::min);
        least > DISTINCT_EXCESS_RATIO * best.model.train.excess_reduced_chi2()
    }

    /// By how much the `delta_bic` of a trial is lower than that of the best one. None unless only this distinguishes
    /// the two, that is, unless the comparison on all records does not.
    pub fn delta_bic_deficit(&self, trial: &Trial) -> Option<f64> {
        let deficit = self.trials[0].delta_bic - trial.delta_bic;
        (trial.best_advantage.z_score() < RIVAL_Z && deficit > 0.0).then_some(deficit)
    }

    /// Whether the data cannot distinguish a trial from the best one, and the two have different effects.
    pub(crate) fn is_tied(&self, trial: &Trial) -> bool {
        let best = &self.trials[0];
        // Additional parameters must improve the fit.
        let is_simple = trial.parameter_count() <= best.parameter_count();
        let is_worth_parameters = trial.best_advantage.sum < 0.0 || !best.model.residuals_are_coloured();
        let is_near = best.delta_bic - trial.delta_bic < TIE_DELTA_BIC && is_worth_parameters || is_simple;
        let is_near = is_near && trial.best_advantage.z_score() < RIVAL_Z;
        // A trial is no rival if its residual is coloured and that of the best one is white or far smaller.
        let leaves_far_more = |fit_of: fn(&FittedModel) -> &FitResult| {
            fit_of(&trial.model).excess_reduced_chi2()
                > DISTINCT_EXCESS_RATIO * fit_of(&best.model).excess_reduced_chi2()
        };
        let is_far = leaves_far_more(|model| &model.train) && leaves_far_more(|model| &model.validation);
        let is_as_good =
            !trial.model.residuals_are_coloured() || best.model.residuals_are_coloured() && !is_far;
        let is_as_good = is_as_good && !trial.is_redundant_alias(best, -trial.best_advantage.z_score());
        let is_visible = trial.delta_bic > self.required_delta_bic;
        trial.candidate.effect != best.candidate.effect && is_visible && is_near && is_as_good
    }
}

/// Whether `best`, the best of this number of trials, could reach the required `delta_bic` if its residual were white
/// and its additional parameters cost nothing.
pub(crate) fn can_be_visible(before: &FittedModel, best: &FittedModel, trials: usize) -> bool {
    before.train.chi2 - best.train.chi2 > required_delta_bic(trials) * best.train.reduced_chi2()
}

/// The unit of `delta_bic`: reduced chi2 and autocorrelation time, in samples, of the model with the smallest chi2.
/// Both are 1 without models.
fn score_unit<'m>(models: impl Iterator<Item = &'m FittedModel>) -> (f64, f64) {
    let best = models.min_by(|a, b| a.train.chi2.total_cmp(&b.train.chi2));
    best.map_or((1.0, 1.0), |best| {
        (best.train.reduced_chi2().max(f64::MIN_POSITIVE), best.autocorrelation_time)
    })
}

#[cfg(test)]
mod tests;
