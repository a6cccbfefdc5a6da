//! Stick at the beginning of a run: when sliding begins.

use super::is_signal;

/// Why no end of sticking was seen.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum StickError {
    /// Times and values do not make a signal.
    #[error("a signal has one finite value for each of its times, which rise")]
    NotASignal,
    /// It moves at the beginning.
    #[error("it does not stand still at the beginning")]
    Moves,
    /// It never moves.
    #[error("it never begins to slide")]
    Sticks,
}

/// A velocity below this share of the largest one is standstill.
const STANDSTILL: f64 = 1e-6;

/// When a velocity that stands still at the beginning first passes a threshold, in either direction: a millionth of its
/// largest value where none is given. On the straight line between two samples, so no closer than they lie to each
/// other. `time` in seconds, rising.
///
/// # Errors
/// When the signal is not one, moves from the beginning, or never moves.
pub fn stick_end(time: &[f64], velocity: &[f64], threshold: Option<f64>) -> Result<f64, StickError> {
    if time.is_empty() || !is_signal(time, velocity) {
        return Err(StickError::NotASignal);
    }
    let largest = velocity.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let threshold = threshold.unwrap_or(STANDSTILL * largest);
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
    fn the_end_lies_where_the_threshold_is_passed() {
        let (time, velocity) = sampled(1000, 1e-3, |t| if t < 0.4005 { 0.0 } else { -2.0 * (t - 0.4005) });
        assert!((stick_end(&time, &velocity, None).unwrap() - 0.4).abs() < 1e-5);
        assert!((stick_end(&time, &velocity, Some(0.1)).unwrap() - 0.4505).abs() < 1e-12);
    }

    #[test]
    fn what_does_not_stick_or_never_moves_is_told() {
        let (time, velocity) = sampled(10, 1e-3, |t| 1.0 + t);
        assert_eq!(stick_end(&time, &velocity, None), Err(StickError::Moves));
        assert_eq!(stick_end(&time, &velocity, Some(5.0)), Err(StickError::Sticks));
        assert_eq!(stick_end(&time, &[0.0; 10], None), Err(StickError::Sticks));
        assert_eq!(stick_end(&[], &[], None), Err(StickError::NotASignal));
        assert_eq!(stick_end(&time, &velocity[1..], None), Err(StickError::NotASignal));
    }
}
