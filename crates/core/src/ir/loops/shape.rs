//! The shape of loops, found once per program: what their operations read, and whether they are straight.

use std::collections::BTreeSet;

use crate::ir::{Op, Program, Register};

impl Program {
    /// Describes the loops of a body that is in its final order.
    pub(crate) fn describe_loops(&mut self) {
        for index in 0..self.lowered.loops.len() {
            let entry = &self.lowered.loops[index];
            let first = entry.tears[0].register;
            let operations = &self.lowered.body[entry.operations.clone()];
            let inputs: BTreeSet<Register> =
                operations.iter().flat_map(|op| op.operands()).filter(|operand| *operand < first).collect();
            let is_straight = operations.iter().all(|op| is_straight(*op, |operand| operand >= first));
            let entry = &mut self.lowered_mut().loops[index];
            (entry.inputs, entry.is_straight) = (inputs.into_iter().collect(), is_straight);
        }
    }
}

/// Whether an operation of a loop is piecewise linear. `varies` says whether an operand depends on a tear.
fn is_straight(op: Op, varies: impl Fn(Register) -> bool) -> bool {
    match op {
        Op::Multiply(a, b) => !(varies(a) && varies(b)),
        Op::Divide(_, b) => !varies(b),
        Op::Call(..) => false,
        // A comparison that varies makes the loop jump.
        Op::Select { left, right, .. } => !varies(left) && !varies(right),
        _ => true,
    }
}
