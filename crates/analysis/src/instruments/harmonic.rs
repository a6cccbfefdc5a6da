//! The part of a signal that goes with one frequency: amplitude, phase and mean.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};

use super::is_signal;

/// What a signal holds of one frequency, over whole periods.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Harmonic {
    /// Height above and below the mean, 0 or more, in the unit of the signal.
    pub amplitude: f64,
    /// Lead on sin(2 pi frequency t) at t = 0 of the time given, in radians, -pi ... pi. A difference of two
    /// phases tells how far one signal lags behind another.
    pub phase: f64,
    /// Mean value, in the unit of the signal.
    pub mean: f64,
    /// How many whole periods were read.
    pub periods: usize,
}

/// Why there is no reading.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum HarmonicError {
    /// The frequency is not a number above 0.
    #[error("a frequency lies above 0 Hz: {0} Hz does not")]
    Frequency(f64),
    /// Times and values do not make a signal.
    #[error("a signal has one finite value for each of its times, which rise")]
    NotASignal,
    /// The signal is shorter than a period.
    #[error("the signal lasts {0:.4} of a period: at least one is needed")]
    TooShort(f64),
    /// The samples are too far apart to tell this frequency from others.
    #[error("samples lie up to {0:.3} of a period apart: at most 1/8 is allowed")]
    TooCoarse(f64),
}

/// Samples may lie this share of a period apart.
const WIDEST_GAP: f64 = 0.125;
/// This much of a period, lost to the rounding of times, is forgiven.
const ROUNDING: f64 = 1e-9;

/// Reads mean + amplitude x sin(2 pi frequency t + phase) off a signal by least squares, over the last whole
/// number of periods, so that a transient at the beginning weighs as little as it can.
///
/// `time` in seconds, rising; `frequency` in Hz, above 0. The phase of a signal without this frequency means
/// nothing: look at the amplitude first. Other harmonics of the frequency do not disturb the reading where
/// samples are evenly spaced; drift and other frequencies do.
///
/// # Errors
/// When the frequency is not above 0, the signal is not one, it is shorter than a period, or its samples lie
/// more than an eighth of a period apart.
pub fn harmonic(time: &[f64], values: &[f64], frequency: f64) -> Result<Harmonic, HarmonicError> {
    if !(frequency > 0.0 && frequency.is_finite()) {
        return Err(HarmonicError::Frequency(frequency));
    }
    check(time, values, frequency)?;
    let (first, periods) = whole_periods(time, frequency)?;
    let [mean, sine, cosine] = least_squares(&time[first..], &values[first..], frequency)?;
    Ok(Harmonic { amplitude: sine.hypot(cosine), phase: cosine.atan2(sine), mean, periods })
}

fn check(time: &[f64], values: &[f64], frequency: f64) -> Result<(), HarmonicError> {
    if time.len() < 2 || !is_signal(time, values) {
        return Err(HarmonicError::NotASignal);
    }
    let widest = time.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max) * frequency;
    if widest > WIDEST_GAP { Err(HarmonicError::TooCoarse(widest)) } else { Ok(()) }
}

/// Index of the first sample of the last whole periods, and how many they are. A sample a whole number of
/// periods before the last one is the same place of the wave again, and left out.
fn whole_periods(time: &[f64], frequency: f64) -> Result<(usize, usize), HarmonicError> {
    let end = time[time.len() - 1];
    let lasts = (end - time[0]) * frequency;
    let periods = (lasts + ROUNDING).floor();
    if periods < 1.0 {
        return Err(HarmonicError::TooShort(lasts));
    }
    let begin = end - (periods - ROUNDING) / frequency;
    Ok((time.partition_point(|instant| *instant < begin), periods as usize))
}

/// Coefficients of 1, sine and cosine.
fn least_squares(time: &[f64], values: &[f64], frequency: f64) -> Result<[f64; 3], HarmonicError> {
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (instant, value) in time.iter().zip(values) {
        let (sine, cosine) = (TAU * frequency * instant).sin_cos();
        let row = Vector3::new(1.0, sine, cosine);
        normal += row * row.transpose();
        right += row * *value;
    }
    let solved = normal.cholesky().map(|factors| factors.solve(&right));
    solved.map(Into::into).ok_or(HarmonicError::NotASignal)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::instruments::sampled;

    #[test]
    fn a_sine_is_read_exactly() {
        for (phase, frequency) in [(0.3, 7.0), (-2.9, 51.9), (3.1, 0.8), (-PI / 4.0, 24.485)] {
            let wave = |t: f64| 50.0 + 7.07 * (TAU * frequency * t + phase).sin();
            let (time, values) = sampled(3000, 1e-3, wave);
            let read = harmonic(&time, &values, frequency).unwrap();
            assert!((read.amplitude - 7.07).abs() < 1e-10, "{read:?}");
            assert!((read.phase - phase).abs() < 1e-10, "{read:?}");
            assert!((read.mean - 50.0).abs() < 1e-10, "{read:?}");
        }
    }

    #[test]
    fn a_square_wave_gives_its_first_harmonic() {
        let (time, values) = sampled(10_001, 1e-4, |t| if (t * 5.0).fract() < 0.5 { 1.0 } else { -1.0 });
        let read = harmonic(&time, &values, 5.0).unwrap();
        assert_eq!(read.periods, 5);
        assert!((read.amplitude - 4.0 / PI).abs() < 1e-5, "{read:?}");
        assert!(read.mean.abs() < 1e-12, "{read:?}");
    }

    #[test]
    fn what_comes_before_the_last_whole_periods_does_not_count() {
        let (time, values) = sampled(2900, 1e-3, |t| if t < 0.8 { 1e3 } else { (TAU * t).cos() });
        let read = harmonic(&time, &values, 1.0).unwrap();
        assert_eq!(read.periods, 2);
        assert!((read.amplitude - 1.0).abs() < 1e-12 && (read.phase - PI / 2.0).abs() < 1e-12, "{read:?}");
    }

    #[test]
    fn what_cannot_be_read_is_refused() {
        let (time, values) = sampled(100, 1e-2, |t| t.sin());
        let read = |frequency| harmonic(&time, &values, frequency);
        assert!(matches!(read(0.0), Err(HarmonicError::Frequency(_))));
        assert!(matches!(read(f64::NAN), Err(HarmonicError::Frequency(_))));
        assert!(matches!(read(0.9), Err(HarmonicError::TooShort(_))));
        assert!(matches!(read(12.6), Err(HarmonicError::TooCoarse(_))));
        assert_eq!(harmonic(&time, &values[1..], 2.0), Err(HarmonicError::NotASignal));
        assert_eq!(harmonic(&[], &[], 2.0), Err(HarmonicError::NotASignal));
        assert_eq!(harmonic(&[0.0, 0.0], &[1.0, 2.0], 2.0), Err(HarmonicError::NotASignal));
        let broken: Vec<f64> = values.iter().map(|v| if *v > 0.5 { f64::NAN } else { *v }).collect();
        assert_eq!(harmonic(&time, &broken, 2.0), Err(HarmonicError::NotASignal));
    }
}
