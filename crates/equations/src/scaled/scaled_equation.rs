//! The scaled equations of a plan: relations between the voltages of the machine.
//!
//! A quantity in brackets is its voltage: `[x]` is x divided by the scale of x. The derivative is that over machine time.
//! So the factors are the computer gains of the block gain rule (thesis eq. 4-8): coefficient times input scale over
//! output scale. A table takes and gives physical quantities, so its argument and its value have units.
//!
//! Every equation is a [`Notation`] with exact numbers. Only its text has rounded ones.

use patchcord_core::machines::REFERENCE;
use patchcord_core::patch::Problem;
use patchcord_expr::Unit;

use super::products::{number, product, quotient, square, times, times_with_unit};
use crate::graph::{ConstantValues, NodeId, Operation, Plan, Sum, Term};
use crate::notation::{Comparison, Condition, Notation, Relation, WrittenEquation, rounded, text};
use crate::symbolic::Fraction;

/// Significant digits of the numbers in the text of an equation.
const DIGITS: usize = 4;
/// The largest number of operations in an expression that is written in the equation of another node. A larger one has
/// an equation of its own.
const MOST_OPERATIONS: usize = 60;

/// Writes the scaled equations of a plan.
pub(super) struct ScaledEquations<'a> {
    /// The plan.
    plan: &'a Plan,
    /// The problem, for the units of its tables.
    problem: &'a Problem,
    /// The value of one volt of each node, in SI units.
    per_volt: &'a [f64],
    /// Machine seconds per problem second.
    time_scale: f64,
    /// The values of the parameters.
    constants: &'a ConstantValues,
    /// For each node, whether the equation of another one has its name in place of its expression.
    is_named: Vec<bool>,
}

impl<'a> ScaledEquations<'a> {
    /// The equations of a plan with the values of one volt of all nodes in SI units.
    pub(super) fn new(
        plan: &'a Plan,
        problem: &'a Problem,
        per_volt: &'a [f64],
        time_scale: f64,
        constants: &'a ConstantValues,
    ) -> Self {
        let is_named = named_nodes(plan);
        ScaledEquations { plan, problem, per_volt, time_scale, constants, is_named }
    }

    /// The nodes that have a name in the equations and are no quantities of the problem: they are in loops, or their
    /// expressions are long.
    pub(super) fn further(&self) -> impl Iterator<Item = NodeId> {
        let is_quantity = |id: &NodeId| self.plan.quantities.iter().any(|quantity| quantity.node == *id);
        self.plan.ids().filter(|id| self.is_named[id.0 as usize]).filter(move |id| !is_quantity(id))
    }

    /// The text of the scaled equation of a quantity, such as `[v]' = -2.5 [x] - 0.4 [v]`. Another name of a node has the
    /// voltage of that node.
    pub(super) fn text(&self, name: &str, id: NodeId) -> String {
        let own_name = &self.plan.node(id).name;
        let equation = if name == own_name {
            self.equation(id)
        } else {
            WrittenEquation { left: voltage(name, 0), right: voltage(own_name, 0) }
        };
        let [left, right] = [equation.left, equation.right].map(|side| text(&rounded(&side, DIGITS)));
        format!("{left} = {right}")
    }

    /// The scaled equation of a node, with exact numbers.
    fn equation(&self, id: NodeId) -> WrittenEquation {
        let name = &self.plan.node(id).name;
        match &self.plan.node(id).operation {
            Operation::Integral { rate, .. } => {
                let right = self.sum(rate, self.scale(id) * self.time_scale);
                WrittenEquation { left: voltage(name, 1), right }
            }
            Operation::Zero(sum) => {
                WrittenEquation { left: number(0.0), right: self.sum(sum, self.largest_term(sum)) }
            }
            _ => WrittenEquation { left: voltage(name, 0), right: self.right_side(id) },
        }
    }

    /// The scale of a node, in SI units per volt.
    fn scale(&self, id: NodeId) -> f64 {
        self.per_volt[id.0 as usize]
    }

    /// The voltage of a node as an operand: its name in brackets, or the expression of an unnamed node.
    fn operand(&self, id: NodeId) -> Notation {
        if self.is_named[id.0 as usize] { voltage(&self.plan.node(id).name, 0) } else { self.right_side(id) }
    }

    /// The voltage of a node as a function of others.
    fn right_side(&self, id: NodeId) -> Notation {
        let own = self.scale(id);
        match &self.plan.node(id).operation {
            Operation::One => number(REFERENCE),
            Operation::Drive(name) => voltage(name, 0),
            Operation::Integral { .. } | Operation::Zero(_) => voltage(&self.plan.node(id).name, 0),
            Operation::Sum(sum) => self.sum(sum, own),
            Operation::Limited { sum, lower, upper } => {
                self.limited(sum, [lower.as_ref(), upper.as_ref()], own)
            }
            Operation::Product(factors) => self.product(*factors, own),
            Operation::Quotient { dividend, divisor } => {
                let dividend = self.sum(dividend, REFERENCE * own * self.scale(*divisor));
                quotient(times(REFERENCE, dividend), self.operand(*divisor))
            }
            Operation::Root(sum) => {
                times(REFERENCE.sqrt(), call("sqrt", vec![self.sum(sum, REFERENCE * own * own)]))
            }
            Operation::Absolute(input) => {
                times(self.scale(*input) / own, call("abs", vec![self.operand(*input)]))
            }
            Operation::Lower(terms) => call("min", self.terms(terms, own)),
            Operation::Higher(terms) => call("max", self.terms(terms, own)),
            Operation::Switch { input, at_least_0, below_0 } => {
                self.switch(*input, [at_least_0, below_0], own)
            }
            Operation::DeadZone { input, width } => {
                let scale = self.scale(*input);
                let arguments = vec![self.operand(*input), self.term(width, scale)];
                times(scale / own, call("dead_zone", arguments))
            }
            Operation::Function { kind, argument } => {
                times(1.0 / own, call(kind.function().name(), vec![self.term(argument, 1.0)]))
            }
            Operation::Curve { table, input } => self.curve(table, input, own),
            Operation::Delay { input, time, .. } => self.delay(*input, time, own),
        }
    }

    /// The product of two nodes in volts of a scale. A multiplier divides it by 100 V.
    fn product(&self, [first, second]: [NodeId; 2], scale: f64) -> Notation {
        let inner = match first == second {
            true => square(self.operand(first)),
            false => product(self.operand(first), self.operand(second)),
        };
        let factor = REFERENCE * self.scale(first) * self.scale(second) / scale;
        times(factor, quotient(inner, number(REFERENCE)))
    }

    /// A limited sum, with its bounds in volts of a scale.
    fn limited(&self, sum: &Sum, bounds: [Option<&Fraction>; 2], scale: f64) -> Notation {
        let [lower, upper] = bounds.map(|bound| bound.map(|bound| self.volts(bound, scale)));
        let inner = self.sum(sum, scale);
        match (lower, upper) {
            (Some(lower), Some(upper)) => call("limit", vec![inner, lower, upper]),
            (Some(lower), None) => call("max", vec![inner, lower]),
            (None, Some(upper)) => call("min", vec![inner, upper]),
            (None, None) => inner,
        }
    }

    /// One of two constants in volts of a scale, by the sign of a node.
    fn switch(&self, input: NodeId, [at_least_0, below_0]: [&Fraction; 2], scale: f64) -> Notation {
        let comparison = Comparison::Compare {
            left: self.operand(input),
            relation: Relation::AtLeast,
            right: number(0.0),
        };
        let first = (self.volts(at_least_0, scale), Some(Condition(vec![comparison])));
        Notation::Cases(vec![first, (self.volts(below_0, scale), None)])
    }

    /// The value of a table of the problem in volts of a scale.
    fn curve(&self, table: &str, input: &Term, scale: f64) -> Notation {
        let units = self.problem.tables.get(table).map(|table| (&table.input_unit, &table.output_unit));
        let per_volt = self.constants.value(&input.coefficient) * self.scale(input.node);
        let operand = self.operand(input.node);
        let Some((input_unit, output_unit)) = units else {
            return times(1.0 / scale, call(table, vec![times(per_volt, operand)]));
        };
        let value = call(table, vec![times_with_unit(per_volt, input_unit, operand)]);
        in_volts(value, output_unit, scale)
    }

    /// The value of a node some time ago in volts of a scale. The time is in machine seconds.
    fn delay(&self, input: NodeId, time: &Fraction, scale: f64) -> Notation {
        let value = self.constants.value(time) * self.time_scale;
        let seconds = Notation::Number { value, unit: Some("s".to_owned()) };
        times(self.scale(input) / scale, call("delay", vec![self.operand(input), seconds]))
    }

    /// A constant in volts of a scale.
    fn volts(&self, constant: &Fraction, scale: f64) -> Notation {
        number(self.constants.value(constant) / scale)
    }

    /// Weighted nodes in volts of a scale.
    fn terms(&self, terms: &[Term; 2], scale: f64) -> Vec<Notation> {
        terms.iter().map(|term| self.term(term, scale)).collect()
    }

    /// A weighted node, in volts of a scale.
    fn term(&self, term: &Term, scale: f64) -> Notation {
        self.weighted(&term.coefficient, term.node, scale)
    }

    /// A coefficient times a node, in volts of a scale. The factor is the computer gain.
    fn weighted(&self, coefficient: &Fraction, node: NodeId, scale: f64) -> Notation {
        times(self.constants.value(coefficient) * self.scale(node) / scale, self.operand(node))
    }

    /// A weighted sum of nodes, in volts of a scale.
    fn sum(&self, sum: &Sum, scale: f64) -> Notation {
        let terms = sum.terms.iter();
        let mut terms: Vec<Notation> =
            terms.map(|(node, coefficient)| self.weighted(coefficient, *node, scale)).collect();
        match terms.pop() {
            Some(only) if terms.is_empty() => only,
            Some(last) => {
                terms.push(last);
                Notation::Sum(terms)
            }
            None => number(0.0),
        }
    }

    /// The largest contribution of one volt of a node to a sum, in SI units; 1 if there is none.
    fn largest_term(&self, sum: &Sum) -> f64 {
        let terms = sum.terms.iter();
        let sizes = terms.map(|(node, c)| self.constants.value(c).abs() * self.scale(*node));
        Some(sizes.fold(0.0, f64::max)).filter(|largest| *largest > 0.0).unwrap_or(1.0)
    }
}

/// The voltage of a quantity, with a prime for its derivative over machine time.
fn voltage(name: &str, primes: u8) -> Notation {
    Notation::Name { name: format!("[{name}]"), primes }
}

/// A function of arguments.
fn call(name: &str, arguments: Vec<Notation>) -> Notation {
    Notation::Call(name.to_owned(), arguments)
}

/// An expression for a quantity in a unit, divided by the value of one volt in SI units.
fn in_volts(value: Notation, unit: &Unit, scale: f64) -> Notation {
    let per_volt = unit.out_of_si(scale);
    if unit.text() == "1" {
        return times(1.0 / per_volt, value);
    }
    quotient(value, Notation::Number { value: per_volt, unit: Some(unit.text().to_owned()) })
}

/// For each node, whether equations contain its name: quantities, states, solutions of equations, nodes in loops, and
/// long expressions.
fn named_nodes(plan: &Plan) -> Vec<bool> {
    let is_always_named =
        |operation: &Operation| matches!(operation, Operation::Integral { .. } | Operation::Zero(_));
    let mut is_named: Vec<bool> = plan.nodes.iter().map(|node| is_always_named(&node.operation)).collect();
    for quantity in &plan.quantities {
        is_named[quantity.node.0 as usize] = true;
    }
    for id in plan.ids() {
        is_named[id.0 as usize] |= depends_on_itself(plan, id, &is_named);
    }
    let mut sizes = vec![None; plan.nodes.len()];
    for id in plan.ids() {
        size(plan, id, &mut is_named, &mut sizes);
    }
    is_named
}

/// Whether a node is in a loop without a named node.
fn depends_on_itself(plan: &Plan, id: NodeId, is_named: &[bool]) -> bool {
    let mut is_visited = vec![false; plan.nodes.len()];
    let mut open = plan.node(id).operation.inputs();
    while let Some(input) = open.pop() {
        let index = input.0 as usize;
        if input == id {
            return true;
        }
        if !is_named[index] && !is_visited[index] {
            is_visited[index] = true;
            open.extend(plan.node(input).operation.inputs());
        }
    }
    false
}

/// The number of operations in the expression of an unnamed node. If it is too large, the node gets a name. No loop
/// consists of unnamed nodes.
fn size(plan: &Plan, id: NodeId, is_named: &mut [bool], sizes: &mut [Option<usize>]) -> usize {
    let index = id.0 as usize;
    if is_named[index] {
        return 1;
    }
    if let Some(size) = sizes[index] {
        return size;
    }
    let inputs = plan.node(id).operation.inputs();
    let own = 1 + inputs.into_iter().map(|input| size(plan, input, is_named, sizes)).sum::<usize>();
    is_named[index] = own > MOST_OPERATIONS;
    sizes[index] = Some(own);
    if is_named[index] { 1 } else { own }
}

#[cfg(test)]
mod tests;
