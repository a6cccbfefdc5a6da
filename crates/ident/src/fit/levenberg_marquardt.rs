//! Output-error fits by the method of Levenberg and Marquardt, within ranges.
//!
//! A [`FitProblem`] minimises the sum of squared residuals (data - model) / sigma. It changes the parameters, the
//! initial voltages of every record, and the offsets of outputs. All of these are *coordinates* of the fit (module
//! `coordinates`). Derivatives are finite differences (module `jacobian`). Each iteration solves the damped normal
//! equations and takes the best of several dampings.

mod coordinates;
mod jacobian;

use nalgebra::DVector;

use crate::data::record::Record;
use crate::fit::estimate::{Estimate, FitResult, FitState};
use crate::fit::model::{Model, OutputTrajectory};
use crate::fit::normal_equations::NormalEquations;
use patchcord_analysis::parallel;

pub(crate) use coordinates::shift_coordinate;
pub(crate) use jacobian::{DERIVATIVE_STEP, RECORD_BATCH, stacked_column};

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

/// The end of a damped step that decreases the sum of squares.
struct DampedStep {
    /// The coordinates at the end of the step.
    coordinates: DVector<f64>,
    /// The model's outputs there, for every record.
    trajectories: Vec<OutputTrajectory>,
    /// The sum of squares there.
    chi2: f64,
    /// The damping of the step.
    damping: f64,
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
/// A coordinate is not changed if its whole range changes the sum of squares by less than this.
const MIN_SENSITIVITY: f64 = 1.0;
/// With at least this many data per fitted value, all fitted values count as degrees of freedom. The error of the count
/// is then below 1 % of the data, and the Jacobian need not be computed.
const AMPLE_DATA_RATIO: usize = 100;

impl FitProblem<'_> {
    /// Fits from a start. `None` if the model cannot be run there.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_ident::fit::estimate::Estimate;
    /// use patchcord_ident::fit::levenberg_marquardt::{
    ///     CONVERGENCE_RATIO, DampingSchedule, FitProblem, MAX_ITERATIONS,
    /// };
    /// use patchcord_ident::fit::model::{FitProgram, Model};
    /// use patchcord_ident::{Experiment, Problem};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let experiment = Experiment::read("../../examples/05_missing_effect/spring.experiment.json")?;
    /// let (patch, Problem { train, sigma, outputs, .. }) = (&experiment.patch, Problem::of(&experiment)?);
    /// let program = FitProgram::new(patch, &[])?;
    /// let model = Model::new(&program, patch, &train, &experiment.fit, &[], &outputs, 1)?;
    /// let fit_problem = FitProblem {
    ///     model: &model,
    ///     records: &train,
    ///     sigma: &sigma,
    ///     has_offset: &[false],
    ///     fits_parameters: true,
    ///     fixed_parameter: None,
    ///     target_chi2: f64::INFINITY,
    ///     max_iterations: MAX_ITERATIONS,
    ///     convergence_ratio: CONVERGENCE_RATIO,
    ///     damping_schedule: DampingSchedule::SEQUENTIAL,
    /// };
    /// let start = Estimate::nominal(&model, outputs.len());
    /// let unfitted = fit_problem.evaluate(&start).ok_or("the patch cannot be run")?;
    /// let fitted = fit_problem.fit(&start).ok_or("the patch cannot be run")?;
    /// assert!(fitted.chi2 < unfitted.chi2);
    /// # Ok(())
    /// # }
    /// ```
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
            let Some(step) = self.best_step(&coordinates, chi2, &normal, damping) else {
                is_finished = true;
                break;
            };
            let decrease = chi2 - step.chi2;
            (coordinates, trajectories, chi2, damping) =
                (step.coordinates, step.trajectories, step.chi2, step.damping / 3.0);
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
    ///
    /// The further iterations are those of a complete fit. If `max_iterations` is smaller, the fit is a rung of
    /// successive halving, and the next rung continues it.
    fn is_target_unreachable(&self, chi2: f64, decrease: f64, iterations: usize) -> bool {
        let remaining = MAX_ITERATIONS.saturating_sub(iterations);
        iterations >= MIN_ITERATIONS && chi2 - decrease * remaining as f64 > self.target_chi2
    }

    /// The sum of squares of each estimate. Infinite if the model cannot be run there.
    pub(crate) fn chi2_of_estimates(&self, estimates: &[Estimate]) -> Vec<f64> {
        let all_coordinates: Vec<_> = estimates.iter().map(|estimate| self.coordinates(estimate)).collect();
        let all_trajectories = self.trajectories(&all_coordinates);
        let pairs = all_coordinates.iter().zip(&all_trajectories);
        pairs
            .map(|(coordinates, trajectories)| {
                trajectories
                    .as_ref()
                    .map_or(f64::INFINITY, |trajectories| self.chi2(coordinates, trajectories))
            })
            .collect()
    }

    /// The model's outputs for several sets of coordinates, each for every record. `None` if a record cannot be run
    /// with a set.
    pub(crate) fn trajectories(&self, coordinates: &[DVector<f64>]) -> Vec<Option<Vec<OutputTrajectory>>> {
        let mut all = vec![Some(Vec::new()); coordinates.len()];
        let runs = parallel::map_indices(self.records.len(), |record| {
            let values: Vec<_> = coordinates.iter().map(|set| self.run_values(set, record)).collect();
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

    /// The best step of the damping schedule. `None` if no step decreases the sum of squares.
    fn best_step(
        &self,
        coordinates: &DVector<f64>,
        chi2: f64,
        normal: &NormalEquations,
        damping: f64,
    ) -> Option<DampedStep> {
        let mut damping = damping;
        for _ in 0..self.damping_schedule.max_attempts {
            let dampings: Vec<f64> =
                self.damping_schedule.parallel_factors.iter().map(|factor| factor * damping).collect();
            let ends: Vec<_> =
                dampings.iter().map(|damping| self.bounded_step(coordinates, normal, *damping)).collect();
            let all_trajectories = self.trajectories(&ends);
            let mut best: Option<DampedStep> = None;
            for ((end, trajectories), damping) in ends.into_iter().zip(all_trajectories).zip(&dampings) {
                let Some(trajectories) = trajectories else { continue };
                let end_chi2 = self.chi2(&end, &trajectories);
                if end_chi2 < best.as_ref().map_or(chi2, |best| best.chi2) {
                    best = Some(DampedStep {
                        coordinates: end,
                        trajectories,
                        chi2: end_chi2,
                        damping: *damping,
                    });
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
            let leaves_bounds = |(row, index): (usize, &usize)| {
                let [low, high] = self.bounds(*index);
                let next = coordinates[*index] + step[row];
                (next < low && coordinates[*index] <= low) || (next > high && coordinates[*index] >= high)
            };
            let fixed: Vec<usize> = free
                .iter()
                .enumerate()
                .filter(|pair| leaves_bounds(*pair))
                .map(|(_, index)| *index)
                .collect();
            if fixed.is_empty() {
                for (row, index) in free.iter().enumerate() {
                    let [low, high] = self.bounds(*index);
                    end[*index] = (coordinates[*index] + step[row]).clamp(low, high);
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

#[cfg(test)]
mod tests;
