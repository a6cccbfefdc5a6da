//! Angles: the arguments of periodic functions.
//!
//! A step over a whole number of periods sees no change at its ends. The solver therefore limits how many periods an
//! angle may advance in one step.

use std::f64::consts::TAU;

use super::Program;
use super::op::{Op, Register};
use patchcord_expr::Function;

/// The argument of a sine, a cosine or a fraction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Angle {
    /// Index of the element whose law contains it.
    pub element: usize,
    /// Register of the argument.
    at: Register,
    /// Period of the function in the unit of the argument: 2 pi for sine and cosine, 1 for a fraction.
    period: f64,
}

impl Angle {
    /// The number of periods between two evaluations of the body.
    pub(crate) fn periods(&self, before: &[f64], after: &[f64]) -> f64 {
        (after[self.at.index()] - before[self.at.index()]).abs() / self.period
    }
}

impl Program {
    /// The angles that vary within a step. `owners` has the element of every operation.
    pub(crate) fn find_angles(&self, owners: &[usize]) -> Vec<Angle> {
        let varying = self.varying();
        let angles = self.lowered.body.iter().zip(owners).filter_map(|(op, owner)| {
            let (at, period) = match *op {
                Op::Call(Function::Sin | Function::Cos, at, _) => (at, TAU),
                Op::Call(Function::Floor, at, _) => (at, 1.0),
                _ => return None,
            };
            varying[at.index()].then_some(Angle { element: *owner, at, period })
        });
        angles.collect()
    }
}
