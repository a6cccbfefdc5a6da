//! Operating in equal steps, so many at a time.

use super::breaks::SAME;
use super::error::{RunError, TimeSetting};
use super::glide::Aloft;
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
                    let gone =
                        self.fly(aloft, Steps { count: steps.count.min(aloft.left), ..steps }, witness);
                    operation.pass(gone);
                    if gone < steps.count {
                        self.come_down(aloft, witness)?;
                        operation.aloft = None;
                        self.advance(operation.steps.end_of(0), witness)?;
                        operation.pass(1);
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

    /// Ends the phase: what is left beyond its last whole step, unless that is rounding.
    pub(super) fn end_operation(
        &mut self,
        operation: Operation,
        witness: &mut impl Witness,
    ) -> Result<(), RunError> {
        if let Some(aloft) = operation.aloft {
            self.come_down(aloft, witness)?;
        }
        let is_over = self.mode() == MachineMode::Hold;
        if !is_over && operation.end - self.time > 1e-9 * self.step && !self.is_stopped_by(witness) {
            self.advance(operation.end, witness)?;
        }
        self.is_stopped_by(witness);
        Ok(())
    }
}
