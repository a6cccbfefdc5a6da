//! Loops without an integrator that shift the start of a quantity.
//!
//! The output of an integrator at the start is its initial value. An amplifier that repeats it, such as an inverter,
//! begins with the same voltage. If one more cord leads from the output of this amplifier back to its input, the loop
//! has no integrator. It divides the voltage by 1 plus the gain of the loop, at the start and later.

use crate::instruments::inverted_by;
use crate::linear::codes;
use crate::linear::growth::shortest_path;
use patchcord_core::circuit::{Circuit, Cord};
use patchcord_core::document::{Diagnostic, format_number, unit_suffix};
use patchcord_core::elements::{OutputStage, Transfer};
use patchcord_core::ir::{Loop, Program};
use patchcord_core::solve::Machine;

/// Shift of a voltage at the start from which it is reported, in volts: 0.1 % of full scale.
const LEAST_SHIFT: f64 = 0.1;

/// An amplifier whose voltage at the start a loop shifts.
struct ShiftedAmplifier {
    /// Index of the element.
    element: usize,
    /// Index of the first element of the loop that drives it.
    feedback: usize,
    /// Its voltage at the start, in volts.
    volts: f64,
    /// The voltage that its inputs from outside the loop alone would give, in volts.
    volts_alone: f64,
}

/// The loops of a program that have no open amplifier. An open amplifier always needs a loop.
pub(super) fn plain_loops(program: &Program) -> impl Iterator<Item = &Loop> {
    program.loops().iter().filter(|entry| entry.tears.iter().all(|tear| tear.amplification.is_none()))
}

/// The warnings about the loops of a program, at most one for each. The machine is in initial condition.
pub(super) fn warnings(circuit: &Circuit, program: &Program, machine: &Machine<'_>) -> Vec<Diagnostic> {
    plain_loops(program).filter_map(|entry| warning(circuit, machine, entry)).collect()
}

/// The warning about a loop. `None` if it shifts no voltage that an integrator alone would determine.
fn warning(circuit: &Circuit, machine: &Machine<'_>, entry: &Loop) -> Option<Diagnostic> {
    let elements = circuit.elements();
    let is_member = |element: &usize| entry.members.contains(&elements[*element].name);
    let members: Vec<usize> = (0..elements.len()).filter(is_member).collect();
    let shifted = members.iter().find_map(|member| shifted(circuit, machine, &members, *member))?;
    let name = &elements[shifted.element].name;
    let path = shortest_path(circuit, [shifted.element; 2], |element| members.contains(&element));
    let others = path.iter().map(|element| format!(" -> {}", elements[*element].name));
    let [begin, alone] =
        [shifted.volts, shifted.volts_alone].map(|volts| quantity(circuit, shifted.element, volts));
    let message = format!(
        "the loop {name}{} has no integrator and shifts the start: {} begins at {begin}, but without the loop at {alone}",
        others.collect::<String>(),
        signal_name(circuit, shifted.element)
    );
    let hint = format!(
        "take the cord from {} out of {name}, or plug it into an integrator; if the loop is intended, state the equations \
         of the patch",
        elements[shifted.feedback].name
    );
    let span = circuit.patch().elements.get(name)?.span;
    Some(Diagnostic::at(codes::LOOP_SHIFTS_START, span, message).hint(hint))
}

/// A member of a loop with its shift. `None` if it is no plain summer or inverter, if no integrator drives it from outside
/// the loop, or if its voltage at the start is not shifted.
fn shifted(
    circuit: &Circuit,
    machine: &Machine<'_>,
    members: &[usize],
    element: usize,
) -> Option<ShiftedAmplifier> {
    let entry = circuit.element(element);
    let is_plain = entry.kind.transfer == Transfer::Inverting && entry.settings.iter().all(Option::is_none);
    let cords = circuit.cords(element);
    let (inside, outside) = cords.iter().partition::<Vec<_>, _>(|(from, _)| members.contains(from));
    if !is_plain || !outside.iter().any(|(from, _)| repeats_integrator(circuit, *from)) {
        return None;
    }
    let feedback = inside.first()?.0;
    let volts = |element: usize| machine.voltage(&circuit.element(element).name).ok();
    let share = |(from, cord): &(usize, Cord)| Some(cord.gain * volts(*from)?);
    let sum: f64 = outside.iter().map(share).sum::<Option<f64>>()?;
    let (volts, volts_alone) = (volts(element)?, -sum);
    let is_shifted = volts_alone.abs() >= LEAST_SHIFT && (volts - volts_alone).abs() >= LEAST_SHIFT;
    is_shifted.then_some(ShiftedAmplifier { element, feedback, volts, volts_alone })
}

/// Whether an output is that of an integrator or a lag, or of an amplifier that only inverts one.
fn repeats_integrator(circuit: &Circuit, element: usize) -> bool {
    let integrates = |element: usize| circuit.element(element).kind.output == OutputStage::Integrator;
    integrates(element) || inverted_by(circuit, element).is_some_and(integrates)
}

/// The first signal with a scale at an element and its value per volt, with its unit.
fn signal_at(circuit: &Circuit, element: usize) -> Option<(&str, f64, &str)> {
    circuit.signals().iter().filter(|point| point.element == element).find_map(|point| {
        let scale = point.scale?;
        let per_volt = circuit.per_volt(scale)? * point.factor;
        Some((point.name.as_str(), per_volt, circuit.derived_unit(scale).text()))
    })
}

/// The signal at an element, and the element: "x at B1". Without a signal it is the element alone.
fn signal_name(circuit: &Circuit, element: usize) -> String {
    let name = &circuit.element(element).name;
    match signal_at(circuit, element) {
        Some((signal, ..)) if signal != name => format!("{signal} at {name}"),
        _ => name.clone(),
    }
}

/// A voltage of an element in the unit of its signal, or in volts.
fn quantity(circuit: &Circuit, element: usize, volts: f64) -> String {
    let (per_volt, unit) =
        signal_at(circuit, element).map_or((1.0, "V"), |(_, per_volt, unit)| (per_volt, unit));
    format!("{}{}", format_number(volts * per_volt), unit_suffix(unit))
}
