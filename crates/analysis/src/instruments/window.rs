//! Windows: short stretches of a run in which a velocity is classified. Converts their length to samples.

use super::critical_velocity::Criterion;
use patchcord_core::document::format_distinct;

/// Why a run cannot be divided into windows.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WindowError {
    /// The threshold or the window is not positive.
    #[error("threshold and window must be positive")]
    BadCriterion,
    /// A window has too few samples. The field is their number.
    #[error("a window has {0} samples, at least {MIN_SAMPLES} are needed")]
    TooCoarse(usize),
    /// The window is longer than the run.
    #[error(
        "window of {} s exceeds the run of {} s",
        format_distinct(*.window, *.run), format_distinct(*.run, *.window)
    )]
    TooLong {
        /// Length of the window in seconds.
        window: f64,
        /// Length of the run in seconds.
        run: f64,
    },
}

/// The fewest samples in a window that show a swing.
const MIN_SAMPLES: usize = 8;

/// The number of samples per window. `time` has at least two evenly spaced entries, in seconds. The last interval may
/// be shorter.
pub(super) fn samples_in(
    time: &[f64],
    Criterion { threshold, window }: Criterion,
) -> Result<usize, WindowError> {
    if !(threshold > 0.0 && window > 0.0 && window.is_finite()) {
        return Err(WindowError::BadCriterion);
    }
    let run = time[time.len() - 1] - time[0];
    let span = (window / spacing(time)).round() as usize;
    if span > time.len() {
        return Err(WindowError::TooLong { window, run });
    }
    if span < MIN_SAMPLES { Err(WindowError::TooCoarse(span)) } else { Ok(span) }
}

/// The time between samples. The last interval does not count if there are others, because the end of a run is recorded
/// even if it is not a whole number of intervals.
fn spacing(time: &[f64]) -> f64 {
    let intervals = time.len().saturating_sub(2).max(1);
    (time[intervals] - time[0]) / intervals as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_last_interval_does_not_change_the_window() {
        let even: Vec<f64> = (0..=10).map(|index| 0.1 * f64::from(index)).collect();
        let criterion = Criterion { threshold: 1.0, window: 0.8 };
        assert_eq!(samples_in(&even, criterion), Ok(8));
        assert_eq!(samples_in(&[&even[..], &[1.001]].concat(), criterion), Ok(8));
        assert_eq!((spacing(&[0.0, 0.5]), spacing(&[0.0, 0.5, 0.6])), (0.5, 0.5));
    }
}
