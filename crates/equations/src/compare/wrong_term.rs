//! Finds the only wrong term of an equation with several divisors.
//!
//! In normal form, such an equation is one long sum over all its divisors, in which a reader does not find the terms of the
//! equation again. So each term of the equation as it is written is compared with the whole difference at points.

use std::collections::HashSet;

use patchcord_expr::{Equation, Expression, Node, Operator};

use super::comparison::Comparison;
use super::intended::fraction;
use super::model::Obstacle;
use super::points::{MIN_POINTS, ParameterValues, Point, points};
use super::solution::Solved;
use super::terms::{DifferenceKind, TermDifference, kind_of_factor};
use crate::symbolic::{Fraction, Symbol, term_size, value};

/// Smallest number of divisors with which a difference is explained by a term as it is written.
const MIN_DIVISORS: usize = 2;
/// Difference by rounding, as a share of the sum of the terms. A smaller difference explains nothing.
const ROUNDING: f64 = 1e-6;
/// Relative deviation of a ratio from a constant.
const CONSTANT: f64 = 1e-6;

/// A point with the difference of a stated value from the wired one.
type Sample<'a> = (Point<'a>, f64);

impl Comparison<'_> {
    /// The only term of an equation that is wrong. `None` if there are few divisors, or if no single term explains the
    /// difference. `wired` is the value that the wiring gives to the quantity for which the equation is solved.
    pub(super) fn wrong_term(
        &mut self,
        equation: &Equation,
        solved: &Solved,
        wired: &Fraction,
        kept: &HashSet<Symbol>,
    ) -> Option<TermDifference> {
        let divisors = solved.value.divisors().len().max(wired.divisors().len());
        if divisors < MIN_DIVISORS {
            return None;
        }
        let terms = self.written_terms(equation, solved, kept);
        let samples = samples(self.point(ParameterValues::Present), [&solved.value, wired]);
        terms.into_iter().find_map(|stated| {
            let factor = 1.0 - constant_ratio(&samples, &stated)?;
            let kind =
                if factor.abs() < CONSTANT { DifferenceKind::Missing } else { kind_of_factor(factor)? };
            let wired = stated.times(&Fraction::number(factor));
            Some(TermDifference { stated, wired, kind })
        })
    }

    /// The terms of an equation as it is written, each with its share in the value of the quantity for which the equation
    /// is solved. Terms with this quantity are left out.
    fn written_terms(
        &mut self,
        equation: &Equation,
        solved: &Solved,
        kept: &HashSet<Symbol>,
    ) -> Vec<Fraction> {
        let mut written = Vec::new();
        add_terms(equation.right(), false, &mut written);
        add_terms(equation.left(), true, &mut written);
        let share = |(is_negative, node): (bool, &Node)| {
            let found = fraction(node, &mut |name| {
                if name == solved.name {
                    return Err(Obstacle::Unknown(name.to_owned()));
                }
                self.model.named(name, kept)
            });
            let share = found.ok()?.over(&solved.slope);
            Some(if is_negative { share.negated() } else { share })
        };
        written.into_iter().filter_map(share).collect()
    }
}

/// Adds the terms of a sum, each with whether it is subtracted.
fn add_terms<'n>(node: &'n Node, is_negative: bool, terms: &mut Vec<(bool, &'n Node)>) {
    match &node.expression {
        Expression::Negate(inner) => add_terms(inner, !is_negative, terms),
        Expression::Binary(operator @ (Operator::Add | Operator::Subtract), left, right) => {
            add_terms(left, is_negative, terms);
            add_terms(right, is_negative != (*operator == Operator::Subtract), terms);
        }
        _ => terms.push((is_negative, node)),
    }
}

/// The differences of a stated and a wired value at the points at which they are above the rounding.
fn samples<'a>(point: Point<'a>, [stated, wired]: [&Fraction; 2]) -> Vec<Sample<'a>> {
    let sample = |point: Point<'a>| {
        let difference = value(stated, &point) - value(wired, &point);
        let size = term_size(stated, &point) + term_size(wired, &point);
        (difference.abs() > ROUNDING * size && difference.is_finite()).then_some((point, difference))
    };
    points(point).filter_map(sample).collect()
}

/// The ratio of the difference to a term, if it is the same at all points. `None` if there are few points.
fn constant_ratio(samples: &[Sample<'_>], term: &Fraction) -> Option<f64> {
    let ratios = samples.iter().map(|(point, difference)| difference / value(term, point));
    let ratios: Vec<f64> = ratios.filter(|ratio| ratio.is_finite()).collect();
    let first = *ratios.first()?;
    let is_same = |ratio: &f64| (ratio - first).abs() <= CONSTANT * first.abs();
    (ratios.len() >= MIN_POINTS as usize && ratios.iter().all(is_same)).then_some(first)
}
