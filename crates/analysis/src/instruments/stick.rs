//! The end of sticking: the time at which a velocity that starts at zero begins to move.

use super::{NOT_A_SIGNAL, is_signal};

/// Why the end of sticking cannot be read.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StickError {
    /// Times and values do not form a signal.
    #[error("{NOT_A_SIGNAL}")]
    NotASignal,
    /// The velocity exceeds the threshold at the first sample.
    #[error("the velocity is not zero at the beginning")]
    Moves,
    /// The velocity never exceeds the threshold.
    #[error("the velocity never exceeds the threshold")]
    Sticks,
}

/// The default threshold as a fraction of the largest absolute velocity.
const DEFAULT_THRESHOLD: f64 = 1e-6;

/// The time at which a velocity that starts at zero first exceeds a threshold, in either direction.
///
/// The default threshold is a millionth of the largest absolute velocity. The result is interpolated linearly, so its
/// accuracy is that of the sample spacing. `time` is in seconds and strictly increasing.
///
/// # Errors
/// If the slices do not form a signal, or the velocity moves from the beginning or never.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::{StickError, stick_end};
///
/// // The velocity is zero up to 0.4 s and then rises by 1 per second.
/// let time: Vec<f64> = (0..1000).map(|index| 1e-3 * f64::from(index)).collect();
/// let velocity: Vec<f64> = time.iter().map(|t| (t - 0.4).max(0.0)).collect();
///
/// assert!((stick_end(&time, &velocity, Some(0.1))? - 0.5).abs() < 1e-9);
/// assert_eq!(stick_end(&time, &velocity, Some(5.0)), Err(StickError::Sticks));
/// # Ok::<(), StickError>(())
/// ```
pub fn stick_end(time: &[f64], velocity: &[f64], threshold: Option<f64>) -> Result<f64, StickError> {
    if time.is_empty() || !is_signal(time, velocity) {
        return Err(StickError::NotASignal);
    }
    let largest = velocity.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let threshold = threshold.unwrap_or(DEFAULT_THRESHOLD * largest);
    match velocity.iter().position(|value| value.abs() > threshold) {
        None => Err(StickError::Sticks),
        Some(0) => Err(StickError::Moves),
        Some(first) => {
            let (before, after) = (velocity[first - 1].abs(), velocity[first].abs());
            let share = (threshold - before) / (after - before);
            Ok(time[first - 1] + share * (time[first] - time[first - 1]))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instruments::sampled;

    #[test]
    fn the_end_is_where_the_threshold_is_passed() {
        let (time, velocity) = sampled(1000, 1e-3, |t| if t < 0.4005 { 0.0 } else { -2.0 * (t - 0.4005) });
        assert!((stick_end(&time, &velocity, None).unwrap() - 0.4).abs() < 1e-5);
        assert!((stick_end(&time, &velocity, Some(0.1)).unwrap() - 0.4505).abs() < 1e-12);
    }

    #[test]
    fn moving_from_the_start_or_never_returns_an_error() {
        let (time, velocity) = sampled(10, 1e-3, |t| 1.0 + t);
        assert_eq!(stick_end(&time, &velocity, None), Err(StickError::Moves));
        assert_eq!(stick_end(&time, &velocity, Some(5.0)), Err(StickError::Sticks));
        assert_eq!(stick_end(&time, &[0.0; 10], None), Err(StickError::Sticks));
        assert_eq!(stick_end(&[], &[], None), Err(StickError::NotASignal));
        assert_eq!(stick_end(&time, &velocity[1..], None), Err(StickError::NotASignal));
    }
}
