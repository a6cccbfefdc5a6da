//! The values of nodes at the start as expressions of parameters.
//!
//! A delay line needs the value of its input before the run. A formula of the parameters follows them when they are
//! changed.

use std::collections::HashMap;

use patchcord_core::circuit::Circuit;
use patchcord_expr::{Dimension, Function};

use super::constants::Constants;
use crate::graph::{Node, NodeId, Operation, Sum, Term};
use crate::symbolic::{Atom, CallOrder, Fraction, Operation as Applied, Polynomial, absolute, call, root};
use crate::writing::Writer;

/// Steps from a node to a state at most.
const MOST_STEPS: usize = 24;
/// Terms of an expression at most. A longer one would be no readable setting.
const MOST_TERMS: usize = 40;

/// Finds the values of nodes at the start.
pub(super) struct StartExpressions<'a> {
    /// The nodes of the plan.
    nodes: &'a [Node],
    /// The constants of the problem.
    constants: &'a Constants,
    /// Finds the dimensions of expressions.
    writer: Writer<'a>,
    /// Whether times are pure numbers.
    is_time_dimensionless: bool,
    /// The values that are known already.
    known: HashMap<NodeId, Fraction>,
}

impl<'a> StartExpressions<'a> {
    /// The values of these nodes.
    pub(super) fn new(nodes: &'a [Node], constants: &'a Constants, circuit: &Circuit) -> Self {
        StartExpressions {
            nodes,
            constants,
            writer: Writer::physical(&constants.system),
            is_time_dimensionless: circuit.is_time_dimensionless(),
            known: HashMap::new(),
        }
    }

    /// The value of a node as a number or as an expression of parameters that a formula of the patch can state. `None` if
    /// it follows from a drive, a table or an implicit equation, if it is not finite, or if it is too long.
    pub(super) fn of(&mut self, node: NodeId) -> Option<Fraction> {
        let value = self.value(node, MOST_STEPS)?;
        let is_stated = value.as_rational().is_some() || self.has_dimension_of(&value, node);
        (is_stated && self.constants.value(&value).is_finite()).then_some(value)
    }

    /// Whether the dimension of an expression is that of a node. It differs if a number in the expression has a unit,
    /// such as the initial value 50 mm. Formulas have no such numbers.
    fn has_dimension_of(&self, value: &Fraction, node: NodeId) -> bool {
        let dimension = self.nodes[node.0 as usize].dimension;
        let expected = if self.is_time_dimensionless { dimension.without_time() } else { dimension };
        self.uniform_dimension(value) == Some(expected)
    }

    /// The dimension of an expression whose terms all have the same dimension, also inside functions. `None` for other
    /// expressions.
    fn uniform_dimension(&self, value: &Fraction) -> Option<Dimension> {
        let mut dimension = self.common_dimension(value.numerator())?;
        for (divisor, power) in value.divisors() {
            dimension = dimension.over(self.common_dimension(divisor)?.power(f64::from(power)));
        }
        Some(dimension)
    }

    /// The dimension that all terms of a sum have. `None` if they differ, or if a function has a wrong argument.
    fn common_dimension(&self, sum: &Polynomial) -> Option<Dimension> {
        sum.atoms().try_for_each(|atom| self.check_arguments(atom))?;
        let mut dimensions = sum.terms().map(|(product, number)| {
            let term = Fraction::from(Polynomial::term(number.clone(), product.clone()));
            self.writer.dimension(&term).unwrap_or(Dimension::NONE)
        });
        let first = dimensions.next().unwrap_or(Dimension::NONE);
        dimensions.all(|dimension| dimension == first).then_some(first)
    }

    /// Checks that the arguments of a function have dimensions that it accepts. `None` if they do not.
    fn check_arguments(&self, atom: &Atom) -> Option<()> {
        let Atom::Apply(applied) = atom else { return Some(()) };
        let takes_units = matches!(
            applied.operation,
            Applied::Absolute | Applied::Call(CallOrder(Function::Sqrt | Function::Power))
        );
        for argument in &applied.arguments {
            let dimension = self.uniform_dimension(argument)?;
            if !takes_units && !dimension.is_dimensionless() {
                return None;
            }
        }
        Some(())
    }

    /// The value of a node. `None` if it is no such expression, or is more than this number of steps from a state.
    fn value(&mut self, node: NodeId, steps: usize) -> Option<Fraction> {
        if let Some(known) = self.known.get(&node) {
            return Some(known.clone());
        }
        let value = self.computed(node, steps.checked_sub(1)?)?;
        if value.nested_size(MOST_TERMS + 1) > MOST_TERMS {
            return None;
        }
        // A function of numbers is a number.
        let has_symbols = value.contains(&mut |_| true);
        let value = if has_symbols { value } else { self.as_number(value) };
        self.known.insert(node, value.clone());
        Some(value)
    }

    /// An expression without symbols as a number.
    fn as_number(&self, value: Fraction) -> Fraction {
        match value.as_rational() {
            Some(_) => value,
            None => Fraction::number(self.constants.value(&value)),
        }
    }

    /// The value of a node from those of the nodes that it reads.
    fn computed(&mut self, node: NodeId, steps: usize) -> Option<Fraction> {
        let nodes = self.nodes;
        Some(match &nodes[node.0 as usize].operation {
            Operation::One => Fraction::whole(1),
            Operation::Integral { initial, .. } => initial.clone(),
            Operation::Sum(sum) => self.sum(sum, steps)?,
            Operation::Limited { sum, lower, upper } => {
                let value = self.sum(sum, steps)?;
                let raised = lower.as_ref().map_or(value.clone(), |lower| value.maximum(lower));
                upper.as_ref().map_or(raised.clone(), |upper| raised.minimum(upper))
            }
            Operation::Product([left, right]) => self.value(*left, steps)?.times(&self.value(*right, steps)?),
            Operation::Quotient { dividend, divisor } => {
                self.sum(dividend, steps)?.over(&self.value(*divisor, steps)?)
            }
            Operation::Root(sum) => root(&self.sum(sum, steps)?),
            Operation::Absolute(input) => absolute(&self.value(*input, steps)?),
            Operation::Lower([first, second]) => self.term(first, steps)?.minimum(&self.term(second, steps)?),
            Operation::Higher([first, second]) => {
                self.term(first, steps)?.maximum(&self.term(second, steps)?)
            }
            Operation::Switch { input, at_least_0, below_0 } => {
                let sign = self.sign(*input, steps)?;
                let [sum, difference] = [at_least_0.plus(below_0), at_least_0.minus(below_0)];
                sum.plus(&difference.times(&sign)).over(&Fraction::whole(2))
            }
            Operation::DeadZone { input, width } => {
                let (value, width) = (self.value(*input, steps)?, self.term(width, steps)?);
                let zero = Fraction::zero();
                value.minus(&width).maximum(&zero).plus(&value.plus(&width).minimum(&zero))
            }
            Operation::Function { kind, argument } => {
                let argument = self.term(argument, steps)?;
                call(kind.function(), &argument, &argument)
            }
            Operation::Delay { input, .. } => self.value(*input, steps)?,
            Operation::Drive(_) | Operation::Zero(_) | Operation::Curve { .. } => return None,
        })
    }

    /// The sign of a node as x / |x|, which formulas can state. `None` if the node is 0.
    fn sign(&mut self, node: NodeId, steps: usize) -> Option<Fraction> {
        let value = self.value(node, steps)?;
        (self.constants.value(&value) != 0.0).then(|| value.over(&absolute(&value)))
    }

    /// The value of a sum.
    fn sum(&mut self, sum: &Sum, steps: usize) -> Option<Fraction> {
        let mut value = Fraction::zero();
        for (node, factor) in &sum.terms {
            value = value.plus(&factor.times(&self.value(*node, steps)?));
        }
        Some(value)
    }

    /// The value of a weighted node.
    fn term(&mut self, term: &Term, steps: usize) -> Option<Fraction> {
        Some(term.coefficient.times(&self.value(term.node, steps)?))
    }
}
