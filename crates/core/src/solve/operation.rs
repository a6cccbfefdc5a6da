//! Operation of a machine over a length of time: in equal steps, or in steps that adapt to a tolerance.
//!
//! Equal steps run on the fast path whenever it is possible. A batch of machines runs some steps at a time, so an
//! operation in equal steps can be interrupted after any of them ([`Operation`]).

use super::discontinuities::INSTANT_TOLERANCE;
use super::error::{RunError, TimeSetting};
use super::fast_path::{ActiveRun, Halt};
use super::machine::{Machine, MachineMode};
use super::observer::StepObserver;
use super::run::MAX_STEPS;
use crate::kernel::Steps;

/// No adaptive step is longer than this share of the time to operate: an element at rest may begin to move.
const LONGEST_STEP: f64 = 0.05;

/// A phase in which a machine operates in equal steps.
///
/// The phase takes the whole steps of the grid first. A rest shorter than a step follows in [`Machine::end_operation`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Operation {
    /// The steps that are left.
    pub steps: Steps,
    /// The kernel run on the fast path; `None` if the machine is not on it.
    pub active: Option<ActiveRun>,
    /// The end of the phase, in problem seconds.
    end: f64,
}

impl Operation {
    /// Removes the first `count` steps, which have been taken.
    pub fn pass(&mut self, count: u64) {
        self.steps = self.steps.after(count);
        if let Some(active) = &mut self.active {
            (active.left, active.meets) = (active.left - count, false);
        }
    }

    /// Ends the phase here.
    fn stop(&mut self) {
        self.steps.count = 0;
    }
}

impl Machine<'_> {
    /// Operates for a length of problem time in seconds and shows every step to an observer.
    ///
    /// # Errors
    /// If the length is negative or not finite, or a step fails.
    pub(super) fn operate_observed(
        &mut self,
        length: f64,
        observer: &mut impl StepObserver,
    ) -> Result<(), RunError> {
        let mut operation = self.begin_operation(length)?;
        if self.control.is_some() {
            return self.operate_adaptive(self.solver.state.time + length, observer);
        }
        self.continue_operation(&mut operation, u64::MAX, observer)?;
        self.end_operation(operation, observer)
    }

    /// Operates up to a problem time in steps that adapt to the tolerance.
    ///
    /// # Errors
    /// If the run takes too many steps, or a step fails.
    fn operate_adaptive(&mut self, end: f64, observer: &mut impl StepObserver) -> Result<(), RunError> {
        let longest = LONGEST_STEP * (end - self.solver.state.time);
        while self.solver.state.time < end && !self.hold_if_asked(observer) {
            let (steps, most) = (self.work.steps as f64, MAX_STEPS);
            if steps > most {
                return Err(RunError::TooManySteps { steps, most });
            }
            let (next, left) = (self.next_step().min(longest), end - self.solver.state.time);
            // The last two steps share the rest, so that neither is much too short.
            let step = if next < left { next.min(0.5 * left) } else { left };
            let target = self.solver.state.time + step;
            self.advance(if step < left { target } else { end }, observer)?;
        }
        self.hold_if_asked(observer);
        Ok(())
    }

    /// Length of the next step in problem seconds.
    fn next_step(&self) -> f64 {
        let solver = &self.solver;
        self.control.map_or(solver.setup.step, |control| control.next_step(&solver.delay_lines))
    }

    /// Goes into hold if the observer asks for it. Returns whether the machine is in hold.
    pub(super) fn hold_if_asked(&mut self, observer: &impl StepObserver) -> bool {
        if observer.is_phase_over() || observer.should_stop(&self.lamps) {
            self.hold();
        }
        self.mode == MachineMode::Hold
    }

    /// Begins to operate for a length of problem time in seconds.
    ///
    /// # Errors
    /// If the length is negative or not finite.
    pub(super) fn begin_operation(&mut self, length: f64) -> Result<Operation, RunError> {
        if !(length >= 0.0 && length.is_finite()) {
            return Err(RunError::NotATime { which: TimeSetting::Duration, value: length });
        }
        self.mode = MachineMode::Operate;
        let (setup, time) = (&self.solver.setup, self.solver.state.time);
        let corners = &setup.program.corners;
        self.events.corners_off_grid = corners.off(time, setup.grid, INSTANT_TOLERANCE * setup.step);
        let count = setup.grid.steps_in(length);
        let steps = Steps { begin: time, grid: setup.grid, first: 1, count };
        Ok(Operation { steps, active: None, end: time + length })
    }

    /// Takes at most `count` of the steps that are left. The machine may then be on the fast path.
    ///
    /// Each pass of the loop either runs the kernel, or enters the fast path, or takes one step without it. If the
    /// observer stops the machine, no steps are left.
    ///
    /// # Errors
    /// If a step fails.
    pub(super) fn continue_operation(
        &mut self,
        operation: &mut Operation,
        count: u64,
        observer: &mut impl StepObserver,
    ) -> Result<(), RunError> {
        let last = operation.steps.count.saturating_sub(count);
        while operation.steps.count > last {
            let steps = Steps { count: operation.steps.count - last, ..operation.steps };
            match operation.active {
                Some(active) => {
                    let steps = Steps { count: steps.count.min(active.left), ..steps };
                    let (taken, halt) = self.run_kernel(active, steps, observer);
                    operation.pass(taken);
                    if operation.steps.count > last {
                        self.finish_step(operation, active, halt, observer)?;
                    }
                }
                None if self.hold_if_asked(observer) => operation.stop(),
                None => {
                    operation.active = self.enter_fast_path(operation.steps);
                    if operation.active.is_none() {
                        self.advance(operation.steps.end_of(0), observer)?;
                        operation.pass(1);
                    }
                }
            }
        }
        Ok(())
    }

    /// Takes the step in which the kernel halted: by the kernel up to the halt, then without it to the end of the step.
    fn finish_step(
        &mut self,
        operation: &mut Operation,
        active: ActiveRun,
        halt: Halt,
        observer: &mut impl StepObserver,
    ) -> Result<(), RunError> {
        let end = operation.steps.end_of(0);
        let halt = if halt == Halt::Quiet { self.run_kernel_to(active, end, observer) } else { halt };
        self.leave_fast_path(active, halt, observer)?;
        operation.active = None;
        self.begin_counting();
        if halt == Halt::Jump {
            self.handle_events(observer)?;
        }
        let change = if let Halt::Change(later) = halt { Some(later) } else { None };
        self.step_to(end, change, observer)?;
        operation.pass(1);
        Ok(())
    }

    /// Ends the phase and leaves the fast path. The rest beyond the last whole step is stepped through, unless it is
    /// rounding.
    pub(super) fn end_operation(
        &mut self,
        operation: Operation,
        observer: &mut impl StepObserver,
    ) -> Result<(), RunError> {
        if let Some(active) = operation.active {
            self.leave_fast_path(active, Halt::Unclear, observer)?;
        }
        let is_held = self.mode() == MachineMode::Hold;
        let rest = operation.end - self.solver.state.time;
        if !is_held && rest > 1e-9 * self.solver.setup.step && !self.hold_if_asked(observer) {
            self.advance(operation.end, observer)?;
        }
        self.hold_if_asked(observer);
        Ok(())
    }
}
