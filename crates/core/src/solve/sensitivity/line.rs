//! The derivative of what goes through a delay line.

use std::collections::VecDeque;

use crate::delay_line::DelayLine;

/// The derivatives of what went into a delay line, and of the instants at which that jumped.
#[derive(Debug, Clone)]
pub(super) struct Line {
    past: DelayLine,
    /// d(delay), in problem seconds.
    delay: f64,
    /// Instants whose place depends on the parameter, and how much.
    shifts: VecDeque<(f64, f64)>,
}

/// Shifted instants that a line has room for from the start.
const ROOM: usize = 256;
/// Slopes, in volts for a whole parameter, that differ by less than this share have not jumped.
const ROUNDING: f64 = 1e-9;

impl Line {
    /// The line beside another of this delay: its own delay and initial output have these slopes.
    pub fn new(seconds: f64, delay: f64, initial: f64, step: f64) -> Self {
        Line { past: DelayLine::new(seconds, initial, step), delay, shifts: VecDeque::with_capacity(ROOM) }
    }

    /// The same with room for so many jumps in a second.
    pub fn with_room_for(self, jumps: f64) -> Self {
        Line { past: self.past.with_room_for(jumps), ..self }
    }

    /// The delay as it is set at a time, and the slopes of delay and initial output.
    pub fn set(&mut self, seconds: f64, delay: f64, initial: f64, time: f64) {
        self.past.set(seconds, initial, time);
        self.delay = delay;
    }

    pub fn clear(&mut self) {
        self.past.clear();
        self.shifts.clear();
    }

    pub fn put(&mut self, time: f64, slope: f64) {
        self.past.put(time, slope);
    }

    /// Takes in the slope at an instant at which what goes in jumps or has a corner. `shift` tells how that instant
    /// moves with the parameter.
    pub fn put_break(&mut self, time: f64, slope: f64, shift: f64) {
        self.past.echo_by(time);
        self.past.put_break(time, slope, 0);
        while self.shifts.front().is_some_and(|first| first.0 < time - 2.0 * self.past.delay()) {
            self.shifts.pop_front();
        }
        if shift != 0.0 {
            self.shifts.push_back((time, shift));
        }
    }

    /// Takes in the slope at the beginning of a stretch, where it differs from that at the end of the last.
    pub fn begin(&mut self, time: f64, slope: f64) {
        let differs = |(_, last): (f64, f64)| (last - slope).abs() > ROUNDING * (1.0 + slope.abs());
        if self.past.last().is_some_and(differs) {
            self.put_break(time, slope, 0.0);
        }
    }

    /// The slope of what comes out from a time on that itself moves by `frame`; what went in is given beside it.
    pub fn from(&self, time: f64, input: &DelayLine, frame: f64) -> f64 {
        let moves = frame - self.delay;
        let along = if moves == 0.0 { 0.0 } else { input.slope_from(time) * moves };
        self.past.from(time) + along
    }

    /// The same up to a time that stays where it is.
    pub fn until(&self, time: f64, input: &DelayLine) -> f64 {
        let along = if self.delay == 0.0 { 0.0 } else { input.slope_until(time) * self.delay };
        self.past.until(time) - along
    }

    /// How the instant moves that comes out at a time.
    pub fn shift_of_echo(&self, time: f64) -> f64 {
        let is_it =
            |(begin, _): &&(f64, f64)| (begin + self.past.delay() - time).abs() <= 2.0 * self.past.near();
        self.delay + self.shifts.iter().find(is_it).map_or(0.0, |(_, shift)| *shift)
    }
}
