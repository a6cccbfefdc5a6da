//! Runs a scaled patch and reads the largest voltage of every output, and the overloads.

use patchcord_core::elements::OutputStage;
use patchcord_core::ir::Program;
use patchcord_core::machines::REFERENCE;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{RunSettings, run};
use patchcord_core::trace::{Overload, Trace};

use super::error::ScaleError;
use super::inventory::unlimited_circuit;

/// The voltages of a run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Measured {
    /// The largest magnitude of each output in volts. An amplifier that overloads has the voltage that it would have
    /// without its limit, or 100 V if that is not known.
    pub volts: Vec<f64>,
    /// The overloads that no other overload causes, one for each amplifier.
    pub overloads: Vec<OverloadedAmplifier>,
}

/// An amplifier that overloads.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct OverloadedAmplifier {
    /// The element.
    pub element: String,
    /// The voltage that it would have without its limit. `None` if that is not known, as of integrators in a loop and open
    /// amplifiers.
    pub demand: Option<f64>,
}

/// Runs a patch and reads the voltages of these outputs. The machine has as many parts as the patch needs.
///
/// # Errors
/// If the patch cannot be wired, compiled or run.
pub(super) fn measured(patch: &Patch, outputs: &[&str]) -> Result<Measured, ScaleError> {
    let circuit = unlimited_circuit(patch)?;
    let program = Program::new(&circuit).map_err(ScaleError::Circuit)?;
    let mut settings = RunSettings::of(&circuit).map_err(ScaleError::Settings)?;
    // A hold would hide how large the voltages become after the first overload.
    settings.hold_on_overload = false;
    let settings = settings.with_signals(outputs.iter().copied());
    let trace = run(&program, &settings).map_err(|stopped| ScaleError::Run(Box::new(stopped)))?;
    Ok(Measured { volts: output_peaks(patch, &trace, outputs), overloads: overloads(patch, &trace) })
}

/// The largest magnitude of each of these outputs in the record of a run of a patch, in volts. See [`Measured::volts`].
pub(crate) fn output_peaks(patch: &Patch, trace: &Trace, outputs: &[&str]) -> Vec<f64> {
    outputs.iter().map(|name| peak(patch, trace, name)).collect()
}

/// The largest magnitude of an output in volts, or its demand if it overloads.
fn peak(patch: &Patch, trace: &Trace, name: &str) -> f64 {
    let extremes = trace.track(name).map_or(&[][..], |track| &track.extremes);
    let largest = |peak: f64, volts: f64| peak.max(volts.abs());
    let reached = extremes.iter().flat_map(|run| [run.least.volts, run.most.volts]).fold(0.0, largest);
    let overloads = trace.overloads().filter(|overload| overload.element == name);
    overloads.map(|overload| demand(patch, overload).unwrap_or(REFERENCE)).fold(reached, largest)
}

/// The voltage that an amplifier would have without its limit. `None` if it is not known.
///
/// The demand of an open amplifier is its amplification times the sum of its inputs: far more than the voltage that it
/// would have without its limit.
fn demand(patch: &Patch, overload: &Overload) -> Option<f64> {
    let element = patch.elements.get(&overload.element);
    let is_open = element.is_some_and(|element| element.kind.output == OutputStage::OpenAmplifier);
    overload.peak().filter(|_| !is_open)
}

/// The overloads that no other one causes, or all if each has a cause. An amplifier that overloads in several repetitions
/// has its largest demand.
fn overloads(patch: &Patch, trace: &Trace) -> Vec<OverloadedAmplifier> {
    let has_first = trace.overloads().any(|overload| overload.caused_by.is_none());
    let mut found: Vec<OverloadedAmplifier> = Vec::new();
    for overload in trace.overloads().filter(|overload| overload.caused_by.is_none() || !has_first) {
        let demand = demand(patch, overload);
        match found.iter_mut().find(|known| known.element == overload.element) {
            Some(known) => known.demand = known.demand.zip(demand).map(|(one, other)| one.max(other)),
            None => found.push(OverloadedAmplifier { element: overload.element.clone(), demand }),
        }
    }
    found
}

#[cfg(test)]
mod tests;
