//! Windows in which a signal is looked at: how many samples they hold.

use super::critical_velocity::Criterion;
use patchcord_core::document::told;

/// Why there are no windows to look through.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum WindowError {
    /// The threshold or the window is not above 0.
    #[error("threshold and window must lie above 0")]
    BadCriterion,
    /// Too few samples stand in a window.
    #[error("{0} samples stand in a window: at least {FEWEST_SAMPLES} are needed")]
    TooCoarse(usize),
    /// The run ends before a window does.
    #[error("the window of {} s is longer than the run of {} s", told(*.window), told(*.run))]
    TooLong {
        /// Length of the window in seconds.
        window: f64,
        /// Length of the run in seconds.
        run: f64,
    },
}

/// Fewer samples in a window than this do not show a swing.
const FEWEST_SAMPLES: usize = 8;

/// Samples in a window; there are two instants at least, evenly spaced.
pub(super) fn samples_in(
    time: &[f64],
    Criterion { threshold, window }: Criterion,
) -> Result<usize, WindowError> {
    if !(threshold > 0.0 && window > 0.0 && window.is_finite()) {
        return Err(WindowError::BadCriterion);
    }
    let run = time[time.len() - 1] - time[0];
    let spacing = run / (time.len() - 1) as f64;
    let span = (window / spacing).round() as usize;
    if span > time.len() {
        return Err(WindowError::TooLong { window, run });
    }
    if span < FEWEST_SAMPLES { Err(WindowError::TooCoarse(span)) } else { Ok(span) }
}
