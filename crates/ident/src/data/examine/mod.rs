//! What data are like before any model is held against them: noise, steps of the recorder, gaps, what was excited.

mod noise;
mod quantum;
mod spectrum;
mod wild;

use crate::data::examine::noise::noise;
use crate::data::examine::quantum::quantum;
use crate::data::examine::spectrum::frequencies_below;
use crate::statistics::descriptive::{ends, mean, there};

pub use noise::{Noise, NoiseKind};
pub use spectrum::SHARES;
pub(crate) use spectrum::{Peak, peaks};
pub(crate) use wild::wild;

/// What a column is like. Values are in its unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Examined {
    /// How many samples are there.
    pub samples: usize,
    /// How many are missing between them.
    pub missing: usize,
    /// The least sample.
    pub least: f64,
    /// The largest sample.
    pub most: f64,
    /// Root mean square about the mean.
    pub rms: f64,
    /// Its noise; `None` where there are too few samples.
    pub noise: Option<Noise>,
    /// The step of which all samples are multiples, apart from an offset; `None` where there is none to be seen.
    pub quantum: Option<f64>,
    /// The share of samples that equal the one before.
    pub repeats: f64,
    /// The frequencies in Hz below which the shares [`SHARES`] of the power lie, the mean and a straight trend left out; the duration
    /// of the record resolves no less than its inverse. `None` where nothing moves.
    pub below: Option<[f64; SHARES.len()]>,
}

/// The noise of evenly spaced samples; `None` where there are too few of them.
pub fn noise_of(samples: &[f64]) -> Option<Noise> {
    noise(samples, quantum(&there(samples)))
}

/// Looks at evenly spaced samples, `interval` seconds apart; NaN is a missing one.
pub fn examine(samples: &[f64], interval: f64) -> Examined {
    let there = there(samples);
    let count = there.len().max(1) as f64;
    let mean = mean(&there);
    let [least, most] = ends(there.iter().copied());
    let quantum = quantum(&there);
    Examined {
        samples: there.len(),
        missing: samples.len() - there.len(),
        least,
        most,
        rms: (there.iter().map(|sample| (sample - mean) * (sample - mean)).sum::<f64>() / count).sqrt(),
        noise: noise(samples, quantum),
        quantum,
        repeats: there.windows(2).filter(|pair| pair[0] == pair[1]).count() as f64 / count,
        below: frequencies_below(samples, interval),
    }
}

impl Examined {
    /// Samples in a period of the frequency below which nine tenths of the power lie.
    pub fn samples_a_period(&self, interval: f64) -> Option<f64> {
        self.below.map(|below| 1.0 / (below[1] * interval))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::examine::NoiseKind;

    #[test]
    fn a_column_is_told_in_short() {
        let mut samples: Vec<f64> = (0..100).map(|place| (0.1 * f64::from(place)).floor()).collect();
        samples[50] = f64::NAN;
        let found = examine(&samples, 0.5);
        assert_eq!((found.samples, found.missing, found.least, found.most), (99, 1, 0.0, 9.0));
        assert_eq!(found.quantum, Some(1.0));
        assert!((found.repeats - 89.0 / 99.0).abs() < 1e-12);
        assert!((found.rms - 2.88).abs() < 0.02, "{}", found.rms);
    }

    #[test]
    fn nothing_is_made_of_nothing() {
        let found = examine(&[], 1.0);
        assert_eq!((found.samples, found.noise, found.quantum, found.below), (0, None, None, None));
        let found = examine(&[2.0; 40], 1.0);
        assert_eq!((found.rms, found.quantum, found.below), (0.0, None, None));
        assert_eq!(found.noise.map(|noise| (noise.sigma, noise.kind)), Some((0.0, NoiseKind::None)));
    }
}
