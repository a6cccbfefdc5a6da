//! The past of a delayed node.
//!
//! A piece of the past is a step with five equally spaced values. Between them, the value follows the polynomial
//! through all five. Jumps and corners of the past are at the ends of pieces.

use std::collections::VecDeque;

use super::quartic::{Values, quartic};

/// The past of the input of a delay line. Times are problem times in seconds.
#[derive(Debug)]
pub(super) struct History {
    /// The delay.
    delay: f64,
    /// The output until the first input arrives.
    initial: f64,
    /// Whether the first input has arrived.
    has_arrived: bool,
    /// The steps of the past, from the earliest that a later output needs.
    pieces: VecDeque<Piece>,
}

/// A step of the past.
#[derive(Debug)]
struct Piece {
    /// The beginning of the step.
    begin: f64,
    /// The end of the step.
    end: f64,
    /// The input at equal distances.
    values: Values,
}

impl History {
    /// The past of an input before the run.
    pub(super) fn new(delay: f64, initial: f64) -> Self {
        History { delay, initial, has_arrived: false, pieces: VecDeque::new() }
    }

    /// The output at a time, at most the delay after the last recorded step.
    pub(super) fn value(&self, time: f64) -> f64 {
        let at = time - self.delay;
        let after = self.pieces.partition_point(|piece| piece.end < at);
        // Rounding may put the time just after the last piece.
        match self.pieces.get(after).or(self.pieces.back()) {
            Some(piece) if self.has_arrived => {
                let share = (at - piece.begin) / (piece.end - piece.begin);
                quartic(&piece.values, share.clamp(0.0, 1.0))
            }
            _ => self.initial,
        }
    }

    /// Records the input over a step, and drops the pieces that no later output needs.
    pub(super) fn record(&mut self, begin: f64, end: f64, values: Values) {
        self.pieces.push_back(Piece { begin, end, values });
        while self.pieces.front().is_some_and(|piece| piece.end < end - self.delay) {
            self.pieces.pop_front();
        }
    }

    /// The time at which the first input arrives; infinity after that.
    pub(super) fn arrival(&self) -> f64 {
        if self.has_arrived { f64::INFINITY } else { self.delay }
    }

    /// Lets the first input arrive if it is due at a time.
    pub(super) fn arrive(&mut self, time: f64) {
        self.has_arrived |= self.delay <= time;
    }
}
