//! A kernel's operations laid out over slots, and the interpreter that runs them over any number of lanes.

use super::lane::Lane;
use crate::ir::Number;
use patchcord_expr::Function;

/// Where a number of a kernel stands: factors first, then what moves.
pub(super) type Slot = u32;

/// An operation on slots.
#[derive(Debug, Clone, Copy)]
pub(super) enum Instruction {
    /// constant + factor x a.
    Line {
        out: Slot,
        constant: Slot,
        factor: Slot,
        a: Slot,
    },
    /// constant + the sum of a range of terms.
    Sum {
        out: Slot,
        constant: Slot,
        first: u32,
        count: u32,
    },
    Multiply {
        out: Slot,
        a: Slot,
        b: Slot,
    },
    Minimum {
        out: Slot,
        a: Slot,
        b: Slot,
    },
    Maximum {
        out: Slot,
        a: Slot,
        b: Slot,
    },
    Absolute {
        out: Slot,
        a: Slot,
    },
    Call {
        out: Slot,
        function: Function,
        a: Slot,
        b: Slot,
    },
    Table {
        out: Slot,
        table: u32,
        a: Slot,
    },
}

/// A list of operations, the terms of its sums beside it.
#[derive(Debug, Clone, Default)]
pub(super) struct Code {
    pub instructions: Vec<Instruction>,
    /// Factor and voltage of every term.
    pub terms: Vec<(Slot, Slot)>,
}

impl Code {
    /// Runs it. Sums begin with the constant and add term after term, each product and sum rounded once.
    #[inline(always)]
    pub fn run<V: Lane>(&self, slots: &mut [V], tables: &[Vec<[f64; 2]>]) {
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
