//! The operations of a kernel on slots, and the interpreter that runs them on one or several lanes.
//!
//! A kernel has few kinds of operations, because signs, gains and settings are parts of the factors. The interpreter
//! here and native code run the same instructions in the same order, so both give the same bits.

use super::lane::Lane;
use crate::ir::Number;
use patchcord_expr::Function;

/// Index of a value in a frame. Factors come first, then the values that vary.
pub(super) type Slot = u32;

/// An operation on slots. It reads slots that are already computed and writes `out`.
#[derive(Debug, Clone, Copy)]
pub(super) enum Instruction {
    /// out = constant + factor x a, as one fused multiply-add: a form with one term.
    Line { out: Slot, constant: Slot, factor: Slot, a: Slot },
    /// out = constant + the sum of a range of terms: a form with several terms.
    Sum {
        out: Slot,
        constant: Slot,
        /// Index of the first term in [`Code::terms`].
        first: u32,
        /// Number of terms.
        count: u32,
    },
    /// out = a x b: a product of two voltages, or a form with one term and without a constant.
    Multiply { out: Slot, a: Slot, b: Slot },
    /// out = b if b < a, otherwise a.
    Minimum { out: Slot, a: Slot, b: Slot },
    /// out = b if b > a, otherwise a.
    Maximum { out: Slot, a: Slot, b: Slot },
    /// out = |a|.
    Absolute { out: Slot, a: Slot },
    /// out = function(a, b). Functions of one argument get it twice.
    Call { out: Slot, function: Function, a: Slot, b: Slot },
    /// out = the value of a table at the abscissa a, for curves that are not split into segments.
    Table { out: Slot, table: u32, a: Slot },
}

/// A list of operations, with the terms of its sums.
#[derive(Debug, Clone, Default)]
pub(super) struct Code {
    /// The operations, in order of evaluation.
    pub instructions: Vec<Instruction>,
    /// The slots of factor and voltage of every term.
    pub terms: Vec<(Slot, Slot)>,
}

impl Code {
    /// Runs the operations. A sum starts with the constant and adds one term after the other. Each term is one fused
    /// multiply-add, which is rounded once.
    #[inline(always)]
    pub(super) fn run<V: Lane>(&self, slots: &mut [V], tables: &[Vec<[f64; 2]>]) {
        for instruction in &self.instructions {
            let (out, value) = match *instruction {
                Instruction::Line { out, constant, factor, a } => {
                    let sum = slots[constant as usize];
                    (out, slots[factor as usize].multiply_add(slots[a as usize], sum))
                }
                Instruction::Sum { out, constant, first, count } => {
                    let terms = &self.terms[first as usize..(first + count) as usize];
                    let mut sum = slots[constant as usize];
                    for (factor, a) in terms {
                        sum = slots[*factor as usize].multiply_add(slots[*a as usize], sum);
                    }
                    (out, sum)
                }
                Instruction::Multiply { out, a, b } => (out, slots[a as usize].multiply(slots[b as usize])),
                Instruction::Minimum { out, a, b } => (out, slots[a as usize].lower_of(slots[b as usize])),
                Instruction::Maximum { out, a, b } => (out, slots[a as usize].upper_of(slots[b as usize])),
                Instruction::Absolute { out, a } => (out, slots[a as usize].absolute()),
                Instruction::Call { out, function, a, b } => {
                    (out, slots[a as usize].map(slots[b as usize], |a, b| function.apply(a, b)))
                }
                Instruction::Table { out, table, a } => {
                    let points = &tables[table as usize];
                    let a = slots[a as usize];
                    (out, a.map(a, |x, _| x.table(points)))
                }
            };
            slots[out as usize] = value;
        }
    }
}
