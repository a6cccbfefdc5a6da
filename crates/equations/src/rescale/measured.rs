//! A patch with a run of it, and the peaks of its outputs.

use std::collections::BTreeSet;

use patchcord_core::circuit::Circuit;
use patchcord_core::document::Report;
use patchcord_core::elements::Family;
use patchcord_core::ir::Program;
use patchcord_core::machines::REFERENCE;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{RunSettings, run};
use patchcord_core::trace::Trace;

use super::error::RescaleError;
use crate::scaled::output_peaks;

/// Rounding of a voltage, as a share.
const ROUNDING: f64 = 1e-9;

/// A patch with a run of it.
pub(super) struct Measured {
    pub circuit: Circuit,
    pub program: Program,
    /// The record of all outputs.
    pub trace: Trace,
    /// The peak of each output in volts, by the index of the element. References have 0.
    pub peaks: Vec<f64>,
    /// The amplifiers that overload, without those that reach 100 V by rounding.
    pub overloads: BTreeSet<String>,
}

impl Measured {
    /// Runs a patch. `fault` makes the error for a patch that cannot be wired.
    ///
    /// # Errors
    /// If the patch cannot be wired, compiled or run.
    pub(super) fn new(patch: &Patch, fault: fn(Box<Report>) -> RescaleError) -> Result<Self, RescaleError> {
        let circuit = Circuit::new(patch).map_err(fault)?;
        let program = Program::new(&circuit).map_err(fault)?;
        let elements = circuit.elements();
        let is_output = |index: &usize| elements[*index].kind.family != Family::Reference;
        let indices: Vec<usize> = (0..elements.len()).filter(is_output).collect();
        let names: Vec<&str> = indices.iter().map(|index| elements[*index].name.as_str()).collect();
        let mut settings = RunSettings::of(&circuit).map_err(RescaleError::Settings)?;
        // A hold would hide how large the voltages become after the first overload.
        settings.hold_on_overload = false;
        let settings =
            settings.with_signals(names.iter().copied()).with_sensitivities(std::iter::empty::<String>());
        let trace = run(&program, &settings).map_err(|stopped| RescaleError::Run(Box::new(stopped)))?;
        let mut peaks = vec![0.0; elements.len()];
        for (index, peak) in indices.iter().zip(output_peaks(circuit.patch(), &trace, &names)) {
            peaks[*index] = peak;
        }
        let is_above = |volts: f64| volts.abs() > REFERENCE * (1.0 + ROUNDING);
        let overloads = trace.overloads().filter(|overload| overload.peak().is_none_or(is_above));
        let overloads: BTreeSet<String> = overloads.map(|overload| overload.element.clone()).collect();
        Ok(Measured { circuit, program, trace, peaks, overloads })
    }
}
