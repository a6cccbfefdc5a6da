//! The coordinates in which a fit works, and the estimates that they represent.
//!
//! First come the parameters as fractions of their ranges, 0 to 1. Then come the offsets in units of sigma, then the
//! initial voltages of every record in machine units of 100 V.

use std::ops::Range;

use nalgebra::DVector;

use super::FitProblem;
use crate::fit::estimate::Estimate;
use crate::fit::model::RunValues;
use patchcord_core::machines::REFERENCE;

impl FitProblem<'_> {
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
        let offsets = self.sigma.iter().enumerate();
        let offsets =
            offsets.map(|(output, sigma)| coordinates[self.model.parameters.len() + output] * sigma);
        Estimate {
            parameters: self.parameter_values(coordinates),
            offsets: offsets.collect(),
            initial: (0..self.records.len())
                .map(|record| self.initial_voltages(coordinates, record))
                .collect(),
        }
    }

    /// The parameter values, in the units of the patch.
    fn parameter_values(&self, coordinates: &DVector<f64>) -> Vec<f64> {
        let pairs = self.model.parameters.iter().zip(coordinates.iter());
        pairs.map(|(parameter, fraction)| parameter.value_at(*fraction)).collect()
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
        RunValues {
            parameters: self.parameter_values(coordinates),
            initial: self.initial_voltages(coordinates, record),
        }
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
}

/// The same coordinates with one of them changed by `step`.
pub(crate) fn shift_coordinate(coordinates: &DVector<f64>, index: usize, step: f64) -> DVector<f64> {
    let mut shifted = coordinates.clone();
    shifted[index] += step;
    shifted
}
