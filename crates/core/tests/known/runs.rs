//! Patches that come with the program, run, and what their runs have in common to be looked at.

use crate::common;
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::solve::{self, RunSettings};
use patchcord_core::trace::Trace;

/// The circuit of a patch such as "lessons/lorenz", with parameters changed.
pub fn circuit(stem: &str, changes: &[(&str, f64)]) -> Circuit {
    common::circuit(&common::shipped(stem), changes)
}

/// Its program.
pub fn program(stem: &str, changes: &[(&str, f64)]) -> Program {
    common::program(&common::shipped(stem), changes)
}

/// The run that a circuit's patch asks for.
pub fn settings(circuit: &Circuit) -> RunSettings {
    RunSettings::of(circuit).unwrap_or_else(|error| panic!("{error}"))
}

/// The step that a patch asks for.
pub fn step_of(stem: &str) -> f64 {
    settings(&circuit(stem, &[])).step
}

/// A run with the step that the patch asks for, and a record of its own.
pub fn recording(circuit: &Circuit, duration: f64, every: f64, record: &[&str]) -> RunSettings {
    let record = record.iter().map(|name| (*name).to_owned()).collect();
    RunSettings { every, record, ..settings(circuit).lasting(duration) }
}

/// What a run of a program gives.
pub fn ran(program: &Program, settings: &RunSettings) -> Trace {
    solve::run(program, settings).unwrap_or_else(|error| panic!("{error}"))
}

/// What a run of a circuit gives.
pub fn ran_circuit(circuit: &Circuit, settings: &RunSettings) -> Trace {
    ran(&common::program_of(circuit), settings)
}

/// A patch's own run, with parameters changed and for a time of its own.
pub fn run(stem: &str, changes: &[(&str, f64)], duration: f64) -> Trace {
    let circuit = circuit(stem, changes);
    ran_circuit(&circuit, &settings(&circuit).lasting(duration))
}

/// The same, with a record of its own.
pub fn record(stem: &str, changes: &[(&str, f64)], duration: f64, every: f64, signals: &[&str]) -> Trace {
    let circuit = circuit(stem, changes);
    ran_circuit(&circuit, &recording(&circuit, duration, every, signals))
}

/// A signal of a trace in the unit of its scale.
pub fn values(trace: &Trace, signal: &str) -> Vec<f64> {
    trace.values(signal).unwrap_or_else(|| panic!("{signal} is not recorded"))
}

/// Largest magnitude; no number where one of them is none.
pub fn peak(values: &[f64]) -> f64 {
    let larger =
        |peak: f64, value: &f64| if value.abs() > peak || value.is_nan() { value.abs() } else { peak };
    values.iter().fold(0.0, larger)
}

/// A velocity in m/s that is nothing beside any that the thesis's patches move with.
const STANDING_STILL: f64 = 1e-9;

/// Largest difference of two courses, as a share of the peak of what was expected.
pub fn difference(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let differences: Vec<f64> = found.iter().zip(expected).map(|(a, b)| a - b).collect();
    peak(&differences) / peak(expected).max(STANDING_STILL)
}
