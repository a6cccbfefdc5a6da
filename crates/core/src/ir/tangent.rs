//! Slopes of all voltages along one direction, beside voltages that are known: what sensitivities are made of.

use std::ops::Range;

use super::loops::closing_slope;
use super::number::{Dual, Number, segment};
use super::op::{Op, Register, Sources};
use super::{Program, Standing};
use crate::document::TIME_SCALE;
use patchcord_expr::{Callee, Expression, Formula, Function, Node, Operator};

/// The slopes of what operations read besides registers. Modes and levels have none.
pub(crate) struct Slopes<'a> {
    pub coefficients: &'a [f64],
    pub states: &'a [f64],
    pub time: f64,
    pub delayed: &'a [f64],
    pub kept: &'a [f64],
}

/// The voltages that slopes stand beside.
#[derive(Clone, Copy)]
pub(crate) struct Beside<'a> {
    /// The voltages themselves.
    pub values: &'a [f64],
    /// Voltages of an instant near by that tell to which side of every kink the slopes belong; where two are equal
    /// there, the slopes decide.
    pub guide: &'a [f64],
}

impl Program {
    /// The slopes of the coefficients where those of the parameters (in SI) are these.
    pub(crate) fn coefficient_slopes(&self, parameters: &[f64], slopes: &[f64]) -> Vec<f64> {
        let pairs = parameters.iter().zip(slopes);
        let duals: Vec<Dual> = pairs.map(|(value, slope)| Dual::new(*value, *slope)).collect();
        self.prepare(&duals).into_iter().map(|dual| dual.slope).collect()
    }

    /// Works out the slopes of a range of the body; those before it stand there already.
    pub(crate) fn differentiate(
        &self,
        range: Range<usize>,
        beside: Beside<'_>,
        from: &Slopes<'_>,
        slopes: &mut [f64],
    ) {
        for at in range {
            slopes[at] = match self.body[at] {
                Op::Tear(index) => self.tear_slope(index as usize, beside, from, slopes),
                op => self.slope(op, beside, from, slopes),
            };
        }
    }

    fn tear_slope(&self, index: usize, beside: Beside<'_>, from: &Slopes<'_>, slopes: &mut [f64]) -> f64 {
        let entry = &self.loops[index];
        closing_slope(|tear| {
            slopes[entry.tear.index()] = tear;
            self.differentiate(entry.tear.index() + 1..entry.result.index() + 1, beside, from, slopes);
            slopes[entry.result.index()]
        })
    }

    fn slope(&self, op: Op, beside: Beside<'_>, from: &Slopes<'_>, slopes: &[f64]) -> f64 {
        let own = |register: Register| slopes[register.index()];
        let guide = |register: Register| beside.guide[register.index()];
        match op {
            Op::Coefficient(index) => from.coefficients[index as usize],
            Op::State(index) => from.states[index as usize],
            Op::Time => from.time,
            Op::Delayed(index) => from.delayed[index as usize],
            Op::Kept(index) => from.kept[index as usize],
            Op::Mode(_) | Op::Level(_) => 0.0,
            Op::Minimum(a, b) if guide(a) != guide(b) => own(if guide(b) < guide(a) { b } else { a }),
            Op::Maximum(a, b) if guide(a) != guide(b) => own(if guide(b) > guide(a) { b } else { a }),
            Op::Absolute(a) if guide(a) != 0.0 => guide(a).signum() * own(a),
            Op::Select { left, right, then, otherwise } if guide(left) != guide(right) => {
                own(if guide(left) > guide(right) { then } else { otherwise })
            }
            Op::Table(table, at) if !is_corner(&self.tables[table as usize], guide(at)) => {
                segment(&self.tables[table as usize], guide(at)).1 * own(at)
            }
            op => {
                let from = Sources { tables: &self.tables, ..Sources::none() };
                op.apply(&from, |register| Dual::new(beside.values[register.index()], own(register))).slope
            }
        }
    }
}

fn is_corner(points: &[[f64; 2]], place: f64) -> bool {
    points.binary_search_by(|point| point[0].total_cmp(&place)).is_ok()
}

/// The slopes of what a formula of a run may name.
pub(crate) struct StandingSlopes<'a> {
    pub parameters: &'a [f64],
    pub coefficients: &'a [f64],
    pub registers: &'a [f64],
}

impl Standing<'_> {
    /// The slope, in SI, of what a formula comes to.
    pub fn slope(&self, formula: &Formula, slopes: &StandingSlopes<'_>) -> f64 {
        self.dual(formula.root(), slopes).slope
    }

    fn dual(&self, node: &Node, slopes: &StandingSlopes<'_>) -> Dual {
        match &node.expression {
            Expression::Number(value) => Dual::constant(*value),
            Expression::Name(name) => self.named(name, slopes),
            Expression::Negate(operand) => Dual::constant(0.0).subtract(self.dual(operand, slopes)),
            Expression::Binary(operator, left, right) => {
                let (left, right) = (self.dual(left, slopes), self.dual(right, slopes));
                match operator {
                    Operator::Add => left.add(right),
                    Operator::Subtract => left.subtract(right),
                    Operator::Multiply => left.multiply(right),
                    Operator::Divide => left.divide(right),
                    Operator::Power => Dual::call(Function::Power, left, right),
                }
            }
            Expression::Call(callee, arguments) => {
                let argument = |place: usize| arguments.get(place).map(|node| self.dual(node, slopes));
                let first = argument(0).unwrap_or(Dual::constant(0.0));
                let second = argument(1).unwrap_or(first);
                match callee {
                    Callee::Minimum => first.lower_of(second),
                    Callee::Maximum => first.upper_of(second),
                    Callee::Absolute => first.absolute(),
                    Callee::Function(function) => Dual::call(*function, first, second),
                }
            }
        }
    }

    fn named(&self, name: &str, slopes: &StandingSlopes<'_>) -> Dual {
        let coefficient = |index: u32| {
            let index = index as usize;
            Dual::new(self.coefficients[index], slopes.coefficients[index])
        };
        if name == TIME_SCALE {
            return Dual::constant(self.program.time_scale);
        }
        if let Some(index) = self.program.parameter(name) {
            return Dual::new(self.parameters[index], slopes.parameters[index]);
        }
        if let Some(scale) = self.program.scale(name) {
            return coefficient(scale.per_volt);
        }
        let (Some(probe), Some(registers)) = (self.program.signal(name), self.registers) else {
            return Dual::constant(f64::NAN);
        };
        let at = probe.register.index();
        let per_volt = probe.per_volt.map_or(Dual::constant(1.0), coefficient);
        Dual::new(registers[at], slopes.registers[at]).multiply(per_volt)
    }
}
