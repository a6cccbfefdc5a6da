//! The progress of long work, as a status line on a terminal. It is erased when the work ends.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar as Line, ProgressDrawTarget, ProgressFinish, ProgressStyle};

/// A run that takes less time shows no status line.
const DELAY: Duration = Duration::from_secs(2);
/// The time between two updates of the status line.
const UPDATE_INTERVAL: Duration = Duration::from_millis(250);
/// The number of solver steps between two readings of the clock, which are slow compared with a step.
const STEPS_PER_CHECK: u32 = 256;
/// The status line of countable work.
const BAR_TEMPLATE: &str = "[{bar:30}] {pos} of {len} {msg}, {eta} left";
/// The status line of other work.
const TEXT_TEMPLATE: &str = "{msg}";

/// A status line that is not shown yet.
fn hidden_line() -> Line {
    Line::with_draw_target(None, ProgressDrawTarget::hidden()).with_finish(ProgressFinish::AndClear)
}

/// Shows a status line on standard error if that is a terminal.
fn show(line: &Line) {
    line.set_draw_target(ProgressDrawTarget::stderr());
    line.enable_steady_tick(UPDATE_INTERVAL);
}

fn set_template(line: &Line, template: &str) {
    // Only an invalid template fails. The templates are constants, and tests use them.
    if let Ok(style) = ProgressStyle::with_template(template) {
        line.set_style(style.progress_chars("#."));
    }
}

/// The progress of one run, in problem time.
pub(super) struct RunProgress {
    line: Line,
    show_from: Instant,
    is_shown: bool,
    whole: f64,
    steps: u32,
}

impl RunProgress {
    /// The progress of a run of `whole` problem seconds.
    pub(super) fn new(whole: f64) -> Self {
        let line = hidden_line();
        set_template(&line, TEXT_TEMPLATE);
        RunProgress { line, show_from: Instant::now() + DELAY, is_shown: false, whole, steps: 0 }
    }

    /// Reports a solver step that ended at this problem time.
    pub(super) fn step(&mut self, time: f64) {
        self.steps = self.steps.wrapping_add(1);
        if self.steps.is_multiple_of(STEPS_PER_CHECK) && Instant::now() >= self.show_from {
            if !self.is_shown {
                self.is_shown = true;
                show(&self.line);
            }
            self.line.set_message(format!("t = {time:.4} of {} s", self.whole));
        }
    }
}

/// The progress of countable work, as a bar with the remaining time.
pub(super) struct ProgressBar {
    line: Line,
    has_begun: bool,
}

impl ProgressBar {
    /// A bar that counts `what`, in the plural.
    pub(super) fn new(what: &str) -> Self {
        let line = hidden_line().with_message(what.to_owned());
        show(&line);
        ProgressBar { line, has_begun: false }
    }

    /// Starts to count something else.
    pub(super) fn switch_to(&mut self, what: &str) {
        if self.line.message() != what {
            self.line.set_message(what.to_owned());
            self.has_begun = false;
        }
    }

    /// Shows a piece of work that is not counted.
    pub(super) fn busy(&mut self, what: &str) {
        set_template(&self.line, TEXT_TEMPLATE);
        self.line.set_message(what.to_owned());
        self.has_begun = false;
    }

    /// Reports that `done` of `all` are complete. The first call reports what was complete before, so the remaining
    /// time is extrapolated from later work only.
    pub(super) fn done(&mut self, done: u64, all: u64) {
        self.line.set_position(done);
        if !self.has_begun {
            self.has_begun = true;
            set_template(&self.line, BAR_TEMPLATE);
            self.line.set_length(all);
            self.line.reset_eta();
        }
    }
}

#[cfg(test)]
mod tests {
    use indicatif::{InMemoryTerm, TermLike};

    use super::*;

    fn shown(what: impl FnOnce(&mut ProgressBar)) -> String {
        let terminal = InMemoryTerm::new(2, 120);
        let mut bar = ProgressBar::new("runs");
        bar.line.disable_steady_tick();
        what(&mut bar);
        bar.line.set_draw_target(ProgressDrawTarget::term_like(Box::new(terminal.clone())));
        bar.line.tick();
        let text = terminal.contents();
        drop(bar);
        assert_eq!(terminal.contents(), "", "the line is erased");
        assert!(terminal.flush().is_ok());
        text
    }

    #[test]
    fn a_bar_shows_the_count_and_the_remaining_time() {
        let text = shown(|bar| [0, 500].into_iter().for_each(|done| bar.done(done, 1000)));
        assert!(text.starts_with("[###############...............] 500 of 1000 runs, "), "{text}");
        assert!(text.ends_with(" left"), "{text}");
    }

    #[test]
    fn the_subject_of_a_bar_can_change() {
        let switch = |bar: &mut ProgressBar| {
            bar.done(7, 10);
            bar.switch_to("effects");
            bar.done(0, 4);
        };
        assert!(shown(switch).contains("] 0 of 4 effects, "));
        assert_eq!(shown(|bar| bar.busy("fitting the patch")), "fitting the patch");
    }
}
