//! Standard errors and 95 % confidence intervals of fitted parameters.
//!
//! The standard error is the larger of two estimates. The first is that for white noise, times the root of reduced
//! chi-squared times autocorrelation time. The second comes from the gradients of blocks of residuals.
//!
//! The interval is first proportional to the standard error. `with_profile_intervals` then checks its ends by the
//! profile likelihood: it fixes the parameter there and fits all others again. If the sum of squares rises too little,
//! the end moves outwards. If it decreases, a better fit exists, and the fit continues from there.

use nalgebra::DVector;

use crate::data::record::Record;
use crate::fit::estimate::FitState;
use crate::fit::estimation::refit;
use crate::fit::fitted_model::FittedModel;
use crate::fit::levenberg_marquardt::{DERIVATIVE_STEP, FitProblem};
use crate::fit::model::{ModelError, OutputTrajectory};
use crate::fit::normal_equations::{Covariance, JacobianColumn, NormalEquations, product_of_present};
use crate::fit::problem::Problem;
use crate::fit::uncertainty::Uncertainty;
use crate::statistics::block_comparison::{blocks_of, sum_outputs};
use crate::statistics::descriptive::student_95;
use patchcord_analysis::parallel;

/// The largest finite-difference step for the covariance, as a fraction of a range. Wide steps average over the kinks
/// of laws.
const MAX_WIDE_STEP: f64 = 0.02;
/// The rms change of the outputs, in units of sigma, to which a wide step is reduced if it causes more than twice as
/// much. It is several times the solver error, which differs from run to run near kinks.
const STEP_RESPONSE: f64 = 0.5;
/// The largest number of passes that reduce wide steps.
const MAX_REDUCTIONS: usize = 8;
/// A derivative is nonlinear if its mean square grows by more than this factor when the step is quartered.
const NONLINEARITY_RATIO: f64 = 1.5;
/// The largest number of times that a step is quartered.
const MAX_QUARTERINGS: usize = 4;
/// The end of an interval is accepted if the sum of squares rises to at least this fraction of the expected rise.
const MIN_RISE_RATIO: f64 = 0.5;
/// The largest number of times that the distance of an end from the optimum is doubled.
const MAX_DOUBLINGS: usize = 8;
/// The number of iterations of the fit of all other coordinates at an end.
const PROFILE_ITERATIONS: usize = 6;

/// The largest number of times that the fit continues from a better fit at an end of an interval.
const MAX_IMPROVEMENTS: usize = 2;

/// The search for confidence intervals around the optimum of a fit.
struct IntervalSearch<'a> {
    /// The least-squares problem of the training records.
    fit_problem: FitProblem<'a>,
    /// The coordinates of the optimum.
    optimum: DVector<f64>,
    /// The sum of squares at the optimum.
    chi2: f64,
    /// Standard errors of all coordinates for white noise.
    white_errors: Vec<f64>,
    /// Standard errors of all coordinates for the residuals as they are. Infinite if undetermined.
    errors: Vec<f64>,
    /// Student's t: the number of standard errors to an end of a 95 % interval, for the number of blocks.
    t_95: f64,
    /// The covariance of the coordinates.
    covariance: Covariance,
}

/// The fitted model with standard errors and proportional intervals of all parameters.
///
/// The standard errors take account of the size and the autocorrelation time of the residuals. They are not smaller
/// than the scatter between blocks of the records.
///
/// # Errors
/// If the patch cannot be run along the records.
///
/// # Examples
///
/// ```
/// use patchcord_ident::fit::intervals::with_standard_errors;
/// use patchcord_ident::{Experiment, Problem, fit_base};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let experiment = Experiment::read("../../examples/05_missing_effect/spring.experiment.json")?;
/// let problem = Problem::of(&experiment)?;
/// let fitted = fit_base(&problem, &experiment.patch, &experiment.fit, 1)?;
/// let fitted = with_standard_errors(&problem, fitted.ok_or("the patch cannot be run")?)?;
/// let stiffness = fitted.train.estimate.parameters[0];
/// let [low, high] = fitted.uncertainty(0).interval;
/// assert!(low <= stiffness && stiffness <= high);
/// # Ok(())
/// # }
/// ```
pub fn with_standard_errors(problem: &Problem, fitted: FittedModel) -> Result<FittedModel, ModelError> {
    let count = fitted.variant.fit.len();
    with_profile_intervals(problem, fitted, count)
}

/// The fitted model with standard errors of all parameters and profile-likelihood intervals from index `first`.
///
/// The parameters before `first` get proportional intervals. If a better fit is found at an end of an interval, the
/// result is the better fit with its intervals.
///
/// # Errors
/// If the patch cannot be run along the records.
pub(crate) fn with_profile_intervals(
    problem: &Problem,
    fitted: FittedModel,
    first: usize,
) -> Result<FittedModel, ModelError> {
    let model = problem.model(&fitted.variant, &problem.train, &problem.outputs)?;
    let mut fitted = fitted;
    for remaining in (0..=MAX_IMPROVEMENTS).rev() {
        let Some(search) = problem.fit_problem(&model, &problem.train, true).interval_search(&fitted) else {
            break;
        };
        let is_determined = |index: &usize| search.errors[*index].is_finite();
        let determined = (first..model.parameters.len()).filter(is_determined);
        let sides: Vec<(usize, usize)> = determined.flat_map(|index| [(index, 0), (index, 1)]).collect();
        let ends = parallel::map(&sides, |(index, side)| search.interval_end(*index, *side), |_| ());
        fitted.uncertainties = (0..model.parameters.len()).map(|index| search.uncertainty(index)).collect();
        for ((index, side), end) in sides.into_iter().zip(&ends) {
            fitted.uncertainties[index].interval[side] = model.parameters[index].value_at(end.fraction);
        }
        let best = ends.into_iter().map(|end| end.best).min_by(|a, b| a.chi2.total_cmp(&b.chi2));
        let better = best.filter(|best| {
            search.chi2 - best.chi2 > fitted.train.reduced_chi2() * fitted.autocorrelation_time
        });
        let Some(better) = better.filter(|_| remaining > 0) else { break };
        let Some(repeated) = refit(problem, &fitted, fitted.variant.clone(), better.estimate)? else { break };
        fitted = repeated;
    }
    Ok(fitted)
}

impl<'a> FitProblem<'a> {
    /// The interval search around the optimum of a fitted model. `None` if the model cannot be run there.
    fn interval_search(self, fitted: &FittedModel) -> Option<IntervalSearch<'a>> {
        let optimum = self.coordinates(&fitted.train.estimate);
        let trajectories = self.trajectories(std::slice::from_ref(&optimum)).pop()??;
        let wide = self.linearise(&optimum, &trajectories, &self.linear_steps(&optimum, &trajectories));
        // Small steps decide what is undetermined: wide steps add curvature, which hides a collinearity.
        let narrow = self.linearise(&optimum, &trajectories, &self.derivative_steps(&optimum));
        let is_determined: Vec<bool> =
            self.covariance(&narrow.normal).standard_errors().iter().map(|error| error.is_finite()).collect();
        let covariance = self.covariance(&wide.normal);
        let white_errors = covariance.standard_errors();
        // Of all initial voltages, only those of its record affect a block.
        let fitted_per_block = (0..optimum.len()).filter(|index| self.is_free(*index)).count()
            - (self.records.len() - 1) * self.model.initial.len();
        let block_errors = covariance.block_standard_errors(&wide.block_gradients, fitted_per_block);
        let inflation = (fitted.train.reduced_chi2().max(1.0) * fitted.autocorrelation_time).sqrt();
        let errors = white_errors.iter().zip(block_errors).zip(is_determined).map(
            |((white_error, block_error), is_determined)| {
                if is_determined { (white_error * inflation).max(block_error) } else { f64::INFINITY }
            },
        );
        let errors = errors.collect();
        let chi2 = self.chi2(&optimum, &trajectories);
        let t_95 = student_95(wide.block_gradients.len().saturating_sub(1));
        Some(IntervalSearch { fit_problem: self, optimum, chi2, white_errors, errors, t_95, covariance })
    }
}

/// A linearisation of the residuals at the optimum.
struct Linearisation {
    /// The normal equations of all residuals.
    normal: NormalEquations,
    /// The gradient of the sum of squares of every block of residuals.
    block_gradients: Vec<DVector<f64>>,
}

impl FitProblem<'_> {
    /// Finite-difference steps with a noticeable but limited effect: [`MAX_WIDE_STEP`], or less if the outputs change
    /// by more than twice [`STEP_RESPONSE`].
    fn wide_steps(&self, coordinates: &DVector<f64>, trajectories: &[OutputTrajectory]) -> Vec<f64> {
        let mut steps: Vec<f64> = (0..coordinates.len())
            .map(|index| self.derivative_step(coordinates, index, MAX_WIDE_STEP))
            .collect();
        let data_count = trajectories.iter().flatten().map(Vec::len).sum::<usize>() as f64;
        for _ in 0..MAX_REDUCTIONS {
            let normal = self.linearise(coordinates, trajectories, &steps).normal;
            let mut is_reduced = false;
            for (index, step) in steps.iter_mut().enumerate() {
                let response = step.abs() * (normal.matrix[(index, index)] / data_count).sqrt();
                if response > 2.0 * STEP_RESPONSE && step.abs() > DERIVATIVE_STEP {
                    *step = self.derivative_step(
                        coordinates,
                        index,
                        (step.abs() * STEP_RESPONSE / response).max(DERIVATIVE_STEP),
                    );
                    is_reduced = true;
                }
            }
            if !is_reduced {
                break;
            }
        }
        steps
    }

    /// Wide steps, reduced for coordinates whose derivative is nonlinear over the wide step, such as a frequency.
    ///
    /// A step is quartered until the derivative no longer grows. If it never stops growing, as near kinks of laws, the
    /// wide step is kept.
    fn linear_steps(&self, coordinates: &DVector<f64>, trajectories: &[OutputTrajectory]) -> Vec<f64> {
        let squares =
            |steps: &[f64]| self.linearise(coordinates, trajectories, steps).normal.matrix.diagonal();
        let mut linear = self.wide_steps(coordinates, trajectories);
        let mut steps = linear.clone();
        let mut step_squares = squares(&steps);
        let mut nonlinear: Vec<usize> = (0..coordinates.len()).collect();
        for pass in 0..MAX_QUARTERINGS {
            let quarters: Vec<f64> = steps.iter().map(|step| step / 4.0).collect();
            let quarter_squares = squares(&quarters);
            let (still_nonlinear, now_linear): (Vec<_>, Vec<_>) = nonlinear
                .into_iter()
                .partition(|index| quarter_squares[*index] > NONLINEARITY_RATIO * step_squares[*index]);
            if pass > 0 {
                now_linear.into_iter().for_each(|index| linear[index] = quarters[index]);
            }
            if still_nonlinear.is_empty() {
                break;
            }
            (nonlinear, steps, step_squares) = (still_nonlinear, quarters, quarter_squares);
        }
        linear
    }

    /// The normal equations and block gradients, with one finite-difference step per coordinate.
    fn linearise(
        &self,
        coordinates: &DVector<f64>,
        trajectories: &[OutputTrajectory],
        steps: &[f64],
    ) -> Linearisation {
        let (mut normal, mut block_gradients) = (NormalEquations::zeros(coordinates.len()), Vec::new());
        for (record, trajectory) in trajectories.iter().enumerate() {
            let outputs = self.linearise_record(coordinates, record, trajectory, steps);
            outputs.iter().for_each(|(columns, residuals)| normal.add(columns, residuals));
            let of_outputs = outputs
                .iter()
                .map(|(columns, residuals)| self.block_gradients(columns, residuals, coordinates.len()));
            block_gradients.extend(sum_outputs(of_outputs));
        }
        Linearisation { normal, block_gradients }
    }

    /// The gradient of every block of the residuals of one output.
    fn block_gradients(
        &self,
        columns: &[JacobianColumn],
        residuals: &[f64],
        count: usize,
    ) -> Vec<DVector<f64>> {
        let mut first = 0;
        let block_gradient = |block: &[f64]| {
            let mut gradient = DVector::zeros(count);
            for (index, column) in columns {
                gradient[*index] = product_of_present(&column[first..], block, block);
            }
            first += block.len();
            gradient
        };
        let samples = self.records.iter().map(Record::len).sum();
        blocks_of(residuals, samples).map(block_gradient).collect()
    }

    /// The covariance of all fitted coordinates.
    fn covariance(&self, normal: &NormalEquations) -> Covariance {
        let with_width = |index: usize| {
            let [low, high] = self.bounds(index);
            (index, high - low)
        };
        let free: Vec<_> =
            (0..normal.gradient.len()).filter(|index| self.is_free(*index)).map(with_width).collect();
        Covariance::new(normal, &free)
    }
}

/// One end of a confidence interval.
struct IntervalEnd {
    /// The position of the end in the range of the parameter, from 0 to 1.
    fraction: f64,
    /// The fit with the least sum of squares that the search found on the way.
    best: FitState,
}

impl IntervalSearch<'_> {
    /// The standard error and the proportional interval of a parameter, as for a model that is linear in it.
    fn uncertainty(&self, index: usize) -> Uncertainty {
        if self.errors[index].is_infinite() {
            return Uncertainty::UNDETERMINED;
        }
        let parameter = &self.fit_problem.model.parameters[index];
        let half_width = self.t_95 * self.errors[index];
        Uncertainty {
            error: parameter.slope(parameter.value_at(self.optimum[index])) * self.errors[index],
            interval: [-half_width, half_width]
                .map(|distance| parameter.value_at(self.optimum[index] + distance)),
        }
    }

    /// The optimum as the state of a complete fit.
    fn optimum_state(&self) -> FitState {
        let estimate = self.fit_problem.estimate(&self.optimum);
        FitState { estimate, chi2: self.chi2, is_finished: true }
    }

    /// The coordinates, each moved into its range.
    fn clamped(&self, mut coordinates: DVector<f64>) -> DVector<f64> {
        for index in 0..coordinates.len() {
            let [low, high] = self.fit_problem.bounds(index);
            coordinates[index] = coordinates[index].clamp(low, high);
        }
        coordinates
    }

    /// The profile-likelihood end of a parameter's interval: the lower one for side 0, the upper one for side 1.
    ///
    /// The parameter moves away from the optimum, first to the proportional end and then twice as far in each step. At
    /// each point all other coordinates are fitted. The search ends at a sufficient rise of the sum of squares, at the
    /// end of the range, or where the model cannot be run.
    fn interval_end(&self, index: usize, side: usize) -> IntervalEnd {
        let max_distance = (self.fit_problem.bounds(index)[side] - self.optimum[index]).abs();
        let sign = [-1.0, 1.0][side];
        let profile = FitProblem {
            fixed_parameter: Some(index),
            max_iterations: PROFILE_ITERATIONS,
            ..self.fit_problem
        };
        let expected_rise = (self.t_95 * self.errors[index] / self.white_errors[index]).powi(2);
        let direction = self.covariance.profile_direction(index);
        let mut step = self.t_95 * self.errors[index];
        let (mut coordinates, mut distance, mut last_rise) = (self.optimum.clone(), 0.0, 0.0_f64);
        let mut best = self.optimum_state();
        for _ in 0..=MAX_DOUBLINGS {
            let next = (distance + step).min(max_distance);
            let next_coordinates = self.clamped(&coordinates + &direction * (sign * (next - distance)));
            let Some(state) = profile.optimise(&self.fit_problem.estimate(&next_coordinates)) else {
                distance = next;
                break;
            };
            if state.chi2 < best.chi2 {
                best = state.clone();
            }
            let rise = (state.chi2 - self.chi2).max(0.0);
            if rise > MIN_RISE_RATIO * expected_rise {
                let share = ((expected_rise.sqrt() - last_rise.sqrt()) / (rise.sqrt() - last_rise.sqrt()))
                    .clamp(0.0, 1.0);
                // The proportional end is never moved inwards. Further out the end is interpolated.
                distance = if distance == 0.0 { next } else { distance + share * (next - distance) };
                break;
            }
            if next >= max_distance {
                distance = next;
                break;
            }
            (coordinates, step, distance, last_rise) =
                (self.fit_problem.coordinates(&state.estimate), next, next, rise);
        }
        IntervalEnd { fraction: self.optimum[index] + sign * distance, best }
    }
}

#[cfg(test)]
mod tests;
