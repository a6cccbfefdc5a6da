//! Operating in equal steps, so many at a time.

use super::breaks::SAME;
use super::error::{RunError, TimeSetting};
use super::glide::{Aloft, Halt};
use super::machine::{Machine, MachineMode, Witness};
use crate::kernel::Steps;

/// A phase in which a machine operates.
#[derive(Debug, Clone, Copy)]
pub(super) struct Operation {
    /// The steps that are left.
    pub steps: Steps,
    /// The flight that is under way.
    pub aloft: Option<Aloft>,
    /// When the phase ends.
    end: f64,
}

impl Operation {
    /// Takes note of steps that were gone.
    pub fn pass(&mut self, gone: u64) {
        self.steps = self.steps.after(gone);
        if let Some(aloft) = &mut self.aloft {
            (aloft.left, aloft.meets) = (aloft.left - gone, false);
        }
    }

    fn stop(&mut self) {
        self.steps.count = 0;
    }
}

impl Machine<'_> {
    /// Begins to operate for a length of problem time.
    ///
    /// # Errors
    /// When the length is none.
    pub(super) fn begin_operation(&mut self, length: f64) -> Result<Operation, RunError> {
        if !(length >= 0.0 && length.is_finite()) {
            return Err(RunError::NotATime { which: TimeSetting::Duration, value: length });
        }
        self.mode = MachineMode::Operate;
        self.stray_corners = self.program.corners.off(self.time, self.grid, SAME * self.step);
        let count = self.grid.steps_in(length);
        let steps = Steps { begin: self.time, grid: self.grid, first: 1, count };
        Ok(Operation { steps, aloft: None, end: self.time + length })
    }

    /// Goes so many of the steps that are left, or all. It may be aloft then.
    pub(super) fn go_on(
        &mut self,
        operation: &mut Operation,
        count: u64,
        witness: &mut impl Witness,
    ) -> Result<(), RunError> {
        let last = operation.steps.count.saturating_sub(count);
        while operation.steps.count > last {
            let steps = Steps { count: operation.steps.count - last, ..operation.steps };
            match operation.aloft {
                Some(aloft) => {
                    let steps = Steps { count: steps.count.min(aloft.left), ..steps };
                    let (gone, halt) = self.fly(aloft, steps, witness);
                    operation.pass(gone);
                    if operation.steps.count > last {
                        self.go_step(operation, aloft, halt, witness)?;
                    }
                }
                None if self.is_stopped_by(witness) => operation.stop(),
                None => {
                    operation.aloft = self.take_off(operation.steps);
                    if operation.aloft.is_none() {
                        self.advance(operation.steps.end_of(0), witness)?;
                        operation.pass(1);
                    }
                }
            }
        }
        Ok(())
    }

    /// Goes a step in which something happens or may happen: in flight up to there.
    fn go_step(
        &mut self,
        operation: &mut Operation,
        aloft: Aloft,
        halt: Halt,
        witness: &mut impl Witness,
    ) -> Result<(), RunError> {
        let end = operation.steps.end_of(0);
        let halt = if halt == Halt::Quiet { self.fly_to_jump(aloft, end, witness) } else { halt };
        self.come_down(aloft, halt, witness)?;
        operation.aloft = None;
        self.count_anew();
        if halt == Halt::Jump {
            self.arrive(witness)?;
        }
        let change = if let Halt::Change(later) = halt { Some(later) } else { None };
        self.go_to(end, change, witness)?;
        operation.pass(1);
        Ok(())
    }

    /// Ends the phase: what is left beyond its last whole step, unless that is rounding.
    pub(super) fn end_operation(
        &mut self,
        operation: Operation,
        witness: &mut impl Witness,
    ) -> Result<(), RunError> {
        if let Some(aloft) = operation.aloft {
            self.come_down(aloft, Halt::Unclear, witness)?;
        }
        let is_over = self.mode() == MachineMode::Hold;
        if !is_over && operation.end - self.time > 1e-9 * self.step && !self.is_stopped_by(witness) {
            self.advance(operation.end, witness)?;
        }
        self.is_stopped_by(witness);
        Ok(())
    }
}
