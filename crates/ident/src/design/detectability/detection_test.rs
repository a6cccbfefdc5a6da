//! The test whether a change of the outputs would be detected by a search.
//!
//! A search accepts an effect if its `delta_bic` is large enough in training and if the validation records confirm
//! it. Both are predicted from the change that the effect causes in the outputs, less the part that the fitted patch
//! can follow.

use crate::design::detectability::fit_directions::{FitDirections, TrainAndValidation};
use crate::design::detectability::record_group::{EffectResponse, RecordGroup};
use crate::fit::estimate::Estimate;
use crate::fit::fitted_model::FittedModel;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::statistics::acceptance::{AcceptanceCriterion, CONFIRMATION_Z};
use crate::statistics::block_comparison::expected_advantage;
use crate::statistics::projection::dot;

/// A fitted patch with its records, and the directions that its fit can follow.
pub(super) struct DetectionTest<'a> {
    /// The data.
    pub(crate) problem: &'a Problem,
    /// The fitted patch without the effect.
    pub(crate) before: &'a FittedModel,
    criterion: AcceptanceCriterion,
    pub(super) train: RecordGroup<'a>,
    pub(super) validation: RecordGroup<'a>,
    /// Directions of an effect without states.
    stateless: FitDirections,
}

impl<'a> DetectionTest<'a> {
    /// The test for effects that need this number of solver steps per sample. None if the patch cannot be run with
    /// these.
    pub(super) fn new(
        problem: &'a Problem,
        before: &'a FittedModel,
        criterion: AcceptanceCriterion,
        steps: u32,
    ) -> Result<Option<DetectionTest<'a>>, ModelError> {
        let variant = before.variant.with_steps(steps);
        let train = RecordGroup::new(problem, &variant, &problem.train, &before.train.estimate)?;
        let validation =
            RecordGroup::new(problem, &variant, &problem.validation, &before.validation.estimate)?;
        Ok(train.zip(validation).map(|(train, validation)| {
            let stateless = FitDirections::new([&train, &validation], variant.fit.len(), [&[], &[]]);
            DetectionTest { problem, before, criterion, train, validation, stateless }
        }))
    }

    /// The decrease of chi2, over the variance of the noise, that a trial with this number of additional parameters
    /// needs.
    pub(crate) fn required_decrease(&self, parameters: usize) -> f64 {
        let samples = self.before.train.data_count as f64 / self.criterion.autocorrelation_time;
        self.criterion.required_delta_bic + parameters as f64 * libm::log(samples)
    }

    /// The part of an effect's response that parameters, initial voltages and offsets do not follow, to first order.
    pub(super) fn residual(&self, [train, validation]: &[EffectResponse; 2]) -> TrainAndValidation {
        let with_states;
        let directions = match train.states.iter().all(Vec::is_empty) {
            true => &self.stateless,
            false => {
                let fit = self.before.variant.fit.len();
                let states = [&train.states[..], &validation.states[..]];
                with_states = FitDirections::new([&self.train, &self.validation], fit, states);
                &with_states
            }
        };
        let spans = [&self.train.spans[..], &self.validation.spans[..]];
        directions.remove_from(spans, [train.outputs.clone(), validation.outputs.clone()])
    }

    /// The same after complete fits to the changed outputs. None if a fit fails.
    pub(super) fn fitted_residual(
        &self,
        [train, validation]: &[EffectResponse; 2],
    ) -> Option<TrainAndValidation> {
        let fitted = self.train.fit(train, self.train.estimate)?;
        let start = Estimate { initial: self.validation.estimate.initial.clone(), ..fitted.estimate.clone() };
        let validated = self.validation.fit_states(validation, &start)?;
        Some([self.train.residual(train, &fitted), self.validation.residual(validation, &validated)])
    }

    /// The residual of a response over the smallest one that a search accepts, in squares. The effect is detected
    /// from 1 on.
    pub(super) fn margin(&self, [train, validation]: &TrainAndValidation, required_decrease: f64) -> f64 {
        let visible = dot(train, train) / (self.criterion.effective_variance() * required_decrease);
        let advantage =
            expected_advantage(&self.validation.tracks(validation), self.criterion.effective_variance());
        let confirmed = (advantage.z_score() / CONFIRMATION_Z).powi(2);
        visible.min(
            confirmed.max(
                advantage.sum / (self.criterion.effective_variance() * self.criterion.required_delta_bic),
            ),
        )
    }
}
