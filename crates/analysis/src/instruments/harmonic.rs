//! One harmonic of a signal at a given frequency: amplitude, phase and mean by least squares over whole periods.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};

use super::{NOT_A_SIGNAL, is_signal};

/// The component of a signal at one frequency, over whole periods.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Harmonic {
    /// Amplitude about the mean, not negative, in the unit of the signal.
    pub amplitude: f64,
    /// Phase relative to sin(2 pi frequency t), in radians, -pi ... pi, with t = 0 of the given time. The difference of
    /// two phases is the phase lag between two signals.
    pub phase: f64,
    /// Mean value, in the unit of the signal.
    pub mean: f64,
    /// The number of whole periods that were fitted.
    pub periods: usize,
}

/// Why the harmonic cannot be computed.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HarmonicError {
    /// The frequency is not a positive finite number.
    #[error("frequency must be positive, got {0} Hz")]
    Frequency(f64),
    /// Times and values do not form a signal.
    #[error("{NOT_A_SIGNAL}")]
    NotASignal,
    /// The signal is shorter than one period. The field is its length in periods.
    #[error("the signal lasts {0:.4} periods, at least one is needed")]
    TooShort(f64),
    /// The samples are too far apart to distinguish this frequency from others. The field is the largest distance
    /// between two samples in periods.
    #[error("samples are up to {0:.3} of a period apart, at most 1/8 is allowed")]
    TooCoarse(f64),
}

/// The largest allowed distance between two samples, in periods.
const MAX_GAP: f64 = 0.125;
/// Whole periods are counted with this tolerance, in periods, because sample times are rounded.
const PERIOD_TOLERANCE: f64 = 1e-9;

/// Fits mean + amplitude x sin(2 pi frequency t + phase) to a signal by least squares.
///
/// The fit covers the last whole number of periods, which reduces the influence of an initial transient. `time` is in
/// seconds and strictly increasing; `frequency` is in Hz and positive. Check the amplitude first: if the signal does
/// not contain this frequency, the phase is meaningless. With evenly spaced samples, other harmonics of the frequency
/// do not disturb the result; drift and other frequencies do.
///
/// # Errors
/// If the frequency is not positive or the slices do not form a signal. Also if the signal is shorter than one period,
/// or its samples are more than an eighth of a period apart.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::{HarmonicError, harmonic};
///
/// let time: Vec<f64> = (0..1000).map(|index| 1e-3 * f64::from(index)).collect();
/// let values: Vec<f64> =
///     time.iter().map(|t| 50.0 + 7.0 * (std::f64::consts::TAU * 5.0 * t + 0.3).sin()).collect();
///
/// let read = harmonic(&time, &values, 5.0)?;
/// assert!((read.amplitude - 7.0).abs() < 1e-9 && (read.phase - 0.3).abs() < 1e-9);
/// assert!((read.mean - 50.0).abs() < 1e-9);
/// assert_eq!(read.periods, 4);
/// # Ok::<(), HarmonicError>(())
/// ```
pub fn harmonic(time: &[f64], values: &[f64], frequency: f64) -> Result<Harmonic, HarmonicError> {
    if !(frequency > 0.0 && frequency.is_finite()) {
        return Err(HarmonicError::Frequency(frequency));
    }
    check(time, values, frequency)?;
    let (first, periods) = whole_periods(time, frequency)?;
    let [mean, sine, cosine] = least_squares(&time[first..], &values[first..], frequency)?;
    Ok(Harmonic { amplitude: sine.hypot(cosine), phase: cosine.atan2(sine), mean, periods })
}

/// Checks that the samples form a signal and are close enough for the frequency.
///
/// # Errors
/// [`HarmonicError::NotASignal`] or [`HarmonicError::TooCoarse`].
fn check(time: &[f64], values: &[f64], frequency: f64) -> Result<(), HarmonicError> {
    if time.len() < 2 || !is_signal(time, values) {
        return Err(HarmonicError::NotASignal);
    }
    let widest = time.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max) * frequency;
    if widest > MAX_GAP { Err(HarmonicError::TooCoarse(widest)) } else { Ok(()) }
}

/// Index of the first sample of the last whole periods, and the number of these periods. A sample exactly n periods
/// before the last sample has the same phase, so it is omitted.
fn whole_periods(time: &[f64], frequency: f64) -> Result<(usize, usize), HarmonicError> {
    let end = time[time.len() - 1];
    let duration = (end - time[0]) * frequency;
    let periods = (duration + PERIOD_TOLERANCE).floor();
    if periods < 1.0 {
        return Err(HarmonicError::TooShort(duration));
    }
    let begin = end - (periods - PERIOD_TOLERANCE) / frequency;
    Ok((time.partition_point(|instant| *instant < begin), periods as usize))
}

/// The coefficients of 1, sine and cosine.
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
    fn samples_before_the_last_whole_periods_are_ignored() {
        let (time, values) = sampled(2900, 1e-3, |t| if t < 0.8 { 1e3 } else { (TAU * t).cos() });
        let read = harmonic(&time, &values, 1.0).unwrap();
        assert_eq!(read.periods, 2);
        assert!((read.amplitude - 1.0).abs() < 1e-12 && (read.phase - PI / 2.0).abs() < 1e-12, "{read:?}");
    }

    #[test]
    fn unusable_signals_and_frequencies_return_errors() {
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
