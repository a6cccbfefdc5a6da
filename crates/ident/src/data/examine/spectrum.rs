//! The power spectrum of a column: the frequencies below which its power is, and its peaks.
//!
//! The linear trend is removed, a Hann window is applied, and the samples are padded with zeros to a power of two. The
//! spectrum is that of the fast Fourier transform.

use std::f64::consts::TAU;

use crate::data::experiment_document::Hold;
use crate::data::interpolation::fill_gaps;

/// The fractions of the power for which [`ColumnStatistics`](crate::ColumnStatistics) has frequencies.
pub const POWER_FRACTIONS: [f64; 3] = [0.5, 0.9, 0.99];

/// Returns the frequencies in Hz below which the fractions [`POWER_FRACTIONS`] of the power are. Samples are `interval`
/// seconds apart. The mean and the linear trend do not count. Missing samples (NaN) are interpolated linearly. None if
/// there is no power or there are fewer than four samples.
pub(super) fn power_frequencies(samples: &[f64], interval: f64) -> Option<[f64; POWER_FRACTIONS.len()]> {
    let (powers, resolution) = power_spectrum(samples, interval)?;
    let total: f64 = powers.iter().sum();
    let frequency_at = |fraction: f64| {
        let mut sum = 0.0;
        let reaches_fraction = |power: &f64| {
            sum += power;
            sum >= fraction * total
        };
        let bin = powers.iter().position(reaches_fraction).unwrap_or(powers.len() - 1);
        (bin + 1) as f64 * resolution
    };
    (total > 0.0).then(|| POWER_FRACTIONS.map(frequency_at))
}

/// A peak of a power spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SpectralPeak {
    /// The frequency, in Hz.
    pub frequency: f64,
    power: f64,
    /// Peaks that are closer than this, in Hz, are the same.
    width: f64,
}

impl SpectralPeak {
    /// Returns at most `count` peaks, the highest first. Of peaks with the same frequency, only the highest is kept.
    pub(crate) fn highest(mut peaks: Vec<SpectralPeak>, count: usize) -> Vec<SpectralPeak> {
        peaks.sort_by(|a, b| b.power.total_cmp(&a.power));
        let mut distinct: Vec<SpectralPeak> = Vec::new();
        for peak in peaks {
            let is_duplicate = distinct
                .iter()
                .any(|higher| (higher.frequency - peak.frequency).abs() < higher.width.max(peak.width));
            if distinct.len() < count && !is_duplicate {
                distinct.push(peak);
            }
        }
        distinct
    }
}

/// Returns at most `count` peaks of the power spectrum, the highest first. Samples are `interval` seconds apart. Empty
/// if there are fewer than four samples.
pub(crate) fn spectral_peaks(samples: &[f64], interval: f64, count: usize) -> Vec<SpectralPeak> {
    let Some((powers, resolution)) = power_spectrum(samples, interval) else { return Vec::new() };
    let is_peak = |bin: &usize| {
        let neighbours = [bin.checked_sub(1), Some(bin + 1)].into_iter().flatten();
        neighbours.filter_map(|neighbour| powers.get(neighbour)).all(|power| *power < powers[*bin])
    };
    let peak = |bin: usize| SpectralPeak {
        frequency: (bin + 1) as f64 * resolution,
        power: powers[bin],
        width: 0.5 * resolution,
    };
    SpectralPeak::highest((0..powers.len()).filter(is_peak).map(peak).collect(), count)
}

/// Returns the power at 1, 2, ... times a frequency, and this frequency in Hz. Missing samples are interpolated. None
/// if there are fewer than four samples.
fn power_spectrum(samples: &[f64], interval: f64) -> Option<(Vec<f64>, f64)> {
    let detrended = without_trend(&interpolated(samples)?);
    let count = detrended.len();
    let hann = |index: usize| 0.5 - 0.5 * libm::cos(TAU * (index as f64 + 0.5) / count as f64);
    let mut real: Vec<f64> = detrended.iter().enumerate().map(|(index, value)| value * hann(index)).collect();
    let size = count.next_power_of_two();
    real.resize(size, 0.0);
    let mut imaginary = vec![0.0; size];
    fourier_transform(&mut real, &mut imaginary);
    let power = |bin: usize| real[bin] * real[bin] + imaginary[bin] * imaginary[bin];
    Some(((1..=size / 2).map(power).collect(), 1.0 / (size as f64 * interval)))
}

/// Returns the samples from the first to the last that is present, with linear interpolation between them. None if
/// there are fewer than four.
fn interpolated(samples: &[f64]) -> Option<Vec<f64>> {
    let first = samples.iter().position(|sample| !sample.is_nan())?;
    let last = samples.iter().rposition(|sample| !sample.is_nan())?;
    let mut filled = samples[first..=last].to_vec();
    fill_gaps(&mut filled, Hold::Linear);
    (filled.len() > 3).then_some(filled)
}

/// The ratio to the largest sample up to which a residual of the trend is zero. It is only rounding of floating-point
/// numbers.
const ZERO_RATIO: f64 = 1e-12;

/// Subtracts the straight line of least squares.
fn without_trend(samples: &[f64]) -> Vec<f64> {
    let count = samples.len() as f64;
    let middle = 0.5 * (count - 1.0);
    let mean = samples.iter().sum::<f64>() / count;
    let from_middle = |index: usize| index as f64 - middle;
    let products: f64 =
        samples.iter().enumerate().map(|(index, value)| from_middle(index) * (value - mean)).sum();
    let squares: f64 = (0..samples.len()).map(|index| from_middle(index) * from_middle(index)).sum();
    let slope = products / squares;
    let largest = samples.iter().map(|value| value.abs()).fold(0.0, f64::max);
    let residuals =
        samples.iter().enumerate().map(|(index, value)| value - mean - slope * from_middle(index));
    residuals.map(|value| if value.abs() < ZERO_RATIO * largest { 0.0 } else { value }).collect()
}

/// Computes the discrete Fourier transform in place (radix 2, decimation in time). The length must be a power of two,
/// the same for both parts.
fn fourier_transform(real: &mut [f64], imaginary: &mut [f64]) {
    let size = real.len();
    let bits = size.trailing_zeros();
    for index in 0..size {
        let reversed = index.reverse_bits() >> (usize::BITS - bits).min(usize::BITS - 1);
        if index < reversed {
            real.swap(index, reversed);
            imaginary.swap(index, reversed);
        }
    }
    let mut half = 1;
    while half < size {
        for twiddle in 0..half {
            let angle = -TAU * twiddle as f64 / (2 * half) as f64;
            let (cos, sin) = (libm::cos(angle), libm::sin(angle));
            for even in (twiddle..size).step_by(2 * half) {
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
    use crate::statistics::rng::standard_normal;

    #[test]
    fn the_fast_transform_equals_the_sum_of_the_definition() {
        for size in [1_usize, 2, 8, 32] {
            let samples = standard_normal(1, size);
            let (mut real, mut imaginary) = (samples.clone(), vec![0.0; size]);
            fourier_transform(&mut real, &mut imaginary);
            for bin in 0..size {
                let angle = |index: usize| -TAU * (bin * index) as f64 / size as f64;
                let sum = |function: fn(f64) -> f64| {
                    samples
                        .iter()
                        .enumerate()
                        .map(|(index, value)| value * function(angle(index)))
                        .sum::<f64>()
                };
                assert!(
                    (real[bin] - sum(f64::cos)).abs() < 1e-12
                        && (imaginary[bin] - sum(f64::sin)).abs() < 1e-12
                );
            }
        }
    }

    #[test]
    fn the_power_of_a_sine_is_at_its_frequency() {
        let sine: Vec<f64> = (0..5000)
            .map(|index| 4.0 + 0.01 * f64::from(index) + libm::sin(TAU * 2.5e-3 * f64::from(index)))
            .collect();
        let frequencies = power_frequencies(&sine, 0.01).unwrap();
        assert!(frequencies.iter().all(|frequency| (frequency - 0.25).abs() < 0.05), "{frequencies:?}");
    }

    #[test]
    fn the_power_of_white_noise_is_even_over_all_frequencies() {
        let frequencies = power_frequencies(&standard_normal(3, 20_000), 0.5).unwrap();
        for (frequency, fraction) in frequencies.iter().zip(POWER_FRACTIONS) {
            assert!((frequency - fraction).abs() < 0.02, "{frequencies:?}: the highest frequency is 1 Hz");
        }
    }

    #[test]
    fn constant_and_straight_columns_have_no_power() {
        let straight: Vec<f64> = (0..100).map(|index| 3.0 + 0.1 * f64::from(index)).collect();
        assert_eq!((power_frequencies(&straight, 1.0), power_frequencies(&[1.0; 50], 1.0)), (None, None));
        assert_eq!((power_frequencies(&[], 1.0), power_frequencies(&[f64::NAN; 9], 1.0)), (None, None));
    }

    #[test]
    fn missing_samples_change_the_frequencies_by_less_than_a_fifth() {
        let mut sine: Vec<f64> = (0..4096).map(|index| libm::sin(TAU * 0.01 * f64::from(index))).collect();
        let complete = power_frequencies(&sine, 1.0).unwrap();
        sine[100..110].fill(f64::NAN);
        let frequencies = power_frequencies(&sine, 1.0).unwrap();
        assert!(
            frequencies
                .iter()
                .zip(complete)
                .all(|(frequency, complete)| (frequency / complete - 1.0).abs() < 0.2),
            "{frequencies:?} {complete:?}"
        );
    }
}
