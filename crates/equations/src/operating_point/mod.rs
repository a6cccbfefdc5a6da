//! Points at which a machine is evaluated: its initial condition, chosen states with settled modes, and what limits them.

mod numbers;

use patchcord_core::ir::{Mode, Op, Program, ProgramPoint, Register};
use patchcord_core::solve::{Machine, RunError};

use crate::derive::ranged;
pub(crate) use numbers::Numbers;

/// Tolerance of a machine that does not run.
const TOLERANCE: f64 = 1e-6;
/// First step of a machine that does not run, in seconds.
const FIRST_STEP: f64 = 1e-3;
/// Demanded output above which an amplifier is overloaded, in volts.
pub(crate) const OVERLOAD: f64 = 100.0 * (1.0 + 1e-6);
/// Voltage by which the input of a network may be outside its range, by rounding.
const RANGE_ROUNDING: f64 = 1e-9;

/// A machine in initial condition. Its steps adapt, so no delay and no lag is too short for it.
///
/// # Errors
/// If it cannot be set to the initial condition.
fn machine(program: &Program) -> Result<Machine<'_>, RunError> {
    Machine::adaptive(program, TOLERANCE, FIRST_STEP)
}

/// The point of the initial condition, at which modes have settled.
///
/// # Errors
/// If the machine cannot be set to it.
pub(crate) fn initial_point(program: &Program) -> Result<ProgramPoint, RunError> {
    Ok(machine(program)?.point())
}

/// The point with these voltages of the states at which modes have settled. States beyond their limits settle the modes
/// as at the limits.
///
/// # Errors
/// If the machine cannot be set to these voltages.
pub(crate) fn settled_point(program: &Program, states: &[f64]) -> Result<ProgramPoint, RunError> {
    let mut machine = machine(program)?;
    let limits = state_limits(program, &machine.point());
    for (index, name) in program.states().iter().enumerate() {
        let [low, high] = limits[index];
        let volts = states[index].max(low).min(high);
        if volts != machine.states()[index] {
            machine.set_state(name, volts)?;
        }
    }
    let mut point = machine.point();
    point.states.copy_from_slice(states);
    Ok(point)
}

/// The lower and the upper limit of every state in volts.
pub(crate) fn state_limits(program: &Program, point: &ProgramPoint) -> Vec<[f64; 2]> {
    let voltages = program.voltages_at(point);
    let at = |register: Register, otherwise: f64| {
        voltages.as_ref().map_or(otherwise, |voltages| voltages[register.index()])
    };
    let states = program.state_laws().iter();
    states.map(|state| [at(state.limits[0], -100.0), at(state.limits[1], 100.0)]).collect()
}

/// Whether a machine has elements that switch, other than drives and amplifiers at their limits.
pub(crate) fn has_switches(program: &Program) -> bool {
    let switches = |mode: &Mode| mode.names.mode != "limit" && !mode.is_drive && !mode.transitions.is_empty();
    program.modes().iter().any(switches)
}

/// The largest voltage that an amplifier demands. Infinite if one is not a number.
pub(crate) fn largest_demand(program: &Program, voltages: &[f64]) -> f64 {
    let demands = program.lamps().iter().map(|lamp| voltages[lamp.demand.index()].abs());
    let is_larger =
        |largest: f64, volts: f64| if volts > largest || volts.is_nan() { volts } else { largest };
    let largest = demands.fold(0.0, is_larger);
    if largest.is_nan() { f64::INFINITY } else { largest }
}

/// Whether the inputs of all squaring networks and logarithms are within their range.
pub(crate) fn is_in_range(program: &Program, voltages: &[f64]) -> bool {
    out_of_range(program, voltages).is_empty()
}

/// The registers that limit the inputs of squaring networks and logarithms which are outside their range.
pub(crate) fn out_of_range(program: &Program, voltages: &[f64]) -> Vec<Register> {
    let volts = |register: Register| voltages[register.index()];
    let is_outside = |register: &Register| match program.body()[register.index()] {
        Op::Maximum(input, least) => volts(input) < volts(least) - RANGE_ROUNDING,
        _ => false,
    };
    ranged(program.body()).into_iter().filter(is_outside).collect()
}
