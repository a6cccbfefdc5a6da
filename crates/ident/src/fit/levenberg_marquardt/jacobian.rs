//! The Jacobian of the residuals by finite differences. The disturbed runs of a record are computed in one batch.

use nalgebra::DVector;

use super::{FitProblem, shift_coordinate};
use crate::fit::model::OutputTrajectory;
use crate::fit::normal_equations::{JacobianColumn, NormalEquations};
use patchcord_analysis::parallel;

/// The number of records whose derivatives are in memory at the same time.
pub(crate) const RECORD_BATCH: usize = 8;
/// Finite-difference step in coordinates: a fraction of a parameter's range, or of 100 V. It is far
/// above the rounding error of a run and far below the curvature of most laws.
pub(crate) const DERIVATIVE_STEP: f64 = 1e-6;

impl FitProblem<'_> {
    /// The number of parameters that are disturbed for derivatives.
    fn disturbed_parameter_count(&self) -> usize {
        if self.fits_parameters { self.model.parameters.len() } else { 0 }
    }

    /// The normal equations at a position, from the Jacobian of all residuals.
    pub(super) fn normal_equations(
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
