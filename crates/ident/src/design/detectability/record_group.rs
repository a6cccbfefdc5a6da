//! The training or the validation records with a fitted patch, and the response of their outputs to an effect.
//!
//! Training and validation records are treated alike. Their outputs are joined into one vector, so that projections
//! on the directions of a fit are simple products of vectors.

use std::ops::Range;

use crate::data::record::Record;
use crate::fit::estimate::{Estimate, FitResult};
use crate::fit::fitted_model::ModelVariant;
use crate::fit::levenberg_marquardt::{FitProblem, stacked_column};
use crate::fit::model::{Model, ModelError, OutputTrajectory, RunValues};
use crate::fit::problem::Problem;
use crate::fit::validation::QUICK_VALIDATION_ITERATIONS;
use crate::statistics::projection::{difference, orthonormal, remove_projections};

/// Change of an effect's initial voltages for their derivatives, in volts. It is small compared with the range of
/// ±100 V and large compared with rounding.
const STATE_PERTURBATION: f64 = 1e-3;

/// Some records with a fitted patch. All outputs of all records form one vector, over the noise. Missing samples are
/// 0 in it.
pub(super) struct RecordGroup<'a> {
    problem: &'a Problem,
    model: Model,
    records: &'a [Record],
    /// The estimate of the fitted patch.
    pub(super) estimate: &'a Estimate,
    /// The range of every record in the vector.
    pub(super) spans: Vec<Range<usize>>,
    /// Outputs of the fitted patch.
    simulated: Vec<f64>,
    /// Derivatives of the outputs with respect to the initial voltages, by record.
    pub(super) states: Vec<Vec<Vec<f64>>>,
    /// Derivatives of all outputs with respect to the fitted parameters, then to the declared offsets.
    pub(super) common: Vec<Vec<f64>>,
}

/// The response of a record group to an effect with some strength.
#[derive(Default)]
pub(super) struct EffectResponse {
    /// Change of all outputs.
    pub(super) outputs: Vec<f64>,
    /// Change of the outputs by a small initial voltage of the effect's integrators, by record.
    pub(super) states: Vec<Vec<Vec<f64>>>,
}

impl<'a> RecordGroup<'a> {
    /// Simulates the patch at an estimate and computes its derivatives. None if a record cannot be run.
    pub(super) fn new(
        problem: &'a Problem,
        variant: &ModelVariant,
        records: &'a [Record],
        estimate: &'a Estimate,
    ) -> Result<Option<RecordGroup<'a>>, ModelError> {
        let model = problem.model(variant, records, &problem.outputs)?;
        let mut group = RecordGroup {
            problem,
            model,
            records,
            estimate,
            spans: Vec::new(),
            simulated: Vec::new(),
            states: Vec::new(),
            common: Vec::new(),
        };
        let fit_problem = problem.fit_problem(&group.model, records, true);
        let coordinates = fit_problem.coordinates(estimate);
        let free: Vec<usize> =
            (0..fit_problem.shared_count()).filter(|index| fit_problem.is_free(*index)).collect();
        group.common = vec![Vec::new(); free.len()];
        for (record, data) in records.iter().enumerate() {
            let Some(trajectory) =
                group.model.run(record, &[fit_problem.run_values(&coordinates, record)]).pop().flatten()
            else {
                return Ok(None);
            };
            let responses = fit_problem.jacobian(&coordinates, record, &trajectory);
            let response = |index: usize| {
                group.without_missing(record, stacked_column(&responses, index, data.len()).into_iter())
            };
            let states = fit_problem.initial_indices(record).map(response).collect();
            let common: Vec<Vec<f64>> = free.iter().map(|index| response(*index)).collect();
            let simulated = group.over_noise(record, &trajectory);
            group.spans.push(group.simulated.len()..group.simulated.len() + simulated.len());
            group.simulated.extend(simulated);
            group.states.push(states);
            group.common.iter_mut().zip(common).for_each(|(all, record)| all.extend(record));
        }
        Ok(Some(group))
    }

    /// The values of all outputs of a record, one output after the other, with 0 for missing samples.
    fn without_missing(&self, record: usize, values: impl Iterator<Item = f64>) -> Vec<f64> {
        let data = self.records[record].outputs.iter().flatten();
        data.zip(values).map(|(datum, value)| if datum.is_nan() { 0.0 } else { value }).collect()
    }

    /// The outputs of a record as one vector over the noise.
    fn over_noise(&self, record: usize, trajectory: &OutputTrajectory) -> Vec<f64> {
        let tracks = trajectory.iter().zip(&self.problem.sigma);
        let scaled = tracks.flat_map(|(track, sigma)| track.iter().map(move |value| value / sigma));
        self.without_missing(record, scaled)
    }

    /// Splits a vector of all outputs by record and output.
    pub(super) fn tracks<'t>(&self, all: &'t [f64]) -> Vec<Vec<&'t [f64]>> {
        let tracks = self.spans.iter().zip(self.records);
        tracks.map(|(span, record)| all[span.clone()].chunks(record.len().max(1)).collect()).collect()
    }

    /// The records as a patch with the effect would produce them, without noise. Missing samples stay missing.
    fn changed_records(&self, response: &EffectResponse) -> Vec<Record> {
        let all: Vec<f64> = self
            .simulated
            .iter()
            .zip(&response.outputs)
            .map(|(simulated, change)| simulated + change)
            .collect();
        let records = self.records.iter().zip(self.tracks(&all));
        let changed = |(record, tracks): (&Record, Vec<&[f64]>)| {
            let outputs = record.outputs.iter().zip(tracks).zip(&self.problem.sigma);
            let outputs = outputs.map(|((data, track), sigma)| {
                let data = data.iter().zip(track);
                data.map(|(datum, value)| if datum.is_nan() { *datum } else { value * sigma }).collect()
            });
            Record { outputs: outputs.collect(), ..record.clone() }
        };
        records.map(changed).collect()
    }

    /// Fits the patch without the effect to the changed records, starting at `start`. None if the patch cannot be
    /// run.
    pub(super) fn fit(&self, response: &EffectResponse, start: &Estimate) -> Option<FitResult> {
        self.problem.fit_problem(&self.model, &self.changed_records(response), true).fit(start)
    }

    /// Fits only initial voltages and offsets to the changed records, with as few iterations as a first validation.
    pub(super) fn fit_states(&self, response: &EffectResponse, start: &Estimate) -> Option<FitResult> {
        let records = self.changed_records(response);
        let fit_problem = FitProblem {
            max_iterations: QUICK_VALIDATION_ITERATIONS,
            ..self.problem.fit_problem(&self.model, &records, false)
        };
        fit_problem.evaluate(&fit_problem.fit_initial(start)?)
    }

    /// The residual of a fit to the changed records that the effect's initial voltages do not follow.
    pub(super) fn residual(&self, response: &EffectResponse, fitted: &FitResult) -> Vec<f64> {
        let records = fitted.residuals.iter().enumerate();
        let mut residual: Vec<f64> = records
            .flat_map(|(record, outputs)| self.without_missing(record, outputs.iter().flatten().copied()))
            .collect();
        let states: Vec<_> =
            response.states.iter().map(|record| orthonormal(record.iter().cloned())).collect();
        remove_states(&states, &self.spans, &mut residual);
        residual
    }

    /// The change of an effect's initial voltage for its derivative, in volts. It is negative if the range ends at
    /// zero. `state` is the index among the effect's states.
    fn perturbation(&self, model: &Model, state: usize) -> f64 {
        let [_, high] = model.initial[self.estimate.initial[0].len() + state].range;
        if high < STATE_PERTURBATION { -STATE_PERTURBATION } else { STATE_PERTURBATION }
    }

    /// Parameters and initial voltages of a record for the patch with an effect. The effect's states start at 0 V.
    fn with_effect(&self, record: usize, parameters: &[f64], effect_states: usize) -> RunValues {
        RunValues {
            parameters: [self.estimate.parameters.as_slice(), parameters].concat(),
            initial: [self.estimate.initial[record].as_slice(), &vec![0.0; effect_states]].concat(),
        }
    }

    /// Outputs of the patch without the effect, by record. None for a record that cannot be run.
    ///
    /// `zero` has the effect's parameters at zero strength: the patch is run with the effect at these values. If it
    /// is None, the outputs are those of the fitted patch.
    pub(super) fn reference_outputs(
        &self,
        model: &Model,
        zero: Option<&[f64]>,
        effect_states: usize,
    ) -> Vec<Option<Vec<f64>>> {
        let at_zero = |record: usize, zero: &[f64]| {
            let choice = self.with_effect(record, zero, effect_states);
            let trajectory = model.run(record, &[choice]).pop().flatten()?;
            Some(self.over_noise(record, &trajectory))
        };
        let by_record = self.spans.iter().enumerate().map(|(record, span)| match zero {
            Some(zero) => at_zero(record, zero),
            None => Some(self.simulated[span.clone()].to_vec()),
        });
        by_record.collect()
    }

    /// The responses to several strengths of an effect, with `reference` as the outputs without it. Each strength has
    /// the values of all parameters of the effect. A response is None if a record cannot be run.
    ///
    /// The lanes of a record hold, for each strength, the effect itself and then one run per state of the effect with a
    /// changed initial voltage.
    pub(super) fn responses(
        &self,
        model: &Model,
        strengths: &[Vec<f64>],
        reference: &[Option<Vec<f64>>],
        effect_states: usize,
    ) -> Vec<Option<EffectResponse>> {
        let mut responses: Vec<Option<EffectResponse>> =
            strengths.iter().map(|_| Some(EffectResponse::default())).collect();
        let first_effect_state = self.estimate.initial[0].len();
        for (record, reference) in reference.iter().enumerate() {
            let lanes = strengths.iter().flat_map(|strength| {
                let perturbed = [None].into_iter().chain((0..effect_states).map(Some));
                perturbed.map(move |perturbed| {
                    let mut choice = self.with_effect(record, strength, effect_states);
                    perturbed.into_iter().for_each(|state| {
                        choice.initial[first_effect_state + state] += self.perturbation(model, state)
                    });
                    choice
                })
            });
            let mut trajectories = model.run(record, &lanes.collect::<Vec<_>>()).into_iter();
            let mut next =
                || trajectories.next().flatten().map(|trajectory| self.over_noise(record, &trajectory));
            for response in &mut responses {
                let with = next();
                let perturbed: Vec<_> = (0..effect_states).map(|_| next()).collect();
                let outputs = response.take().zip(reference.as_ref().zip(with));
                *response = outputs.map(|(mut response, (reference, with))| {
                    let perturbed = perturbed.into_iter().flatten();
                    response.states.push(perturbed.map(|outputs| difference(&outputs, &with)).collect());
                    response.outputs.extend(difference(&with, reference));
                    response
                });
            }
        }
        responses
    }
}

/// Removes the directions of initial voltages from a vector of all outputs. `states` has an orthonormal basis for
/// every record, `spans` the range of the record.
pub(super) fn remove_states(states: &[Vec<Vec<f64>>], spans: &[Range<usize>], track: &mut [f64]) {
    states.iter().zip(spans).for_each(|(basis, span)| remove_projections(basis, &mut track[span.clone()]));
}
