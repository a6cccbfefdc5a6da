//! How fast a column moves: below which frequencies its power lies.

use std::f64::consts::TAU;

/// The shares of the power for which frequencies are told.
pub const SHARES: [f64; 3] = [0.5, 0.9, 0.99];

/// The frequencies in Hz below which the shares [`SHARES`] of the power lie, of evenly spaced samples, `interval` seconds apart, the
/// mean and a straight trend left out. Missing samples lie on straight lines. `None` where nothing moves.
pub(super) fn frequencies_below(samples: &[f64], interval: f64) -> Option<[f64; SHARES.len()]> {
    let (powers, step) = powers(samples, interval)?;
    let whole: f64 = powers.iter().sum();
    let frequency = |share: f64| {
        let mut sum = 0.0;
        let reached = |power: &f64| {
            sum += power;
            sum >= share * whole
        };
        let place = powers.iter().position(reached).unwrap_or(powers.len() - 1);
        (place + 1) as f64 * step
    };
    (whole > 0.0).then(|| SHARES.map(frequency))
}

/// A frequency of which samples are full.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Peak {
    /// In Hz.
    pub frequency: f64,
    power: f64,
    /// What lies nearer than this, in Hz, is the same.
    width: f64,
}

impl Peak {
    /// The highest of several, the highest first, each frequency once.
    pub(crate) fn highest(mut peaks: Vec<Peak>, count: usize) -> Vec<Peak> {
        peaks.sort_by(|a, b| b.power.total_cmp(&a.power));
        let mut told: Vec<Peak> = Vec::new();
        for peak in peaks {
            let is_told =
                told.iter().any(|own| (own.frequency - peak.frequency).abs() < own.width.max(peak.width));
            if told.len() < count && !is_told {
                told.push(peak);
            }
        }
        told
    }
}

/// The highest peaks of the power, the highest first.
pub(crate) fn peaks(samples: &[f64], interval: f64, count: usize) -> Vec<Peak> {
    let Some((powers, step)) = powers(samples, interval) else { return Vec::new() };
    let is_peak = |place: &usize| {
        let beside = [place.checked_sub(1), Some(place + 1)].into_iter().flatten();
        beside.filter_map(|other| powers.get(other)).all(|other| *other < powers[*place])
    };
    let told =
        |place: usize| Peak { frequency: (place + 1) as f64 * step, power: powers[place], width: 0.5 * step };
    Peak::highest((0..powers.len()).filter(is_peak).map(told).collect(), count)
}

/// The power at 1, 2, ... times a frequency in Hz, which is the other number; `None` where there are too few samples.
fn powers(samples: &[f64], interval: f64) -> Option<(Vec<f64>, f64)> {
    let level = without_trend(&filled(samples)?);
    let count = level.len();
    let window = |place: usize| 0.5 - 0.5 * libm::cos(TAU * (place as f64 + 0.5) / count as f64);
    let mut real: Vec<f64> = level.iter().enumerate().map(|(place, value)| value * window(place)).collect();
    let size = count.next_power_of_two();
    real.resize(size, 0.0);
    let mut imaginary = vec![0.0; size];
    transform(&mut real, &mut imaginary);
    let power = |place: usize| real[place] * real[place] + imaginary[place] * imaginary[place];
    Some(((1..=size / 2).map(power).collect(), 1.0 / (size as f64 * interval)))
}

/// The samples, missing ones on straight lines between their neighbours; `None` where there are too few.
fn filled(samples: &[f64]) -> Option<Vec<f64>> {
    let there: Vec<usize> = (0..samples.len()).filter(|place| !samples[*place].is_nan()).collect();
    let (first, last) = (*there.first()?, *there.last()?);
    let mut filled = samples[first..=last].to_vec();
    for pair in there.windows(2) {
        let (from, to) = (samples[pair[0]], samples[pair[1]]);
        let length = (pair[1] - pair[0]) as f64;
        for (steps, value) in filled[pair[0] - first..pair[1] - first].iter_mut().enumerate().skip(1) {
            *value = from + steps as f64 / length * (to - from);
        }
    }
    (filled.len() > 3).then_some(filled)
}

/// What is left beside the straight line that fits best; what is next to nothing is nothing.
fn without_trend(samples: &[f64]) -> Vec<f64> {
    let count = samples.len() as f64;
    let middle = 0.5 * (count - 1.0);
    let mean = samples.iter().sum::<f64>() / count;
    let away = |place: usize| place as f64 - middle;
    let products: f64 = samples.iter().enumerate().map(|(place, value)| away(place) * (value - mean)).sum();
    let squares: f64 = (0..samples.len()).map(|place| away(place) * away(place)).sum();
    let slope = products / squares;
    let largest = samples.iter().map(|value| value.abs()).fold(0.0, f64::max);
    let left = samples.iter().enumerate().map(|(place, value)| value - mean - slope * away(place));
    left.map(|value| if value.abs() < 1e-12 * largest { 0.0 } else { value }).collect()
}

/// The discrete Fourier transform in place, of a length that is a power of two.
fn transform(real: &mut [f64], imaginary: &mut [f64]) {
    let size = real.len();
    let bits = size.trailing_zeros();
    for place in 0..size {
        let mirrored = place.reverse_bits() >> (usize::BITS - bits).min(usize::BITS - 1);
        if place < mirrored {
            real.swap(place, mirrored);
            imaginary.swap(place, mirrored);
        }
    }
    let mut half = 1;
    while half < size {
        for turn in 0..half {
            let angle = -TAU * turn as f64 / (2 * half) as f64;
            let (cos, sin) = (libm::cos(angle), libm::sin(angle));
            for even in (turn..size).step_by(2 * half) {
                let odd = even + half;
                let (x, y) = (cos * real[odd] - sin * imaginary[odd], sin * real[odd] + cos * imaginary[odd]);
                (real[odd], imaginary[odd]) = (real[even] - x, imaginary[even] - y);
                (real[even], imaginary[even]) = (real[even] + x, imaginary[even] + y);
            }
        }
        half *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::rng::normal;

    #[test]
    fn the_transform_is_the_sum_of_its_definition() {
        for size in [1_usize, 2, 8, 32] {
            let samples = normal(1, size);
            let (mut real, mut imaginary) = (samples.clone(), vec![0.0; size]);
            transform(&mut real, &mut imaginary);
            for line in 0..size {
                let angle = |place: usize| -TAU * (line * place) as f64 / size as f64;
                let sum = |of: fn(f64) -> f64| {
                    samples.iter().enumerate().map(|(place, value)| value * of(angle(place))).sum::<f64>()
                };
                assert!(
                    (real[line] - sum(f64::cos)).abs() < 1e-12
                        && (imaginary[line] - sum(f64::sin)).abs() < 1e-12
                );
            }
        }
    }

    #[test]
    fn a_sine_has_its_power_at_its_frequency() {
        let sine: Vec<f64> = (0..5000)
            .map(|place| 4.0 + 0.01 * f64::from(place) + libm::sin(TAU * 2.5e-3 * f64::from(place)))
            .collect();
        let found = frequencies_below(&sine, 0.01).unwrap();
        assert!(found.iter().all(|frequency| (frequency - 0.25).abs() < 0.05), "{found:?}");
    }

    #[test]
    fn white_noise_has_its_power_everywhere() {
        let found = frequencies_below(&normal(3, 20_000), 0.5).unwrap();
        for (frequency, share) in found.iter().zip(SHARES) {
            assert!((frequency - share).abs() < 0.02, "{found:?}: the highest frequency is 1 Hz");
        }
    }

    #[test]
    fn what_does_not_move_has_no_power() {
        let straight: Vec<f64> = (0..100).map(|place| 3.0 + 0.1 * f64::from(place)).collect();
        assert_eq!((frequencies_below(&straight, 1.0), frequencies_below(&[1.0; 50], 1.0)), (None, None));
        assert_eq!((frequencies_below(&[], 1.0), frequencies_below(&[f64::NAN; 9], 1.0)), (None, None));
    }

    #[test]
    fn a_missing_sample_changes_little() {
        let mut sine: Vec<f64> = (0..4096).map(|place| libm::sin(TAU * 0.01 * f64::from(place))).collect();
        let whole = frequencies_below(&sine, 1.0).unwrap();
        sine[100..110].fill(f64::NAN);
        let found = frequencies_below(&sine, 1.0).unwrap();
        assert!(
            found.iter().zip(whole).all(|(found, whole)| (found / whole - 1.0).abs() < 0.2),
            "{found:?} {whole:?}"
        );
    }
}
