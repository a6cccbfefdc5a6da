//! Estimation of an unknown input: a table of time or of a signal, wired to a junction, whose coefficients are fitted.
//!
//! The input is linear in its coefficients (see [`InputBasis`]). An iteration perturbs each coefficient, each parameter
//! and each initial voltage, runs the model, and so finds the derivatives of all outputs. [`InputNormalEquations`] then
//! gives the most likely coefficients under a smoothness prior, jointly with parameters, initial voltages and offsets
//! (the nuisance parameters). Iterations continue until the sum of squares agrees with the linear model. A curve over a
//! signal of the model acts back on that signal, so its steps may have to be shortened.

use nalgebra::{DMatrix, DVector};

use crate::fit::estimate::Estimate;
use crate::fit::levenberg_marquardt::{DERIVATIVE_STEP, FitProblem, RECORD_BATCH, shift_coordinate};
use crate::fit::model::{OutputTrajectory, ReplacedTable, RunValues};
use crate::fit::schedule::RecordBeginnings;
use crate::localise::evidence::{InputNormalEquations, InputPosterior, NuisancePrior, SmoothnessPrior};
use crate::localise::input_basis::InputBasis;
use patchcord_analysis::parallel;

/// The estimation of one unknown input.
#[derive(Clone, Copy)]
pub(crate) struct InputEstimation<'a> {
    /// The patch with a table for the input, and the records.
    pub fit_problem: FitProblem<'a>,
    /// The table.
    pub table: ReplacedTable<'a>,
    /// The perturbation of a coefficient for its derivatives, in the unit of the input.
    pub perturbation: f64,
    /// The basis of the input.
    pub basis: &'a InputBasis,
    /// The estimate without an input: the prior mean of the nuisance parameters.
    pub reference: &'a Estimate,
    /// The sum of squares without an input.
    pub baseline_chi2: f64,
    /// Whether the input depends on a signal that it changes itself. Steps may then have to be shortened.
    pub has_feedback: bool,
    /// The prior standard deviation of parameters and initial voltages, as a fraction of their ranges.
    pub nuisance_spread: f64,
}

/// The point from which the estimation of an input starts.
pub(crate) struct InputStart<'a> {
    /// Parameters, initial voltages and offsets.
    pub estimate: &'a Estimate,
    /// The coefficients. `None` if all are 0.
    pub coefficients: Option<&'a [f64]>,
}

/// An estimated input.
#[derive(Debug, Clone)]
pub(crate) struct InputFit {
    /// Parameters, initial voltages and offsets, estimated jointly.
    pub estimate: Estimate,
    /// The coefficients of the input.
    pub coefficients: Vec<f64>,
    /// The standard errors of the coefficients.
    pub errors: Vec<f64>,
    /// The standard errors of the coefficients if all nuisance parameters were known exactly.
    pub conditional_errors: Vec<f64>,
    /// The sum of squares of the residuals.
    pub chi2: f64,
    /// Logarithm of the marginal likelihood, relative to that without an input.
    pub evidence: f64,
    /// The effective number of parameters of the input.
    pub effective_parameters: f64,
    /// The smoothness prior of the larger evidence.
    pub prior: SmoothnessPrior,
    /// The normal equations of the last iteration. Curves over signals are solved from them without further runs.
    pub equations: InputNormalEquations,
    /// The nuisance coordinates at which these equations were linearised.
    linearised_at: DVector<f64>,
}

/// Largest number of iterations. Each computes all derivatives once.
const MAX_ITERATIONS: usize = 5;
/// An iteration has converged if the sum of squares differs from the one that the linear model predicts by less than
/// this share.
const CONVERGENCE_RATIO: f64 = 0.03;
/// A start with feedback is rejected if its sum of squares exceeds that without an input by more than this factor. The
/// linear model is not valid there.
const MAX_START_CHI2_RATIO: f64 = 3.0;
/// Fractions of a step that are tried in turn if the whole step of a problem with feedback increases the sum of
/// squares.
const STEP_FRACTIONS: [f64; 3] = [0.5, 0.2, 0.05];
/// The prior weight of an offset, as an inverse variance in units of sigma. It only keeps the equations regular.
const OFFSET_WEIGHT: f64 = 1e-6;

/// The point that an iteration has reached.
#[derive(Clone)]
struct Iterate {
    /// The coordinates of the fit problem: parameters, offsets and initial voltages.
    coordinates: DVector<f64>,
    /// The coefficients of the input.
    coefficients: DVector<f64>,
}

impl InputEstimation<'_> {
    /// Estimates the input from a start. `None` if the patch cannot be run, or no input is better than none.
    pub(crate) fn solve(&self, start: &InputStart<'_>) -> Option<InputFit> {
        let is_better = |chi2: f64| chi2 < self.baseline_chi2;
        let zero = DVector::zeros(self.basis.coefficient_count());
        let coefficients = start.coefficients.map_or(zero, DVector::from_column_slice);
        let mut iterate = Iterate { coordinates: self.fit_problem.coordinates(start.estimate), coefficients };
        let mut last_chi2 = self
            .chi2(&iterate)
            .filter(|chi2| !self.has_feedback || *chi2 < MAX_START_CHI2_RATIO * self.baseline_chi2)?;
        for iteration in 1.. {
            let equations = self.normal_equations(&iterate)?;
            let posterior = equations.solve()?;
            let Some((next, chi2)) = self.step(&iterate, &posterior, last_chi2) else {
                return is_better(last_chi2)
                    .then(|| self.input_fit(&iterate, &iterate, equations, posterior, last_chi2));
            };
            let is_stationary = self.has_feedback && (last_chi2 - chi2).abs() < CONVERGENCE_RATIO * chi2;
            if is_stationary || (chi2 - posterior.chi2).abs() < CONVERGENCE_RATIO * posterior.chi2 {
                return is_better(chi2).then(|| self.input_fit(&next, &iterate, equations, posterior, chi2));
            }
            if iteration == MAX_ITERATIONS {
                // The input with all nuisance parameters fixed competes with the last iterate.
                let fixed = Iterate {
                    coefficients: equations.with_fixed_nuisance().solve()?.coefficients,
                    coordinates: iterate.coordinates.clone(),
                };
                let fixed = self.chi2(&fixed).map(|chi2| (fixed, chi2));
                let best = fixed.into_iter().chain([(next, chi2)]).min_by(|a, b| a.1.total_cmp(&b.1));
                let (next, chi2) = best.filter(|(_, chi2)| is_better(*chi2))?;
                return Some(self.input_fit(&next, &iterate, equations, posterior, chi2));
            }
            (iterate, last_chi2) = (next, chi2);
        }
        None
    }

    /// Estimates the input from growing beginnings of the records. Each estimate starts from the one before. A model
    /// with feedback that is wrong near the end of a record would otherwise be out of phase there, and could not
    /// converge.
    pub(crate) fn solve_progressively(&self, fractions: &[f64]) -> Option<InputFit> {
        let mut fit: Option<InputFit> = None;
        for fraction in fractions {
            let beginnings = RecordBeginnings::new(&self.fit_problem, *fraction);
            let fit_problem = beginnings
                .as_ref()
                .map_or(self.fit_problem, |beginnings| beginnings.fit_problem(&self.fit_problem));
            let zero = Iterate {
                coordinates: fit_problem.coordinates(self.reference),
                coefficients: DVector::zeros(self.basis.coefficient_count()),
            };
            let baseline_chi2 = InputEstimation { fit_problem, ..*self }.chi2(&zero)?;
            let estimate = fit.as_ref().map_or(self.reference, |fit| &fit.estimate);
            let coefficients = fit.as_ref().map(|fit| fit.coefficients.as_slice());
            let estimation = InputEstimation { fit_problem, baseline_chi2, ..*self };
            fit = Some(estimation.solve(&InputStart { estimate, coefficients })?);
        }
        fit
    }

    /// Steps to a posterior mean. With feedback, a step that increases the sum of squares is replaced by the first
    /// fraction of it that decreases it. `None` if there is none.
    fn step(&self, iterate: &Iterate, posterior: &InputPosterior, last_chi2: f64) -> Option<(Iterate, f64)> {
        let trial = |fraction: f64| {
            let next = self.moved(iterate, posterior, fraction);
            let chi2 = self.chi2(&next).unwrap_or(f64::INFINITY);
            (next, chi2)
        };
        let whole = trial(1.0);
        if !self.has_feedback || whole.1 < last_chi2.max(self.baseline_chi2) {
            return Some(whole);
        }
        STEP_FRACTIONS.into_iter().map(trial).find(|(_, chi2)| *chi2 < last_chi2)
    }

    /// The point at a fraction of the way from an iterate to a posterior mean, within the bounds.
    fn moved(&self, from: &Iterate, posterior: &InputPosterior, fraction: f64) -> Iterate {
        let mut coordinates = from.coordinates.clone();
        for (position, index) in self.free_coordinates().into_iter().enumerate() {
            let [low, high] = self.fit_problem.bounds(index);
            coordinates[index] =
                (from.coordinates[index] + fraction * posterior.nuisance[position]).clamp(low, high);
        }
        let coefficients = &from.coefficients + (&posterior.coefficients - &from.coefficients) * fraction;
        Iterate { coordinates, coefficients }
    }

    /// The nuisance parameters that belong to a posterior of a curve, solved from the normal equations of `fit`.
    pub(crate) fn nuisance_estimate(&self, fit: &InputFit, posterior: &InputPosterior) -> Estimate {
        let iterate =
            Iterate { coordinates: fit.linearised_at.clone(), coefficients: posterior.coefficients.clone() };
        self.fit_problem.estimate(&self.moved(&iterate, posterior, 1.0).coordinates)
    }

    /// Collects the result: `iterate` is the estimate, `linearised_at` the point of the equations.
    fn input_fit(
        &self,
        iterate: &Iterate,
        linearised_at: &Iterate,
        equations: InputNormalEquations,
        posterior: InputPosterior,
        chi2: f64,
    ) -> InputFit {
        let errors = |covariance: &DMatrix<f64>| -> Vec<f64> {
            covariance.diagonal().iter().map(|variance| variance.max(0.0).sqrt()).collect()
        };
        let conditional = equations.conditional_covariance(&posterior);
        InputFit {
            estimate: self.fit_problem.estimate(&iterate.coordinates),
            coefficients: iterate.coefficients.iter().copied().collect(),
            errors: errors(&posterior.covariance),
            conditional_errors: errors(conditional.as_ref().unwrap_or(&posterior.covariance)),
            chi2,
            evidence: posterior.evidence,
            effective_parameters: posterior.effective_parameters,
            prior: posterior.prior,
            equations,
            linearised_at: linearised_at.coordinates.clone(),
        }
    }

    /// Indices of the fitted coordinates: the nuisance parameters, in this order.
    fn free_coordinates(&self) -> Vec<usize> {
        let problem = &self.fit_problem;
        (0..problem.initial_indices(problem.records.len()).start)
            .filter(|index| problem.is_free(*index))
            .collect()
    }

    /// The sum of squares at an iterate. `None` if a record cannot be run.
    fn chi2(&self, iterate: &Iterate) -> Option<f64> {
        let trajectory = |record: usize| {
            let values = self.run_values(record, &iterate.coordinates, &iterate.coefficients);
            self.fit_problem.model.run_with_tables(record, self.table, &[values]).pop()?
        };
        let trajectories: Option<Vec<OutputTrajectory>> =
            parallel::map_indices(self.fit_problem.records.len(), trajectory).into_iter().collect();
        Some(self.fit_problem.chi2(&iterate.coordinates, &trajectories?))
    }

    /// The values of a run along a record, and the points of the table.
    fn run_values(
        &self,
        record: usize,
        coordinates: &DVector<f64>,
        coefficients: &DVector<f64>,
    ) -> (RunValues, Vec<[f64; 2]>) {
        let points = self.basis.points(record, coefficients.as_slice());
        (self.fit_problem.run_values(coordinates, record), points)
    }

    /// The normal equations, linearised at an iterate. `None` if a record cannot be run there.
    fn normal_equations(&self, iterate: &Iterate) -> Option<InputNormalEquations> {
        let free = self.free_coordinates();
        let reference = self.fit_problem.coordinates(self.reference);
        let priors = free.iter().map(|index| NuisancePrior {
            mean: reference[*index] - iterate.coordinates[*index],
            weight: if self.is_offset(*index) {
                OFFSET_WEIGHT
            } else {
                1.0 / (self.nuisance_spread * self.nuisance_spread)
            },
            range: self.fit_problem.bounds(*index).map(|end| end - iterate.coordinates[*index]),
        });
        let mut equations =
            InputNormalEquations::new(priors.collect(), self.basis.groups.clone(), self.baseline_chi2);
        let mut is_complete = true;
        let columns = |record: usize| self.columns(record, iterate, &free);
        parallel::map_in_batches(self.fit_problem.records.len(), RECORD_BATCH, columns, |columns| {
            is_complete &= columns.is_some();
            columns.iter().flatten().for_each(|rows| equations.add(rows));
        });
        is_complete.then_some(equations)
    }

    /// Whether a coordinate is the offset of an output.
    fn is_offset(&self, index: usize) -> bool {
        (self.fit_problem.model.parameters.len()..self.fit_problem.shared_count()).contains(&index)
    }

    /// The derivatives of every output of a record by all nuisance parameters and coefficients, one row per datum. The
    /// last column is the residual that the input has to explain. Missing data have no row.
    fn columns(&self, record: usize, iterate: &Iterate, free: &[usize]) -> Option<Vec<DMatrix<f64>>> {
        let Iterate { coordinates, coefficients } = iterate;
        let mut runs = vec![self.run_values(record, coordinates, coefficients)];
        // The column of each further run, and the step of its coordinate or coefficient.
        let mut steps: Vec<(usize, f64)> = Vec::new();
        for (column, index) in free.iter().enumerate().filter(|(_, index)| self.affects_run(**index, record))
        {
            let step = self.fit_problem.derivative_step(coordinates, *index, DERIVATIVE_STEP);
            let shifted = shift_coordinate(coordinates, *index, step);
            runs.push(self.run_values(record, &shifted, coefficients));
            steps.push((column, step));
        }
        for index in self.basis.coefficients_of(record) {
            let shifted = shift_coordinate(coefficients, index, self.perturbation);
            runs.push(self.run_values(record, coordinates, &shifted));
            steps.push((free.len() + index, self.perturbation));
        }
        let trajectories = self.fit_problem.model.run_with_tables(record, self.table, &runs);
        let base = trajectories[0].as_ref()?;
        let parameter_count = self.fit_problem.model.parameters.len();
        let coefficient_count = self.basis.coefficient_count();
        let width = free.len() + coefficient_count + 1;
        let outputs = (0..self.fit_problem.sigma.len()).map(|output| {
            let residuals = self.fit_problem.residuals(coordinates, record, output, base);
            let mut columns = DMatrix::zeros(residuals.len(), width);
            for ((column, step), shifted) in steps.iter().zip(&trajectories[1..]) {
                // If a shifted run fails, its derivative is 0: the value stays in this iteration.
                let Some(shifted) = shifted else { continue };
                let scale = 1.0 / (step * self.fit_problem.sigma[output]);
                for (row, (shifted, base)) in shifted[output].iter().zip(&base[output]).enumerate() {
                    columns[(row, *column)] = (shifted - base) * scale;
                }
            }
            let offset = free.iter().position(|index| *index == parameter_count + output);
            offset.into_iter().for_each(|column| columns.column_mut(column).fill(1.0));
            let explained = columns.columns(free.len(), coefficient_count) * coefficients;
            columns.set_column(width - 1, &(DVector::from_vec(residuals) + explained));
            let missing: Vec<usize> =
                (0..columns.nrows()).filter(|row| columns[(*row, width - 1)].is_nan()).collect();
            columns.remove_rows_at(&missing)
        });
        Some(outputs.collect())
    }

    /// Whether the run of a record depends on a coordinate: a parameter, or an initial voltage of the record.
    fn affects_run(&self, index: usize, record: usize) -> bool {
        let problem = &self.fit_problem;
        index < problem.model.parameters.len() || problem.initial_indices(record).contains(&index)
    }
}

/// The perturbation of a coefficient for its derivatives, in volts: small against the machine unit, and large against
/// the rounding of a run.
pub(super) const PERTURBATION: f64 = 1e-3;

#[cfg(test)]
mod tests;
