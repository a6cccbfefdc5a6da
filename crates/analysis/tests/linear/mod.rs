//! Linear analysis: roots and responses compared with closed solutions, runs of the machine, and SciPy.

mod delay;
mod point;
mod response;
mod roots;

use patchcord_analysis::linear::{FrequencyBand, FrequencyResponse, Root, TransferFunction};
use patchcord_core::ir::{Program, StateSpace};
use patchcord_core::solve::Machine;

/// A shipped patch with changed parameters.
fn shipped(stem: &str, changes: &[(&str, f64)]) -> Program {
    crate::common::program(&crate::common::shipped(stem), changes)
}

/// The linear model in initial condition.
fn model(program: &Program) -> StateSpace {
    // The step is shorter than any delay or lag of these tests.
    Machine::new(program, 1e-5).unwrap_or_else(|error| panic!("{error}")).state_space()
}

/// The characteristic roots in initial condition.
fn roots_of(program: &Program) -> Vec<Root> {
    patchcord_analysis::linear::roots(&model(program)).unwrap_or_else(|error| panic!("{error}"))
}

/// The frequency response between a drive and a signal, over a band in Hz.
fn response(program: &Program, from: &str, to: &str, band: [f64; 2]) -> FrequencyResponse {
    let model = model(program);
    let transfer = TransferFunction::new(&model, from, to).unwrap_or_else(|error| panic!("{error}"));
    transfer.response(FrequencyBand { low: band[0], high: band[1] }).unwrap_or_else(|error| panic!("{error}"))
}

/// Whether two numbers agree within a fraction of the expected one.
fn near(found: f64, expected: f64, tolerance: f64) -> bool {
    (found - expected).abs() <= tolerance * expected.abs()
}
