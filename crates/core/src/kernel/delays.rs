//! Delay lines in a kernel.
//!
//! Every lane has its own delay lines. If a discontinuity comes out within a step, the step is cut into pieces that
//! end there. Where the pieces end can differ from lane to lane.
//!
//! The outputs of the delay lines are inputs of the kernel, set before each evaluation. Their inputs are stored at the
//! end of every piece. Kernels with delay lines have no native code.

use super::Kernel;
use super::frame::Frame;
use super::lane::Lane;
use super::span::Span;
use crate::delay_line::{self, DelayLine};

impl Kernel {
    /// Whether the kernel has delay lines.
    #[inline(always)]
    pub(super) fn has_delay_lines(&self) -> bool {
        !self.delay_inputs.is_empty()
    }

    /// The span of the next piece of a step that ends at `end`.
    #[inline(always)]
    pub(super) fn next_piece<V: Lane>(&self, frame: &Frame<V>, end: f64) -> Span<V> {
        if self.has_delay_lines() {
            return Span::between(frame.time, next_ends(frame, end));
        }
        let begin = frame.time.get(0);
        Span::same(begin, end - begin, end)
    }

    /// The end of the next piece of a step that ends at `end`, in problem seconds.
    pub(crate) fn end_of_piece(&self, frame: &Frame<f64>, end: f64) -> f64 {
        next_ends(frame, end)
    }

    /// Stores the inputs of the delay lines at a time, in problem seconds.
    pub(crate) fn put_delay_inputs(&self, frame: &mut Frame<f64>, time: f64) {
        for (line, slot) in frame.lines[0].iter_mut().zip(&self.delay_inputs) {
            line.put(time, frame.slots[*slot as usize]);
        }
    }

    /// Marks the present as a discontinuity in the inputs of all delay lines.
    pub(crate) fn mark_discontinuity(&self, frame: &mut Frame<f64>) {
        for (line, slot) in frame.lines[0].iter_mut().zip(&self.delay_inputs) {
            line.put_discontinuity(frame.time, frame.slots[*slot as usize], 0);
        }
    }

    /// Writes the outputs of the delay lines into the slots of the active lanes. `output` reads a line at a time,
    /// either just before or just after a discontinuity.
    #[inline(always)]
    pub(super) fn set_delayed<V: Lane>(
        &self,
        frame: &mut Frame<V>,
        time: V,
        output: fn(&mut DelayLine, f64) -> f64,
    ) {
        if self.has_delay_lines() {
            put(frame, self.layout.delayed, time, output);
        }
    }

    /// Stores the inputs of the delay lines in the lanes that are not idle, at the end of a span. Discontinuities that
    /// come out there are passed on.
    #[inline(always)]
    pub(super) fn record_delay_inputs<V: Lane>(&self, frame: &mut Frame<V>, span: &Span<V>) {
        if self.has_delay_lines() {
            record_delay_inputs(self, frame, span);
        }
    }
}

/// For every active lane, the next time before `end` at which a discontinuity comes out of a line; otherwise `end`.
///
/// This and the next functions are not inlined, so that the callers consist of whole vectors.
#[inline(never)]
fn next_ends<V: Lane>(frame: &Frame<V>, end: f64) -> V {
    let mut ends = V::splat(end);
    for (lane, lines) in active(frame.active_lanes, frame.lines.iter()) {
        let next = lines.iter().filter_map(|line| line.next_arrival_before(end)).fold(end, f64::min);
        ends.set(lane, next);
    }
    ends
}

/// Writes the outputs of the lines of every active lane into the slots from `first` on.
#[inline(never)]
fn put<V: Lane>(frame: &mut Frame<V>, first: usize, time: V, output: fn(&mut DelayLine, f64) -> f64) {
    let Frame { slots, lines, active_lanes: bits, .. } = frame;
    for (lane, lines) in active(*bits, lines.iter_mut()) {
        let time = time.get(lane);
        for (slot, line) in slots[first..].iter_mut().zip(lines) {
            slot.set(lane, output(line, time));
        }
    }
}

/// Stores the inputs of the lines of every lane that moves, with a mark if a table of time has a corner there.
#[inline(never)]
fn record_delay_inputs<V: Lane>(kernel: &Kernel, frame: &mut Frame<V>, span: &Span<V>) {
    let Frame { slots, lines, schedules, active_lanes: bits, .. } = frame;
    for (lane, lines) in active(*bits & span.moving(), lines.iter_mut()) {
        let time = span.end.get(lane);
        let volts = kernel.delay_inputs.iter().map(|slot| slots[*slot as usize].get(lane));
        let tolerance = lines[0].time_tolerance();
        let is_at_corner = schedules.iter().any(|schedule| schedule.has_ended_by(time + tolerance));
        delay_line::record_inputs(lines, time, volts, is_at_corner);
    }
}

/// The lanes whose bit is set, with their items.
fn active<T>(bits: u64, all: impl Iterator<Item = T>) -> impl Iterator<Item = (usize, T)> {
    all.enumerate().filter(move |(lane, _)| bits >> lane & 1 == 1)
}
