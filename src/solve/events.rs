//! Changes of mode: found within a step, stepped to, carried out.

use super::error::RunError;
use super::machine::{Machine, Witness};
use crate::program::Transition;

/// More changes than this within one step are chatter.
const MOST_CHANGES: usize = 1000;
/// A change is found when its place in the step is known to this share of the step.
const FOUND: f64 = 1e-13;
/// Halving alone would need fewer looks than this.
const MOST_LOOKS: usize = 100;

impl Machine<'_> {
    /// Goes to a time, stopping for every change of mode and every echo of one on the way.
    pub(super) fn advance(&mut self, target: f64, witness: &mut impl Witness) -> Result<(), RunError> {
        let mut changes = 0;
        loop {
            let end = self.end_of_stretch(target);
            let length = end - self.time;
            self.step_ahead(length);
            let share = if self.any_fires_ahead() { self.first_change(length) } else { 1.0 };
            let time = if share >= 1.0 { end } else { self.time + share * length };
            self.accept(time, witness)?;
            self.meet_breaks();
            changes += self.settle(changes)?;
            witness.arrival(self);
            if self.time >= target {
                return Ok(());
            }
        }
    }

    /// Carries out every change that is due now, one after the other; tells how many there were.
    pub(super) fn settle(&mut self, before: usize) -> Result<usize, RunError> {
        let mut changes = 0;
        while let Some((mode, transition)) = self.due() {
            changes += 1;
            if before + changes > MOST_CHANGES {
                let element = self.program.name(self.program.modes[mode].element).to_owned();
                return Err(RunError::Chatter { element, most: MOST_CHANGES, time: self.time });
            }
            self.carry_out(mode, transition);
        }
        Ok(changes)
    }

    fn due(&self) -> Option<(usize, usize)> {
        self.program.modes.iter().enumerate().find_map(|(index, mode)| {
            let fires = |transition: &Transition| {
                transition.from == self.modes[index] && transition.guard.holds(&self.registers)
            };
            mode.transitions.iter().position(fires).map(|transition| (index, transition))
        })
    }

    fn carry_out(&mut self, mode: usize, transition: usize) {
        let transition = &self.program.modes[mode].transitions[transition];
        self.work.changes += 1;
        self.modes[mode] = transition.to;
        if let Some(reset) = transition.reset {
            self.states[reset.state as usize] = self.registers[reset.to.index()];
        }
        self.evaluate();
        self.remember_break(0);
    }

    /// Transitions that can be made from the present modes.
    fn open_transitions(&self) -> impl Iterator<Item = &Transition> {
        let pairs = self.program.modes.iter().zip(&self.modes);
        pairs.flat_map(|(mode, value)| mode.transitions.iter().filter(move |open| open.from == *value))
    }

    fn any_fires_ahead(&self) -> bool {
        self.open_transitions().any(|open| open.guard.holds(&self.trial_registers))
    }

    /// How far the foremost guard is past its mark ahead; negative where none is.
    fn excess_ahead(&self) -> f64 {
        let values = self.open_transitions().map(|open| self.trial_registers[open.guard.register.index()]);
        values.fold(f64::NEG_INFINITY, f64::max)
    }

    fn excess_now(&self) -> f64 {
        let values = self.open_transitions().map(|open| self.registers[open.guard.register.index()]);
        values.fold(f64::NEG_INFINITY, f64::max)
    }

    /// The share of the step after which the first change is due, by false position (Illinois) kept safe by
    /// halving. Leaves the machine looking at that place.
    fn first_change(&mut self, length: f64) -> f64 {
        let (mut low, mut low_excess) = (0.0, self.excess_now().min(0.0));
        let (mut high, mut high_excess) = (1.0, self.excess_ahead());
        for look in 0..MOST_LOOKS {
            if high - low <= FOUND {
                break;
            }
            let middle = between(low, low_excess, high, high_excess, look % 3 == 2);
            self.step_ahead(middle * length);
            if self.any_fires_ahead() {
                (high, high_excess) = (middle, self.excess_ahead());
                low_excess *= 0.5;
            } else {
                (low, low_excess) = (middle, self.excess_ahead());
                high_excess *= 0.5;
            }
        }
        self.step_ahead(high * length);
        high
    }
}

/// A place strictly between two: where the straight line between the excesses is 0, or half-way.
fn between(low: f64, low_excess: f64, high: f64, high_excess: f64, halve: bool) -> f64 {
    let width = high - low;
    let line = low + width * low_excess / (low_excess - high_excess);
    let edge = FOUND.max(width * 1e-3) * 0.5;
    if halve || !line.is_finite() { low + 0.5 * width } else { line.clamp(low + edge, high - edge) }
}
