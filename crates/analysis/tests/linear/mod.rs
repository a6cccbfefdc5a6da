//! Linear analysis: roots and responses against closed solutions, runs of the machine, and SciPy.

mod delay;
mod point;
mod response;
mod roots;

use patchcord_analysis::linear::{Band, Response, Root, Transfer};
use patchcord_core::ir::{Program, StateSpace};
use patchcord_core::solve::Machine;

/// A patch that comes with the program, with parameters changed.
fn shipped(stem: &str, changes: &[(&str, f64)]) -> Program {
    crate::common::program(&crate::common::shipped(stem), changes)
}

/// The linear model in initial condition.
fn model(program: &Program) -> StateSpace {
    // Shorter than any delay and any lag here.
    Machine::new(program, 1e-5).unwrap_or_else(|error| panic!("{error}")).state_space()
}

fn roots_of(program: &Program) -> Vec<Root> {
    patchcord_analysis::linear::roots(&model(program)).unwrap_or_else(|error| panic!("{error}"))
}

fn response(program: &Program, from: &str, to: &str, band: [f64; 2]) -> Response {
    let model = model(program);
    let transfer = Transfer::new(&model, from, to).unwrap_or_else(|error| panic!("{error}"));
    transfer.over(Band { low: band[0], high: band[1] }).unwrap_or_else(|error| panic!("{error}"))
}

/// Whether numbers agree to a share of the wanted one.
fn near(found: f64, wanted: f64, share: f64) -> bool {
    (found - wanted).abs() <= share * wanted.abs()
}
