//! Bounds of the size of an expression of constants, before it is multiplied out.
//!
//! A chain of squares, such as b = (a + 1)^2 and c = (b + 1)^2, doubles the degree with every step.

use std::collections::BTreeMap;

use patchcord_expr::{Expression, Node, Operator};

use crate::symbolic::{Fraction, Monomial};

/// The most terms of an expression that is multiplied out.
const MOST_TERMS: f64 = 400.0;
/// The largest degree of an expression that is multiplied out. The digits of a number grow with it too.
const MOST_DEGREE: f64 = 400.0;
/// Larger whole exponents are not multiplied out.
const MOST_EXPONENT: f64 = 12.0;

/// Upper bounds of the size of an expression.
#[derive(Clone, Copy)]
struct Extent {
    /// The terms of the numerator.
    tops: f64,
    /// The terms of the denominator.
    bottoms: f64,
    /// The degree. Numbers count as factors.
    degree: f64,
}

/// Whether an expression of constants stays short if it is multiplied out. `named` has the values of its names.
pub(super) fn is_short(node: &Node, named: &BTreeMap<String, Fraction>) -> bool {
    extent(node, named).is_some()
}

/// The extent of an expression. `None` if it, or a part of it, is too large.
fn extent(node: &Node, named: &BTreeMap<String, Fraction>) -> Option<Extent> {
    let found = match &node.expression {
        Expression::Number(_) => Extent::ATOM,
        Expression::Name(name) => named.get(name).map_or(Extent::ATOM, Extent::of),
        Expression::Negate(inner) => extent(inner, named)?,
        Expression::Binary(operator, left, right) => {
            let (left, other) = (extent(left, named)?, extent(right, named)?);
            match operator {
                Operator::Add | Operator::Subtract => left.plus(other),
                Operator::Multiply => left.times(other),
                Operator::Divide => left.times(other.inverse()),
                Operator::Power => left.power(exponent(right)),
            }
        }
        Expression::Call(_, arguments) | Expression::Apply(_, arguments) => {
            let arguments: Option<Vec<Extent>> =
                arguments.iter().map(|argument| extent(argument, named)).collect();
            // A minimum or a maximum consists of its arguments and an absolute value.
            arguments?.into_iter().fold(Extent::ATOM, Extent::plus)
        }
    };
    let is_short = found.tops <= MOST_TERMS && found.bottoms <= MOST_TERMS && found.degree <= MOST_DEGREE;
    is_short.then_some(found)
}

/// The size of an exponent, at most the largest one that is multiplied out.
fn exponent(node: &Node) -> f64 {
    match &node.expression {
        Expression::Number(value) => value.abs().min(MOST_EXPONENT).ceil(),
        Expression::Negate(inner) => exponent(inner),
        _ => MOST_EXPONENT,
    }
}

impl Extent {
    /// A number, a symbol or a function.
    const ATOM: Extent = Extent { tops: 1.0, bottoms: 1.0, degree: 1.0 };

    /// The extent of a known expression.
    fn of(fraction: &Fraction) -> Extent {
        let degree_of = |product: &Monomial| {
            product.factors().iter().map(|(_, exponent)| f64::from(exponent.unsigned_abs())).sum::<f64>()
        };
        let numerator = fraction.numerator();
        let degree = numerator.terms().map(|(product, _)| degree_of(product)).fold(1.0, f64::max);
        let extent = Extent { tops: numerator.terms().len() as f64, bottoms: 1.0, degree };
        fraction.divisors().fold(extent, |extent, (divisor, power)| {
            let degree = divisor.terms().map(|(product, _)| degree_of(product)).fold(1.0, f64::max);
            let bottom = Extent { tops: divisor.terms().len() as f64, bottoms: 1.0, degree };
            extent.times(bottom.power(f64::from(power)).inverse())
        })
    }

    /// The extent of a sum.
    fn plus(self, other: Extent) -> Extent {
        let degree = if self.bottoms * other.bottoms == 1.0 {
            self.degree.max(other.degree)
        } else {
            self.degree + other.degree
        };
        let tops = self.tops * other.bottoms + other.tops * self.bottoms;
        Extent { tops, bottoms: self.bottoms * other.bottoms, degree }
    }

    /// The extent of a product.
    fn times(self, other: Extent) -> Extent {
        Extent {
            tops: self.tops * other.tops,
            bottoms: self.bottoms * other.bottoms,
            degree: self.degree + other.degree,
        }
    }

    /// The extent of 1 over the expression.
    fn inverse(self) -> Extent {
        Extent { tops: self.bottoms, bottoms: self.tops, degree: self.degree }
    }

    /// The extent of a power with a whole exponent.
    fn power(self, exponent: f64) -> Extent {
        let terms = |count: f64| {
            let mut terms = 1.0;
            let mut step = 0.0;
            while step < exponent {
                terms *= (count + step) / (step + 1.0);
                step += 1.0;
            }
            terms
        };
        Extent {
            tops: terms(self.tops),
            bottoms: terms(self.bottoms),
            degree: (self.degree * exponent).max(1.0),
        }
    }
}
