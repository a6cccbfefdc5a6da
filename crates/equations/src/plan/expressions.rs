//! Reads expressions of equations as sums of nodes.

use std::collections::BTreeMap;
use std::ops::Range;

use patchcord_expr::{Expression, FormulaError, Node, Operator};

use super::builder::Builder;
use super::trees::{factors, terms};
use crate::graph::{NodeId, Sum};
use crate::symbolic::Fraction;

/// Reads the expressions of one equation.
pub(super) struct Reader<'r, 'a> {
    /// Makes the nodes.
    pub builder: &'r mut Builder<'a>,
    /// The nodes of the quantities, by name with primes.
    pub names: &'r BTreeMap<String, NodeId>,
    /// The text of the equation.
    pub text: &'r str,
}

/// The name of problem time in equations.
const TIME: &str = "t";

impl Reader<'_, '_> {
    /// An expression as a sum of nodes.
    ///
    /// # Errors
    /// If a function or a power has no elements, or a divisor is 0.
    pub(super) fn form(&mut self, node: &Node) -> Result<Sum, FormulaError> {
        match &node.expression {
            Expression::Number(_) => {
                Ok(Sum::constant(&self.builder.constants.expression(node).unwrap_or_default()))
            }
            Expression::Name(name) => self.named(name, &node.range),
            Expression::Negate(_) | Expression::Binary(Operator::Add | Operator::Subtract, ..) => {
                self.sum(node)
            }
            Expression::Binary(Operator::Multiply | Operator::Divide, ..) => self.product(node),
            Expression::Binary(Operator::Power, base, exponent) => self.power(node, base, exponent),
            Expression::Call(callee, arguments) => self.call(node, *callee, arguments),
            Expression::Apply(name, arguments) => self.application(node, name, arguments),
        }
    }

    /// The value of a name.
    fn named(&mut self, name: &str, range: &Range<usize>) -> Result<Sum, FormulaError> {
        if let Some(value) = self.builder.constants.named(name) {
            return Ok(Sum::constant(value));
        }
        let node = match self.names.get(name) {
            Some(node) => *node,
            None if name == TIME => self.builder.time(),
            None if self.builder.is_drive(name) => self.builder.drive(name),
            None => {
                let message = format!("no equation determines {name}");
                let hint = format!("write an equation for {name}");
                return Err(fault(range.clone(), message, hint));
            }
        };
        Ok(Sum::node(node))
    }

    /// A sum of terms.
    fn sum(&mut self, node: &Node) -> Result<Sum, FormulaError> {
        let mut sum = Sum::default();
        for (is_negative, term) in terms(node) {
            let form = self.form(term)?;
            sum = if is_negative { sum.minus(&form) } else { sum.plus(&form) };
        }
        Ok(sum)
    }

    /// A product of factors and divisors.
    fn product(&mut self, node: &Node) -> Result<Sum, FormulaError> {
        let product = factors(node);
        let [mut tops, bottoms] = self.factor_forms(&product.factors)?;
        if product.is_negative {
            tops.push(Sum::constant(&Fraction::whole(-1)));
        }
        Ok(self.builder.ratio(&tops, &bottoms))
    }

    /// The factors and the divisors of a product.
    pub(super) fn factor_forms(&mut self, factors: &[(&Node, bool)]) -> Result<[Vec<Sum>; 2], FormulaError> {
        let mut forms = [Vec::new(), Vec::new()];
        for (factor, divides) in factors {
            let (form, divides) = match self.inverse_power(factor)? {
                Some(form) => (form, !divides),
                None => (self.form(factor)?, *divides),
            };
            if divides {
                self.check_divisor(factor, &form)?;
            }
            forms[usize::from(divides)].push(form);
        }
        Ok(forms)
    }

    /// Checks that a divisor is not the constant 0, also for the present values of the parameters.
    pub(super) fn check_divisor(&self, node: &Node, divisor: &Sum) -> Result<(), FormulaError> {
        match divisor.as_constant() {
            Some(value) if self.builder.constants.value(&value) == 0.0 || value.is_zero() => {
                let message = format!("the divisor {} is 0", self.excerpt(node));
                let hint =
                    "choose parameters for which it is not 0, or multiply the equation by it".to_owned();
                Err(fault(node.range.clone(), message, hint))
            }
            _ => Ok(()),
        }
    }

    /// The text of a node.
    pub(super) fn excerpt(&self, node: &Node) -> &str {
        self.text.get(node.range.clone()).unwrap_or_default()
    }
}

/// A fault of an expression with its hint.
pub(super) fn fault(range: Range<usize>, message: String, hint: String) -> FormulaError {
    FormulaError { range, message, hint: Some(hint) }
}
