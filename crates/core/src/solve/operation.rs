//! Operation of a machine over a length of time: in equal steps, or in steps that adapt to a tolerance.
//!
//! Equal steps run on the fast path whenever possible. A batch of machines runs some steps at a time, so an operation
//! in equal steps can be interrupted after any of them. [`Operation`] is the position in it. The end of an operation
//! need not be on the grid of equal steps: a shorter step follows.

use super::discontinuities::INSTANT_TOLERANCE;
use super::error::RunError;
use super::fast_path::{ActiveRun, Halt};
use super::machine::{Machine, MachineMode};
use super::observer::StepObserver;
use crate::kernel::Steps;

/// Largest adaptive step as a share of the time to operate. Without it, the first step after a standstill could skip
/// the beginning of a motion.
const MAX_STEP_SHARE: f64 = 0.05;

/// Share of a step up to which the time that is left needs no step.
const SAME_STEP: f64 = 1e-6;

/// A phase in which a machine operates in equal steps.
///
/// The phase takes the whole steps of the grid first. A shorter step may follow in [`Machine::end_operation`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Operation {
    /// The steps that are not taken yet. The first of them is the next step.
    pub steps: Steps,
    /// The kernel run on the fast path; `None` if the machine is not on it.
    pub active: Option<ActiveRun>,
    /// The end of the phase, in problem seconds.
    end: f64,
}

impl Operation {
    /// Removes the first `count` steps, which have been taken. An event that was expected in the next step is over.
    pub(super) fn count_taken(&mut self, count: u64) {
        self.steps = self.steps.after(count);
        if let Some(active) = &mut self.active {
            (active.steps_left, active.is_event_next) = (active.steps_left - count, false);
        }
    }

    /// The time that is left at a problem time of the operation, in problem seconds.
    pub(super) fn time_left(&self, time: f64) -> f64 {
        (self.end - time).max(0.0)
    }

    /// Ends the phase at the present instant: no steps are left.
    fn stop(&mut self) {
        self.steps.count = 0;
    }
}

impl Machine<'_> {
    /// Operates for a length of problem time in seconds, and passes every step to an observer.
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
        let longest = MAX_STEP_SHARE * (end - self.solver.state.time);
        while self.take_adaptive_step(end, longest, observer)? {}
        self.hold_if_stopped(observer);
        Ok(())
    }

    /// Takes a step that adapts to the tolerance, at most of the length `longest` in problem seconds and at most up to
    /// the problem time `end`. Returns whether it took one: not at `end`, and not if the observer stops the machine.
    ///
    /// # Errors
    /// If the run takes too many steps, or the step fails.
    fn take_adaptive_step(
        &mut self,
        end: f64,
        longest: f64,
        observer: &mut impl StepObserver,
    ) -> Result<bool, RunError> {
        if self.solver.state.time >= end || self.hold_if_stopped(observer) {
            return Ok(false);
        }
        let (steps, max) = (self.work.steps as f64, self.max_steps);
        if steps > max {
            return Err(RunError::TooManySteps { steps, max });
        }
        let (next, remaining) = (self.next_step().min(longest), end - self.solver.state.time);
        // The last two steps share the remaining time, so that neither is much too short.
        let step = if next < remaining { next.min(0.5 * remaining) } else { remaining };
        let target = self.solver.state.time + step;
        self.advance(if step < remaining { target } else { end }, observer)?;
        Ok(true)
    }

    /// Continues an operation up to a problem time, and takes at most `most` steps. Returns whether the operation is
    /// complete. Steps that adapt may end after the time.
    ///
    /// # Errors
    /// If a step fails.
    pub(super) fn continue_up_to(
        &mut self,
        operation: &mut Operation,
        time: f64,
        most: u64,
        observer: &mut impl StepObserver,
    ) -> Result<bool, RunError> {
        if self.control.is_none() {
            // A step that ends within rounding of the time is not needed.
            let steps =
                ((time - self.solver.state.time) / self.solver.setup.step - SAME_STEP).ceil().max(0.0);
            self.continue_operation(operation, most.min(steps as u64), observer)?;
            let is_held = self.mode == MachineMode::Hold;
            return Ok(operation.steps.count == 0 && (is_held || time >= operation.end));
        }
        let longest = MAX_STEP_SHARE * (operation.end - operation.steps.begin);
        for _ in 0..most {
            if self.solver.state.time >= time {
                return Ok(false);
            }
            if !self.take_adaptive_step(operation.end, longest, observer)? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Length of the next step in problem seconds: constant, or by the step control.
    fn next_step(&self) -> f64 {
        let solver = &self.solver;
        self.control.map_or(solver.setup.step, |control| control.next_step(&solver.delay_lines))
    }

    /// Number of equal steps in a length of problem time in seconds; 0 if steps adapt to a tolerance.
    pub(super) fn equal_steps_in(&self, length: f64) -> f64 {
        if self.control.is_some() { 0.0 } else { length / self.solver.setup.step }
    }

    /// Puts the machine into hold if the observer ends the phase or stops the run. Returns whether it is in hold.
    pub(super) fn hold_if_stopped(&mut self, observer: &impl StepObserver) -> bool {
        if observer.is_phase_over() || observer.should_stop(&self.lamps) {
            self.hold();
        }
        self.mode == MachineMode::Hold
    }

    /// Begins to operate for a length of problem time in seconds. The steps begin at the present time, on a grid of
    /// equal steps. Corners of tables that are not on this grid are listed, because a kernel has to stop there.
    ///
    /// # Errors
    /// If the length is negative or not finite.
    pub(super) fn begin_operation(&mut self, length: f64) -> Result<Operation, RunError> {
        if !(length >= 0.0 && length.is_finite()) {
            return Err(RunError::NotAnOperatingTime { value: length });
        }
        self.mode = MachineMode::Operate;
        let (setup, time) = (&self.solver.setup, self.solver.state.time);
        let corners = &setup.program.corners;
        self.events.corners_off_grid = corners.off_grid(time, setup.grid, INSTANT_TOLERANCE * setup.step);
        let count = setup.grid.steps_in(length);
        if let Some(check) = &mut self.step_check {
            check.begin_phase(count);
        }
        if let Some(peaks) = &mut self.amplifier_peaks {
            peaks.begin_phase(count);
        }
        let steps = Steps { begin: time, grid: setup.grid, first: 1, count };
        Ok(Operation { steps, active: None, end: time + length })
    }

    /// Takes at most `count` of the steps that are left. Afterwards the machine may be on the fast path
    /// (`operation.active`).
    ///
    /// Each pass of the loop runs the kernel, enters the fast path, or takes one step without it. If the observer stops
    /// the machine, no steps are left.
    ///
    /// # Errors
    /// If a step fails.
    pub(super) fn continue_operation(
        &mut self,
        operation: &mut Operation,
        count: u64,
        observer: &mut impl StepObserver,
    ) -> Result<(), RunError> {
        let count_after = operation.steps.count.saturating_sub(count);
        while operation.steps.count > count_after {
            let before_check = self.steps_before_check(operation.steps);
            if before_check == 0 && !self.hold_if_stopped(observer) {
                self.check_step(operation, observer)?;
                continue;
            }
            let count = (operation.steps.count - count_after).min(before_check.max(1));
            let steps = Steps { count, ..operation.steps };
            match operation.active {
                Some(active) => {
                    let steps = Steps { count: steps.count.min(active.steps_left), ..steps };
                    let (taken, halt) = self.run_kernel(active, steps, observer);
                    operation.count_taken(taken);
                    if taken < count {
                        self.finish_step(operation, active, halt, observer)?;
                        self.note_events(operation.steps.first);
                    }
                }
                None if self.hold_if_stopped(observer) => operation.stop(),
                None => {
                    operation.active = self.enter_fast_path(operation.steps);
                    if operation.active.is_none() {
                        self.advance(operation.steps.end_of(0), observer)?;
                        operation.count_taken(1);
                        self.note_events(operation.steps.first);
                    }
                }
            }
        }
        Ok(())
    }

    /// Notes for the checks of steps how many changes of mode and jumps there have been before the step with this number
    /// in the present phase. Kinks do not count, because kernels cross them.
    fn note_events(&mut self, next_step: u64) {
        if let Some(check) = &mut self.step_check {
            check.note_events([self.work.changes, self.events.jumps], next_step);
        }
    }

    /// Number of steps before the next one that is checked, or before which the outputs of amplifiers are read; the
    /// largest number if there is none.
    fn steps_before_check(&self, steps: Steps) -> u64 {
        let check = self.step_check.as_ref().map(|check| check.steps_before(steps.first));
        let reading = self.amplifier_peaks.as_ref().map(|peaks| peaks.steps_before(steps.first));
        check.unwrap_or(u64::MAX).min(reading.unwrap_or(u64::MAX))
    }

    /// Checks the next step if a check is due. The machine leaves the fast path for this, because the kernel has only a
    /// part of the state. There it reads the outputs of all amplifiers.
    ///
    /// # Errors
    /// If the machine cannot leave the fast path.
    fn check_step(
        &mut self,
        operation: &mut Operation,
        observer: &mut impl StepObserver,
    ) -> Result<(), RunError> {
        if let Some(active) = operation.active.take() {
            self.leave_fast_path(active, Halt::Unsupported, observer)?;
        }
        let next_step = operation.steps.first;
        if let Some(peaks) = &mut self.amplifier_peaks {
            peaks.advance(next_step);
        }
        if let Some(check) = self.step_check.as_mut().filter(|check| check.steps_before(next_step) == 0) {
            check.check(&mut self.solver, next_step);
        }
        Ok(())
    }

    /// Takes the step in which the kernel halted: by the kernel up to the halt, then without it to the end of the step.
    ///
    /// # Errors
    /// If the step fails.
    fn finish_step(
        &mut self,
        operation: &mut Operation,
        active: ActiveRun,
        halt: Halt,
        observer: &mut impl StepObserver,
    ) -> Result<(), RunError> {
        let end = operation.steps.end_of(0);
        let halt = if halt == Halt::Completed { self.run_kernel_to(active, end, observer) } else { halt };
        self.leave_fast_path(active, halt, observer)?;
        operation.active = None;
        self.begin_counting();
        if halt == Halt::Jump {
            self.handle_events(observer)?;
        }
        let mode_change = if let Halt::ModeChange(seconds) = halt { Some(seconds) } else { None };
        self.step_to(end, mode_change, observer)?;
        operation.count_taken(1);
        Ok(())
    }

    /// Ends the phase and leaves the fast path. A shorter step to the end of the phase follows the last whole step,
    /// unless the difference is rounding (less than 1e-9 of a step).
    ///
    /// # Errors
    /// If the shorter step fails, or a voltage is not a number.
    pub(super) fn end_operation(
        &mut self,
        operation: Operation,
        observer: &mut impl StepObserver,
    ) -> Result<(), RunError> {
        if let Some(active) = operation.active {
            self.leave_fast_path(active, Halt::Unsupported, observer)?;
        }
        let is_held = self.mode() == MachineMode::Hold;
        let remainder = operation.end - self.solver.state.time;
        if !is_held && remainder > 1e-9 * self.solver.setup.step && !self.hold_if_stopped(observer) {
            self.advance(operation.end, observer)?;
        }
        self.hold_if_stopped(observer);
        Ok(())
    }
}
