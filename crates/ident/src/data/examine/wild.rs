//! Samples that a recorder or a wire let slip: far off those before and behind, which agree with one another.

use crate::statistics::descriptive::{HALF_WITHIN, median};

/// A wild sample lies so many times as far off the middle of its neighbours as noise does, and as samples two places away,
const FAR: f64 = 10.0;
/// and its neighbours lie half as far off the other way, but for such a share: what jumps or bends does not come back at once.
const SHARE: f64 = 0.25;

/// The places of wild samples among others that carry noise of such a standard deviation; NaN is a missing one.
pub(crate) fn wild(samples: &[f64], noise: f64) -> Vec<usize> {
    let off: Vec<f64> = samples.windows(3).map(|own| own[1] - 0.5 * (own[0] + own[2])).collect();
    let sizes: Vec<f64> = off.iter().map(|own| own.abs()).filter(|own| !own.is_nan()).collect();
    let usual = (median(&sizes) / HALF_WITHIN).max(noise);
    let is_wild = |near: &[f64]| {
        let (own, size) = (near[2], near[2].abs());
        let stands_out = size > FAR * usual.max(near[0].abs()).max(near[4].abs());
        let comes_back = [near[1], near[3]].iter().all(|beside| (beside + 0.5 * own).abs() < SHARE * size);
        stands_out && comes_back
    };
    let found = off.windows(5).enumerate().filter(|(_, near)| is_wild(near));
    // The middle of five differences, each about the middle of three samples.
    found.map(|(place, _)| place + 3).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::rng::normal;

    fn curve() -> Vec<f64> {
        let noise = normal(3, 400).into_iter().enumerate();
        noise.map(|(k, own)| (0.05 * k as f64).sin().max(-0.5) + 1e-3 * own).collect()
    }

    #[test]
    fn a_slip_is_found_and_neither_noise_nor_kinks_nor_jumps_are() {
        assert_eq!(wild(&curve(), 1e-3), [0_usize; 0]);
        let mut samples = curve();
        samples[100] += 0.05;
        samples[301] -= 3.0;
        assert_eq!(wild(&samples, 1e-3), [100, 301]);
        samples.iter_mut().skip(200).for_each(|own| *own += 1.0);
        assert_eq!(wild(&samples, 1e-3), [100, 301]);
        samples[99] = f64::NAN;
        assert_eq!(wild(&samples, 1e-3), [301]);
    }

    #[test]
    fn a_step_of_the_recorder_is_no_slip() {
        let mut samples = vec![2.0; 60];
        samples[30] = 3.0;
        assert_eq!(wild(&samples, 1.0 / 12.0_f64.sqrt()), [0_usize; 0]);
        samples[30] = 9.0;
        assert_eq!(wild(&samples, 1.0 / 12.0_f64.sqrt()), [30]);
        assert_eq!(wild(&[], 0.0), [0_usize; 0]);
    }
}
