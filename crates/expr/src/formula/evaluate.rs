//! Evaluates a formula and explains why a value is missing or not finite.
//!
//! The tree is evaluated from the leaves to the root, and every intermediate value is checked. An
//! error therefore names the smallest part of the formula that has no finite value, together with the
//! values of its operands. Later stages can rely on a finite result.

use std::ops::Range;

use super::callee::Callee;
use super::equation::EquationFunction;
use super::error::FormulaError;
use super::expression::{Expression, Node, Operator};
use super::scope::{Scope, base_error, missing_property};
use super::wording::{excerpt, name_values, operand_values};
use crate::function::Function;
use crate::number_text::format_shortest;

/// Returns the value of a node. The value is always finite.
pub(super) fn value(text: &str, node: &Node, scope: &dyn Scope) -> Result<f64, FormulaError> {
    Evaluator { text, scope }.value(node)
}

/// Evaluates the nodes of one formula.
struct Evaluator<'e> {
    /// The text of the formula, for excerpts in error messages.
    text: &'e str,
    /// The values of the names, in SI units.
    scope: &'e dyn Scope,
}

impl Evaluator<'_> {
    /// Returns the value of a node. A literal number is checked too, because a constant can be NaN.
    fn value(&self, node: &Node) -> Result<f64, FormulaError> {
        match &node.expression {
            Expression::Number(value) => finite(&format_shortest(*value), *value, &node.range),
            Expression::Name(name) => self.named(name, &node.range),
            Expression::Negate(inner) => Ok(-self.value(inner)?),
            Expression::Binary(operator, left, right) => self.binary(node, *operator, left, right),
            Expression::Call(callee, arguments) => self.call(node, *callee, arguments),
            Expression::Apply(name, arguments) => self.application(node, name, arguments),
        }
    }

    /// Returns the value of a name from the scope.
    fn named(&self, name: &str, range: &Range<usize>) -> Result<f64, FormulaError> {
        match self.scope.value(name) {
            Some(value) => finite(name, value, range),
            None => Err(missing_property(self.scope, name, "value", range.clone())),
        }
    }

    /// Returns the value of an operation. A power is computed by the same function as `power(a, b)`.
    fn binary(
        &self,
        node: &Node,
        operator: Operator,
        left: &Node,
        right: &Node,
    ) -> Result<f64, FormulaError> {
        let a = self.value(left).map_err(|error| match operator {
            Operator::Power => base_error(self.text, left, right, error),
            _ => error,
        })?;
        let b = self.value(right)?;
        let operands = [(left, a), (right, b)];
        match operator {
            Operator::Add => self.check_overflow(node, a + b, &operands),
            Operator::Subtract => self.check_overflow(node, a - b, &operands),
            Operator::Multiply => self.check_overflow(node, a * b, &operands),
            Operator::Divide if b == 0.0 => Err(self.denominator_is_zero(right)),
            Operator::Divide => self.check_overflow(node, a / b, &operands),
            Operator::Power => self.apply(node, Callee::Function(Function::Power), &operands),
        }
    }

    /// Evaluates the arguments from left to right and calls the function.
    fn call(&self, node: &Node, callee: Callee, arguments: &[Node]) -> Result<f64, FormulaError> {
        self.apply(node, callee, &self.operands(arguments)?)
    }

    /// Returns the value of a function of equations. Delays and tables have none here: it depends on more than
    /// the present values of the arguments.
    fn application(&self, node: &Node, name: &str, arguments: &[Node]) -> Result<f64, FormulaError> {
        let operands = self.operands(arguments)?;
        let values: Vec<f64> = operands.iter().map(|(_, value)| *value).collect();
        match EquationFunction::from_name(name).and_then(|function| function.value(&values)) {
            Some(value) => self.check_overflow(node, value, &operands),
            None => {
                let message = format!("{} has no value here", excerpt(self.text, node));
                Err(FormulaError::new(node.range.clone(), message))
            }
        }
    }

    /// Returns the arguments of a call with their values, evaluated from left to right.
    fn operands<'n>(&self, arguments: &'n [Node]) -> Result<Vec<(&'n Node, f64)>, FormulaError> {
        arguments.iter().map(|argument| Ok((argument, self.value(argument)?))).collect()
    }

    /// Calls a function with evaluated operands. A function of one argument gets 0 as the second.
    ///
    /// A NaN, or an infinite value at a first argument of 0 (a pole), means that the arguments are
    /// outside the domain; the hint then describes the domain. Any other infinite value is an overflow.
    fn apply(&self, node: &Node, callee: Callee, operands: &[(&Node, f64)]) -> Result<f64, FormulaError> {
        let argument = |index: usize| operands.get(index).map_or(0.0, |(_, value)| *value);
        let value = callee.apply(argument(0), argument(1));
        // An infinite value is a pole if the first argument is 0. Otherwise the result has overflowed.
        if value.is_finite() || (value.is_infinite() && argument(0) != 0.0) {
            return self.check_overflow(node, value, operands);
        }
        let values = operand_values(self.text, operands);
        let message = format!("{} has no finite value{values}", excerpt(self.text, node));
        let hint = callee.domain().map(str::to_owned);
        Err(FormulaError::new(node.range.clone(), message).with_hint_if(hint))
    }

    /// Returns the value if it is finite. The error for an overflow lists the values of the operands.
    fn check_overflow(
        &self,
        node: &Node,
        value: f64,
        operands: &[(&Node, f64)],
    ) -> Result<f64, FormulaError> {
        if value.is_finite() {
            return Ok(value);
        }
        let values = operand_values(self.text, operands);
        let message = format!("{} is too large for a number{values}", excerpt(self.text, node));
        Err(FormulaError::new(node.range.clone(), message))
    }

    /// Returns the error for a division by 0, with the values of the names in the denominator.
    fn denominator_is_zero(&self, denominator: &Node) -> FormulaError {
        let message = match denominator.expression {
            Expression::Number(_) => "the denominator is 0".to_owned(),
            _ => format!(
                "the denominator {} is 0{}",
                excerpt(self.text, denominator),
                name_values(denominator, self.scope)
            ),
        };
        FormulaError::new(denominator.range.clone(), message)
    }
}

/// Returns the value of a number or a name if it is finite.
fn finite(name: &str, value: f64, range: &Range<usize>) -> Result<f64, FormulaError> {
    if value.is_finite() {
        return Ok(value);
    }
    let message = format!("{name} has no finite value");
    Err(FormulaError::new(range.clone(), message))
}
