//! Watching a machine: voltages that are no numbers, loops that do not close, overload lamps.

use super::error::RunError;
use super::machine::Machine;
use super::overload::Lit;
use crate::machines::REFERENCE;
use crate::program::{LAMP_LEVEL, LoopFault, remedy, tell};

impl Machine<'_> {
    pub(super) fn check_voltages(&self) -> Result<(), RunError> {
        if let Some(&LoopFault { index, solutions }) = self.scratch.faults.first() {
            let entry = &self.program.loops[index];
            return Err(RunError::Loop {
                members: entry.members.join(", "),
                opened: entry.opened().to_owned(),
                solutions: tell(entry, solutions),
                advice: remedy(entry, solutions).1,
                time: self.time,
            });
        }
        match self.program.in_order().find(|outlet| self.registers[outlet.register.index()].is_nan()) {
            Some(outlet) => Err(RunError::NotANumber { element: outlet.name.clone(), time: self.time }),
            None => Ok(()),
        }
    }

    /// Lights the lamps of amplifiers that are asked for more than they can give.
    pub(super) fn watch_amplifiers(&mut self) {
        for lamp in &self.program.lamps {
            let asked = self.registers[lamp.demand.index()].abs();
            if asked > LAMP_LEVEL {
                let before = self.trial_registers[lamp.demand.index()].abs();
                let time = lit_at(self.last.time, before, self.time, asked);
                light(&mut self.lamps[lamp.element], lamp.element, time, asked);
            }
        }
    }

    /// Lights the lamps of integrators that were held at ±100 V over the last stretch and driven on, by the mean of its
    /// two ends: a stay within one step ends where the drive turns. A lag would come back by itself the more the farther
    /// it had gone.
    pub(super) fn watch_integrators(&mut self) {
        let length = self.time - self.last.time;
        for (index, state) in self.program.states.iter().enumerate() {
            let last = self.last.states[index];
            let [begin, end] = [&self.trial_registers, &self.registers].map(|at| at[state.demand.index()]);
            let outward = 0.5 * (begin + end) * last.signum();
            let held = last.abs() >= REFERENCE && outward > 0.0;
            let time = state.lag.map_or(f64::INFINITY, |lag| self.time_of(lag));
            let pushed = &mut self.pushed[index];
            let kept = 1.0 / (1.0 + length / time);
            *pushed = if held { (*pushed + length * outward) * kept } else { 0.0 };
            let asked = REFERENCE + *pushed;
            if asked > LAMP_LEVEL {
                light(&mut self.lamps[state.element], state.element, self.last.time, asked);
            }
        }
    }
}

fn light(lamp: &mut Option<Lit>, element: usize, time: f64, asked: f64) {
    let lit = lamp.get_or_insert(Lit { element, time, peak: asked });
    lit.peak = lit.peak.max(asked);
}

/// When a demand passed the level: at the beginning of a stretch where it jumped there, else on the straight
/// line between its ends.
fn lit_at(begin: f64, before: f64, end: f64, after: f64) -> f64 {
    if before > LAMP_LEVEL {
        return begin;
    }
    let share = (LAMP_LEVEL - before) / (after - before);
    if share < 1.0 { begin + share * (end - begin) } else { end }
}
