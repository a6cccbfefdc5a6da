//! Changes of mode and kinks: found within a step, stepped to, carried out.

use super::control::CHATTER;
use super::error::RunError;
use super::locate::{self, Ahead};
use super::machine::{Machine, Witness};
use crate::ir::{Calm, Crossing, Guard, Kink, ON_THE_KINK, Transition};

/// More changes of one mode, or crossings of one kink, than this within one of equal steps are chatter; with a tolerance,
/// within a share of the first step tried ([`CHATTER`]).
const MOST_CHANGES: u32 = 1000;

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
}

impl Ahead for Machine<'_> {
    type Event = Event;

    fn look(&mut self, length: f64) {
        self.step_ahead(length);
    }

    /// Something that happens on the way to what was looked at ahead.
    fn event(&self) -> Option<Event> {
        self.event_at(&self.trial_registers)
    }

    fn is_hinted(&self) -> bool {
        self.hint.is_some()
    }

    fn middle(&self) -> f64 {
        self.hint.unwrap_or(1.0)
    }

    fn excess_now(&self, event: Event) -> f64 {
        event.excess(&self.registers)
    }

    fn excess(&self, event: Event) -> f64 {
        event.excess(&self.trial_registers)
    }

    fn room(&self, event: Event) -> f64 {
        if matches!(event, Event::Kink(..)) { ON_THE_KINK } else { 0.0 }
    }
}

impl Machine<'_> {
    /// Goes to a time, stopping for every change of mode and every echo of one on the way.
    pub(super) fn advance(&mut self, target: f64, witness: &mut impl Witness) -> Result<(), RunError> {
        self.count_anew();
        self.go_to(target, None, witness)
    }

    /// The same, and goes on to count what switches. The first may be known to be a change of mode, about so much later.
    pub(super) fn go_to(
        &mut self,
        mut target: f64,
        mut change: Option<f64>,
        witness: &mut impl Witness,
    ) -> Result<(), RunError> {
        if let Some(later) = change
            && self.go_to_change(later, target, witness)?
        {
            change = None;
        }
        while self.time < target && !witness.has_met() {
            let end = self.end_of_stretch(target);
            let length = end - self.time;
            self.step_ahead(length);
            if let Some(shorter) = self.turned_too_far(length)? {
                target = self.time + shorter;
                continue;
            }
            let near = change.take().map(|later| later / length);
            let (share, met) = locate::first_event(self, length, near);
            if let Some(shorter) = self.refused(share * length)? {
                target = self.time + shorter;
                continue;
            }
            let time = if share >= 1.0 { end } else { self.time + share * length };
            self.accept(time, witness)?;
            if let Some(Event::Kink(kink, _)) = met {
                self.cross(kink)?;
            }
            self.arrive(witness)?;
            if self.control.is_some() {
                break;
            }
        }
        Ok(())
    }

    /// Goes in one step to where a flight has found a change of mode on the way to a time, and carries it out; tells whether it
    /// is due there.
    fn go_to_change(
        &mut self,
        length: f64,
        target: f64,
        witness: &mut impl Witness,
    ) -> Result<bool, RunError> {
        self.step_ahead(length);
        let is_due = matches!(self.event(), Some(Event::Change(_))) && !self.is_hinted();
        if is_due {
            let is_whole = length >= target - self.time;
            self.accept(if is_whole { target } else { self.time + length }, witness)?;
            self.arrive(witness)?;
        }
        Ok(is_due)
    }

    /// Carries out what is due where a stretch has ended.
    pub(super) fn arrive(&mut self, witness: &mut impl Witness) -> Result<(), RunError> {
        self.enter_event()?;
        let echoed = self.meet_breaks();
        if self.settle()? || echoed {
            self.remember_values();
            self.check_now()?;
        }
        self.leave_event()?;
        witness.arrival(self);
        Ok(())
    }

    /// Begins to count what switches anew: with every one of equal steps, else after a span of time.
    pub(super) fn count_anew(&mut self) {
        if self.control.as_mut().is_none_or(|control| control.counts_anew(self.time, self.step)) {
            self.changes.fill(0);
            self.crossings.fill(0);
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
                        chatters = Some(&self.program.modes[mode]);
                    }
                },
            );
            if let Some(mode) = chatters {
                return Err(self.chatter(mode.element, mode.calmed_by));
            }
            if !any {
                return Ok(self.work.changes > before);
            }
            self.evaluate();
            self.remember_break();
        }
    }

    /// Transitions that can be made from the present modes.
    pub(super) fn open_transitions(&self) -> impl Iterator<Item = &Transition> {
        let pairs = self.program.modes.iter().zip(&self.modes);
        pairs.flat_map(|(mode, value)| mode.transitions.iter().filter(move |open| open.from == *value))
    }

    /// Something that happens on the way from the present to these voltages.
    pub(super) fn event_at(&self, registers: &[f64]) -> Option<Event> {
        let mut guards = self.open_transitions().map(|open| open.guard);
        let due = guards.find(|guard| guard.holds(registers)).map(Event::Change);
        due.or_else(|| self.kink_on_the_way_to(registers))
    }

    /// The kinks that no step reaches across. Those that guards alone have matter where long steps could miss what comes and
    /// goes behind them.
    pub(super) fn kinks(&self) -> impl Iterator<Item = &Kink> {
        let of_guards = if self.control.is_some() { self.program.guard_kinks.as_slice() } else { &[] };
        self.program.kinks.iter().chain(of_guards)
    }

    fn kink_on_the_way_to(&self, registers: &[f64]) -> Option<Event> {
        self.kinks().enumerate().find_map(|(index, kink)| {
            let [from, to] = [&self.registers, registers].map(|voltages| kink.value(voltages));
            Some(Event::Kink(index, kink.crossed(&self.program.tables, from, to)?))
        })
    }

    /// Takes note that the machine stands on a kink: its echo will be one.
    fn cross(&mut self, index: usize) -> Result<(), RunError> {
        self.work.crossings += 1;
        self.crossings[index] += 1;
        if let Some(kink) = self.kinks().nth(index).filter(|_| self.crossings[index] > MOST_CHANGES) {
            return Err(self.chatter(kink.element, Calm::Drive));
        }
        self.remember_break();
        Ok(())
    }

    fn chatter(&self, element: usize, calmed_by: Calm) -> RunError {
        let element = self.program.name(element).to_owned();
        let within = if self.control.is_some() { CHATTER * self.step } else { self.step };
        let advice = match (calmed_by, &self.control) {
            (Calm::Rest, _) => "give it a larger \"rest\": what is thrown back below it stays at the stop",
            (Calm::Hysteresis, None) => "give it hysteresis, or take a shorter step",
            (Calm::Hysteresis, Some(_)) => "give it hysteresis",
            (Calm::Drive, None) => "look for what drives it to and fro, or take a shorter step",
            (Calm::Drive, Some(_)) => "look for what drives it to and fro",
        };
        RunError::Chatter { element, most: MOST_CHANGES as usize, within, time: self.time, advice }
    }
}
