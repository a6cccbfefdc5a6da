//! Traps at the start of a run: initial conditions at a limit, and loops without an integrator that shift the start.

mod limit;
mod loops;

use patchcord_core::circuit::Circuit;
use patchcord_core::document::Diagnostic;
use patchcord_core::ir::Program;
use patchcord_core::machines::REFERENCE;
use patchcord_core::solve::Machine;

use super::check_size;

/// Distance from the limit, in volts, up to which an initial voltage is at the limit.
const LIMIT_TOLERANCE: f64 = 1e-6;

/// The warnings about the start of a patch.
///
/// * `initial-at-limit`: an integrator or lag begins at ±100 V, and its rate points outward or its feedback to itself does
///   not draw it back. A lag, or a state with feedback of its own like one, is not reported if its rate does not point
///   outward: such a state often is a share that begins at 1.
/// * `loop-shifts-start`: an amplifier that repeats an integrator is also in a loop without an integrator, which changes
///   its voltage at the start. The loop is intended if it contains an open amplifier, or if the patch states its
///   equations: these are compared with the wiring.
///
/// `machine` makes the machine in initial condition. It is only called if there may be a warning, and there is none if it
/// gives `None`.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::linear::start_warnings;
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::Machine;
///
/// // dx/dt = x, from 100 V
/// let growth = ElementBuilder::new("integrator").cords("x1", ["B"]).set("initial", 100);
/// let patch = PatchBuilder::new("growth").element("A", growth);
/// let patch = patch.element("B", ElementBuilder::new("inverter").cord("in", "A")).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let program = Program::new(&circuit)?;
/// let warnings = start_warnings(&circuit, &program, || Machine::new(&program, 1e-3).ok());
/// assert_eq!(warnings[0].code.as_str(), "initial-at-limit");
/// assert_eq!(
///     warnings[0].message,
///     "A begins at 100 V, its limit, and rises by 100 V/s at the start: it is overloaded at once"
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn start_warnings<'p>(
    circuit: &Circuit,
    program: &'p Program,
    machine: impl FnOnce() -> Option<Machine<'p>>,
) -> Vec<Diagnostic> {
    let begins_at_limit = program.initial_point().states.iter().any(|volts| is_at_limit(*volts));
    let has_loops = circuit.patch().equations.is_empty() && loops::plain_loops(program).next().is_some();
    if !(begins_at_limit || has_loops) || check_size(program).is_err() {
        return Vec::new();
    }
    let Some(machine) = machine() else { return Vec::new() };
    let mut warnings = Vec::new();
    if begins_at_limit {
        warnings.extend(limit::warnings(circuit, &machine.state_space()));
    }
    if has_loops {
        warnings.extend(loops::warnings(circuit, program, &machine));
    }
    warnings
}

/// Whether a voltage is at a limit of the amplifiers.
fn is_at_limit(volts: f64) -> bool {
    volts.abs() >= REFERENCE - LIMIT_TOLERANCE
}

#[cfg(test)]
mod tests;
