//! Control of the step size by the estimated error.
//!
//! A tried step is accepted if its error is at most the tolerance times its length. So the errors of one second add up
//! to at most the tolerance. The length of the next step follows from the error of this one. Steps are also limited by
//! the angles of sines and cosines: no angle may advance by more than an eighth of a period.

use super::buffers::StepBuffers;
use super::error::RunError;
use super::runge_kutta::largest_error;
use super::state::{Setup, Solver, SolverState};
use crate::delay_line::DelayLine;
use crate::ir::Program;
use crate::machines::REFERENCE;
use crate::trace::WorkCounters;

/// The length of the next step.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepControl {
    /// Largest error allowed in any state, in machine units of 100 V per problem second.
    tolerance: f64,
    /// Length of the next step according to the error, in problem seconds.
    next: f64,
    /// Largest length of the next step according to the angles, in problem seconds; infinity before the first step.
    max_by_angles: f64,
}

/// Length of the next step as a share of the length whose predicted error is exactly the tolerance. The usual value of
/// codes for ordinary differential equations (Hairer, Nørsett and Wanner 1993, section II.4); it makes rejections rare.
const SAFETY_FACTOR: f64 = 0.9;
/// Largest ratio between the lengths of two successive steps, in both directions. The error estimate does not predict
/// larger changes.
const MAX_CHANGE: f64 = 5.0;
/// Largest advance of an angle in one step, in periods. Then the four samples of a voltage in a step show where a sine
/// turns.
const MAX_TURN_PERIODS: f64 = 0.125;
/// Least length of a step as a share of the first step tried. Below it the run stops with an error.
const MIN_STEP_SHARE: f64 = 1e-8;

impl StepControl {
    /// The control before the first step. `tolerance` is in machine units per problem second, `first` in problem
    /// seconds.
    pub(super) fn new(tolerance: f64, first: f64) -> Self {
        StepControl { tolerance, next: first, max_by_angles: f64::INFINITY }
    }

    /// Resets the control to the first step.
    pub(super) fn reset(&mut self, first: f64) {
        *self = StepControl::new(self.tolerance, first);
    }

    /// The error allowed over a time in problem seconds, in volts.
    pub(super) fn allowed_error(&self, time: f64) -> f64 {
        self.tolerance * time * REFERENCE
    }

    /// Length of the next step in problem seconds. It is at most the shortest delay: the output of a delay line must be
    /// known before the step.
    pub(super) fn next_step(&self, delay_lines: &[DelayLine]) -> f64 {
        let delays = delay_lines.iter().map(DelayLine::delay);
        delays.fold(self.next.min(self.max_by_angles), f64::min)
    }

    /// Whether a step of this length and error is accepted; updates the length of the next step. A step that an event
    /// or the end of the phase cut short does not shorten the next one. `order` is the order of the error estimate.
    fn should_accept(&mut self, length: f64, error: f64, order: f64) -> bool {
        let excess = error / (self.tolerance * length);
        // The error per second grows with the length to the power `order`.
        let change = SAFETY_FACTOR * excess.powf(-1.0 / order);
        let next_by_error = length
            * if change.is_nan() { 1.0 / MAX_CHANGE } else { change.clamp(1.0 / MAX_CHANGE, MAX_CHANGE) };
        let was_cut = length < self.next * SAFETY_FACTOR;
        self.next =
            if was_cut && change >= MAX_CHANGE { self.next.max(next_by_error) } else { next_by_error };
        excess <= 1.0
    }

    /// Checks the angles over the tried step. Returns a shorter length to try if an angle advanced too far, else
    /// `None`.
    ///
    /// # Errors
    /// If the shorter step would be too short.
    pub(super) fn limit_angles(
        &mut self,
        solver: &Solver<'_>,
        work: &mut WorkCounters,
        length: f64,
    ) -> Result<Option<f64>, RunError> {
        let (element, periods) = largest_angle_change(solver.setup.program, &solver.state, &solver.buffers);
        self.max_by_angles = SAFETY_FACTOR * length * MAX_TURN_PERIODS / periods;
        if periods > MAX_TURN_PERIODS {
            shorter_step(&solver.setup, solver.state.time, work, element, self.max_by_angles).map(Some)
        } else {
            Ok(None)
        }
    }

    /// Checks the error of the tried step. Returns a shorter length to try if the error is too large, else `None`.
    ///
    /// # Errors
    /// If the shorter step would be too short.
    pub(super) fn reject(
        &mut self,
        solver: &Solver<'_>,
        work: &mut WorkCounters,
        length: f64,
    ) -> Result<Option<f64>, RunError> {
        let Solver { setup, state, buffers, .. } = solver;
        let (worst, error) = largest_error(setup.method, &buffers.stage_rates, state.states.len(), length);
        if self.should_accept(length, error, setup.method.error_order) {
            return Ok(None);
        }
        // If a voltage is not a number even then, the check of the accepted step reports it.
        let shorter = self.next.min(length);
        if error.is_nan() && shorter <= MIN_STEP_SHARE * setup.step {
            return Ok(None);
        }
        let element = setup.program.lowered.states[worst].element;
        shorter_step(setup, state.time, work, element, shorter).map(Some)
    }
}

/// The index of the element whose angle advances most from the present to the end or a checked stage of the tried step,
/// and the advance in periods; (0, 0.0) without angles.
fn largest_angle_change(program: &Program, state: &SolverState, buffers: &StepBuffers) -> (usize, f64) {
    let voltages = || buffers.checked_voltages.iter().chain([&buffers.voltages]);
    let angle_changes = program.lowered.angles.iter().map(|angle| {
        let periods = voltages().map(|after| angle.periods(&state.voltages, after));
        (angle.element, periods.fold(0.0, f64::max))
    });
    angle_changes
        .fold((0, 0.0), |most, angle_change| if angle_change.1 > most.1 { angle_change } else { most })
}

/// Counts a rejected step, and returns the length `step` to try next, in problem seconds. `element` is the index of the
/// element that the error names.
///
/// # Errors
/// If `step` is at most [`MIN_STEP_SHARE`] of the first step tried.
fn shorter_step(
    setup: &Setup<'_>,
    time: f64,
    work: &mut WorkCounters,
    element: usize,
    step: f64,
) -> Result<f64, RunError> {
    work.rejections += 1;
    if step > MIN_STEP_SHARE * setup.step {
        return Ok(step);
    }
    Err(RunError::StepTooShort { element: setup.program.name(element).to_owned(), time, step })
}
