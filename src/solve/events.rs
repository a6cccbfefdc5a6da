//! Changes of mode: found within a step, stepped to, carried out.

use super::error::RunError;
use super::machine::{Machine, Witness};
use crate::program::{Guard, Transition};

/// More changes of one mode than this within one step are chatter.
const MOST_CHANGES: u32 = 1000;
/// A change is found when its place in the step is known to this share of the step.
const FOUND: f64 = 1e-13;
/// One look in three halves at least: this many make the rest smaller than the step's rounding.
const MOST_LOOKS: usize = 150;

impl Machine<'_> {
    /// Goes to a time, stopping for every change of mode and every echo of one on the way.
    pub(super) fn advance(&mut self, target: f64, witness: &mut impl Witness) -> Result<(), RunError> {
        self.changes.fill(0);
        loop {
            let end = self.end_of_stretch(target);
            let length = end - self.time;
            self.step_ahead(length);
            let share = self.firing_ahead().map_or(1.0, |guard| self.first_change(length, guard));
            let time = if share >= 1.0 { end } else { self.time + share * length };
            self.accept(time, witness)?;
            let echoed = self.meet_breaks();
            if self.settle()? || echoed {
                self.remember_values();
                self.check_now()?;
            }
            witness.arrival(self);
            if self.time >= target || witness.has_met() {
                return Ok(());
            }
        }
    }

    /// Carries out every change that is due now, and those that follow from them; tells whether there were any.
    pub(super) fn settle(&mut self) -> Result<bool, RunError> {
        let before = self.work.changes;
        loop {
            let (mut any, mut chatters) = (false, None);
            self.program.change_modes(&self.registers, &mut self.modes, &mut self.states, |mode| {
                any = true;
                self.changes[mode] += 1;
                self.work.changes += 1;
                if self.changes[mode] > MOST_CHANGES {
                    chatters = Some(self.program.modes[mode].element);
                }
            });
            if let Some(element) = chatters {
                let element = self.program.name(element).to_owned();
                return Err(RunError::Chatter { element, most: MOST_CHANGES as usize, time: self.time });
            }
            if !any {
                return Ok(self.work.changes > before);
            }
            self.evaluate();
            self.remember_break(0);
        }
    }

    /// Transitions that can be made from the present modes.
    fn open_transitions(&self) -> impl Iterator<Item = &Transition> {
        let pairs = self.program.modes.iter().zip(&self.modes);
        pairs.flat_map(|(mode, value)| mode.transitions.iter().filter(move |open| open.from == *value))
    }

    /// The guard of a change that is due ahead.
    fn firing_ahead(&self) -> Option<Guard> {
        self.open_transitions().map(|open| open.guard).find(|guard| guard.holds(&self.trial_registers))
    }

    /// The share of the step after which the first change is due, by false position (Illinois) on its guard,
    /// kept safe by halving. Leaves the machine looking at that place.
    fn first_change(&mut self, length: f64, mut guard: Guard) -> f64 {
        let (mut low, mut low_excess) = (0.0, guard.excess(&self.registers));
        let (mut high, mut high_excess) = (1.0, guard.excess(&self.trial_registers));
        for look in 0..MOST_LOOKS {
            if high - low <= FOUND {
                break;
            }
            let middle = between(low, low_excess, high, high_excess, look % 3 == 2);
            self.step_ahead(middle * length);
            match self.firing_ahead() {
                None => {
                    (low, low_excess) = (middle, guard.excess(&self.trial_registers));
                    high_excess *= 0.5;
                }
                Some(first) => {
                    // Of another guard's past nothing is known: the next look halves.
                    low_excess = if first == guard { low_excess * 0.5 } else { f64::NAN };
                    (high, high_excess, guard) = (middle, first.excess(&self.trial_registers), first);
                }
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
