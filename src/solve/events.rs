//! Changes of mode and kinks: found within a step, stepped to, carried out.

use super::error::RunError;
use super::machine::{Machine, Witness};
use crate::program::{Crossing, Guard, ON_THE_KINK, Transition};

/// More changes of one mode, or crossings of one kink, than this within one step are chatter.
const MOST_CHANGES: u32 = 1000;
/// An event is found when its place in the step is known to this share of the step.
const FOUND: f64 = 1e-13;
/// One look in three halves at least: this many make the rest smaller than the step's rounding.
const MOST_LOOKS: usize = 150;

/// What a step must not reach across.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Event {
    /// A change of mode.
    Change(Guard),
    /// The kink of this index.
    Kink(usize, Crossing),
}

impl Event {
    /// How far past it voltages are; negative before it.
    fn excess(self, registers: &[f64]) -> f64 {
        match self {
            Event::Change(guard) => guard.excess(registers),
            Event::Kink(_, crossing) => crossing.excess(registers),
        }
    }

    /// Whether a step may end here, a little before it: on a kink either side will do.
    fn is_near(self, excess: f64) -> bool {
        matches!(self, Event::Kink(..)) && excess.abs() <= ON_THE_KINK
    }
}

impl Machine<'_> {
    /// Goes to a time, stopping for every change of mode and every echo of one on the way.
    pub(super) fn advance(&mut self, mut target: f64, witness: &mut impl Witness) -> Result<(), RunError> {
        self.changes.fill(0);
        self.crossings.fill(0);
        loop {
            let end = self.end_of_stretch(target);
            let length = end - self.time;
            self.step_ahead(length);
            let (share, met) = self.first_event(length);
            if let Some(shorter) = self.refused(share * length)? {
                target = self.time + shorter;
                continue;
            }
            let time = if share >= 1.0 { end } else { self.time + share * length };
            self.accept(time, witness)?;
            if let Some(Event::Kink(kink, _)) = met {
                self.cross(kink)?;
            }
            self.enter_event()?;
            let echoed = self.meet_breaks();
            if self.settle()? || echoed {
                self.remember_values();
                self.check_now()?;
            }
            self.leave_event()?;
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
            self.program.change_modes(
                &self.registers,
                &mut self.modes,
                &mut self.states,
                |mode, transition| {
                    any = true;
                    if let Some(own) = &mut self.sensitivities {
                        own.carry_out(self.program, &self.registers, mode, transition);
                    }
                    self.changes[mode] += 1;
                    self.work.changes += 1;
                    if self.changes[mode] > MOST_CHANGES {
                        chatters = Some(self.program.modes[mode].element);
                    }
                },
            );
            if let Some(element) = chatters {
                return Err(self.chatter(element));
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

    /// Something that happens on the way to what was looked at ahead.
    pub(super) fn event_ahead(&self) -> Option<Event> {
        let mut guards = self.open_transitions().map(|open| open.guard);
        let due = guards.find(|guard| guard.holds(&self.trial_registers)).map(Event::Change);
        due.or_else(|| self.kink_ahead())
    }

    fn kink_ahead(&self) -> Option<Event> {
        let (tables, before, after) = (&self.program.tables, &self.registers, &self.trial_registers);
        let mut kinks = self.program.kinks.iter().enumerate();
        kinks.find_map(|(index, kink)| Some(Event::Kink(index, kink.crossed(tables, before, after)?)))
    }

    /// The share of the step looked at after which the first event comes, and which it is. Leaves the machine looking
    /// at that place. What comes and goes within the step is found where the stage in its middle shows it.
    fn first_event(&mut self, length: f64) -> (f64, Option<Event>) {
        if let Some(event) = self.event_ahead() {
            let (share, event) = self.located(length, event);
            return (share, Some(event));
        }
        if !self.hint {
            return (1.0, None);
        }
        let middle = self.method.middle();
        self.step_ahead(middle * length);
        if let Some(event) = self.event_ahead() {
            let (share, event) = self.located(middle * length, event);
            return (middle * share, Some(event));
        }
        self.step_ahead(length);
        (1.0, None)
    }

    /// The share of the step looked at after which the first event comes, by false position (Illinois) on its excess,
    /// kept safe by halving.
    fn located(&mut self, length: f64, mut event: Event) -> (f64, Event) {
        let mut bracket = Bracket::new(event.excess(&self.registers), event.excess(&self.trial_registers));
        for look in 0..MOST_LOOKS {
            if bracket.width() <= FOUND {
                break;
            }
            let middle = bracket.guess(look % 8 == 7);
            self.step_ahead(middle * length);
            match self.event_ahead() {
                None => {
                    let excess = event.excess(&self.trial_registers);
                    if event.is_near(excess) {
                        return (middle, event);
                    }
                    bracket.raise(middle, excess);
                }
                Some(first) if first == event => bracket.lower(middle, event.excess(&self.trial_registers)),
                Some(first) => {
                    event = first;
                    bracket.change(middle, event.excess(&self.trial_registers));
                }
            }
        }
        self.step_ahead(bracket.high * length);
        (bracket.high, event)
    }

    /// Takes note that the machine stands on a kink: its echo will be one.
    fn cross(&mut self, kink: usize) -> Result<(), RunError> {
        self.work.crossings += 1;
        self.crossings[kink] += 1;
        if self.crossings[kink] > MOST_CHANGES {
            return Err(self.chatter(self.program.kinks[kink].element));
        }
        self.remember_break(0);
        Ok(())
    }

    fn chatter(&self, element: usize) -> RunError {
        let element = self.program.name(element).to_owned();
        RunError::Chatter { element, most: MOST_CHANGES as usize, time: self.time }
    }
}

/// Shares of a step between which an event comes, with its excess at both.
struct Bracket {
    low: f64,
    high: f64,
    low_excess: f64,
    high_excess: f64,
    /// Which end was moved last: -1 the lower, 1 the upper one, 0 none yet.
    moved: i8,
}

impl Bracket {
    fn new(low_excess: f64, high_excess: f64) -> Self {
        Bracket { low: 0.0, high: 1.0, low_excess, high_excess, moved: 0 }
    }

    fn width(&self) -> f64 {
        self.high - self.low
    }

    /// A place strictly between the ends: where the straight line between the excesses is 0, or half-way.
    fn guess(&self, halve: bool) -> f64 {
        let width = self.width();
        let line = self.low + width * self.low_excess / (self.low_excess - self.high_excess);
        let edge = FOUND.max(width * 1e-3) * 0.5;
        if halve || !line.is_finite() {
            self.low + 0.5 * width
        } else {
            line.clamp(self.low + edge, self.high - edge)
        }
    }

    /// Moves the lower end. An upper end that stays twice counts half (Illinois).
    fn raise(&mut self, to: f64, excess: f64) {
        (self.low, self.low_excess) = (to, excess);
        if self.moved == -1 {
            self.high_excess *= 0.5;
        }
        self.moved = -1;
    }

    /// Moves the upper end; the same for the lower one.
    fn lower(&mut self, to: f64, excess: f64) {
        (self.high, self.high_excess) = (to, excess);
        if self.moved == 1 {
            self.low_excess *= 0.5;
        }
        self.moved = 1;
    }

    /// Moves the upper end to where another event has come, of whose past nothing is known: the next guess halves.
    fn change(&mut self, to: f64, excess: f64) {
        (self.high, self.high_excess, self.low_excess, self.moved) = (to, excess, f64::NAN, 0);
    }
}
