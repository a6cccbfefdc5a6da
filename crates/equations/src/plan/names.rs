//! Names of nodes that are no quantities: the expressions that they compute.

use super::builder::Builder;
use crate::graph::{NodeId, ONE, Operation, Sum, Term};
use crate::notation::Notation;
use crate::symbolic::Fraction;

/// The number 1.
pub(super) const ONE_NOTATION: Notation = Notation::Number { value: 1.0, unit: None };

impl Builder<'_> {
    /// The expression that an operation computes, in the language of equations.
    pub(super) fn notation(&self, operation: &Operation) -> Notation {
        let call = |name: &str, arguments: Vec<Notation>| Notation::Call(name.to_owned(), arguments);
        let own = |node: NodeId| self.entry(node).notation.clone();
        match operation {
            Operation::One => ONE_NOTATION,
            Operation::Drive(name) => Notation::Name { name: name.clone(), primes: 0 },
            Operation::Integral { rate: sum, .. } | Operation::Sum(sum) | Operation::Zero(sum) => {
                self.sum_notation(sum)
            }
            Operation::Limited { sum, lower, upper } => {
                self.limited_notation(sum, lower.as_ref(), upper.as_ref())
            }
            Operation::Product([left, right]) => times(own(*left), own(*right)),
            Operation::Quotient { dividend, divisor } => {
                Notation::Quotient(Box::new(self.sum_notation(dividend)), Box::new(own(*divisor)))
            }
            Operation::Root(sum) => call("sqrt", vec![self.sum_notation(sum)]),
            Operation::Absolute(input) => call("abs", vec![own(*input)]),
            Operation::Lower(terms) => call("min", self.term_notations(terms)),
            Operation::Higher(terms) => call("max", self.term_notations(terms)),
            Operation::Switch { input, below_0, .. } => {
                call(if below_0.is_zero() { "step" } else { "sign" }, vec![own(*input)])
            }
            Operation::DeadZone { input, width } => {
                call("dead_zone", vec![own(*input), self.term_notation(width.node, &width.coefficient)])
            }
            Operation::Function { kind, argument } => {
                call(kind.function().name(), vec![self.term_notation(argument.node, &argument.coefficient)])
            }
            Operation::Curve { table, input } => {
                call(table, vec![self.term_notation(input.node, &input.coefficient)])
            }
            Operation::Delay { input, time, .. } => call("delay", vec![own(*input), self.constant(time)]),
        }
    }

    /// A power of a sum with a constant exponent.
    pub(super) fn power_notation(&self, base: &Sum, exponent: &Fraction) -> Notation {
        Notation::Power(Box::new(self.sum_notation(base)), Box::new(self.constant(exponent)))
    }

    /// A sum, with a positive term in front if there is one.
    pub(super) fn sum_notation(&self, sum: &Sum) -> Notation {
        let terms = sum.terms.iter().map(|(node, coefficient)| self.term_notation(*node, coefficient));
        let mut terms: Vec<Notation> = terms.collect();
        let positive = terms.iter().position(|term| !matches!(term, Notation::Negative(_)));
        if let Some(position) = positive {
            terms[..=position].rotate_right(1);
        }
        if terms.len() == 1 { terms.remove(0) } else { Notation::Sum(terms) }
    }

    /// A sum between bounds.
    fn limited_notation(&self, sum: &Sum, lower: Option<&Fraction>, upper: Option<&Fraction>) -> Notation {
        let name = match (lower, upper) {
            (Some(_), Some(_)) => "limit",
            (Some(_), None) => "max",
            (None, _) => "min",
        };
        let bounds = [lower, upper].into_iter().flatten().map(|bound| self.constant(bound));
        Notation::Call(name.to_owned(), [self.sum_notation(sum)].into_iter().chain(bounds).collect())
    }

    /// Weighted nodes.
    fn term_notations(&self, terms: &[Term]) -> Vec<Notation> {
        terms.iter().map(|term| self.term_notation(term.node, &term.coefficient)).collect()
    }

    /// A node times a constant.
    fn term_notation(&self, node: NodeId, coefficient: &Fraction) -> Notation {
        let constant = self.constant(coefficient);
        if node == ONE {
            return constant;
        }
        let own = self.entry(node).notation.clone();
        match constant {
            Notation::Negative(size) => Notation::Negative(Box::new(scaled(*size, own))),
            constant => scaled(constant, own),
        }
    }

    /// A constant.
    fn constant(&self, value: &Fraction) -> Notation {
        self.writer.expression(value, None)
    }
}

/// A constant times an expression. The inverse of a constant is a divisor.
fn scaled(constant: Notation, own: Notation) -> Notation {
    match constant {
        Notation::Quotient(top, bottom) if *top == ONE_NOTATION => Notation::Quotient(Box::new(own), bottom),
        constant => times(constant, own),
    }
}

/// The product of two expressions. Powers of one base are joined, and a factor 1 is left out.
pub(super) fn times(left: Notation, right: Notation) -> Notation {
    let mut powers: Vec<(Notation, f64)> = Vec::new();
    for factor in factors(left).into_iter().chain(factors(right)) {
        let (base, exponent) = base_and_exponent(factor);
        let is_number = matches!(base, Notation::Number { .. });
        match powers.iter_mut().find(|(known, _)| !is_number && *known == base) {
            Some((_, sum)) => *sum += exponent,
            None => powers.push((base, exponent)),
        }
    }
    let mut factors: Vec<Notation> =
        powers.into_iter().map(|(base, exponent)| raised(base, exponent)).collect();
    if factors.len() > 1 {
        factors.retain(|factor| *factor != ONE_NOTATION);
    }
    if factors.len() == 1 { factors.remove(0) } else { Notation::Product(factors) }
}

/// The factors of a product.
fn factors(notation: Notation) -> Vec<Notation> {
    match notation {
        Notation::Product(factors) => factors,
        other => vec![other],
    }
}

/// A factor as a power.
fn base_and_exponent(factor: Notation) -> (Notation, f64) {
    match factor {
        Notation::Power(base, exponent) => match *exponent {
            Notation::Number { value, unit: None } => (*base, value),
            exponent => (Notation::Power(base, Box::new(exponent)), 1.0),
        },
        other => (other, 1.0),
    }
}

/// A power with a number as the exponent.
fn raised(base: Notation, exponent: f64) -> Notation {
    if exponent == 1.0 {
        return base;
    }
    Notation::Power(Box::new(base), Box::new(Notation::Number { value: exponent, unit: None }))
}
