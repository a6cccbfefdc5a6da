//! Properties of a column of samples that need no model: range, noise, quantisation, repetitions, bandwidth, outliers.
//!
//! [`examine`] computes all of them except the outliers, which [`wild_samples`] finds. Samples are evenly spaced, and
//! NaN is a missing sample.

mod noise;
mod quantum;
mod spectrum;
mod wild_samples;

use crate::data::examine::noise::noise;
use crate::data::examine::quantum::quantum;
use crate::data::examine::spectrum::power_frequencies;
use crate::statistics::descriptive::{extremes, mean, present};

pub use noise::{Noise, NoiseKind};
pub use spectrum::POWER_FRACTIONS;
pub(crate) use spectrum::{SpectralPeak, spectral_peaks};
pub(crate) use wild_samples::wild_samples;

/// Statistics of a column. Values are in the unit of the column.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnStatistics {
    /// The number of samples without the missing ones.
    pub samples: usize,
    /// The number of missing samples.
    pub missing: usize,
    /// The smallest sample; infinite if there are no samples.
    pub minimum: f64,
    /// The largest sample; negative infinite if there are no samples.
    pub maximum: f64,
    /// Root mean square about the mean.
    pub rms: f64,
    /// The noise. None if there are too few consecutive samples.
    pub noise: Option<Noise>,
    /// The quantum: the step of which all samples are multiples, apart from a common offset. None if there is no such
    /// step.
    pub quantum: Option<f64>,
    /// The fraction of samples that are equal to their predecessor.
    pub repeated_fraction: f64,
    /// The frequencies in Hz below which the fractions [`POWER_FRACTIONS`] of the power are. The mean and the linear
    /// trend do not count. The resolution is about the inverse of the duration. None if the column is constant, is a
    /// straight line, or is too short.
    pub power_frequencies: Option<[f64; POWER_FRACTIONS.len()]>,
}

/// Estimates the noise of evenly spaced samples. None if there are too few consecutive samples.
pub(crate) fn estimate_noise(samples: &[f64]) -> Option<Noise> {
    noise(samples, quantum(&present(samples)))
}

/// Computes the statistics of evenly spaced samples that are `interval` seconds apart. NaN is a missing sample.
///
/// # Examples
///
/// ```
/// use patchcord_ident::examine;
///
/// let mut samples: Vec<f64> = (0..100).map(|index| 0.5 * f64::from(index % 20)).collect();
/// samples[7] = f64::NAN;
/// let statistics = examine(&samples, 0.01);
/// assert_eq!((statistics.samples, statistics.missing), (99, 1));
/// assert_eq!((statistics.minimum, statistics.maximum), (0.0, 9.5));
/// assert_eq!((statistics.quantum, statistics.repeated_fraction), (Some(0.5), 0.0));
/// ```
pub fn examine(samples: &[f64], interval: f64) -> ColumnStatistics {
    let present = present(samples);
    let count = present.len().max(1) as f64;
    let mean = mean(&present);
    let [minimum, maximum] = extremes(present.iter().copied());
    let quantum = quantum(&present);
    ColumnStatistics {
        samples: present.len(),
        missing: samples.len() - present.len(),
        minimum,
        maximum,
        rms: (present.iter().map(|sample| (sample - mean) * (sample - mean)).sum::<f64>() / count).sqrt(),
        noise: noise(samples, quantum),
        quantum,
        repeated_fraction: present.windows(2).filter(|pair| pair[0] == pair[1]).count() as f64 / count,
        power_frequencies: power_frequencies(samples, interval),
    }
}

impl ColumnStatistics {
    /// Returns the samples per period of the frequency below which 90 % of the power is. `interval` is the interval of
    /// the samples in seconds. None if there is no such frequency.
    pub fn samples_per_period(&self, interval: f64) -> Option<f64> {
        self.power_frequencies.map(|frequencies| 1.0 / (frequencies[1] * interval))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::examine::NoiseKind;

    #[test]
    fn statistics_of_a_quantised_column_with_a_missing_sample_are_correct() {
        let mut samples: Vec<f64> = (0..100).map(|index| (0.1 * f64::from(index)).floor()).collect();
        samples[50] = f64::NAN;
        let statistics = examine(&samples, 0.5);
        assert_eq!((statistics.samples, statistics.missing), (99, 1));
        assert_eq!((statistics.minimum, statistics.maximum), (0.0, 9.0));
        assert_eq!(statistics.quantum, Some(1.0));
        assert!((statistics.repeated_fraction - 89.0 / 99.0).abs() < 1e-12);
        assert!((statistics.rms - 2.88).abs() < 0.02, "{}", statistics.rms);
    }

    #[test]
    fn empty_and_constant_columns_have_no_quantum_and_no_power() {
        let empty = examine(&[], 1.0);
        assert_eq!((empty.samples, empty.noise), (0, None));
        assert_eq!((empty.quantum, empty.power_frequencies), (None, None));
        let constant = examine(&[2.0; 40], 1.0);
        assert_eq!((constant.rms, constant.quantum, constant.power_frequencies), (0.0, None, None));
        assert_eq!(constant.noise.map(|noise| (noise.sigma, noise.kind)), Some((0.0, NoiseKind::Absent)));
    }
}
