//! The expressions of single operations.

use std::collections::BTreeSet;

use patchcord_core::ir::{Level, Op, Register};
use patchcord_expr::Function;

use super::Derivation;
use crate::symbolic::{Fraction, Operation, absolute, call, opaque};

impl Derivation<'_> {
    /// The expression of an operation, with the expressions of its operands.
    ///
    /// `is_ranged` is whether it limits the input of a squaring network or a logarithm to its range.
    pub(super) fn operation(&self, op: Op, is_ranged: bool, get: &dyn Fn(Register) -> Fraction) -> Fraction {
        match op {
            Op::Constant(value) => self.constant(value),
            Op::Parameter(index) => Fraction::symbol(self.wiring.parameters[index as usize]),
            Op::Coefficient(index) => self.coefficients[index as usize].clone(),
            Op::State(index) => {
                let register = self.output(self.program.state_laws()[index as usize].element).1;
                self.wiring.names[&register].volts()
            }
            Op::Mode(index) => Fraction::symbol(self.wiring.system.modes[index as usize].symbol),
            Op::Time => Fraction::symbol(self.wiring.time),
            Op::Add(a, b) => get(a).plus(&get(b)),
            Op::Subtract(a, b) => get(a).minus(&get(b)),
            Op::Multiply(a, b) => get(a).times(&get(b)),
            Op::Divide(a, b) => get(a).over(&get(b)),
            Op::Minimum(a, b) => get(a).minimum(&get(b)),
            Op::Maximum(a, _) if is_ranged && self.options.stays_in_range => get(a),
            Op::Maximum(a, b) => get(a).maximum(&get(b)),
            Op::Absolute(a) => absolute(&get(a)),
            Op::Select { left, right, then, otherwise } => {
                Fraction::select(&get(left), &get(right), &get(then), &get(otherwise))
            }
            Op::Call(function, a, b) => call(function, &get(a), &get(b)),
            Op::Table(table, at) => self.in_unit(table, opaque(Operation::Table(table), vec![get(at)])),
            Op::Delayed(index) => Fraction::symbol(self.wiring.delayed[index as usize]),
            Op::Sampled(index) => Fraction::symbol(self.wiring.sampled[index as usize]),
            Op::Level(index) => self.level(index as usize),
            // A loop computes its tears before their readers.
            Op::Tear { .. } => Fraction::zero(),
        }
    }

    /// The value of a table in SI as a number in its unit.
    fn in_unit(&self, table: u32, value: Fraction) -> Fraction {
        match &self.wiring.system.tables[table as usize].unit {
            Some(unit) => value.over(&Fraction::number(unit.factor)),
            None => value,
        }
    }

    /// The value of a level.
    fn level(&self, index: usize) -> Fraction {
        let value = Fraction::symbol(self.wiring.levels[index]);
        match self.program.levels()[index] {
            Level::Points { table } => self.in_unit(table as u32, value),
            Level::Noise(_) | Level::Pulses(_) => value,
        }
    }

    /// A number; multiples of pi keep their name.
    fn constant(&self, value: f64) -> Fraction {
        let turns = value / std::f64::consts::PI;
        let is_multiple = [1.0, 2.0, 0.5].contains(&turns);
        if is_multiple {
            Fraction::symbol(self.pi).times(&Fraction::number(turns))
        } else {
            Fraction::number(value)
        }
    }
}

/// The registers that limit the inputs of squaring networks and logarithms to their range.
pub(crate) fn ranged(operations: &[Op]) -> BTreeSet<Register> {
    let inputs = operations.iter().filter_map(|op| match op {
        Op::Multiply(a, b) if a == b => Some(*a),
        Op::Call(Function::Ln | Function::Log10, a, _) => match operations[a.index()] {
            // The limited voltage is divided by that of the argument 1.
            Op::Divide(limited, _) => Some(limited),
            _ => Some(*a),
        },
        _ => None,
    });
    inputs.filter(|register| matches!(operations[register.index()], Op::Maximum(..))).collect()
}
