//! Continues a run with another program: the states of one machine for another one.
//!
//! An operator who moves a cord or adds an element changes the program. Integrators, relays, brakes and delay lines that
//! are in both programs keep their voltages and positions.

use super::error::RunError;
use super::lamps::LitLamp;
use super::machine::{Machine, MachineMode};
use super::state::SolverState;
use crate::ir::Program;

impl Machine<'_> {
    /// Takes over time, mode, states, positions, stored values, delayed inputs and lamps from another machine.
    ///
    /// This machine is in initial condition. What belongs to elements that the other program does not have stays as it
    /// is. A state beyond the limits of its element here is at the limit.
    ///
    /// # Errors
    /// If the voltages cannot be evaluated with these states. Nothing is changed then.
    pub(super) fn take_over(&mut self, other: &Machine<'_>) -> Result<(), RunError> {
        if other.mode == MachineMode::InitialCondition {
            return Ok(());
        }
        self.transaction(|machine| {
            let (from, to) = (&other.solver, &mut machine.solver);
            let (program, old) = (to.setup.program, from.setup.program);
            copy_state((program, &mut to.state), (old, &from.state));
            for (line, delay) in to.delay_lines.iter_mut().zip(&program.lowered.delays) {
                let same = |entry: &&crate::ir::Delay| old.name(entry.element) == program.name(delay.element);
                let known = old.lowered.delays.iter().zip(&from.delay_lines);
                if let Some((_, past)) = known.into_iter().find(|(entry, _)| same(entry)) {
                    line.take_past_of(past, to.state.time);
                }
            }
            to.state.begin_levels(&to.setup);
            machine.mode = other.mode;
            machine.events.reset();
            for (element, lamp) in machine.lamps.lit.iter_mut().enumerate() {
                let known = old.element(program.name(element)).and_then(|index| other.lamps.lit[index]);
                *lamp = known.map(|known| LitLamp { element, ..known });
            }
            machine.reevaluate()
        })
    }
}

/// Copies time, states, modes and stored values of the elements that both programs have.
fn copy_state((program, to): (&Program, &mut SolverState), (old, from): (&Program, &SolverState)) {
    to.time = from.time;
    for (value, state) in to.states.iter_mut().zip(&program.lowered.states) {
        let name = program.name(state.element);
        if let Some(index) = old.lowered.states.iter().position(|known| old.name(known.element) == name) {
            let [low, high] = state.limits.map(|limit| to.voltages[limit.index()]);
            *value = from.states[index].max(low).min(high);
        }
    }
    for (value, mode) in to.modes.iter_mut().zip(&program.lowered.modes) {
        let name = program.name(mode.element);
        let mut known = old.lowered.modes.iter();
        let same =
            |known: &crate::ir::Mode| old.name(known.element) == name && known.names.mode == mode.names.mode;
        if let Some(index) = known.position(same) {
            *value = from.modes[index];
        }
    }
    for (value, sampled) in to.sampled.iter_mut().zip(&program.lowered.sampled) {
        let name = program.name(sampled.element);
        let mut known = old.lowered.sampled.iter();
        if let Some(index) = known.position(|known| old.name(known.element) == name) {
            *value = from.sampled[index];
        }
    }
}
