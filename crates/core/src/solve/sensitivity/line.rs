//! The derivative of the voltage in a delay line by a parameter. In addition to the slopes of the input, a line keeps
//! how much jumps of the input shift with the parameter. The output shifts with the delay, too.

use std::collections::VecDeque;

use crate::delay_line::DelayLine;

/// The slopes of the input of a delay line, and the shifts of the instants at which the input jumped.
#[derive(Debug, Clone)]
pub(super) struct Line {
    past: DelayLine,
    /// Slope of the delay, in problem seconds.
    delay: f64,
    /// Instants that shift with the parameter, in problem seconds, each with its shift. The oldest is first.
    shifts: VecDeque<(f64, f64)>,
}

/// Number of shifted instants for which a line allocates memory at its beginning.
const INITIAL_CAPACITY: usize = 256;
/// Slopes that differ by less than this, relative to 1 + their size in volts, have not jumped.
const JUMP_TOLERANCE: f64 = 1e-9;

impl Line {
    /// The slopes for a delay line with a delay of `seconds`. `delay` and `initial` are the slopes of its delay and of
    /// its initial output.
    pub fn new(seconds: f64, delay: f64, initial: f64, step: f64) -> Self {
        let shifts = VecDeque::with_capacity(INITIAL_CAPACITY);
        Line { past: DelayLine::new(seconds, initial, step), delay, shifts }
    }

    /// The same line with memory for a number of jumps per second.
    pub fn with_room_for(self, jumps: f64) -> Self {
        Line { past: self.past.with_room_for(jumps), ..self }
    }

    /// Sets the delay at a time, and the slopes of delay and initial output.
    pub fn set(&mut self, seconds: f64, delay: f64, initial: f64, time: f64) {
        self.past.set(seconds, initial, time);
        self.delay = delay;
    }

    /// Forgets all inputs, for a new initial condition.
    pub fn clear(&mut self) {
        self.past.clear();
        self.shifts.clear();
    }

    /// Puts the slope of the input at a time into the line.
    pub fn put(&mut self, time: f64, slope: f64) {
        self.past.put(time, slope);
    }

    /// Puts the slope at an instant at which the input jumps or has a corner. `shift` is the slope of that instant, in
    /// problem seconds.
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

    /// Puts the slope at the beginning of a step, if it differs from the slope at the end of the step before.
    pub fn begin(&mut self, time: f64, slope: f64) {
        let differs = |(_, last): (f64, f64)| (last - slope).abs() > JUMP_TOLERANCE * (1.0 + slope.abs());
        if self.past.last().is_some_and(differs) {
            self.put_break(time, slope, 0.0);
        }
    }

    /// The slope of the output just after a time that itself shifts by `shift`. `input` is the delay line of the
    /// solver.
    pub fn from(&self, time: f64, input: &DelayLine, shift: f64) -> f64 {
        let moves = shift - self.delay;
        let along = if moves == 0.0 { 0.0 } else { input.slope_from(time) * moves };
        self.past.from(time) + along
    }

    /// The slope of the output just before a fixed time. `input` is the delay line of the solver.
    pub fn until(&self, time: f64, input: &DelayLine) -> f64 {
        let along = if self.delay == 0.0 { 0.0 } else { input.slope_until(time) * self.delay };
        self.past.until(time) - along
    }

    /// The shift of the jump that the line puts out at a time: that of the input and that of the delay.
    pub fn shift_of_echo(&self, time: f64) -> f64 {
        let is_it =
            |(begin, _): &&(f64, f64)| (begin + self.past.delay() - time).abs() <= 2.0 * self.past.near();
        self.delay + self.shifts.iter().find(is_it).map_or(0.0, |(_, shift)| *shift)
    }
}
