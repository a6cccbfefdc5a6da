//! Traces against time, one screen each, and the trigger that begins them.

use std::mem;

use super::envelope::Envelope;
use super::{CHANNELS, COLUMNS, Sample, Trigger, TriggerMode};

/// Share of a screen by which a time may miss an edge because of rounding.
const EDGE: f64 = 1e-9;

/// The present trace and, until a frame has it, the one before.
///
/// A trace of which no frame has the end is kept until the next frame. So the last frame of a generation has its
/// complete trace, unless several traces end between two frames.
#[derive(Debug, Clone)]
pub(super) struct Traces {
    /// The present trace, or the last one while the scope waits.
    current: Trace,
    /// The trace before, if `has_finished`.
    finished: Trace,
    /// Whether the next frame shows `finished`.
    has_finished: bool,
    /// Whether the present trace continues.
    state: State,
    /// Whether the present trace began in the present run.
    is_in_run: bool,
}

/// A trace.
#[derive(Debug, Clone)]
struct Trace {
    /// A number that grows from trace to trace.
    generation: u32,
    /// Its columns.
    columns: Envelope,
    /// Whether a frame has the trace as it is.
    is_sent: bool,
}

/// Whether the present trace continues.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// The next trigger begins a trace.
    Waiting,
    /// The present trace continues.
    Running,
    /// A single trace is complete. Only `erase` permits another one.
    Done,
}

/// When traces begin, and how long they are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Timing<'a> {
    /// The trigger.
    pub(super) trigger: &'a Trigger,
    /// Length of a screen in seconds.
    pub(super) screen: f64,
}

impl Timing<'_> {
    /// Length of a column in seconds.
    fn column(&self) -> f64 {
        self.screen / COLUMNS as f64
    }

    /// The state after a trace.
    fn after_trace(&self) -> State {
        if self.trigger.mode == TriggerMode::SingleShot { State::Done } else { State::Waiting }
    }

    /// The time at which the trigger begins a trace on the line between two samples, if it does. The part of the line
    /// before `start` belongs to an earlier trace.
    fn begin(&self, from: &Sample, to: &Sample, start: f64) -> Option<f64> {
        match self.trigger.mode {
            TriggerMode::Run => Some(self.screen_edge(start, to.time)),
            TriggerMode::Level | TriggerMode::SingleShot => self.crossing(from, to, start),
        }
    }

    /// The left edge of the last screen that the time between two instants reaches. Screens follow each other from time
    /// 0. An instant at an edge belongs to the screen before.
    fn screen_edge(&self, start: f64, end: f64) -> f64 {
        let [first, last] = [start, end].map(|time| time / self.screen);
        let number = ((last - EDGE).ceil() - 1.0).max((first + EDGE).floor());
        number.max(0.0) * self.screen
    }

    /// The time at which the line between two samples passes the level in the direction of the trigger, if it does so
    /// after `start`.
    fn crossing(&self, from: &Sample, to: &Sample, start: f64) -> Option<f64> {
        let volts = |sample: &Sample| sample.volts[self.trigger.channel] - self.trigger.level;
        let sign = if self.trigger.rising { 1.0 } else { -1.0 };
        let (before, after) = (sign * volts(from), sign * volts(to));
        // The comparisons are false if the channel is free.
        let passes = before < 0.0 && after >= 0.0;
        let time = from.time + (to.time - from.time) * (before / (before - after));
        (passes && time >= start).then_some(time.min(to.time))
    }
}

impl Trace {
    /// A trace without columns that begins at time 0.
    fn new(column: f64) -> Self {
        Trace { generation: 0, columns: Envelope::new(COLUMNS, 0.0, column), is_sent: true }
    }

    /// Begins a trace of the next generation in the place of this one.
    fn restart(&mut self, generation: u32, left: f64, column: f64) {
        self.generation = generation;
        self.columns.reset(left, column);
        self.is_sent = false;
    }
}

impl Traces {
    /// An empty screen.
    pub(super) fn new(timing: Timing) -> Self {
        let trace = Trace::new(timing.column());
        Traces {
            current: trace.clone(),
            finished: trace,
            has_finished: false,
            state: State::Waiting,
            is_in_run: false,
        }
    }

    /// The generation of the present trace.
    pub(super) fn generation(&self) -> u32 {
        self.current.generation
    }

    /// Gives the present trace this generation, because the screen showed something else before.
    pub(super) fn set_generation(&mut self, generation: u32) {
        self.current.generation = generation;
        self.has_finished = false;
    }

    /// Ends the present trace, because a run begins.
    pub(super) fn begin_run(&mut self, timing: Timing) {
        if self.state == State::Running {
            self.state = timing.after_trace();
        }
        self.is_in_run = false;
    }

    /// Waits for the trigger.
    pub(super) fn wait(&mut self) {
        self.state = State::Waiting;
    }

    /// Adds the straight line between two samples of the run.
    pub(super) fn add_line(&mut self, from: &Sample, to: &Sample, timing: Timing) {
        let mut start = from.time;
        if self.state == State::Running {
            self.current.columns.add_line(from, to);
            self.current.is_sent = false;
            if !self.current.columns.is_past(to.time) {
                return;
            }
            self.state = timing.after_trace();
            start = self.current.columns.right();
        }
        if self.state != State::Waiting {
            return;
        }
        if let Some(left) = timing.begin(from, to, start) {
            self.begin(left, timing);
            self.current.columns.add_line(from, to);
            if self.current.columns.is_past(to.time) {
                self.state = timing.after_trace();
            }
        }
    }

    /// Begins a trace.
    fn begin(&mut self, left: f64, timing: Timing) {
        let generation = self.current.generation.wrapping_add(1);
        if !self.current.is_sent && self.current.columns.reached() > 0 {
            mem::swap(&mut self.current, &mut self.finished);
            self.has_finished = true;
        }
        self.current.restart(generation, left, timing.column());
        self.state = State::Running;
        self.is_in_run = true;
    }

    /// Empties the screen. If the trigger is the run, the present trace continues.
    pub(super) fn erase(&mut self, timing: Timing) {
        self.replace(self.current.columns.left(), self.current.columns.width());
        if timing.trigger.mode != TriggerMode::Run {
            self.state = State::Waiting;
        }
    }

    /// Empties the trace of a channel.
    pub(super) fn clear_channel(&mut self, channel: usize) {
        self.current.columns.clear_channel(channel);
        self.set_generation(self.current.generation.wrapping_add(1));
        self.current.is_sent = false;
    }

    /// Replaces the present trace and the one before by an empty one.
    fn replace(&mut self, left: f64, column: f64) {
        self.current.restart(self.current.generation.wrapping_add(1), left, column);
        self.has_finished = false;
    }

    /// Draws the screen again, from the memory of a run up to the time `end`. If the trigger is the run, the screen
    /// before is drawn, too.
    pub(super) fn redraw(&mut self, memory: &Envelope, end: Option<f64>, timing: Timing) {
        let is_run = timing.trigger.mode == TriggerMode::Run;
        let left = if is_run {
            end.map(|end| timing.screen_edge(0.0, end))
        } else {
            self.is_in_run.then_some(self.current.columns.left())
        };
        let (Some(left), Some(end)) = (left, end) else {
            self.replace(0.0, timing.column());
            self.state = State::Waiting;
            return;
        };
        self.replace(left, timing.column());
        if is_run && left > 0.0 {
            self.current.columns.reset(left - timing.screen, timing.column());
            self.current.columns.add_envelope(memory, left);
            self.begin(left, timing);
        }
        self.current.columns.add_envelope(memory, end);
        self.state = if self.current.columns.is_past(end) { timing.after_trace() } else { State::Running };
        self.is_in_run = true;
    }

    /// Shows the screen with a time of a run that ends at the time `end`. Only with the run as trigger are the screens one
    /// after the other.
    pub(super) fn show(&mut self, memory: &Envelope, time: f64, end: f64, timing: Timing) {
        let columns = &self.current.columns;
        let is_shown = time >= columns.left() && !columns.is_past(time);
        if is_shown || !self.is_in_run || timing.trigger.mode != TriggerMode::Run {
            return;
        }
        let right = timing.screen_edge(0.0, time) + timing.screen;
        self.redraw(memory, Some(end.min(right)), timing);
        // The screen before would be visible for one frame only.
        self.has_finished = false;
    }

    /// Removes what is after a time, because the run continues from there.
    pub(super) fn cut(&mut self, memory: &Envelope, time: f64, timing: Timing) {
        if !self.is_in_run {
            return;
        }
        if time < self.current.columns.left() {
            self.is_in_run = false;
            self.redraw(memory, Some(time), timing);
        } else if !self.current.columns.is_past(time) {
            self.current.columns.cut(time);
            self.current.is_sent = false;
            self.state = State::Running;
        }
    }

    /// Appends the trace of the next frame. The bits of `channels` are the channels in use.
    pub(super) fn encode(&mut self, channels: u32, out: &mut Vec<u8>) {
        let has_finished = mem::take(&mut self.has_finished);
        let trace = if has_finished { &mut self.finished } else { &mut self.current };
        trace.is_sent = true;
        let columns = &trace.columns;
        out.extend_from_slice(&trace.generation.to_le_bytes());
        out.extend_from_slice(&channels.count_ones().to_le_bytes());
        out.extend_from_slice(&columns.left().to_le_bytes());
        out.extend_from_slice(&columns.width().to_le_bytes());
        out.extend_from_slice(&(columns.reached() as u32).to_le_bytes());
        out.extend_from_slice(&channels.to_le_bytes());
        for channel in (0..CHANNELS).filter(|channel| (channels >> channel) & 1 == 1) {
            for [low, high] in columns.extremes(channel) {
                let pair = if low <= high { [*low, *high] } else { [f64::NAN; 2] };
                pair.iter().for_each(|volts| out.extend_from_slice(&(*volts as f32).to_le_bytes()));
            }
        }
    }
}

#[cfg(test)]
mod tests;
