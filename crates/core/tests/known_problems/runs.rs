//! Runs of shipped patches, and helpers that examine their traces.

use crate::common;
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::solve::{self, RunSettings};
use patchcord_core::trace::Trace;

/// The circuit of a shipped patch such as "lessons/lorenz", with these parameter values.
pub(crate) fn circuit(stem: &str, changes: &[(&str, f64)]) -> Circuit {
    common::circuit(&common::shipped(stem), changes)
}

/// The program of a shipped patch with these parameter values.
pub(crate) fn program(stem: &str, changes: &[(&str, f64)]) -> Program {
    common::program(&common::shipped(stem), changes)
}

/// The run settings of a circuit's patch.
pub(crate) fn settings(circuit: &Circuit) -> RunSettings {
    RunSettings::of(circuit).unwrap_or_else(|error| panic!("{error}"))
}

/// The step of a shipped patch in seconds.
pub(crate) fn step_of(stem: &str) -> f64 {
    settings(&circuit(stem, &[])).step
}

/// Run settings with the patch's step, but another duration, sampling interval and list of recorded signals.
pub(crate) fn recording_settings(
    circuit: &Circuit,
    duration: f64,
    every: f64,
    record: &[&str],
) -> RunSettings {
    settings(circuit).with_duration(duration).with_sample_interval(every).with_signals(record.iter().copied())
}

/// The trace of a program.
pub(crate) fn run_program(program: &Program, settings: &RunSettings) -> Trace {
    solve::run(program, settings).unwrap_or_else(|error| panic!("{error}"))
}

/// The trace of a circuit.
pub(crate) fn run_circuit(circuit: &Circuit, settings: &RunSettings) -> Trace {
    run_program(&common::program_of(circuit), settings)
}

/// The trace of a shipped patch with these parameter values and duration.
pub(crate) fn run(stem: &str, changes: &[(&str, f64)], duration: f64) -> Trace {
    let circuit = circuit(stem, changes);
    run_circuit(&circuit, &settings(&circuit).with_duration(duration))
}

/// The trace of a shipped patch with another sampling interval and list of recorded signals too.
pub(crate) fn record(
    stem: &str,
    changes: &[(&str, f64)],
    duration: f64,
    every: f64,
    signals: &[&str],
) -> Trace {
    let circuit = circuit(stem, changes);
    run_circuit(&circuit, &recording_settings(&circuit, duration, every, signals))
}

/// The samples of a signal in the unit of its scale.
pub(crate) fn values(trace: &Trace, signal: &str) -> Vec<f64> {
    trace.values(signal).unwrap_or_else(|| panic!("{signal} is not recorded"))
}

/// The largest magnitude, or NaN if a value is NaN.
pub(crate) fn peak(values: &[f64]) -> f64 {
    let larger =
        |peak: f64, value: &f64| if value.abs() > peak || value.is_nan() { value.abs() } else { peak };
    values.iter().fold(0.0, larger)
}

/// Lower bound of the peak in `difference`, so that two signals at rest can be compared. In m/s it is far below every
/// velocity of the thesis's patches.
const SMALLEST_PEAK: f64 = 1e-9;

/// The largest difference of two signals, relative to the peak of the expected one.
pub(crate) fn difference(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let differences: Vec<f64> = found.iter().zip(expected).map(|(a, b)| a - b).collect();
    peak(&differences) / peak(expected).max(SMALLEST_PEAK)
}
