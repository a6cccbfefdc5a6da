//! Output-error fits by the method of Levenberg and Marquardt, within ranges.
//!
//! A [`FitProblem`] minimises the sum of squared residuals (data - model) / sigma. It changes the parameters, the
//! initial voltages of every record, and the offsets of outputs. Derivatives are finite differences: the disturbed runs
//! of a record are computed in one batch. Each iteration solves the damped normal equations and takes the best of
//! several dampings.
//!
//! The fit works in *coordinates*. First come the parameters as fractions of their ranges, 0 to 1. Then come the
//! offsets in units of sigma, then the initial voltages of every record in machine units of 100 V.

use std::ops::Range;

use nalgebra::DVector;

use crate::data::record::Record;
use crate::fit::estimate::{Estimate, FitResult, FitState};
use crate::fit::model::{Model, OutputTrajectory, RunValues};
use crate::fit::normal_equations::{JacobianColumn, NormalEquations};
use patchcord_analysis::parallel;
use patchcord_core::machines::REFERENCE;

/// A least-squares problem: a model, its records, and the settings of the fit.
#[derive(Debug, Clone, Copy)]
pub struct FitProblem<'a> {
    /// The model.
    pub model: &'a Model,
    /// The records, as many as the model was made for and in the same order.
    pub records: &'a [Record],
    /// Standard deviation of the noise of every output, in the unit of the output.
    pub sigma: &'a [f64],
    /// Whether the constant offset of each output is fitted.
    pub has_offset: &'a [bool],
    /// Whether the parameters are fitted. Initial voltages are fitted in any case.
    pub fits_parameters: bool,
    /// Index of a parameter that is not fitted although the others are.
    pub fixed_parameter: Option<usize>,
    /// A fit is given up if it is not expected to bring the sum of squares below this value. Infinite: never.
    pub target_chi2: f64,
    /// The largest number of iterations. Each computes the Jacobian once.
    pub max_iterations: usize,
    /// A fit has converged if an iteration decreases the sum of squares by less than this fraction of it.
    pub convergence_ratio: f64,
    /// The dampings that an iteration tries.
    pub damping_schedule: DampingSchedule,
}

/// The dampings that an iteration tries, from the weakest to the strongest, until a step decreases the sum of squares.
#[derive(Debug, Clone, Copy)]
pub struct DampingSchedule {
    /// The dampings of one attempt, relative to the present damping. Their runs are computed in one batch.
    parallel_factors: &'static [f64],
    /// The factor by which the damping grows after an attempt without a better step.
    growth: f64,
    /// The largest number of attempts per iteration.
    max_attempts: usize,
}

impl DampingSchedule {
    /// Several dampings in one batch, for fits that may have to go far.
    pub const PARALLEL: DampingSchedule =
        DampingSchedule { parallel_factors: &[0.1, 1.0, 10.0, 100.0], growth: 1e4, max_attempts: 3 };
    /// One damping after the other, for fits that are nearly complete or if a batch saves no time.
    pub const SEQUENTIAL: DampingSchedule =
        DampingSchedule { parallel_factors: &[0.3], growth: 3.0, max_attempts: 16 };
}

/// The default of [`FitProblem::max_iterations`].
pub const MAX_ITERATIONS: usize = 40;
/// No fit is given up before this number of iterations.
const MIN_ITERATIONS: usize = 4;
/// A decrease of the sum of squares below this value is negligible. If the mean square exceeds 1, the limit is this
/// fraction of the mean square.
const NEGLIGIBLE_DECREASE: f64 = 0.01;
/// The default of [`FitProblem::convergence_ratio`].
pub const CONVERGENCE_RATIO: f64 = 1e-6;
/// The number of records whose derivatives are in memory at the same time.
pub(crate) const RECORD_BATCH: usize = 8;
/// Finite-difference step in coordinates: a fraction of a parameter's range, or of 100 V. It is far
/// above the rounding error of a run and far below the curvature of most laws.
pub(crate) const DERIVATIVE_STEP: f64 = 1e-6;
/// A coordinate is not changed if its whole range changes the sum of squares by less than this.
const MIN_SENSITIVITY: f64 = 1.0;
/// With at least this many data per fitted value, all fitted values count as degrees of freedom. The error of the count
/// is then below 1 % of the data, and the Jacobian need not be computed.
const AMPLE_DATA_RATIO: usize = 100;

impl FitProblem<'_> {
    /// Fits from a start. `None` if the model cannot be run there.
    pub fn fit(&self, start: &Estimate) -> Option<FitResult> {
        self.evaluate(&self.optimise(start)?.estimate)
    }

    /// Fits only the initial voltages and offsets, and keeps the parameters. `None` if the model cannot be run there.
    pub(crate) fn fit_initial(&self, start: &Estimate) -> Option<Estimate> {
        let without_parameters = FitProblem { fits_parameters: false, ..*self };
        // Offsets are common to all records. Without offsets every record can be fitted separately.
        if self.has_offset.contains(&true) {
            return without_parameters.optimise(start).map(|state| state.estimate);
        }
        let initial = parallel::map_indices(self.records.len(), |record| {
            without_parameters.fit_record_initial(start, record)
        });
        Some(Estimate { initial: initial.into_iter().collect::<Option<_>>()?, ..start.clone() })
    }

    /// Fits the initial voltages of one record without the others.
    fn fit_record_initial(&self, start: &Estimate, record: usize) -> Option<Vec<f64>> {
        let (model, records) = (self.model.for_record(record), &self.records[record..=record]);
        let single = FitProblem { model: &model, records, ..*self };
        let start = Estimate { initial: vec![start.initial[record].clone()], ..start.clone() };
        single.optimise(&start)?.estimate.initial.pop()
    }

    /// Iterates from a start until the fit converges, is given up or reaches `max_iterations`. `None` if the model
    /// cannot be run from the start.
    pub fn optimise(&self, start: &Estimate) -> Option<FitState> {
        let mut coordinates = self.coordinates(start);
        let mut trajectories = self.trajectories(std::slice::from_ref(&coordinates)).pop()??;
        let mut chi2 = self.chi2(&coordinates, &trajectories);
        let mut damping = 1e-3;
        let mut is_finished = false;
        for iteration in 1..=self.max_iterations {
            let normal = self.normal_equations(&coordinates, &trajectories);
            let Some((next, next_trajectories, next_chi2, used_damping)) =
                self.best_step(&coordinates, chi2, &normal, damping)
            else {
                is_finished = true;
                break;
            };
            let decrease = chi2 - next_chi2;
            (coordinates, trajectories, chi2, damping) =
                (next, next_trajectories, next_chi2, used_damping / 3.0);
            is_finished = decrease < self.negligible_decrease(chi2)
                || self.is_target_unreachable(chi2, decrease, iteration);
            if is_finished {
                break;
            }
        }
        Some(FitState { estimate: self.estimate(&coordinates), chi2, is_finished })
    }

    /// The decrease of the sum of squares below which another iteration is not worthwhile.
    fn negligible_decrease(&self, chi2: f64) -> f64 {
        let samples: usize = self.records.iter().map(Record::len).sum();
        let mean_square = chi2 / (samples * self.sigma.len()).max(1) as f64;
        (NEGLIGIBLE_DECREASE * mean_square.max(1.0)).max(self.convergence_ratio * chi2)
    }

    /// Whether the fit would miss `target_chi2` even if every further iteration decreased the sum of squares as much as
    /// the last one.
    fn is_target_unreachable(&self, chi2: f64, decrease: f64, iterations: usize) -> bool {
        let remaining = MAX_ITERATIONS.saturating_sub(iterations);
        iterations >= MIN_ITERATIONS && chi2 - decrease * remaining as f64 > self.target_chi2
    }

    /// The sum of squares of each estimate. Infinite if the model cannot be run there.
    pub(crate) fn chi2_of_estimates(&self, estimates: &[Estimate]) -> Vec<f64> {
        let points: Vec<_> = estimates.iter().map(|estimate| self.coordinates(estimate)).collect();
        let all_trajectories = self.trajectories(&points);
        let pairs = points.iter().zip(&all_trajectories);
        pairs
            .map(|(point, trajectories)| {
                trajectories.as_ref().map_or(f64::INFINITY, |trajectories| self.chi2(point, trajectories))
            })
            .collect()
    }

    /// The number of parameters that are disturbed for derivatives.
    fn disturbed_parameter_count(&self) -> usize {
        if self.fits_parameters { self.model.parameters.len() } else { 0 }
    }

    /// The number of coordinates that all records share: parameters and offsets. Those of the records follow.
    pub(crate) fn shared_count(&self) -> usize {
        self.model.parameters.len() + self.sigma.len()
    }

    /// The coordinates of an estimate.
    ///
    /// Parameters are fractions of their ranges, offsets are in units of sigma, and the initial voltages of every
    /// record are in machine units.
    pub(crate) fn coordinates(&self, estimate: &Estimate) -> DVector<f64> {
        let parameters = self
            .model
            .parameters
            .iter()
            .zip(&estimate.parameters)
            .map(|(parameter, value)| parameter.fraction(*value));
        let offsets = estimate.offsets.iter().zip(self.sigma).map(|(offset, sigma)| offset / sigma);
        let initial = estimate.initial.iter().flatten().map(|volts| volts / REFERENCE);
        DVector::from_vec(parameters.chain(offsets).chain(initial).collect())
    }

    /// The estimate with these coordinates.
    pub(crate) fn estimate(&self, coordinates: &DVector<f64>) -> Estimate {
        let parameters = self
            .model
            .parameters
            .iter()
            .zip(coordinates.iter())
            .map(|(parameter, fraction)| parameter.value_at(*fraction));
        let offsets = self.sigma.iter().enumerate();
        let offsets =
            offsets.map(|(output, sigma)| coordinates[self.model.parameters.len() + output] * sigma);
        Estimate {
            parameters: parameters.collect(),
            offsets: offsets.collect(),
            initial: (0..self.records.len())
                .map(|record| self.initial_voltages(coordinates, record))
                .collect(),
        }
    }

    /// Indices of the coordinates that are the initial voltages of a record.
    pub(crate) fn initial_indices(&self, record: usize) -> Range<usize> {
        let (first, count) = (self.shared_count(), self.model.initial.len());
        first + record * count..first + (record + 1) * count
    }

    /// The initial voltages of a record, in V.
    fn initial_voltages(&self, coordinates: &DVector<f64>, record: usize) -> Vec<f64> {
        self.initial_indices(record).map(|index| REFERENCE * coordinates[index]).collect()
    }

    /// The values that a run along one record needs.
    pub(crate) fn run_values(&self, coordinates: &DVector<f64>, record: usize) -> RunValues {
        let parameters = self
            .model
            .parameters
            .iter()
            .zip(coordinates.iter())
            .map(|(parameter, fraction)| parameter.value_at(*fraction));
        RunValues { parameters: parameters.collect(), initial: self.initial_voltages(coordinates, record) }
    }

    /// The model's outputs at several points, for every record. `None` for a point from which a record cannot be run.
    pub(crate) fn trajectories(&self, points: &[DVector<f64>]) -> Vec<Option<Vec<OutputTrajectory>>> {
        let mut all = vec![Some(Vec::new()); points.len()];
        let runs = parallel::map_indices(self.records.len(), |record| {
            let values: Vec<_> = points.iter().map(|point| self.run_values(point, record)).collect();
            self.model.run(record, &values)
        });
        for run in runs {
            for (trajectories, trajectory) in all.iter_mut().zip(run) {
                *trajectories = trajectories.take().zip(trajectory).map(|(mut trajectories, trajectory)| {
                    trajectories.push(trajectory);
                    trajectories
                });
            }
        }
        all
    }

    /// The residuals (data - model) / sigma - offset of one output in one record. NaN if the datum is missing.
    pub(crate) fn residuals(
        &self,
        coordinates: &DVector<f64>,
        record: usize,
        output: usize,
        trajectory: &OutputTrajectory,
    ) -> Vec<f64> {
        let offset = coordinates[self.model.parameters.len() + output];
        let pairs = self.records[record].outputs[output].iter().zip(&trajectory[output]);
        pairs.map(|(datum, value)| (datum - value) / self.sigma[output] - offset).collect()
    }

    /// The sum of squared residuals over all records and outputs, without missing data.
    pub(crate) fn chi2(&self, coordinates: &DVector<f64>, trajectories: &[OutputTrajectory]) -> f64 {
        let mut sum = 0.0;
        for (record, trajectory) in trajectories.iter().enumerate() {
            for output in 0..self.sigma.len() {
                let residuals = self.residuals(coordinates, record, output, trajectory);
                sum +=
                    residuals.iter().filter(|value| !value.is_nan()).map(|value| value * value).sum::<f64>();
            }
        }
        sum
    }

    /// Whether a coordinate is fitted.
    pub(crate) fn is_free(&self, index: usize) -> bool {
        let parameter_count = self.model.parameters.len();
        match index {
            index if index < parameter_count => self.fits_parameters && self.fixed_parameter != Some(index),
            index if index < self.shared_count() => self.has_offset[index - parameter_count],
            _ => true,
        }
    }

    /// The least and the largest value of a coordinate. Offsets have no bounds.
    pub(crate) fn bounds(&self, index: usize) -> [f64; 2] {
        match index {
            index if index < self.model.parameters.len() => [0.0, 1.0],
            index if index < self.shared_count() => [f64::NEG_INFINITY, f64::INFINITY],
            _ => {
                let states = &self.model.initial;
                states[(index - self.shared_count()) % states.len()].range.map(|volts| volts / REFERENCE)
            }
        }
    }

    /// The normal equations at a point, from the Jacobian of all residuals.
    fn normal_equations(
        &self,
        coordinates: &DVector<f64>,
        trajectories: &[OutputTrajectory],
    ) -> NormalEquations {
        let (mut normal, steps) =
            (NormalEquations::zeros(coordinates.len()), self.derivative_steps(coordinates));
        let linearise =
            |record: usize| self.linearise_record(coordinates, record, &trajectories[record], &steps);
        parallel::map_in_batches(trajectories.len(), RECORD_BATCH, linearise, |outputs| {
            outputs.iter().for_each(|(columns, residuals)| normal.add(columns, residuals));
        });
        normal
    }

    /// For every output of a record the columns of the Jacobian and the residuals.
    pub(crate) fn linearise_record(
        &self,
        coordinates: &DVector<f64>,
        record: usize,
        trajectory: &OutputTrajectory,
        steps: &[f64],
    ) -> Vec<(Vec<JacobianColumn>, Vec<f64>)> {
        let jacobian =
            self.jacobian_with_steps(coordinates, record, trajectory, steps).into_iter().enumerate();
        jacobian
            .map(|(output, columns)| (columns, self.residuals(coordinates, record, output, trajectory)))
            .collect()
    }

    /// For every output of a record the columns of the Jacobian, with default steps.
    pub(crate) fn jacobian(
        &self,
        coordinates: &DVector<f64>,
        record: usize,
        trajectory: &OutputTrajectory,
    ) -> Vec<Vec<JacobianColumn>> {
        self.jacobian_with_steps(coordinates, record, trajectory, &self.derivative_steps(coordinates))
    }

    /// For every output of a record the columns of the Jacobian, with one finite-difference step per coordinate.
    fn jacobian_with_steps(
        &self,
        coordinates: &DVector<f64>,
        record: usize,
        trajectory: &OutputTrajectory,
        steps: &[f64],
    ) -> Vec<Vec<JacobianColumn>> {
        let disturbed: Vec<usize> =
            (0..self.disturbed_parameter_count()).chain(self.initial_indices(record)).collect();
        let values = disturbed
            .iter()
            .map(|index| self.run_values(&shift_coordinate(coordinates, *index, steps[*index]), record));
        let disturbed_runs = self.model.run(record, &values.collect::<Vec<_>>());
        let columns_of_output = |output: usize| {
            let mut columns: Vec<JacobianColumn> = Vec::new();
            for (index, disturbed_run) in disturbed.iter().zip(&disturbed_runs) {
                // If the disturbed run fails, the iteration does not change that coordinate.
                let Some(disturbed_run) = disturbed_run else { continue };
                let scale = -1.0 / (steps[*index] * self.sigma[output]);
                let pairs = disturbed_run[output].iter().zip(&trajectory[output]);
                columns.push((*index, pairs.map(|(there, here)| (there - here) * scale).collect()));
            }
            if self.has_offset[output] {
                columns.push((self.model.parameters.len() + output, vec![-1.0; trajectory[output].len()]));
            }
            columns
        };
        (0..self.sigma.len()).map(columns_of_output).collect()
    }

    /// The finite-difference step of every coordinate, towards the inside of its range.
    pub(crate) fn derivative_steps(&self, coordinates: &DVector<f64>) -> Vec<f64> {
        (0..coordinates.len())
            .map(|index| self.derivative_step(coordinates, index, DERIVATIVE_STEP))
            .collect()
    }

    /// A step of the given size, negative if a positive one would leave the range.
    pub(crate) fn derivative_step(&self, coordinates: &DVector<f64>, index: usize, size: f64) -> f64 {
        let [_, high] = self.bounds(index);
        if coordinates[index] + size > high { -size } else { size }
    }

    /// The best step of the damping schedule: coordinates, trajectories, sum of squares and damping. `None` if no step
    /// decreases the sum of squares.
    fn best_step(
        &self,
        coordinates: &DVector<f64>,
        chi2: f64,
        normal: &NormalEquations,
        damping: f64,
    ) -> Option<(DVector<f64>, Vec<OutputTrajectory>, f64, f64)> {
        let mut damping = damping;
        for _ in 0..self.damping_schedule.max_attempts {
            let dampings: Vec<f64> =
                self.damping_schedule.parallel_factors.iter().map(|factor| factor * damping).collect();
            let points: Vec<_> =
                dampings.iter().map(|damping| self.bounded_step(coordinates, normal, *damping)).collect();
            let all_trajectories = self.trajectories(&points);
            let mut best: Option<(DVector<f64>, Vec<OutputTrajectory>, f64, f64)> = None;
            for ((point, trajectories), damping) in points.into_iter().zip(all_trajectories).zip(&dampings) {
                let Some(trajectories) = trajectories else { continue };
                let point_chi2 = self.chi2(&point, &trajectories);
                if point_chi2 < best.as_ref().map_or(chi2, |best| best.2) {
                    best = Some((point, trajectories, point_chi2, *damping));
                }
            }
            if best.is_some() {
                return best;
            }
            damping *= self.damping_schedule.growth;
        }
        None
    }

    /// The end of a damped step within the bounds. Coordinates at a bound that the step would leave are fixed, and the
    /// step of the others is computed again.
    fn bounded_step(
        &self,
        coordinates: &DVector<f64>,
        normal: &NormalEquations,
        damping: f64,
    ) -> DVector<f64> {
        let mut free = self.sensitive_coordinates(normal);
        let mut end = coordinates.clone();
        loop {
            let step = normal.damped_step(&free, damping);
            let leaves_bounds = |(place, index): (usize, &usize)| {
                let [low, high] = self.bounds(*index);
                let next = coordinates[*index] + step[place];
                (next < low && coordinates[*index] <= low) || (next > high && coordinates[*index] >= high)
            };
            let fixed: Vec<usize> = free
                .iter()
                .enumerate()
                .filter(|pair| leaves_bounds(*pair))
                .map(|(_, index)| *index)
                .collect();
            if fixed.is_empty() {
                for (place, index) in free.iter().enumerate() {
                    let [low, high] = self.bounds(*index);
                    end[*index] = (coordinates[*index] + step[place]).clamp(low, high);
                }
                return end;
            }
            free.retain(|index| !fixed.contains(index));
        }
    }

    /// Indices of the fitted coordinates that affect the residuals.
    fn sensitive_coordinates(&self, normal: &NormalEquations) -> Vec<usize> {
        let is_sensitive = |index: &usize| normal.matrix[(*index, *index)] > MIN_SENSITIVITY;
        (0..normal.gradient.len()).filter(|index| self.is_free(*index)).filter(is_sensitive).collect()
    }

    /// The number of fitted values that affect the data.
    fn fitted_count(
        &self,
        coordinates: &DVector<f64>,
        trajectories: &[OutputTrajectory],
        data_count: usize,
    ) -> usize {
        let free_count = (0..coordinates.len()).filter(|index| self.is_free(*index)).count();
        if data_count >= AMPLE_DATA_RATIO * free_count {
            free_count
        } else {
            self.sensitive_coordinates(&self.normal_equations(coordinates, trajectories)).len()
        }
    }

    /// The residuals and their sum of squares at an estimate, without a fit. `None` if the model cannot be run there.
    pub fn evaluate(&self, estimate: &Estimate) -> Option<FitResult> {
        let coordinates = self.coordinates(estimate);
        let trajectories = self.trajectories(std::slice::from_ref(&coordinates)).pop()??;
        let chi2 = self.chi2(&coordinates, &trajectories);
        let residuals = trajectories.iter().enumerate().map(|(record, trajectory)| {
            (0..self.sigma.len())
                .map(|output| self.residuals(&coordinates, record, output, trajectory))
                .collect::<Vec<_>>()
        });
        let residuals: Vec<Vec<Vec<f64>>> = residuals.collect();
        let data_count = residuals.iter().flatten().flatten().filter(|value| !value.is_nan()).count();
        let fitted_count = self.fitted_count(&coordinates, &trajectories, data_count);
        Some(FitResult { estimate: estimate.clone(), chi2, residuals, data_count, fitted_count })
    }
}

/// The derivatives of all outputs with respect to one coordinate, one output after the other. Zeros stand for an output
/// without that column; `samples` is the length of an output.
pub(crate) fn stacked_column(jacobian: &[Vec<JacobianColumn>], index: usize, samples: usize) -> Vec<f64> {
    let column_of_output = |columns: &Vec<JacobianColumn>| {
        let column = columns.iter().find(|column| column.0 == index);
        column.map_or_else(|| vec![0.0; samples], |column| column.1.clone())
    };
    jacobian.iter().flat_map(column_of_output).collect()
}

/// The same point with one coordinate changed by `step`.
pub(crate) fn shift_coordinate(coordinates: &DVector<f64>, index: usize, step: f64) -> DVector<f64> {
    let mut shifted = coordinates.clone();
    shifted[index] += step;
    shifted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::model::FitProgram;
    use patchcord_core::patch::Patch;

    /// An integrator without input. Its output B1 = -begin is constant; begin is from -50 to 0 V.
    const CONSTANT: &str = r#"{
  "patchcord": 1,
  "parameters": {"begin": {"value": -30, "unit": "1", "range": [-50, 0]}},
  "elements": {"L1": {"kind": "held"}, "B1": {"kind": "inverter", "in": "L1.out"}},
  "macros": {"held": {"outputs": {"out": "A1"}, "elements": {
    "A1": {"kind": "integrator", "in": {"x1": ["ground"]}, "initial": "begin"}
  }}}
}"#;

    /// The fitted initial voltage, from a start, if B1 was measured as a constant. All in V.
    fn fitted_voltage(start: f64, measured: f64) -> f64 {
        let patch = Patch::parse("standing.json", CONSTANT).unwrap_or_else(|report| panic!("{report}"));
        let records = [Record {
            name: String::new(),
            begin: 0.0,
            start_in_file: 0.0,
            interval: 0.1,
            jitter: 0.0,
            drives: Vec::new(),
            outputs: vec![vec![measured; 12]],
        }];
        let [initial_states, outputs] = ["begin", "B1"].map(|name| [name.to_owned()]);
        let program = FitProgram::new(&patch, &[]).unwrap();
        let model = Model::new(&program, &patch, &records, &[], &initial_states, &outputs, 1).unwrap();
        let fit_problem = FitProblem {
            model: &model,
            records: &records,
            sigma: &[1.0],
            has_offset: &[false],
            fits_parameters: true,
            fixed_parameter: None,
            target_chi2: f64::INFINITY,
            max_iterations: MAX_ITERATIONS,
            convergence_ratio: CONVERGENCE_RATIO,
            damping_schedule: DampingSchedule::SEQUENTIAL,
        };
        let start = Estimate { parameters: Vec::new(), initial: vec![vec![start]], offsets: vec![0.0] };
        fit_problem.fit(&start).unwrap().estimate.initial[0][0]
    }

    #[test]
    fn initial_voltages_are_fitted_within_their_ranges() {
        for start in [-50.0, -30.0, 0.0] {
            for (measured, expected) in [(20.0, -20.0), (-10.0, 0.0), (70.0, -50.0)] {
                let fitted = fitted_voltage(start, measured);
                assert!((fitted - expected).abs() < 1e-6, "{fitted} from {start}, expected {expected}");
            }
        }
    }
}
