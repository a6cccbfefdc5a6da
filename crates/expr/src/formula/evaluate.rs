use std::ops::Range;

use super::callee::Callee;
use super::error::FormulaError;
use super::expression::{Expression, Node, Operator};
use super::scope::{Scope, not_told};
use super::words::{excerpt, number, values_of_names, values_of_parts};
use crate::function::Function;

/// The value of a node; always finite.
pub(super) fn value(text: &str, node: &Node, scope: &dyn Scope) -> Result<f64, FormulaError> {
    Evaluator { text, scope }.value(node)
}

struct Evaluator<'e> {
    text: &'e str,
    scope: &'e dyn Scope,
}

impl Evaluator<'_> {
    fn value(&self, node: &Node) -> Result<f64, FormulaError> {
        match &node.expression {
            Expression::Number(value) => finite(&number(*value), *value, &node.range),
            Expression::Name(name) => self.named(name, &node.range),
            Expression::Negate(inner) => Ok(-self.value(inner)?),
            Expression::Binary(operator, left, right) => self.binary(node, *operator, left, right),
            Expression::Call(callee, arguments) => self.call(node, *callee, arguments),
        }
    }

    fn named(&self, name: &str, range: &Range<usize>) -> Result<f64, FormulaError> {
        match self.scope.value(name) {
            Some(value) => finite(name, value, range),
            None => Err(not_told(self.scope, name, "value", range.clone())),
        }
    }

    fn binary(
        &self,
        node: &Node,
        operator: Operator,
        left: &Node,
        right: &Node,
    ) -> Result<f64, FormulaError> {
        let a = self.value(left)?;
        let b = self.value(right)?;
        let parts = [(left, a), (right, b)];
        match operator {
            Operator::Add => self.not_too_large(node, a + b, &parts),
            Operator::Subtract => self.not_too_large(node, a - b, &parts),
            Operator::Multiply => self.not_too_large(node, a * b, &parts),
            Operator::Divide if b == 0.0 => Err(self.denominator_is_zero(right)),
            Operator::Divide => self.not_too_large(node, a / b, &parts),
            Operator::Power => self.applied(node, Callee::Function(Function::Power), &parts),
        }
    }

    fn call(&self, node: &Node, callee: Callee, arguments: &[Node]) -> Result<f64, FormulaError> {
        let mut parts = Vec::with_capacity(arguments.len());
        for argument in arguments {
            parts.push((argument, self.value(argument)?));
        }
        self.applied(node, callee, &parts)
    }

    fn applied(&self, node: &Node, callee: Callee, parts: &[(&Node, f64)]) -> Result<f64, FormulaError> {
        let argument = |place: usize| parts.get(place).map_or(0.0, |(_, value)| *value);
        let value = callee.apply(argument(0), argument(1));
        // An infinite value at 0 is a pole; elsewhere the numbers have come to their end.
        if value.is_finite() || (value.is_infinite() && argument(0) != 0.0) {
            return self.not_too_large(node, value, parts);
        }
        let values = values_of_parts(self.text, parts);
        let message = format!("{} has no finite value{values}", excerpt(self.text, node));
        let hint = callee.domain().map(str::to_owned);
        Err(FormulaError::new(node.range.clone(), message).with_hint_if(hint))
    }

    fn not_too_large(&self, node: &Node, value: f64, parts: &[(&Node, f64)]) -> Result<f64, FormulaError> {
        if value.is_finite() {
            return Ok(value);
        }
        let values = values_of_parts(self.text, parts);
        let message = format!("{} is too large for a number{values}", excerpt(self.text, node));
        Err(FormulaError::new(node.range.clone(), message))
    }

    fn denominator_is_zero(&self, denominator: &Node) -> FormulaError {
        let message = match denominator.expression {
            Expression::Number(_) => "the denominator is 0".to_owned(),
            _ => format!(
                "the denominator {} is 0{}",
                excerpt(self.text, denominator),
                values_of_names(denominator, self.scope)
            ),
        };
        FormulaError::new(denominator.range.clone(), message)
    }
}

fn finite(what: &str, value: f64, range: &Range<usize>) -> Result<f64, FormulaError> {
    if value.is_finite() {
        return Ok(value);
    }
    let message = format!("{what} has no finite value");
    Err(FormulaError::new(range.clone(), message))
}
