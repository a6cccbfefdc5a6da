//! The progress of long work on standard error.
//!
//! A terminal shows a status line, which is erased when the work ends. Elsewhere, such as in a log file, a plain line
//! is printed every ten seconds: "sweep: 1200 of 10000 runs, about 2 min left". The environment can set another
//! interval, which is checked before the work.

use std::fmt;
use std::ops::RangeInclusive;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar as Line, ProgressDrawTarget, ProgressFinish, ProgressState, ProgressStyle};

use super::eprint;
use super::failure::Failure;
use super::progress_lines::PlainLines;
use super::progress_status::{Amount, Status};
use patchcord::document::escape_controls;

/// A run that takes less time shows no status line.
const DELAY: Duration = Duration::from_secs(2);
/// The time between two updates of the status line.
const UPDATE_INTERVAL: Duration = Duration::from_millis(250);
/// The time between two plain lines if the environment sets no other.
const LINE_INTERVAL: Duration = Duration::from_secs(10);
/// The environment variable with the seconds between two plain lines.
const INTERVAL_VARIABLE: &str = "PATCHCORD_PROGRESS";
/// The permitted times between two plain lines in seconds; 0 prints none.
const INTERVALS: RangeInclusive<f64> = 1e-3..=1e9;
/// The number of solver steps between two readings of the clock, which are slow compared with a step.
const STEPS_PER_CHECK: u32 = 256;
/// The status line of countable work.
const BAR_TEMPLATE: &str = "[{bar:30}] {status}";
/// The status line of other work.
const TEXT_TEMPLATE: &str = "{status}";

/// The work of a command: its status, and what displays it.
struct Work {
    /// The status, which the threads of the displays read.
    status: Arc<Mutex<Status>>,
    /// The status line of a terminal, which is not shown yet.
    line: Line,
    /// The plain lines. None on a terminal, or if the environment permits none.
    _lines: Option<PlainLines>,
}

/// The status, for reading or writing.
fn lock(status: &Mutex<Status>) -> MutexGuard<'_, Status> {
    status.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Work {
    /// The work of a command with this name.
    fn new(command: &'static str, status: Status) -> Self {
        let status = Arc::new(Mutex::new(status));
        let line = Line::with_draw_target(None, ProgressDrawTarget::hidden());
        let interval = line_interval(given_interval().as_deref()).unwrap_or_default();
        let interval = interval.filter(|_| ProgressDrawTarget::stderr().is_hidden());
        let lines = interval.map(|interval| plain_lines(command, &status, interval, eprint));
        let work = Work { status, line: line.with_finish(ProgressFinish::AndClear), _lines: lines };
        work.set_template(TEXT_TEMPLATE);
        work
    }

    /// Shows the status line on standard error if that is a terminal.
    fn show(&self) {
        self.line.set_draw_target(ProgressDrawTarget::stderr());
        self.line.enable_steady_tick(UPDATE_INTERVAL);
    }

    /// Sets the template of the status line.
    fn set_template(&self, template: &str) {
        let status = Arc::clone(&self.status);
        let write_status = move |_: &ProgressState, out: &mut dyn fmt::Write| {
            // The line is drawn into a buffer, which cannot fail.
            let _ = out.write_str(&lock(&status).text(Instant::now()));
        };
        // Only an invalid template fails. The templates are constants, and tests use them.
        if let Ok(style) = ProgressStyle::with_template(template) {
            self.line.set_style(style.progress_chars("#.").with_key("status", write_status));
        }
    }

    /// Sets the amount of work that is done. Returns whether a new count begins.
    fn set_amount(&self, amount: Amount) -> bool {
        lock(&self.status).set_amount(amount, Instant::now())
    }
}

/// Checks the interval that the environment sets.
///
/// # Errors
/// If it is not a permitted number of seconds.
pub(super) fn check_interval() -> Result<(), Failure> {
    line_interval(given_interval().as_deref()).map(|_| ()).map_err(Failure::usage)
}

/// The text of the environment variable. None if it is not set.
fn given_interval() -> Option<String> {
    std::env::var_os(INTERVAL_VARIABLE).map(|text| text.to_string_lossy().into_owned())
}

/// The time between two plain lines, from the text of the environment variable. None if it is 0: then no lines are
/// printed. An empty text counts as none.
///
/// # Errors
/// If the text is not a permitted number of seconds.
fn line_interval(text: Option<&str>) -> Result<Option<Duration>, String> {
    let Some(text) = text.map(str::trim).filter(|text| !text.is_empty()) else {
        return Ok(Some(LINE_INTERVAL));
    };
    match text.parse::<f64>() {
        Ok(0.0) => Ok(None),
        Ok(seconds) if INTERVALS.contains(&seconds) => Ok(Some(Duration::from_secs_f64(seconds))),
        _ => Err(format!(
            "the environment variable {INTERVAL_VARIABLE} must be a number of seconds from 0.001 to 1e9, or 0, not \
             \"{}\"",
            escape_controls(text)
        )),
    }
}

/// Prints the status of a command after each interval, in one line.
fn plain_lines(
    command: &'static str,
    status: &Arc<Mutex<Status>>,
    interval: Duration,
    print: impl Fn(&str) + Send + 'static,
) -> PlainLines {
    let status = Arc::clone(status);
    PlainLines::every(interval, move || {
        let text = lock(&status).text(Instant::now());
        print(&format!("{command}: {text}"));
    })
}

/// The progress of one run, in problem time.
pub(super) struct RunProgress {
    work: Work,
    show_from: Instant,
    is_shown: bool,
    whole: f64,
    steps: u32,
}

impl RunProgress {
    /// The progress of a run of `whole` problem seconds that a command makes.
    pub(super) fn new(command: &'static str, whole: f64) -> Self {
        let mut status = Status::new("simulated", "left");
        status.set_amount(Amount::Seconds(0.0, whole), Instant::now());
        let work = Work::new(command, status);
        RunProgress { work, show_from: Instant::now() + DELAY, is_shown: false, whole, steps: 0 }
    }

    /// Reports a solver step that ended at this problem time.
    pub(super) fn step(&mut self, time: f64) {
        self.steps = self.steps.wrapping_add(1);
        if self.steps.is_multiple_of(STEPS_PER_CHECK) {
            self.work.set_amount(Amount::Seconds(time, self.whole));
            if !self.is_shown && Instant::now() >= self.show_from {
                self.is_shown = true;
                self.work.show();
            }
        }
    }
}

/// The progress of countable work, as a bar with the remaining time.
pub(super) struct ProgressBar {
    work: Work,
}

impl ProgressBar {
    /// A bar of a command that counts `what`, in the plural.
    pub(super) fn new(command: &'static str, what: &str) -> Self {
        ProgressBar::of(command, Status::new(what, "left"))
    }

    /// A bar of a command that counts one phase of its work after the other. The remaining time is that of a phase.
    pub(super) fn with_phases(command: &'static str, what: &str) -> Self {
        ProgressBar::of(command, Status::new(what, "left in this phase"))
    }

    /// A bar that is shown at once.
    fn of(command: &'static str, status: Status) -> Self {
        let work = Work::new(command, status);
        work.show();
        ProgressBar { work }
    }

    /// Starts to count something else.
    pub(super) fn switch_to(&self, what: &str) {
        lock(&self.work.status).switch_to(what);
    }

    /// Shows a piece of work that is not counted.
    pub(super) fn busy(&self, what: &str) {
        lock(&self.work.status).begin(what);
        self.work.set_template(TEXT_TEMPLATE);
    }

    /// Sets a result that is known already; empty if there is none.
    pub(super) fn set_note(&self, note: String) {
        lock(&self.work.status).set_note(note);
    }

    /// Reports that `done` of `all` are complete. The first call reports what was complete before, so the remaining
    /// time is extrapolated from later work only.
    pub(super) fn done(&self, done: u64, all: u64) {
        if self.work.set_amount(Amount::Items(done, all)) {
            self.work.set_template(BAR_TEMPLATE);
            self.work.line.set_length(all);
        }
        self.work.line.set_position(done);
    }

    /// Prints a result while the work continues. The status line of a terminal is erased meanwhile.
    pub(super) fn suspend<T>(&self, print: impl FnOnce() -> T) -> T {
        self.work.line.suspend(print)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use indicatif::{InMemoryTerm, TermLike};

    use super::*;

    fn shown(what: impl FnOnce(&ProgressBar)) -> String {
        let terminal = InMemoryTerm::new(2, 120);
        let bar = ProgressBar::new("sweep", "runs");
        let line = &bar.work.line;
        line.disable_steady_tick();
        what(&bar);
        line.set_draw_target(ProgressDrawTarget::term_like(Box::new(terminal.clone())));
        line.tick();
        let text = terminal.contents();
        drop(bar);
        assert_eq!(terminal.contents(), "", "the line is erased");
        assert!(terminal.flush().is_ok());
        text
    }

    #[test]
    fn a_bar_shows_the_count() {
        let text = shown(|bar| [0, 500].into_iter().for_each(|done| bar.done(done, 1000)));
        assert!(text.starts_with("[###############...............] 500 of 1000 runs"), "{text}");
    }

    #[test]
    fn the_subject_of_a_bar_can_change() {
        let switch = |bar: &ProgressBar| {
            bar.done(7, 10);
            bar.switch_to("effects");
            bar.done(0, 4);
            bar.set_note("best so far: leak at I2".to_owned());
        };
        assert!(shown(switch).ends_with("] 0 of 4 effects; best so far: leak at I2"));
        assert_eq!(shown(|bar| bar.busy("fitting the patch")), "fitting the patch");
    }

    #[test]
    fn a_plain_line_has_the_command_and_its_status() {
        let (sender, printed) = mpsc::channel();
        let status = Arc::new(Mutex::new(Status::new("fitting the patch", "left")));
        let lines = plain_lines("gap", &status, Duration::from_millis(1), move |line| {
            let _ = sender.send(line.to_owned());
        });
        let line = printed.recv_timeout(Duration::from_secs(60));
        assert_eq!(line.as_deref(), Ok("gap: fitting the patch"));
        drop(lines);
    }

    #[test]
    fn the_environment_sets_the_interval_of_plain_lines() {
        for text in [None, Some(""), Some(" ")] {
            assert_eq!(line_interval(text), Ok(Some(LINE_INTERVAL)), "{text:?}");
        }
        assert_eq!(line_interval(Some(" 0.5 ")), Ok(Some(Duration::from_millis(500))));
        assert_eq!(line_interval(Some("0.001")), Ok(Some(Duration::from_millis(1))));
        assert_eq!(line_interval(Some("0")), Ok(None));
        for text in ["often", "-1", "NaN", "1e30", "1e-9", "5 s"] {
            let error = line_interval(Some(text)).unwrap_err();
            assert!(error.ends_with(&format!(", not \"{text}\"")), "{error}");
        }
    }

    #[test]
    fn a_result_is_printed_during_the_work() {
        assert_eq!(ProgressBar::new("replay", "figures").suspend(|| 7), 7);
    }
}
