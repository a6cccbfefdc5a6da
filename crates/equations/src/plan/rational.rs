//! Equations that are rational functions of their unknown: they are solved by quotients and square roots.
//!
//! An open amplifier cannot solve an equation such as x^2 + y^2 = 1, because a second solution is within its range.

use patchcord_expr::{Equation, Expression, FormulaError, Node, Operator};

use super::builder::Builder;
use super::expressions::Reader;
use super::trees::{contains, factors, terms};
use crate::graph::{Operation, Sum};
use crate::symbolic::{Fraction, nearest, root};

/// The largest exponent of the unknown.
const MOST_DEGREE: usize = 4;

/// A polynomial in the unknown: the coefficients of its powers, from the exponent 0 on. The last one is not 0.
type Coefficients = Vec<Sum>;

/// A rational function of the unknown.
struct RationalFunction {
    /// The numerator.
    top: Coefficients,
    /// The denominator.
    bottom: Coefficients,
}

impl Reader<'_, '_> {
    /// The value of an unknown from an equation that is rational in it, and of which it is a quotient or a square root.
    /// `None` for other equations.
    ///
    /// Of two solutions it is the one near `start`. Without a start it is the positive square root, or the solution near 0.
    ///
    /// # Errors
    /// If an expression cannot be read.
    pub(super) fn rational_solution(
        &mut self,
        equation: &Equation,
        unknown: &str,
        start: Option<&Fraction>,
    ) -> Result<Option<Sum>, FormulaError> {
        let Some(left) = self.rational(equation.left(), unknown)? else { return Ok(None) };
        let Some(right) = self.rational(equation.right(), unknown)? else { return Ok(None) };
        let Some(difference) = self.builder.rational_sum(&left, &right, true) else { return Ok(None) };
        Ok(self.builder.solution_of(&difference.top, start))
    }

    /// An expression as a rational function of an unknown. `None` if it is none, or its degree is too large.
    fn rational(&mut self, node: &Node, unknown: &str) -> Result<Option<RationalFunction>, FormulaError> {
        let whole = |top: Coefficients| RationalFunction { top, bottom: vec![one()] };
        if !contains(node, unknown) {
            return Ok(Some(whole(trimmed(vec![self.form(node)?]))));
        }
        match &node.expression {
            Expression::Name(_) => Ok(Some(whole(vec![Sum::default(), one()]))),
            Expression::Negate(_) | Expression::Binary(Operator::Add | Operator::Subtract, ..) => {
                self.rational_terms(node, unknown)
            }
            Expression::Binary(Operator::Multiply | Operator::Divide, ..) => {
                self.rational_factors(node, unknown)
            }
            Expression::Binary(Operator::Power, base, exponent) => {
                let Some(exponent) = self.whole_exponent(exponent) else { return Ok(None) };
                let Some(base) = self.rational(base, unknown)? else { return Ok(None) };
                Ok(self.builder.rational_power(base, exponent))
            }
            _ => Ok(None),
        }
    }

    /// A sum of rational functions.
    fn rational_terms(
        &mut self,
        node: &Node,
        unknown: &str,
    ) -> Result<Option<RationalFunction>, FormulaError> {
        let mut sum = RationalFunction { top: Vec::new(), bottom: vec![one()] };
        for (is_negative, term) in terms(node) {
            let Some(term) = self.rational(term, unknown)? else { return Ok(None) };
            let Some(next) = self.builder.rational_sum(&sum, &term, is_negative) else { return Ok(None) };
            sum = next;
        }
        Ok(Some(sum))
    }

    /// A product of rational functions.
    fn rational_factors(
        &mut self,
        node: &Node,
        unknown: &str,
    ) -> Result<Option<RationalFunction>, FormulaError> {
        let product = factors(node);
        let sign = Fraction::whole(if product.is_negative { -1 } else { 1 });
        let mut result = RationalFunction { top: vec![Sum::constant(&sign)], bottom: vec![one()] };
        for (factor, divides) in &product.factors {
            let Some(factor) = self.rational(factor, unknown)? else { return Ok(None) };
            let factor = if *divides { factor.inverse() } else { factor };
            let Some(next) = self.builder.rational_product(&result, &factor) else { return Ok(None) };
            result = next;
        }
        Ok(Some(result))
    }

    /// An exponent that is a small whole number. `None` for other exponents.
    fn whole_exponent(&self, exponent: &Node) -> Option<i32> {
        let value = nearest(&self.builder.constants.expression(exponent)?.as_rational()?);
        (value.fract() == 0.0 && value.abs() <= MOST_DEGREE as f64).then_some(value as i32)
    }
}

impl RationalFunction {
    /// 1 over the function.
    fn inverse(self) -> RationalFunction {
        RationalFunction { top: self.bottom, bottom: self.top }
    }
}

impl Builder<'_> {
    /// The sum or the difference of two functions. `None` if its degree is too large.
    fn rational_sum(
        &mut self,
        left: &RationalFunction,
        right: &RationalFunction,
        is_difference: bool,
    ) -> Option<RationalFunction> {
        let sign = Fraction::whole(if is_difference { -1 } else { 1 });
        let add = |one: Coefficients, other: Coefficients| {
            let mut sums = vec![Sum::default(); one.len().max(other.len())];
            for (sum, own) in sums.iter_mut().zip(one) {
                *sum = own;
            }
            for (sum, own) in sums.iter_mut().zip(other) {
                *sum = std::mem::take(sum).plus(&own.scaled(&sign));
            }
            trimmed(sums)
        };
        if left.bottom == right.bottom {
            let top = add(left.top.clone(), right.top.clone());
            return Some(RationalFunction { top, bottom: left.bottom.clone() });
        }
        let first = self.polynomial_product(&left.top, &right.bottom)?;
        let second = self.polynomial_product(&right.top, &left.bottom)?;
        let bottom = self.polynomial_product(&left.bottom, &right.bottom)?;
        Some(RationalFunction { top: add(first, second), bottom })
    }

    /// The product of two functions. `None` if its degree is too large.
    fn rational_product(
        &mut self,
        left: &RationalFunction,
        right: &RationalFunction,
    ) -> Option<RationalFunction> {
        let top = self.polynomial_product(&left.top, &right.top)?;
        Some(RationalFunction { top, bottom: self.polynomial_product(&left.bottom, &right.bottom)? })
    }

    /// A whole power of a function. `None` if its degree is too large.
    fn rational_power(&mut self, base: RationalFunction, exponent: i32) -> Option<RationalFunction> {
        let base = if exponent < 0 { base.inverse() } else { base };
        let mut power = RationalFunction { top: vec![one()], bottom: vec![one()] };
        for _ in 0..exponent.abs() {
            power = self.rational_product(&power, &base)?;
        }
        Some(power)
    }

    /// The product of two polynomials. `None` if its degree is too large.
    fn polynomial_product(&mut self, left: &[Sum], right: &[Sum]) -> Option<Coefficients> {
        let degree = (left.len() + right.len()).saturating_sub(2);
        if degree > MOST_DEGREE {
            return None;
        }
        let mut product = vec![Sum::default(); degree + 1];
        for (low, left) in left.iter().enumerate() {
            for (high, right) in right.iter().enumerate() {
                let term = self.times(left, right);
                let sum = &mut product[low + high];
                *sum = std::mem::take(sum).plus(&term);
            }
        }
        Some(trimmed(product))
    }

    /// The zero of a polynomial near a start: of degree 1, of one even power, or of degree 2 with constant factors of both
    /// powers. `None` for other polynomials.
    fn solution_of(&mut self, polynomial: &[Sum], start: Option<&Fraction>) -> Option<Sum> {
        let (first, powers) = polynomial.split_first()?;
        let (highest, lower) = powers.split_last()?;
        if highest.as_constant().is_some_and(|factor| self.constants.value(&factor) == 0.0) {
            return None;
        }
        let degree = powers.len();
        if lower.iter().all(|factor| factor.terms.is_empty()) {
            let power = self.ratio(&[first.negated()], std::slice::from_ref(highest));
            return if degree == 1 { Some(power) } else { self.even_root(power, degree, start) };
        }
        let [linear] = lower else { return None };
        let (square, linear) = (highest.as_constant()?, linear.as_constant()?);
        // y^2 + 2 h y + rest = 0
        let half = linear.over(&square.times(&Fraction::whole(2)));
        let rest = first.scaled(&Fraction::whole(1).over(&square));
        let radicand = Sum::constant(&half.times(&half)).minus(&rest);
        let distance = self.square_root(radicand);
        let from_middle = match start {
            Some(start) => self.constants.value(&start.plus(&half)),
            None => self.constants.value(&half),
        };
        let distance = if from_middle < 0.0 { distance.negated() } else { distance };
        Some(distance.minus(&Sum::constant(&half)))
    }

    /// The root of an even degree that has the sign of a start. `None` if the degree is no power of 2.
    fn even_root(&mut self, power: Sum, degree: usize, start: Option<&Fraction>) -> Option<Sum> {
        if !degree.is_power_of_two() {
            return None;
        }
        let root = (0..degree.ilog2()).fold(power, |power, _| self.square_root(power));
        let is_negative = start.is_some_and(|start| self.constants.value(start) < 0.0);
        Some(if is_negative { root.negated() } else { root })
    }

    /// The square root of a sum.
    fn square_root(&mut self, radicand: Sum) -> Sum {
        match radicand.as_constant() {
            Some(constant) => Sum::constant(&root(&constant)),
            None => Sum::node(self.add(Operation::Root(radicand))),
        }
    }
}

/// The number 1 as a sum.
fn one() -> Sum {
    Sum::constant(&Fraction::whole(1))
}

/// A polynomial without factors of 0 at its end.
fn trimmed(mut polynomial: Coefficients) -> Coefficients {
    while polynomial.last().is_some_and(|factor| factor.terms.is_empty()) {
        polynomial.pop();
    }
    polynomial
}
