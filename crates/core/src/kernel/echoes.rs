//! Delay lines: every lane keeps the past of its own. A step is gone in pieces, none of which reaches across the echo of a
//! corner; where these end differs from lane to lane.

use super::Kernel;
use super::frame::Frame;
use super::lane::Lane;
use super::span::Span;
use crate::delay_line::{self, DelayLine};

impl Kernel {
    /// Whether it has delay lines.
    #[inline(always)]
    pub(super) fn has_lines(&self) -> bool {
        !self.stored.is_empty()
    }

    /// The next piece of a step that ends at a time.
    #[inline(always)]
    pub(super) fn piece<V: Lane>(&self, frame: &Frame<V>, end: f64) -> Span<V> {
        if self.has_lines() {
            return Span::between(frame.time, next_ends(frame, end));
        }
        let begin = frame.time.get(0);
        Span::same(begin, end - begin, end)
    }

    /// When the next piece of a step ends that itself ends at a time.
    pub fn end_of_piece(&self, frame: &Frame<f64>, end: f64) -> f64 {
        next_ends(frame, end)
    }

    /// Takes in what goes into the delay lines at a time.
    pub fn put_stored(&self, frame: &mut Frame<f64>, time: f64) {
        for (line, slot) in frame.lines[0].iter_mut().zip(&self.stored) {
            line.put(time, frame.slots[*slot as usize]);
        }
    }

    /// Takes note in the delay lines that the frame is on a corner: its echo will be one.
    pub fn remember_corner(&self, frame: &mut Frame<f64>) {
        for (line, slot) in frame.lines[0].iter_mut().zip(&self.stored) {
            line.put_break(frame.time, frame.slots[*slot as usize], 0);
        }
    }

    /// Puts into the slots of the lanes aboard what their delay lines give at a time.
    #[inline(always)]
    pub(super) fn put_delayed<V: Lane>(
        &self,
        frame: &mut Frame<V>,
        time: V,
        output: fn(&mut DelayLine, f64) -> f64,
    ) {
        if self.has_lines() {
            put(frame, self.layout.delayed, time, output);
        }
    }

    /// Takes in what goes into the delay lines of the lanes that move, at the end of a stretch, and hears what comes out of
    /// them there.
    #[inline(always)]
    pub(super) fn store<V: Lane>(&self, frame: &mut Frame<V>, span: &Span<V>) {
        if self.has_lines() {
            store(self, frame, span);
        }
    }
}

// Apart from those who ask, in which everything else is whole vectors.
#[inline(never)]
fn next_ends<V: Lane>(frame: &Frame<V>, end: f64) -> V {
    let mut ends = V::splat(end);
    for (lane, lines) in aboard(frame.aboard, frame.lines.iter()) {
        let echo = lines.iter().filter_map(|line| line.echo_before(end)).fold(end, f64::min);
        ends.set(lane, echo);
    }
    ends
}

#[inline(never)]
fn put<V: Lane>(frame: &mut Frame<V>, first: usize, time: V, output: fn(&mut DelayLine, f64) -> f64) {
    let Frame { slots, lines, aboard: bits, .. } = frame;
    for (lane, lines) in aboard(*bits, lines.iter_mut()) {
        let time = time.get(lane);
        for (slot, line) in slots[first..].iter_mut().zip(lines) {
            slot.set(lane, output(line, time));
        }
    }
}

#[inline(never)]
fn store<V: Lane>(kernel: &Kernel, frame: &mut Frame<V>, span: &Span<V>) {
    let Frame { slots, lines, schedules, aboard: bits, .. } = frame;
    for (lane, lines) in aboard(*bits & span.moving(), lines.iter_mut()) {
        let time = span.end.get(lane);
        let volts = kernel.stored.iter().map(|slot| slots[*slot as usize].get(lane));
        let near = lines[0].near();
        let is_at_corner = schedules.iter().any(|schedule| schedule.ends_by(time + near));
        delay_line::arrive(lines, time, volts, is_at_corner);
    }
}

/// The lanes of which a bit is set, with what they have.
fn aboard<T>(bits: u64, all: impl Iterator<Item = T>) -> impl Iterator<Item = (usize, T)> {
    all.enumerate().filter(move |(lane, _)| bits >> lane & 1 == 1)
}
