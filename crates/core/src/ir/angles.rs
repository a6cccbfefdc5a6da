//! Angles: what periodic functions are taken of. A step that goes on by whole periods would see nothing move.

use std::f64::consts::TAU;

use super::Program;
use super::op::{Op, Register};
use patchcord_expr::Function;

/// What a periodic function is taken of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Angle {
    /// Whose law it stands in.
    pub element: usize,
    at: Register,
    period: f64,
}

impl Angle {
    /// How many periods lie between some voltages and others.
    pub fn periods(&self, before: &[f64], after: &[f64]) -> f64 {
        (after[self.at.index()] - before[self.at.index()]).abs() / self.period
    }
}

impl Program {
    /// The angles that move within a step; `owners` tells whose law each operation is.
    pub(crate) fn find_angles(&self, owners: &[usize]) -> Vec<Angle> {
        let moving = self.moving(|op| matches!(op, Op::State(_) | Op::Time | Op::Delayed(_) | Op::Tear(_)));
        let angles = self.body.iter().zip(owners).filter_map(|(op, owner)| {
            let (at, period) = match *op {
                Op::Call(Function::Sin | Function::Cos, at, _) => (at, TAU),
                Op::Call(Function::Floor, at, _) => (at, 1.0),
                _ => return None,
            };
            moving[at.index()].then_some(Angle { element: *owner, at, period })
        });
        angles.collect()
    }
}
