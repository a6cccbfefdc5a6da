//! Wild samples: single samples far from their neighbours, which agree with one another.
//!
//! For each sample, the *deviation* is its difference from the mean of its two neighbours. A single wrong sample of
//! size d gives the deviations -d/2, d, -d/2. A step or a kink of the signal does not give this pattern.

use crate::statistics::descriptive::{NORMAL_QUARTILE, median};

/// The least ratio of the deviation of a wild sample to the noise, and to the deviations two samples before and after
/// it. A chosen limit.
const MIN_DEVIATION_RATIO: f64 = 10.0;
/// The largest difference between the deviation of a neighbour and -d/2, as a fraction of d. After a step or a kink the
/// difference is larger, because the signal does not return at once. A chosen limit.
const RETURN_TOLERANCE: f64 = 0.25;

/// Returns the indices of the wild samples. NaN is a missing sample. The three samples at either end are never wild.
///
/// `noise` is the standard deviation of the noise. If the median of the deviations gives a larger one, that is used.
pub(crate) fn wild_samples(samples: &[f64], noise: f64) -> Vec<usize> {
    let deviations: Vec<f64> =
        samples.windows(3).map(|window| window[1] - 0.5 * (window[0] + window[2])).collect();
    let sizes: Vec<f64> =
        deviations.iter().map(|deviation| deviation.abs()).filter(|size| !size.is_nan()).collect();
    let usual_size = (median(&sizes) / NORMAL_QUARTILE).max(noise);
    let is_wild = |near: &[f64]| {
        let (deviation, size) = (near[2], near[2].abs());
        let is_large = size > MIN_DEVIATION_RATIO * usual_size.max(near[0].abs()).max(near[4].abs());
        let returns = [near[1], near[3]]
            .iter()
            .all(|neighbour| (neighbour + 0.5 * deviation).abs() < RETURN_TOLERANCE * size);
        is_large && returns
    };
    let wild = deviations.windows(5).enumerate().filter(|(_, near)| is_wild(near));
    // The middle of five deviations belongs to the sample 2 + 1 after the first: each deviation is about the middle of
    // three samples.
    wild.map(|(index, _)| index + 3).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::rng::standard_normal;

    /// A clipped sine with noise of standard deviation 1e-3.
    fn curve() -> Vec<f64> {
        let noise = standard_normal(3, 400).into_iter().enumerate();
        noise.map(|(k, random)| (0.05 * k as f64).sin().max(-0.5) + 1e-3 * random).collect()
    }

    #[test]
    fn single_outliers_are_wild_but_noise_and_kinks_and_steps_are_not() {
        assert_eq!(wild_samples(&curve(), 1e-3), [0_usize; 0]);
        let mut samples = curve();
        samples[100] += 0.05;
        samples[301] -= 3.0;
        assert_eq!(wild_samples(&samples, 1e-3), [100, 301]);
        samples.iter_mut().skip(200).for_each(|sample| *sample += 1.0);
        assert_eq!(wild_samples(&samples, 1e-3), [100, 301]);
        samples[99] = f64::NAN;
        assert_eq!(wild_samples(&samples, 1e-3), [301]);
    }

    #[test]
    fn a_sample_one_quantum_away_is_not_wild() {
        let mut samples = vec![2.0; 60];
        samples[30] = 3.0;
        assert_eq!(wild_samples(&samples, 1.0 / 12.0_f64.sqrt()), [0_usize; 0]);
        samples[30] = 9.0;
        assert_eq!(wild_samples(&samples, 1.0 / 12.0_f64.sqrt()), [30]);
        assert_eq!(wild_samples(&[], 0.0), [0_usize; 0]);
    }
}
