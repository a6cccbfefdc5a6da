//! The values of operations in SI units.

use patchcord_core::patch::Problem;

use super::voltages::curve;
use crate::graph::{ConstantValues, FunctionKind, NodeId, Operation, Plan, Sum, Term};
use crate::peaks::points_in_si;
use crate::symbolic::Fraction;

/// A value with the sum of the magnitudes of the terms from which it was computed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Computed {
    /// The value.
    pub value: f64,
    /// The sum of the terms.
    pub size: f64,
}

impl Computed {
    /// A given value.
    fn given(value: f64) -> Self {
        Computed { value, size: value.abs() }
    }

    /// The value in units of a scale.
    pub(super) fn over(self, scale: f64) -> Self {
        Computed { value: self.value / scale, size: self.size / scale }
    }

    /// The value times a number.
    fn times(self, factor: f64) -> Self {
        Computed { value: factor * self.value, size: factor.abs() * self.size }
    }
}

/// A plan with the values of its named nodes.
pub(super) struct Physical<'a> {
    pub plan: &'a Plan,
    pub problem: &'a Problem,
    pub constants: &'a ConstantValues,
    pub is_named: &'a [bool],
    /// The values by node. Only those of named nodes and drives count.
    pub values: &'a [f64],
}

impl Physical<'_> {
    /// The value of a node.
    fn node(&self, id: NodeId) -> Computed {
        let operation = &self.plan.node(id).operation;
        match operation {
            _ if self.is_named[id.0 as usize] => Computed::given(self.values[id.0 as usize]),
            Operation::Drive(_) => Computed::given(self.values[id.0 as usize]),
            _ => self.operation(operation),
        }
    }

    /// The value of a constant.
    fn constant(&self, constant: &Fraction) -> f64 {
        self.constants.value(constant)
    }

    /// The value of a weighted node.
    fn term(&self, term: &Term) -> Computed {
        self.node(term.node).times(self.constant(&term.coefficient))
    }

    /// The value of a weighted sum.
    pub(super) fn sum(&self, sum: &Sum) -> Computed {
        let terms = sum.terms.iter();
        let terms = terms.map(|(node, coefficient)| self.node(*node).times(self.constant(coefficient)));
        let add = |sum: Computed, term: Computed| Computed {
            value: sum.value + term.value,
            size: sum.size + term.size,
        };
        terms.fold(Computed { value: 0.0, size: 0.0 }, add)
    }

    /// The value of an operation. It is not finite if the operation has none.
    pub(super) fn operation(&self, operation: &Operation) -> Computed {
        match operation {
            Operation::One => Computed::given(1.0),
            Operation::Drive(_) | Operation::Integral { .. } | Operation::Zero(_) => {
                panic!("the value of {operation:?} is given")
            }
            Operation::Sum(sum) => self.sum(sum),
            Operation::Limited { sum, lower, upper } => {
                let bound = |bound: &Option<Fraction>, without: f64| {
                    bound.as_ref().map_or(without, |bound| self.constant(bound))
                };
                let inner = self.sum(sum);
                let (lower, upper) = (bound(lower, f64::NEG_INFINITY), bound(upper, f64::INFINITY));
                Computed { value: inner.value.max(lower).min(upper), ..inner }
            }
            Operation::Product([first, second]) => {
                let (first, second) = (self.node(*first), self.node(*second));
                Computed { value: first.value * second.value, size: first.size * second.size }
            }
            Operation::Quotient { dividend, divisor } => {
                let (dividend, divisor) = (self.sum(dividend), self.node(*divisor));
                let loss = divisor.size / divisor.value.abs();
                Computed {
                    value: dividend.value / divisor.value,
                    size: dividend.size / divisor.value.abs() * loss,
                }
            }
            Operation::Root(sum) => {
                let Computed { value, size } = self.sum(sum);
                Computed { value: value.sqrt(), size: size / value.sqrt() }
            }
            Operation::Absolute(input) => {
                let inner = self.node(*input);
                Computed { value: inner.value.abs(), ..inner }
            }
            Operation::Lower([first, second]) => self.selected(first, second, f64::min),
            Operation::Higher([first, second]) => self.selected(first, second, f64::max),
            Operation::Switch { input, at_least_0, below_0 } => {
                let is_above = self.node(*input).value >= 0.0;
                Computed::given(self.constant(if is_above { at_least_0 } else { below_0 }))
            }
            Operation::DeadZone { input, width } => {
                let (inner, width) = (self.node(*input), self.term(width));
                let beyond = (inner.value.abs() - width.value).max(0.0).copysign(inner.value);
                Computed { value: beyond, size: inner.size + width.size }
            }
            Operation::Function { kind, argument } => function(*kind, self.term(argument)),
            Operation::Curve { table, input } => {
                let points = points_in_si(&self.problem.tables[table.as_str()]);
                let (argument, size) = (self.term(input), curve_size(&points));
                let value = curve(&points, argument.value);
                Computed { value, size: value.abs() + size * (1.0 + argument.size / argument.value.abs()) }
            }
            // In these tests, the past of a value is the value times 1 + the delay in seconds.
            Operation::Delay { input, time, .. } => self.node(*input).times(1.0 + self.constant(time)),
        }
    }

    /// One of two weighted nodes.
    fn selected(&self, first: &Term, second: &Term, select: fn(f64, f64) -> f64) -> Computed {
        let (first, second) = (self.term(first), self.term(second));
        Computed { value: select(first.value, second.value), size: first.size + second.size }
    }
}

/// The value of a function.
fn function(kind: FunctionKind, argument: Computed) -> Computed {
    let Computed { value: at, size } = argument;
    match kind {
        FunctionKind::Sin => Computed { value: at.sin(), size: 1.0 + size },
        FunctionKind::Cos => Computed { value: at.cos(), size: 1.0 + size },
        FunctionKind::Exp => Computed { value: at.exp(), size: at.exp() * (1.0 + size) },
        FunctionKind::Ln => Computed { value: at.ln(), size: at.ln().abs() + size / at.abs() },
    }
}

/// The sum of the terms of the steepest segment of a curve, which limits its rounding.
fn curve_size(points: &[[f64; 2]]) -> f64 {
    let most = |axis: usize| points.iter().map(|point| point[axis].abs()).fold(0.0, f64::max);
    let slope = |pair: &[[f64; 2]]| ((pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0])).abs();
    most(1) + points.windows(2).map(slope).fold(0.0, f64::max) * most(0)
}
