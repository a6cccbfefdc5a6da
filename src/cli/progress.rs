//! How far a long run has come, for those who wait for it at a terminal.

use std::io::{self, IsTerminal as _, Write as _};
use std::time::{Duration, Instant};

/// Shorter runs tell nothing.
const PATIENCE: Duration = Duration::from_secs(2);
const BETWEEN_LINES: Duration = Duration::from_millis(250);
/// Looking at the clock takes a good part of the time of a step.
const STEPS_BETWEEN_LOOKS: u32 = 256;

/// A line on standard error, written anew in its place; none where that is no terminal.
pub(super) struct Progress {
    whole: f64,
    shown: bool,
    next: Instant,
    steps: u32,
}

impl Progress {
    /// The progress of a run of so many seconds of problem time.
    pub fn new(whole: f64) -> Option<Self> {
        let next = Instant::now() + PATIENCE;
        io::stderr().is_terminal().then_some(Progress { whole, shown: false, next, steps: 0 })
    }

    /// Takes note of a step that ended at this time.
    pub fn step(&mut self, time: f64) {
        self.steps += 1;
        if self.steps.is_multiple_of(STEPS_BETWEEN_LOOKS) && Instant::now() >= self.next {
            self.next = Instant::now() + BETWEEN_LINES;
            self.shown = true;
            let mut terminal = io::stderr().lock();
            let _ = write!(terminal, "\rt = {time:.4} of {} s", self.whole).and_then(|()| terminal.flush());
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if self.shown {
            let _ = write!(io::stderr().lock(), "\r\x1b[K");
        }
    }
}
