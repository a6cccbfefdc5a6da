//! Evaluates plans and equations at a state, independently of each other.

use std::collections::BTreeMap;

use patchcord_core::circuit::Circuit;
use patchcord_core::patch::Problem;
use patchcord_expr::{
    Callee, Dimension, Equation, EquationFunction, Expression, Function, Node, Operator, Scope,
};

use crate::graph::{FunctionKind, NodeId, Operation, Plan, Sum, Term};
use crate::plan::constants::Constants;
use crate::symbolic::Fraction;

/// Evaluations of all nodes at most. Loops converge in fewer.
const MOST_ROUNDS: usize = 2000;
/// Evaluations after which rounding errors at most repeat themselves.
const MAX_PERIOD: usize = 8;

/// Evaluates the nodes of a plan.
pub(super) struct Evaluator<'a> {
    pub plan: &'a Plan,
    pub problem: &'a Problem,
    pub constants: Constants,
    /// The values of integrals and drives.
    pub given: BTreeMap<NodeId, f64>,
}

impl Evaluator<'_> {
    /// The values of all nodes. Each node is evaluated again until nothing changes, so the gain of a loop must be below
    /// 1.
    pub(super) fn values(&self) -> Vec<f64> {
        let mut values = vec![0.0; self.plan.nodes.len()];
        let mut earlier: Vec<Vec<f64>> = Vec::new();
        for _ in 0..MOST_ROUNDS {
            earlier.push(values.clone());
            for node in self.plan.ids() {
                values[node.0 as usize] = self.value(node, &values);
            }
            // The last bits can alternate.
            if earlier.iter().rev().take(MAX_PERIOD).any(|before| *before == values) {
                return values;
            }
        }
        panic!("the values of {:?} do not converge", self.plan.quantities)
    }

    /// The value of a sum.
    pub(super) fn sum(&self, sum: &Sum, values: &[f64]) -> f64 {
        sum.terms.iter().map(|(node, factor)| self.constant(factor) * values[node.0 as usize]).sum()
    }

    fn constant(&self, value: &Fraction) -> f64 {
        self.constants.value(value)
    }

    fn term(&self, term: &Term, values: &[f64]) -> f64 {
        self.constant(&term.coefficient) * values[term.node.0 as usize]
    }

    fn value(&self, node: NodeId, values: &[f64]) -> f64 {
        if let Some(given) = self.given.get(&node) {
            return *given;
        }
        let of = |node: &NodeId| values[node.0 as usize];
        match &self.plan.node(node).operation {
            Operation::One => 1.0,
            Operation::Drive(_) | Operation::Integral { .. } => panic!("{node:?} is given"),
            Operation::Sum(sum) => self.sum(sum, values),
            Operation::Limited { sum, lower, upper } => {
                let value =
                    lower.iter().fold(self.sum(sum, values), |value, lower| value.max(self.constant(lower)));
                upper.iter().fold(value, |value, upper| value.min(self.constant(upper)))
            }
            Operation::Product(factors) => factors.iter().map(of).product(),
            Operation::Quotient { dividend, divisor } => self.sum(dividend, values) / of(divisor),
            Operation::Root(sum) => self.sum(sum, values).sqrt(),
            Operation::Zero(_) => self.angle(node, values),
            Operation::Absolute(input) => of(input).abs(),
            Operation::Lower(terms) => {
                terms.iter().map(|term| self.term(term, values)).fold(f64::MAX, f64::min)
            }
            Operation::Higher(terms) => {
                terms.iter().map(|term| self.term(term, values)).fold(f64::MIN, f64::max)
            }
            Operation::Switch { input, at_least_0, below_0 } => {
                self.constant(if of(input) < 0.0 { below_0 } else { at_least_0 })
            }
            Operation::DeadZone { input, width } => {
                let excess = of(input).abs() - self.term(width, values);
                excess.max(0.0).copysign(of(input))
            }
            Operation::Function { kind, argument } => {
                let argument = self.term(argument, values);
                match kind {
                    FunctionKind::Sin => Function::Sin.apply(argument, 0.0),
                    FunctionKind::Cos => Function::Cos.apply(argument, 0.0),
                    FunctionKind::Exp => Function::Exp.apply(argument, 0.0),
                    FunctionKind::Ln => Function::Ln.apply(argument, 0.0),
                }
            }
            Operation::Curve { table, input } => interpolated(self.problem, table, self.term(input, values)),
            // Any value is possible; the equations of delays are not compared.
            Operation::Delay { input, .. } => of(input),
        }
    }

    /// The angle y of the sum b sin(y) - a cos(y), which has the value -a at 0 and b at a right angle.
    fn angle(&self, node: NodeId, values: &[f64]) -> f64 {
        let at = |angle: f64| self.zero(node, angle, values);
        let (a, b) = (-at(0.0), at(std::f64::consts::FRAC_PI_2));
        let angle = a.atan2(b);
        let falls = at(angle + 0.1) < at(angle - 0.1);
        assert!(!falls, "{node:?} is the opposite angle");
        angle
    }

    /// The sum of an implicit node for a value of the node.
    fn zero(&self, node: NodeId, own: f64, values: &[f64]) -> f64 {
        let mut values = values.to_vec();
        values[node.0 as usize] = own;
        let others = || self.plan.ids().filter(move |other| *other != node);
        // The functions of the angle, their products, and sums of these.
        for _ in 0..3 {
            for other in others().filter(|other| self.depends_on(*other, node, 3)) {
                values[other.0 as usize] = self.value(other, &values);
            }
        }
        let Operation::Zero(sum) = &self.plan.node(node).operation else { panic!("{node:?} is implicit") };
        self.sum(sum, &values)
    }

    /// Whether a node depends on another one over at most this many nodes.
    fn depends_on(&self, node: NodeId, other: NodeId, steps: usize) -> bool {
        let operation = &self.plan.node(node).operation;
        if matches!(operation, Operation::Integral { .. } | Operation::Zero(_)) {
            return false;
        }
        let inputs = operation.inputs();
        inputs.contains(&other)
            || (steps > 1 && inputs.iter().any(|input| self.depends_on(*input, other, steps - 1)))
    }
}

/// The value of a table of a problem in SI units. The outermost lines continue.
fn interpolated(problem: &Problem, table: &str, at: f64) -> f64 {
    let table = &problem.tables[table];
    let at = table.input_unit.out_of_si(at);
    let after = table.points.partition_point(|point| point[0] < at).clamp(1, table.points.len() - 1);
    let ([x0, y0], [x1, y1]) = (table.points[after - 1], table.points[after]);
    table.output_unit.to_si(y0 + (y1 - y0) / (x1 - x0) * (at - x0))
}

/// The values of all names of the equations.
pub(super) struct Names<'a> {
    pub circuit: &'a Circuit,
    pub problem: &'a Problem,
    /// Quantities with primes, drives and the time, in SI units.
    pub values: BTreeMap<String, f64>,
}

impl Scope for Names<'_> {
    fn value(&self, name: &str) -> Option<f64> {
        self.values.get(name).copied().or_else(|| self.circuit.quantities().value(name))
    }

    fn dimension(&self, _name: &str) -> Option<Dimension> {
        None
    }

    fn names(&self) -> Vec<&str> {
        self.values.keys().map(String::as_str).collect()
    }
}

/// Values and sizes of expressions. The size is that of the rounding error as a multiple of 2^-52, or larger.
struct Measured {
    value: f64,
    size: f64,
}

/// The difference of the sides of an equation as a share of the size of both. `None` if it contains a delay.
pub(super) fn difference(equation: &Equation, names: &Names<'_>) -> Option<f64> {
    let [left, right] = [equation.left(), equation.right()].map(|side| names.sized(side));
    let (left, right) = (left?, right?);
    if let Ok(values) = equation.evaluate(names) {
        assert_eq!(values, [left.value, right.value], "{equation}");
    }
    let difference = (left.value - right.value).abs();
    Some(if difference == 0.0 { 0.0 } else { difference / (left.size + right.size) })
}

impl Names<'_> {
    /// The value of an expression. `None` if it contains a delay.
    fn sized(&self, node: &Node) -> Option<Measured> {
        let plain = |value: f64| Some(Measured { value, size: value.abs() });
        match &node.expression {
            Expression::Number(value) => plain(*value),
            Expression::Name(name) => {
                plain(self.value(name).unwrap_or_else(|| panic!("{name} has no value")))
            }
            Expression::Negate(inner) => {
                self.sized(inner).map(|inner| Measured { value: -inner.value, ..inner })
            }
            Expression::Binary(operator, left, right) => {
                let (a, b) = (self.sized(left)?, self.sized(right)?);
                let (value, size) = match operator {
                    Operator::Add => (a.value + b.value, a.size + b.size),
                    Operator::Subtract => (a.value - b.value, a.size + b.size),
                    Operator::Multiply => (a.value * b.value, a.size * b.size),
                    Operator::Divide => {
                        (a.value / b.value, a.size / b.value.abs() * (b.size / b.value.abs()))
                    }
                    Operator::Power => {
                        let value = Function::Power.apply(a.value, b.value);
                        let relative = if a.value == 0.0 { 0.0 } else { a.size / a.value.abs() };
                        (value, value.abs() * (1.0 + b.size * relative))
                    }
                };
                Some(Measured { value, size })
            }
            Expression::Call(callee, arguments) => {
                let arguments: Vec<Measured> =
                    arguments.iter().map(|node| self.sized(node)).collect::<Option<_>>()?;
                let argument = |index: usize| arguments.get(index).map_or(0.0, |argument| argument.value);
                let value = callee.apply(argument(0), argument(1));
                Some(Measured { value, size: call_size(*callee, value, &arguments) })
            }
            Expression::Apply(name, arguments) => {
                let arguments: Vec<Measured> =
                    arguments.iter().map(|node| self.sized(node)).collect::<Option<_>>()?;
                let values: Vec<f64> = arguments.iter().map(|argument| argument.value).collect();
                let total: f64 = arguments.iter().map(|argument| argument.size).sum();
                match EquationFunction::from_name(name) {
                    Some(EquationFunction::Sign | EquationFunction::Step) => {
                        let function = EquationFunction::from_name(name)?;
                        Some(Measured { value: function.value(&values)?, size: 1.0 })
                    }
                    Some(function) => Some(Measured { value: function.value(&values)?, size: total }),
                    None => plain(interpolated(self.problem, name, values[0])),
                }
            }
        }
    }
}

/// The size of the error of a function.
fn call_size(callee: Callee, value: f64, arguments: &[Measured]) -> f64 {
    let total: f64 = arguments.iter().map(|argument| argument.size).sum();
    let relative: f64 = arguments.iter().map(|argument| argument.size / argument.value.abs()).sum();
    match callee {
        Callee::Absolute | Callee::Minimum | Callee::Maximum => total,
        Callee::Function(Function::Sqrt | Function::Power) => value.abs() * (1.0 + relative),
        Callee::Function(Function::Ln | Function::Log10) => value.abs() + relative,
        Callee::Function(Function::Atan2) => 1.0 + value.abs(),
        Callee::Function(_) => (1.0 + value.abs()) * (1.0 + total),
    }
}
