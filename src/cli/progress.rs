//! How far a long run has come, for those who wait for it at a terminal.

use std::io::{self, IsTerminal as _, Write as _};
use std::time::{Duration, Instant};

/// Shorter runs tell nothing.
const PATIENCE: Duration = Duration::from_secs(2);
const BETWEEN_LINES: Duration = Duration::from_millis(250);
/// Looking at the clock takes a good part of the time of a step.
const STEPS_BETWEEN_LOOKS: u32 = 256;

/// A line on standard error, written anew in its place; none where that is no terminal.
struct Line {
    shown: bool,
    next: Instant,
}

impl Line {
    fn new() -> Option<Self> {
        let next = Instant::now() + PATIENCE;
        io::stderr().is_terminal().then_some(Line { shown: false, next })
    }

    /// Writes what is to be told, where the last telling lies far enough back.
    fn show(&mut self, told: impl FnOnce() -> String) {
        let now = Instant::now();
        if now >= self.next {
            self.next = now + BETWEEN_LINES;
            self.write(&told());
        }
    }

    fn write(&mut self, told: &str) {
        self.shown = true;
        let mut terminal = io::stderr().lock();
        let _ = write!(terminal, "\r{told}\x1b[K").and_then(|()| terminal.flush());
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        if self.shown {
            let _ = write!(io::stderr().lock(), "\r\x1b[K");
        }
    }
}

/// How far a run has come.
pub(super) struct Progress {
    line: Line,
    whole: f64,
    steps: u32,
}

impl Progress {
    /// The progress of a run of so many seconds of problem time.
    pub fn new(whole: f64) -> Option<Self> {
        Some(Progress { line: Line::new()?, whole, steps: 0 })
    }

    /// Takes note of a step that ended at this time.
    pub fn step(&mut self, time: f64) {
        self.steps += 1;
        if self.steps.is_multiple_of(STEPS_BETWEEN_LOOKS) {
            self.line.show(|| format!("t = {time:.4} of {} s", self.whole));
        }
    }
}

/// How many of many things are done, with the time that is left.
pub(super) struct Bar {
    line: Line,
    /// What is counted.
    what: String,
    /// How many were done at the beginning, and when that was.
    begin: Option<(u64, Instant)>,
}

impl Bar {
    /// Nothing done yet of what is counted.
    pub fn new(what: &str) -> Option<Self> {
        Some(Bar { line: Line::new()?, what: what.to_owned(), begin: None })
    }

    /// Goes on to count something else.
    pub fn turn_to(&mut self, what: &str) {
        if self.what != what {
            (self.what, self.begin) = (what.to_owned(), None);
        }
    }

    /// Tells at once of something that is not counted.
    pub fn busy(&mut self, what: &str) {
        self.turn_to(what);
        self.line.write(what);
    }

    /// Takes note of how many of all are done; first of how many were done before.
    pub fn done(&mut self, done: u64, all: u64) {
        let (before, since) = *self.begin.get_or_insert((done, Instant::now()));
        let what = &self.what;
        self.line.show(|| bar_told(done, all, what, done - before, since.elapsed()));
    }
}

/// Letters of the bar.
const LETTERS: u64 = 30;

/// A bar, how many are done of all, and how long the rest takes at the pace of those done now.
fn bar_told(done: u64, all: u64, what: &str, now: u64, elapsed: Duration) -> String {
    let full = (done * LETTERS / all.max(1)) as usize;
    let bar = "#".repeat(full) + &".".repeat(LETTERS as usize - full);
    let left = match now {
        0 => String::new(),
        now => format!(", {} left", time_told(elapsed.as_secs_f64() / now as f64 * (all - done) as f64)),
    };
    format!("[{bar}] {done} of {all} {what}{left}")
}

/// "8 s", "3 min 20 s", "5 h 3 min".
fn time_told(seconds: f64) -> String {
    let seconds = seconds.round() as u64;
    match seconds {
        0..60 => format!("{seconds} s"),
        60..3600 => format!("{} min {} s", seconds / 60, seconds % 60),
        _ => format!("{} h {} min", seconds / 3600, seconds % 3600 / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_follows_from_the_runs_done_now() {
        let told = |done, now| bar_told(done, 1000, "runs", now, Duration::from_secs(10));
        assert_eq!(told(500, 100), "[###############...............] 500 of 1000 runs, 50 s left");
        assert_eq!(told(0, 0), format!("[{}] 0 of 1000 runs", ".".repeat(30)));
        assert_eq!(told(1000, 1), format!("[{}] 1000 of 1000 runs, 0 s left", "#".repeat(30)));
        assert_eq!([200.0, 18_200.0].map(time_told), ["3 min 20 s", "5 h 3 min"]);
    }
}
