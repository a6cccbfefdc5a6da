//! The smallest and the largest value of every node and rate.

use super::quartic::{INTERVALS, Values, largest_within, quartic};

/// Amount by which a value exceeds the known range to count as outside, as a share of the range.
const MARGIN: f64 = 1e-7;
/// Amount by which a smooth value may exceed the largest of five values over a step, as a share of their range.
const REACH: f64 = 0.3;

/// The range of every node and rate so far, in SI units.
#[derive(Debug)]
pub(super) struct Extremes {
    /// The smallest value of each.
    low: Vec<f64>,
    /// The largest value of each.
    high: Vec<f64>,
}

impl Extremes {
    /// The ranges at the first instant.
    pub(super) fn new(values: &[f64]) -> Self {
        Extremes { low: values.to_vec(), high: values.to_vec() }
    }

    /// The range of a node or rate.
    pub(super) fn range(&self, index: usize) -> [f64; 2] {
        [self.low[index], self.high[index]]
    }

    /// The largest magnitude of a node or rate.
    pub(super) fn peak(&self, index: usize) -> f64 {
        self.low[index].abs().max(self.high[index].abs())
    }

    /// Extends the ranges by the values of an instant.
    pub(super) fn include(&mut self, values: &[f64]) {
        for ((low, high), value) in self.low.iter_mut().zip(&mut self.high).zip(values) {
            *low = low.min(*value);
            *high = high.max(*value);
        }
    }

    /// The share of a step at which a node or rate seems to exceed its largest value, between five equally spaced
    /// samples. With a sign of -1 it falls below its smallest value.
    pub(super) fn hidden_peak(
        &self,
        index: usize,
        samples: &[Vec<f64>; INTERVALS + 1],
        sign: f64,
    ) -> Option<f64> {
        let values: Values = samples.each_ref().map(|sample| sign * sample[index]);
        let [low, high] = self.range(index);
        let extreme = if sign > 0.0 { high } else { -low };
        let known = extreme + MARGIN * (high - low);
        let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let smallest = values.iter().copied().fold(f64::INFINITY, f64::min);
        if largest + REACH * (largest - smallest) <= known {
            return None;
        }
        largest_within(&values).filter(|share| quartic(&values, *share) > known)
    }
}
