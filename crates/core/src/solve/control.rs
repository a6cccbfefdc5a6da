//! Steps as long as an error allows.

use super::error::RunError;
use super::machine::{Machine, Witness};
use super::run::MOST_STEPS;
use crate::delay_line::DelayLine;
use crate::machines::REFERENCE;

/// How long the next step may be, so that the errors of a second of steps add up to no more than a tolerance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Control {
    /// The error allowed in any state, in machine units of 100 V per problem second.
    tolerance: f64,
    /// Length of the next step by its error, in problem seconds.
    next: f64,
    /// How long it may be at most, by the angles that turn.
    reach: f64,
    /// Since when changes of mode have been counted.
    counted: f64,
}

/// What the next step keeps of the length that would meet the tolerance exactly.
const CAUTION: f64 = 0.9;
/// A step is at most this many times shorter or longer than the last.
const CHANGE: f64 = 5.0;
/// No step is longer than this share of the time to operate: what stands still may begin to move.
const LONGEST: f64 = 0.05;
/// No step goes on by more than this share of a period of anything: four looks at it show where it turns.
const MOST_TURN: f64 = 0.125;
/// The share of the first step tried within which a thousand changes are chatter.
pub(super) const CHATTER: f64 = 0.01;

impl Control {
    pub fn new(tolerance: f64, first: f64) -> Self {
        Control { tolerance, next: first, reach: f64::INFINITY, counted: 0.0 }
    }

    /// As it was before the first step.
    pub fn begun(self, first: f64) -> Self {
        Control::new(self.tolerance, first)
    }

    /// What the errors of such a time may add up to, in volts.
    pub fn allowed(&self, time: f64) -> f64 {
        self.tolerance * time * REFERENCE
    }

    /// Whether changes of mode are to be counted anew: so much time has gone since they were.
    pub fn counts_anew(&mut self, time: f64, first: f64) -> bool {
        let is_due = time - self.counted >= CHATTER * first;
        if is_due {
            self.counted = time;
        }
        is_due
    }

    /// Whether a step of this length may be taken, and how long the next one may be. One that had to be very short for
    /// another reason does not shorten the next.
    fn allows(&mut self, length: f64, error: f64, order: f64) -> bool {
        let excess = error / (self.tolerance * length);
        let change = CAUTION * excess.powf(-1.0 / order);
        let fitting =
            length * if change.is_nan() { 1.0 / CHANGE } else { change.clamp(1.0 / CHANGE, CHANGE) };
        let was_cut = length < self.next * CAUTION;
        self.next = if was_cut && change >= CHANGE { self.next.max(fitting) } else { fitting };
        excess <= 1.0
    }
}

impl Machine<'_> {
    /// Goes to a time in steps as long as the tolerance allows.
    pub(super) fn operate_within_tolerance(
        &mut self,
        end: f64,
        witness: &mut impl Witness,
    ) -> Result<(), RunError> {
        let longest = LONGEST * (end - self.time);
        while self.time < end && !self.is_stopped_by(witness) {
            let (steps, most) = (self.work.steps as f64, MOST_STEPS);
            if steps > most {
                return Err(RunError::TooManySteps { steps, most });
            }
            let (next, left) = (self.next_step().min(longest), end - self.time);
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
        delays.fold(self.control.map_or(self.step, |control| control.next.min(control.reach)), f64::min)
    }

    /// How long to try instead where the step looked at goes on by too much of a period.
    pub(super) fn turned_too_far(&mut self, length: f64) -> Result<Option<f64>, RunError> {
        if self.control.is_none() {
            return Ok(None);
        }
        let (element, periods) = self.most_turned();
        let reach = CAUTION * length * MOST_TURN / periods;
        self.control.iter_mut().for_each(|control| control.reach = reach);
        if periods > MOST_TURN { self.shorter(element, reach).map(Some) } else { Ok(None) }
    }

    /// What goes on by most of its period from the present to the end or a stage of the step looked at, and by how many.
    fn most_turned(&self) -> (usize, f64) {
        let voltages = || self.glances.iter().chain([&self.trial_registers]);
        let turns = self.program.angles.iter().map(|angle| {
            let periods = voltages().map(|after| angle.periods(&self.registers, after));
            (angle.element, periods.fold(0.0, f64::max))
        });
        turns.fold((0, 0.0), |most, turn| if turn.1 > most.1 { turn } else { most })
    }

    /// A shorter step to try, unless it would be too short.
    fn shorter(&mut self, element: usize, step: f64) -> Result<f64, RunError> {
        self.work.rejections += 1;
        if step > LEAST * self.step {
            return Ok(step);
        }
        let element = self.program.name(element).to_owned();
        Err(RunError::StepTooShort { element, time: self.time, step })
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
        // Where there is no number, looking on will tell why.
        let shorter = control.next.min(length);
        if error.is_nan() && shorter <= LEAST * self.step {
            return Ok(None);
        }
        self.shorter(self.program.states[state].element, shorter).map(Some)
    }
}

/// No step is shorter than this share of the first one tried.
const LEAST: f64 = 1e-8;
