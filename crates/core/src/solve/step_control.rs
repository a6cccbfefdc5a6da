//! Control of the step size by the estimated error.
//!
//! A tried step is accepted if its error is at most the tolerance times its length, so that the errors of one second
//! add up to no more than the tolerance. The next step follows from the error of this one. Steps are also limited by
//! the angles of sines and cosines, which must not advance by a large part of a period.

use super::buffers::StepBuffers;
use super::error::RunError;
use super::runge_kutta::largest_error;
use super::state::{Setup, Solver, SolverState};
use crate::delay_line::DelayLine;
use crate::ir::Program;
use crate::machines::REFERENCE;
use crate::trace::Work;

/// The length of the next step.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepControl {
    /// The error allowed in any state, in machine units of 100 V per problem second.
    tolerance: f64,
    /// Length of the next step by the error, in problem seconds.
    next: f64,
    /// Largest length of the next step by the angles, in problem seconds.
    reach: f64,
}

/// The next step is this share of the length that would meet the tolerance exactly.
const CAUTION: f64 = 0.9;
/// A step is at most this many times shorter or longer than the last.
const MAX_CHANGE: f64 = 5.0;
/// No step advances an angle by more than this share of a period. Four voltages per step then show where a sine turns.
const MAX_TURN: f64 = 0.125;
/// No step is shorter than this share of the first step tried.
const LEAST_STEP: f64 = 1e-8;

impl StepControl {
    /// The control before the first step. `tolerance` is in machine units per problem second, `first` in problem
    /// seconds.
    pub fn new(tolerance: f64, first: f64) -> Self {
        StepControl { tolerance, next: first, reach: f64::INFINITY }
    }

    /// Resets the control to the first step.
    pub fn reset(&mut self, first: f64) {
        *self = StepControl::new(self.tolerance, first);
    }

    /// The error allowed over a time in problem seconds, in volts.
    pub fn allowed_error(&self, time: f64) -> f64 {
        self.tolerance * time * REFERENCE
    }

    /// Length of the next step in problem seconds. It is at most the shortest delay: the output of a delay line must be
    /// known before the step.
    pub fn next_step(&self, delay_lines: &[DelayLine]) -> f64 {
        let delays = delay_lines.iter().map(DelayLine::delay);
        delays.fold(self.next.min(self.reach), f64::min)
    }

    /// Whether a step of this length and error is accepted; updates the length of the next step. A step that was cut
    /// short for another reason does not shorten the next one.
    fn accepts(&mut self, length: f64, error: f64, order: f64) -> bool {
        let excess = error / (self.tolerance * length);
        let change = CAUTION * excess.powf(-1.0 / order);
        let fitting = length
            * if change.is_nan() { 1.0 / MAX_CHANGE } else { change.clamp(1.0 / MAX_CHANGE, MAX_CHANGE) };
        let was_cut = length < self.next * CAUTION;
        self.next = if was_cut && change >= MAX_CHANGE { self.next.max(fitting) } else { fitting };
        excess <= 1.0
    }

    /// Checks the angles over the tried step, and returns a shorter step to try if one advanced too far.
    ///
    /// # Errors
    /// If the shorter step would be too short.
    pub fn limit_angles(
        &mut self,
        solver: &Solver<'_>,
        work: &mut Work,
        length: f64,
    ) -> Result<Option<f64>, RunError> {
        let (element, periods) = largest_turn(solver.setup.program, &solver.state, &solver.buffers);
        self.reach = CAUTION * length * MAX_TURN / periods;
        if periods > MAX_TURN {
            shorter_step(&solver.setup, solver.state.time, work, element, self.reach).map(Some)
        } else {
            Ok(None)
        }
    }

    /// Checks the error of the tried step, and returns a shorter step to try if the error is too large.
    ///
    /// # Errors
    /// If the shorter step would be too short.
    pub fn reject(
        &mut self,
        solver: &Solver<'_>,
        work: &mut Work,
        length: f64,
    ) -> Result<Option<f64>, RunError> {
        let Solver { setup, state, buffers, .. } = solver;
        let (worst, error) = largest_error(setup.method, &buffers.stage_rates, state.states.len(), length);
        if self.accepts(length, error, setup.method.order) {
            return Ok(None);
        }
        // If a voltage is not a number even then, the check of the accepted step reports it.
        let shorter = self.next.min(length);
        if error.is_nan() && shorter <= LEAST_STEP * setup.step {
            return Ok(None);
        }
        let element = setup.program.states[worst].element;
        shorter_step(setup, state.time, work, element, shorter).map(Some)
    }
}

/// The element whose angle advances most from the present to the end or a checked stage of the tried step, and by how
/// many periods.
fn largest_turn(program: &Program, state: &SolverState, buffers: &StepBuffers) -> (usize, f64) {
    let voltages = || buffers.checked_voltages.iter().chain([&buffers.voltages]);
    let turns = program.angles.iter().map(|angle| {
        let periods = voltages().map(|after| angle.periods(&state.voltages, after));
        (angle.element, periods.fold(0.0, f64::max))
    });
    turns.fold((0, 0.0), |most, turn| if turn.1 > most.1 { turn } else { most })
}

/// Counts a rejected step, and returns the shorter step to try.
///
/// # Errors
/// If the step is shorter than the least share of the first step tried.
fn shorter_step(
    setup: &Setup<'_>,
    time: f64,
    work: &mut Work,
    element: usize,
    step: f64,
) -> Result<f64, RunError> {
    work.rejections += 1;
    if step > LEAST_STEP * setup.step {
        return Ok(step);
    }
    Err(RunError::StepTooShort { element: setup.program.name(element).to_owned(), time, step })
}
