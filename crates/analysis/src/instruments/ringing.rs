//! A damped oscillation about its final value: natural frequency and damping ratio from its peaks.

use std::f64::consts::PI;

use super::{NOT_A_SIGNAL, is_signal};

/// Natural frequency, damping ratio and final value of a damped oscillation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ringing {
    /// Undamped natural frequency, in rad/s: damped frequency / sqrt(1 - damping^2).
    pub natural_frequency: f64,
    /// Damping ratio; negative if the oscillation grows.
    pub damping: f64,
    /// The value about which the signal oscillates, in its unit.
    pub final_value: f64,
    /// The number of peaks, upper and lower, that were used.
    pub peaks: usize,
}

/// Why the ringing cannot be read.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RingingError {
    /// Times and values do not form a signal.
    #[error("{NOT_A_SIGNAL}")]
    NotASignal,
    /// The signal has too few peaks. The field is their number.
    #[error("{0} distinct peaks, upper and lower: at least 4 are needed")]
    TooFewPeaks(usize),
    /// Too few samples between two peaks to locate them. The field is their mean number.
    #[error("{0:.1} samples between two peaks, at least 5 are needed")]
    TooCoarse(f64),
    /// The peaks are not evenly spaced, or the swings do not shrink by a constant ratio.
    #[error("not a single damped oscillation: its {what} deviate by {share:.3} from the best fit")]
    Irregular {
        /// What is irregular: "peak times" or "swings".
        what: &'static str,
        /// The largest deviation as a fraction of a half period or of a swing.
        share: f64,
    },
}

/// The fewest peaks that also test whether the oscillation is regular.
const MIN_PEAKS: usize = 4;
/// Peaks after a swing below this fraction of the largest swing are ignored as noise.
const MIN_SWING: f64 = 1e-3;
/// The fewest samples between two peaks that locate them.
const MIN_SAMPLES: f64 = 5.0;
/// The largest deviation of a peak from even spacing, or of a swing from a constant ratio, as a fraction.
const TOLERANCE: f64 = 0.02;

/// Reads natural frequency, damping ratio and final value off a step response or any other ringing.
///
/// Upper and lower peaks are refined by the parabola through three samples. Peaks are pi / wd apart, where wd is the
/// damped frequency. Each swing is smaller than the previous one by exp(-d), where d is the logarithmic decrement of a
/// half period. Then damping = d / sqrt(pi^2 + d^2) and natural frequency = sqrt(pi^2 + d^2) / spacing. Spacing and d
/// are slopes of straight lines through all peaks. The final value is not needed for this and is computed last. The
/// method works up to a damping ratio of about 0.7; beyond, fewer than four peaks are distinct.
///
/// `time` is in seconds and strictly increasing.
///
/// # Errors
/// If the slices do not form a signal, or it has fewer than four peaks or fewer than five samples between them. Also if
/// it is not a single damped oscillation. Solid friction, two modes and a limit cycle give such signals: the swings
/// shrink by a constant amount, the modes beat, or the peaks are corners.
///
/// # Examples
///
/// The step response of a second-order system with 50 rad/s and a damping ratio of 0.1:
///
/// ```
/// use patchcord_analysis::instruments::{RingingError, ringing};
///
/// let (natural, damping) = (50.0_f64, 0.1_f64);
/// let damped = natural * (1.0 - damping * damping).sqrt();
/// let time: Vec<f64> = (0..1000).map(|index| 1e-3 * f64::from(index)).collect();
/// let wave = |t: f64| (damped * t).cos() + damping * natural / damped * (damped * t).sin();
/// let values: Vec<f64> = time.iter().map(|t| 2.0 - 2.0 * (-damping * natural * t).exp() * wave(*t)).collect();
///
/// let read = ringing(&time, &values)?;
/// assert!((read.natural_frequency / natural - 1.0).abs() < 1e-3);
/// assert!((read.damping - damping).abs() < 1e-3);
/// assert!((read.final_value - 2.0).abs() < 1e-2);
/// # Ok::<(), RingingError>(())
/// ```
pub fn ringing(time: &[f64], values: &[f64]) -> Result<Ringing, RingingError> {
    if !is_signal(time, values) {
        return Err(RingingError::NotASignal);
    }
    let peaks = distinct(peaks(time, values));
    if peaks.len() < MIN_PEAKS {
        return Err(RingingError::TooFewPeaks(peaks.len()));
    }
    let spacing = spacing(&peaks, time)?;
    let decrement = decrement(&peaks)?;
    let turn = PI.hypot(decrement);
    Ok(Ringing {
        natural_frequency: turn / spacing,
        damping: decrement / turn,
        final_value: final_value(&peaks, decrement),
        peaks: peaks.len(),
    })
}

/// A refined extreme: time in seconds, value in the unit of the signal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Peak {
    /// Time of the vertex in seconds.
    time: f64,
    /// Value of the vertex, in the unit of the signal.
    pub value: f64,
}

/// Every extreme of the signal. Two equal samples at the top are one peak.
fn peaks(time: &[f64], values: &[f64]) -> Vec<Peak> {
    let turns = (1..values.len().saturating_sub(1)).filter(|index| {
        let before = values[*index] - values[index - 1];
        let after = values[index + 1] - values[*index];
        let beyond = values.get(index + 2).map_or(0.0, |next| next - values[index + 1]);
        before * after < 0.0 || (after == 0.0 && before * beyond < 0.0)
    });
    turns.map(|index| vertex(&time[index - 1..=index + 1], &values[index - 1..=index + 1])).collect()
}

/// The vertex of the parabola through three samples.
pub(super) fn vertex(time: &[f64], values: &[f64]) -> Peak {
    let slope = |from: usize| (values[from + 1] - values[from]) / (time[from + 1] - time[from]);
    let bend = (slope(1) - slope(0)) / (time[2] - time[0]);
    let top = (time[0] + time[1]) / 2.0 - slope(0) / (2.0 * bend);
    Peak { time: top, value: values[0] + (top - time[0]) * (slope(0) + bend * (top - time[1])) }
}

/// The peaks before the first swing that may be noise.
fn distinct(mut peaks: Vec<Peak>) -> Vec<Peak> {
    let swings = swings(&peaks);
    let least = MIN_SWING * swings.iter().copied().fold(0.0, f64::max);
    if let Some(small) = swings.iter().position(|swing| *swing < least) {
        peaks.truncate(small + 1);
    }
    peaks
}

/// Absolute difference of each peak and the next.
fn swings(peaks: &[Peak]) -> Vec<f64> {
    peaks.windows(2).map(|pair| (pair[1].value - pair[0].value).abs()).collect()
}

/// Mean time between two peaks, in seconds.
fn spacing(peaks: &[Peak], time: &[f64]) -> Result<f64, RingingError> {
    let times: Vec<f64> = peaks.iter().map(|peak| peak.time).collect();
    let (spacing, off) = line(&times);
    let within = time.iter().filter(|instant| times[0] < **instant && **instant <= times[times.len() - 1]);
    let samples = within.count() as f64 / (times.len() - 1) as f64;
    if samples < MIN_SAMPLES {
        return Err(RingingError::TooCoarse(samples));
    }
    check_regular("peak times", off / spacing).map(|()| spacing)
}

/// The logarithmic decrement of a half period.
fn decrement(peaks: &[Peak]) -> Result<f64, RingingError> {
    let logarithms: Vec<f64> = swings(peaks).iter().map(|swing| swing.ln()).collect();
    let (slope, off) = line(&logarithms);
    check_regular("swings", off.exp_m1()).map(|()| -slope)
}

/// An error if a deviation, as a fraction, exceeds the tolerance.
fn check_regular(what: &'static str, share: f64) -> Result<(), RingingError> {
    if share <= TOLERANCE { Ok(()) } else { Err(RingingError::Irregular { what, share }) }
}

/// Slope of the least-squares line through values at 0, 1, 2, ..., and the largest deviation from it.
fn line(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let (middle, mean) = ((count - 1.0) / 2.0, values.iter().sum::<f64>() / count);
    let offset = |index: usize| index as f64 - middle;
    let moment: f64 = values.iter().enumerate().map(|(index, value)| offset(index) * value).sum();
    let slope = moment / (count * (count * count - 1.0) / 12.0);
    let off = |(index, value): (usize, &f64)| (value - mean - slope * offset(index)).abs();
    (slope, values.iter().enumerate().map(off).fold(0.0, f64::max))
}

/// The mean estimate from all pairs of peaks. The final value divides each swing in the ratio 1 : exp(-decrement).
fn final_value(peaks: &[Peak], decrement: f64) -> f64 {
    let share = 1.0 / (1.0 + (-decrement).exp());
    let estimates = peaks.windows(2).map(|pair| pair[0].value + share * (pair[1].value - pair[0].value));
    estimates.sum::<f64>() / (peaks.len() - 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instruments::sampled;

    /// Step response of wn^2 / (s^2 + 2 zeta wn s + wn^2), height 2.
    fn response(wn: f64, zeta: f64) -> impl Fn(f64) -> f64 {
        let wd = wn * (1.0 - zeta * zeta).sqrt();
        move |t| 2.0 - 2.0 * (-zeta * wn * t).exp() * ((wd * t).cos() + zeta * wn / wd * (wd * t).sin())
    }

    #[test]
    fn a_step_response_gives_its_parameters() {
        for (wn, zeta) in [(198.3, 0.0992), (322.4, 0.0383), (50.0, 0.0), (50.0, 0.4), (50.0, 0.7)] {
            let (time, values) = sampled(4000, 1e-4, response(wn, zeta));
            let read = ringing(&time, &values).unwrap();
            assert!((read.natural_frequency / wn - 1.0).abs() < 1e-5, "{wn} {zeta} {read:?}");
            assert!((read.damping - zeta).abs() < 1e-5, "{wn} {zeta} {read:?}");
            assert!((read.final_value - 2.0).abs() < 1e-4, "{wn} {zeta} {read:?}");
        }
    }

    #[test]
    fn a_growing_oscillation_has_negative_damping() {
        let (time, values) = sampled(1000, 1e-3, response(50.0, -0.05));
        assert!((ringing(&time, &values).unwrap().damping + 0.05).abs() < 1e-4);
    }

    #[test]
    fn solid_friction_beats_and_noise_are_not_a_single_damped_oscillation() {
        let constant_loss = |t: f64| {
            let half = (t / PI).floor();
            let side = if half % 2.0 == 0.0 { 0.06 } else { -0.06 };
            (1.0 - 0.06 * (2.0 * half + 1.0)) * t.cos() + side
        };
        let beat = |t: f64| t.sin() + (1.17 * t).sin();
        let noise = |t: f64| (1e4 * t * t).sin();
        for (name, signal) in
            [("loss", &constant_loss as &dyn Fn(f64) -> f64), ("beat", &beat), ("noise", &noise)]
        {
            let (time, values) = sampled(2000, 0.01, signal);
            let read = ringing(&time, &values);
            assert!(
                matches!(read, Err(RingingError::Irregular { .. } | RingingError::TooCoarse(_))),
                "{name}: {read:?}"
            );
        }
    }

    #[test]
    fn unusable_signals_return_errors() {
        let (time, values) = sampled(1000, 1e-3, response(50.0, 0.9));
        assert!(matches!(ringing(&time, &values), Err(RingingError::TooFewPeaks(_))));
        assert_eq!(ringing(&time, &vec![1.0; 1000]), Err(RingingError::TooFewPeaks(0)));
        assert_eq!(ringing(&[], &[]), Err(RingingError::TooFewPeaks(0)));
        assert_eq!(ringing(&time, &values[1..]), Err(RingingError::NotASignal));
        let (time, values) = sampled(100, 1e-2, response(200.0, 0.01));
        assert!(matches!(ringing(&time, &values), Err(RingingError::TooCoarse(_))));
        let (time, values) = sampled(100, 1e-2, |t| 1.0 / (t - 0.5));
        assert_eq!(ringing(&time, &values), Err(RingingError::NotASignal));
    }
}
