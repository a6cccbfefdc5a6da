//! The derivative of the voltage in a delay line by a parameter.
//!
//! The slopes of the input are stored in a second delay line. If the delay depends on the parameter, the slope of the
//! output has a further term: the slope of the voltage in time multiplied by the shift. In addition, the instants at
//! which the input jumped are stored with their shifts, because a jump that shifts arrives at a shifted instant.

use std::collections::VecDeque;

use crate::delay_line::DelayLine;

/// The slopes of the input of a delay line, and the shifts of the instants at which the input jumped.
#[derive(Debug, Clone)]
pub(super) struct DelayedSlopes {
    /// The slopes of the input in the past, in volts.
    past: DelayLine,
    /// Slope of the delay, in problem seconds.
    delay_slope: f64,
    /// Instants of the input that shift with the parameter, each with its shift, both in problem seconds. The oldest is
    /// first.
    shifts: VecDeque<(f64, f64)>,
}

/// Number of shifted instants for which a new line allocates memory.
const INITIAL_CAPACITY: usize = 256;
/// Relative difference of two slopes above which the slope jumps. The difference is divided by 1 V plus the slope.
const JUMP_TOLERANCE: f64 = 1e-9;

impl DelayedSlopes {
    /// Empty slopes for a line with this delay, in problem seconds, at this step length. `delay_slope` and
    /// `initial_slope` are the slopes of the delay and of the initial output.
    pub(super) fn new(delay: f64, delay_slope: f64, initial_slope: f64, step: f64) -> Self {
        let shifts = VecDeque::with_capacity(INITIAL_CAPACITY);
        DelayedSlopes { past: DelayLine::new(delay, initial_slope, step), delay_slope, shifts }
    }

    /// The same line with memory for this number of jumps per problem second.
    pub(super) fn with_capacity_for(self, jumps: f64) -> Self {
        DelayedSlopes { past: self.past.with_capacity_for(jumps), ..self }
    }

    /// Sets the delay at a problem time, and the slopes of the delay and of the initial output.
    pub(super) fn set(&mut self, delay: f64, delay_slope: f64, initial_slope: f64, time: f64) {
        self.past.set(delay, initial_slope, time);
        self.delay_slope = delay_slope;
    }

    /// Forgets all inputs, for a new initial condition.
    pub(super) fn clear(&mut self) {
        self.past.clear();
        self.shifts.clear();
    }

    /// Stores the slope of the input at a problem time.
    pub(super) fn put(&mut self, time: f64, slope: f64) {
        self.past.put(time, slope);
    }

    /// Stores the slope at an instant at which the input jumps or has a corner. `shift` is the slope of that instant,
    /// in problem seconds. Shifts older than twice the delay are dropped.
    pub(super) fn put_discontinuity(&mut self, time: f64, slope: f64, shift: f64) {
        self.past.take_arrivals(time);
        self.past.put_discontinuity(time, slope, 0);
        while self.shifts.front().is_some_and(|first| first.0 < time - 2.0 * self.past.delay()) {
            self.shifts.pop_front();
        }
        if shift != 0.0 {
            self.shifts.push_back((time, shift));
        }
    }

    /// Stores the slope at the beginning of a step, if it differs from the slope at the end of the step before.
    pub(super) fn begin_step(&mut self, time: f64, slope: f64) {
        let differs = |(_, last): (f64, f64)| (last - slope).abs() > JUMP_TOLERANCE * (1.0 + slope.abs());
        if self.past.last().is_some_and(differs) {
            self.put_discontinuity(time, slope, 0.0);
        }
    }

    /// The slope of the output just after a problem time that itself shifts by `shift`. `input` is the delay line of
    /// the solver.
    pub(super) fn right_limit(&self, time: f64, input: &DelayLine, shift: f64) -> f64 {
        let input_shift = shift - self.delay_slope;
        let by_motion = if input_shift == 0.0 { 0.0 } else { input.right_slope(time) * input_shift };
        self.past.right_limit(time) + by_motion
    }

    /// The slope of the output just before a fixed problem time. `input` is the delay line of the solver.
    pub(super) fn left_limit(&self, time: f64, input: &DelayLine) -> f64 {
        let by_motion = if self.delay_slope == 0.0 { 0.0 } else { input.left_slope(time) * self.delay_slope };
        self.past.left_limit(time) - by_motion
    }

    /// The shift of the jump that arrives at the output at a problem time, in problem seconds: the sum of the shift of
    /// the input and that of the delay.
    pub(super) fn arrival_shift(&self, time: f64) -> f64 {
        let arrives_now = |(begin, _): &&(f64, f64)| {
            (begin + self.past.delay() - time).abs() <= 2.0 * self.past.time_tolerance()
        };
        self.delay_slope + self.shifts.iter().find(arrives_now).map_or(0.0, |(_, shift)| *shift)
    }
}
