//! Runs a scaled patch and reads the largest voltage of every output.

use patchcord_core::circuit::Circuit;
use patchcord_core::elements::OutputStage;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{RunSettings, run};
use patchcord_core::trace::{Demand, Trace};

use super::error::ScaleError;

/// The voltage of an amplifier that is driven into its limit, if the voltage that it would have without the limit is not
/// known.
const DRIVEN_VOLTS: f64 = 200.0;

/// Runs a patch and returns the largest magnitude of each of these outputs in volts. An amplifier that overloads has the
/// voltage that it would have without its limit, or 200 V if that is not known, as of integrators and open amplifiers.
///
/// # Errors
/// If the patch cannot be wired, compiled or run.
pub(super) fn measured_peaks(patch: &Patch, outputs: &[&str]) -> Result<Vec<f64>, ScaleError> {
    let circuit = Circuit::new(patch).map_err(ScaleError::Circuit)?;
    let program = Program::new(&circuit).map_err(ScaleError::Circuit)?;
    let settings = RunSettings::of(&circuit).map_err(ScaleError::Settings)?;
    let settings = settings.with_signals(outputs.iter().copied());
    let trace = run(&program, &settings).map_err(|stopped| ScaleError::Run(Box::new(stopped)))?;
    Ok(output_peaks(patch, &trace, outputs))
}

/// The largest magnitude of each of these outputs in a record of a run of the patch, in volts, as by [`measured_peaks`].
/// The record has a track for each output.
pub(crate) fn output_peaks(patch: &Patch, trace: &Trace, outputs: &[&str]) -> Vec<f64> {
    // The demand of an open amplifier is its amplification times the sum of its inputs: far more than the voltage that it
    // would have without its limit.
    let is_open = |name: &str| {
        let element = patch.elements.get(name);
        element.is_some_and(|element| element.kind.output == OutputStage::OpenAmplifier)
    };
    outputs.iter().map(|name| peak(trace, name, is_open(name))).collect()
}

/// The largest magnitude of an output in volts, or its demand if it overloads and is no open amplifier.
fn peak(trace: &Trace, name: &str, is_open: bool) -> f64 {
    let extremes = trace.track(name).map_or(&[][..], |track| &track.extremes);
    let largest = |peak: f64, volts: f64| peak.max(volts.abs());
    let reached = extremes.iter().flat_map(|run| [run.least.volts, run.most.volts]).fold(0.0, largest);
    let demands = trace.overloads().filter(|overload| overload.element == name);
    let demands = demands.map(|overload| match overload.demand {
        Demand::Peak(volts) if !is_open => volts,
        Demand::Peak(_) | Demand::Driven(_) => DRIVEN_VOLTS,
    });
    demands.fold(reached, largest)
}

#[cfg(test)]
mod tests;
