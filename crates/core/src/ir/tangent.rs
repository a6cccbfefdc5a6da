//! Slopes of all voltages along one direction, for sensitivities.
//!
//! The voltages are already known, so only the derivative parts of the dual numbers are computed. The voltages
//! themselves can be exactly at a kink, at the instant of an event. Then the voltages of a nearby instant decide on
//! which side of the kink the slopes are taken.

use std::ops::Range;

use super::loops::close_slopes;
use super::number::{Dual, Number, segment};
use super::op::{Op, Register, Sources};
use super::parts::Loop;
use super::{Program, RunScope};
use crate::document::TIME_SCALE;
use patchcord_expr::{Callee, Expression, Formula, Function, Node, Operator};

/// The slopes of what operations read in addition to registers. Modes and levels have slope 0.
pub(crate) struct SourceSlopes<'a> {
    /// Slopes of the coefficients.
    pub coefficients: &'a [f64],
    /// Slopes of the states.
    pub states: &'a [f64],
    /// Slope of problem time: 1 along time, otherwise 0.
    pub time: f64,
    /// Slopes of the outputs of the delay lines.
    pub delayed: &'a [f64],
    /// Slopes of the sampled values.
    pub sampled: &'a [f64],
}

impl SourceSlopes<'_> {
    /// No sources, for operations that read registers only.
    pub(super) fn none() -> Self {
        SourceSlopes { coefficients: &[], states: &[], time: 0.0, delayed: &[], sampled: &[] }
    }
}

/// The voltages at which slopes are taken.
#[derive(Clone, Copy)]
pub(crate) struct TangentBase<'a> {
    /// The voltages themselves.
    pub values: &'a [f64],
    /// Voltages of a nearby instant. They decide on which side of every kink the slopes are taken. If two of them are
    /// equal, the slopes decide.
    pub guide: &'a [f64],
}

impl Program {
    /// The slopes of the coefficients, from the parameters (in SI) and their slopes.
    pub(crate) fn coefficient_slopes(&self, parameters: &[f64], slopes: &[f64]) -> Vec<f64> {
        let pairs = parameters.iter().zip(slopes);
        let duals: Vec<Dual> = pairs.map(|(value, slope)| Dual::new(*value, *slope)).collect();
        self.prepare(&duals).into_iter().map(|coefficient| coefficient.slope).collect()
    }

    /// Computes the slopes of a range of the body. The slopes before it must already be there.
    pub(crate) fn differentiate(
        &self,
        range: Range<usize>,
        base: TangentBase<'_>,
        from: &SourceSlopes<'_>,
        slopes: &mut [f64],
    ) {
        let mut at = range.start;
        while at < range.end {
            let Op::Tear { index, .. } = self.lowered.body[at] else {
                self.differentiate_operation(at, base, from, slopes);
                at += 1;
                continue;
            };
            let entry = &self.lowered.loops[index as usize];
            self.differentiate_loop(entry, base, from, slopes);
            at = entry.operations.end;
        }
    }

    /// Computes the slopes of a loop. Those of its tears follow from evaluations with chosen slopes of the tears.
    fn differentiate_loop(
        &self,
        entry: &Loop,
        base: TangentBase<'_>,
        from: &SourceSlopes<'_>,
        slopes: &mut [f64],
    ) {
        close_slopes(entry.tears.len(), |tears| {
            entry.tears.iter().zip(&*tears).for_each(|(tear, slope)| slopes[tear.register.index()] = *slope);
            entry.operations.clone().for_each(|at| self.differentiate_operation(at, base, from, slopes));
            entry.tears.iter().zip(tears).for_each(|(tear, slope)| *slope = slopes[tear.result.index()]);
        });
    }

    /// Computes the slope of one operation. The slopes of its operands must already be there.
    fn differentiate_operation(
        &self,
        at: usize,
        base: TangentBase<'_>,
        from: &SourceSlopes<'_>,
        slopes: &mut [f64],
    ) {
        let value = |register: Register| base.values[register.index()];
        let guide = |register: Register| base.guide[register.index()];
        let slope_of = |register: Register| slopes[register.index()];
        slopes[at] = self.slope(self.lowered.body[at], value, guide, from, slope_of);
    }

    /// The slope of one operation, from the values and slopes of its operands. The guide decides on which side of a
    /// kink the slope is taken.
    pub(super) fn slope(
        &self,
        op: Op,
        value: impl Fn(Register) -> f64,
        guide: impl Fn(Register) -> f64,
        from: &SourceSlopes<'_>,
        slope_of: impl Fn(Register) -> f64,
    ) -> f64 {
        match op {
            Op::Coefficient(index) => from.coefficients[index as usize],
            Op::State(index) => from.states[index as usize],
            Op::Time => from.time,
            Op::Delayed(index) => from.delayed[index as usize],
            Op::Sampled(index) => from.sampled[index as usize],
            Op::Mode(_) | Op::Level(_) => 0.0,
            Op::Minimum(a, b) if guide(a) != guide(b) => slope_of(if guide(b) < guide(a) { b } else { a }),
            Op::Maximum(a, b) if guide(a) != guide(b) => slope_of(if guide(b) > guide(a) { b } else { a }),
            Op::Absolute(a) if guide(a) != 0.0 => guide(a).signum() * slope_of(a),
            Op::Select { left, right, then, otherwise } if guide(left) != guide(right) => {
                slope_of(if guide(left) > guide(right) { then } else { otherwise })
            }
            Op::Table(table, at) if !is_corner(&self.tables[table as usize], guide(at)) => {
                segment(&self.tables[table as usize], guide(at)).1 * slope_of(at)
            }
            op => {
                let from = Sources { tables: &self.tables, ..Sources::none() };
                op.apply(&from, |register| Dual::new(value(register), slope_of(register))).slope
            }
        }
    }
}

/// Whether a table has a point exactly at this abscissa.
fn is_corner(points: &[[f64; 2]], abscissa: f64) -> bool {
    points.binary_search_by(|point| point[0].total_cmp(&abscissa)).is_ok()
}

/// The slopes of the values that a formula of a run can name.
pub(crate) struct RunScopeSlopes<'a> {
    /// Slopes of the parameters in SI.
    pub parameters: &'a [f64],
    /// Slopes of the coefficients.
    pub coefficients: &'a [f64],
    /// Slopes of all registers of the body.
    pub registers: &'a [f64],
}

impl RunScope<'_> {
    /// The slope of a formula's value, in SI.
    pub(crate) fn slope(&self, formula: &Formula, slopes: &RunScopeSlopes<'_>) -> f64 {
        self.evaluate(formula.root(), slopes).slope
    }

    /// The value and slope of an expression.
    fn evaluate(&self, node: &Node, slopes: &RunScopeSlopes<'_>) -> Dual {
        match &node.expression {
            Expression::Number(value) => Dual::constant(*value),
            Expression::Name(name) => self.named(name, slopes),
            Expression::Negate(operand) => Dual::constant(0.0).subtract(self.evaluate(operand, slopes)),
            Expression::Binary(operator, left, right) => {
                let (left, right) = (self.evaluate(left, slopes), self.evaluate(right, slopes));
                match operator {
                    Operator::Add => left.add(right),
                    Operator::Subtract => left.subtract(right),
                    Operator::Multiply => left.multiply(right),
                    Operator::Divide => left.divide(right),
                    Operator::Power => Dual::call(Function::Power, left, right),
                }
            }
            Expression::Call(callee, arguments) => {
                let argument = |index: usize| arguments.get(index).map(|node| self.evaluate(node, slopes));
                let first = argument(0).unwrap_or(Dual::constant(0.0));
                let second = argument(1).unwrap_or(first);
                match callee {
                    Callee::Minimum => first.lower_of(second),
                    Callee::Maximum => first.upper_of(second),
                    Callee::Absolute => first.absolute(),
                    Callee::Function(function) => Dual::call(*function, first, second),
                }
            }
            Expression::Apply(..) => unreachable!("only equations apply functions of equations and tables"),
        }
    }

    /// The value and slope of a name; NaN if it is unknown or has no value yet.
    fn named(&self, name: &str, slopes: &RunScopeSlopes<'_>) -> Dual {
        let coefficient = |index: u32| {
            let index = index as usize;
            Dual::new(self.coefficients[index], slopes.coefficients[index])
        };
        if name == TIME_SCALE {
            return Dual::constant(self.program.lowered.time_scale);
        }
        if let Some(index) = self.program.parameter(name) {
            return Dual::new(self.parameters[index], slopes.parameters[index]);
        }
        if let Some(scale) = self.program.scale(name) {
            return coefficient(scale.per_volt);
        }
        let (Some(signal), Some(registers)) = (self.program.signal(name), self.registers) else {
            return Dual::constant(f64::NAN);
        };
        let at = signal.register.index();
        let per_volt = signal.per_volt.map_or(Dual::constant(1.0), coefficient);
        Dual::new(registers[at], slopes.registers[at]).multiply(per_volt)
    }
}
