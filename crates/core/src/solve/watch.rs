//! Watching a machine: voltages that are no numbers, loops that do not close, overload lamps.

use super::error::RunError;
use super::machine::Machine;
use super::overload::Lit;
use crate::ir::{LAMP_LEVEL, LoopFault, Register, remedy, tell};
use crate::machines::REFERENCE;

/// So many leave less of a stretch than a time is rounded to.
const HALVINGS: usize = 50;

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

    /// Lights the lamps of amplifiers that were asked for more than they can give, within the last stretch or now.
    pub(super) fn watch_amplifiers(&mut self) {
        let program = self.program;
        for lamp in &program.lamps {
            let peak = self.lamps[lamp.element].map_or(LAMP_LEVEL, |lit| lit.peak);
            let now = (self.time, self.registers[lamp.demand.index()]);
            let turns = self.turns_beyond(lamp.demand, [-peak, peak]).into_iter().flatten();
            let (time, asked) =
                turns.fold(now, |most, turn| if turn.1.abs() > most.1.abs() { turn } else { most });
            if asked.abs() > peak {
                let time =
                    self.lamps[lamp.element].map_or_else(|| self.lit_at(lamp.demand, time), |lit| lit.time);
                light(&mut self.lamps[lamp.element], lamp.element, time, asked.abs());
            }
        }
    }

    /// When a demand passed the level on the way from the beginning of the last stretch to a time, by the curve of the
    /// states: at the beginning where it jumped there.
    fn lit_at(&mut self, demand: Register, time: f64) -> f64 {
        let (mut before, mut after) = (self.last.time, time);
        if before >= after || self.last.registers[demand.index()].abs() > LAMP_LEVEL {
            return before;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (before + after);
            self.look_back(middle);
            let is_lit = self.trial_registers[demand.index()].abs() > LAMP_LEVEL;
            *(if is_lit { &mut after } else { &mut before }) = middle;
        }
        after
    }

    /// Lights the lamps of integrators that were held at ±100 V over the last stretch and driven on, by the mean of its
    /// two ends: a stay within one step ends where the drive turns. A lag would come back by itself the more the farther
    /// it had gone.
    pub(super) fn watch_integrators(&mut self) {
        let length = self.time - self.last.time;
        for (index, state) in self.program.states.iter().enumerate() {
            let last = self.last.states[index];
            let [begin, end] = [&self.last.registers, &self.registers].map(|at| at[state.demand.index()]);
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
