//! Steps as long as an error allows.

use super::delay_line::DelayLine;
use super::error::RunError;
use super::machine::{Machine, Witness};
use super::run::MOST_STEPS;

/// How long the next step may be, so that the errors of a second of steps add up to no more than a tolerance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Control {
    /// The error allowed in any state, in machine units of 100 V per problem second.
    tolerance: f64,
    /// Length of the next step, in problem seconds.
    next: f64,
}

/// What the next step keeps of the length that would meet the tolerance exactly.
const CAUTION: f64 = 0.9;
/// A step is at most this many times shorter or longer than the last.
const CHANGE: f64 = 5.0;

impl Control {
    pub fn new(tolerance: f64, first: f64) -> Self {
        Control { tolerance, next: first }
    }

    /// Whether a step of this length may be taken, and how long the next one may be. One that had to be short
    /// for another reason says little about the next.
    fn allows(&mut self, length: f64, error: f64, order: f64) -> bool {
        let excess = error / (self.tolerance * length);
        let change = CAUTION * excess.powf(-1.0 / order);
        let fitting =
            length * if change.is_nan() { 1.0 / CHANGE } else { change.clamp(1.0 / CHANGE, CHANGE) };
        let allows = excess <= 1.0;
        let was_cut = length < self.next * CAUTION;
        self.next = if allows && was_cut { self.next.max(fitting) } else { fitting };
        allows
    }
}

impl Machine<'_> {
    /// Goes to a time in steps as long as the tolerance allows.
    pub(super) fn operate_within_tolerance(
        &mut self,
        end: f64,
        witness: &mut impl Witness,
    ) -> Result<(), RunError> {
        while self.time < end && !self.is_stopped_by(witness) {
            let (steps, most) = (self.work.steps as f64, MOST_STEPS);
            if steps > most {
                return Err(RunError::TooManySteps { steps, most });
            }
            let (next, left) = (self.next_step(), end - self.time);
            // The last two steps share what is left, so that none of them is a stub.
            let step = if next < left { next.min(0.5 * left) } else { left };
            let target = self.time + step;
            self.advance(if step < left { target } else { end }, witness)?;
        }
        self.is_stopped_by(witness);
        Ok(())
    }

    /// No step is longer than a delay: what comes out of a line must have gone in.
    fn next_step(&self) -> f64 {
        let delays = self.lines.iter().map(DelayLine::delay);
        delays.fold(self.control.map_or(self.step, |control| control.next), f64::min)
    }

    /// Whether the step looked at may be taken; if not, how long to try instead.
    pub(super) fn refused(&mut self, length: f64) -> Result<Option<f64>, RunError> {
        // Equal steps are all taken, and need no error.
        let Some(mut control) = self.control else { return Ok(None) };
        let (state, error) = self.worst_error(length);
        let allows = control.allows(length, error, self.method.order);
        self.control = Some(control);
        if allows {
            return Ok(None);
        }
        self.work.rejections += 1;
        let shorter = control.next.min(length);
        if shorter > LEAST * self.step {
            return Ok(Some(shorter));
        }
        // Where there is no number, looking on will tell why.
        if error.is_nan() {
            return Ok(None);
        }
        let element = self.program.name(self.program.states[state].element).to_owned();
        Err(RunError::StepTooShort { element, time: self.time, step: shorter })
    }
}

/// No step is shorter than this share of the first one tried.
const LEAST: f64 = 1e-8;
