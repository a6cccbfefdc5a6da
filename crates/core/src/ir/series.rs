//! Truncated Taylor series: a number with its first derivatives along time.
//!
//! The rules are those of A. Griewank and A. Walther, Evaluating Derivatives, 2nd edition, 2008, chapter 13. A term of a
//! result depends on the terms of the arguments up to the same order only, so later terms can be added one by one.

use std::f64::consts::LN_10;

use super::number::{Number, segment};
use patchcord_expr::Function;

/// Number of terms: the number itself and those of its derivatives.
pub(crate) const TERMS: usize = 13;

/// A number as a polynomial of time. At a kink, the terms decide which side applies after the present instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Series {
    /// The factors of the powers of time, from power 0.
    pub terms: [f64; TERMS],
}

impl Series {
    /// A number that rises by this much in a unit of time.
    pub(crate) fn rising(value: f64, slope: f64) -> Self {
        let mut series = Series::constant(value);
        series.terms[1] = slope;
        series
    }

    /// The derivative.
    fn rate(self) -> Self {
        let mut rate = Series::constant(0.0);
        for (order, term) in self.terms.iter().enumerate().skip(1) {
            rate.terms[order - 1] = order as f64 * term;
        }
        rate
    }

    /// Whether it does not vary.
    fn is_constant(&self) -> bool {
        self.terms[1..].iter().all(|term| *term == 0.0)
    }

    /// Whether it is smaller now, or is equal now and becomes smaller.
    fn is_below(&self, other: &Self) -> bool {
        let mut pairs = self.terms.iter().zip(&other.terms);
        pairs.find(|(own, other)| own != other).is_some_and(|(own, other)| own < other)
    }

    /// The product with a number.
    fn scaled(self, factor: f64) -> Self {
        Series { terms: self.terms.map(|term| factor * term) }
    }
}

impl Number for Series {
    fn constant(value: f64) -> Self {
        let mut terms = [0.0; TERMS];
        terms[0] = value;
        Series { terms }
    }
    fn add(self, other: Self) -> Self {
        Series { terms: std::array::from_fn(|order| self.terms[order] + other.terms[order]) }
    }
    fn subtract(self, other: Self) -> Self {
        Series { terms: std::array::from_fn(|order| self.terms[order] - other.terms[order]) }
    }
    fn multiply(self, other: Self) -> Self {
        let term =
            |order: usize| (0..=order).map(|own| self.terms[own] * other.terms[order - own]).sum::<f64>();
        Series { terms: std::array::from_fn(term) }
    }
    fn divide(self, other: Self) -> Self {
        let mut quotient = Series::constant(0.0);
        for order in 0..TERMS {
            let known: f64 = (0..order).map(|lower| quotient.terms[lower] * other.terms[order - lower]).sum();
            quotient.terms[order] = (self.terms[order] - known) / other.terms[0];
        }
        quotient
    }
    fn lower_of(self, other: Self) -> Self {
        if other.is_below(&self) { other } else { self }
    }
    fn upper_of(self, other: Self) -> Self {
        if self.is_below(&other) { other } else { self }
    }
    fn absolute(self) -> Self {
        if self.is_below(&Series::constant(0.0)) { self.scaled(-1.0) } else { self }
    }
    fn select(left: Self, right: Self, then: Self, otherwise: Self) -> Self {
        // The first condition excludes NaN, which is below nothing.
        if left.terms[0] >= right.terms[0] && !left.is_below(&right) { then } else { otherwise }
    }
    fn call(function: Function, a: Self, b: Self) -> Self {
        called(function, a, b, TERMS)
    }
    fn table(self, points: &[[f64; 2]]) -> Self {
        let abscissa = self.terms[0];
        let (value, slope, origin) = segment(points, abscissa);
        let is_falling = self.is_below(&Series::constant(abscissa));
        let slope_ahead = if is_falling { segment(points, abscissa.next_down()).1 } else { slope };
        let mut ordinate = self.scaled(slope_ahead);
        ordinate.terms[0] = value + slope * (abscissa - origin);
        ordinate
    }
}

/// The first terms of a function, at least one. The others are 0.
fn called(function: Function, a: Series, b: Series, count: usize) -> Series {
    let mut result = Series::constant(function.apply(a.terms[0], b.terms[0]));
    // A function of one argument does not depend on the second one.
    let b = if function.argument_count() > 1 { b } else { Series::constant(0.0) };
    if count == 1 || (a.is_constant() && b.is_constant()) {
        return result;
    }
    let [by_a, by_b] = partial_derivatives(function, a, b, count - 1);
    // A constant has no rate even if the function is infinitely steep.
    let along = |steepness: Series, argument: Series| {
        if argument.is_constant() { Series::constant(0.0) } else { steepness.multiply(argument.rate()) }
    };
    let rate = along(by_a, a).add(along(by_b, b));
    for order in 1..count {
        result.terms[order] = rate.terms[order - 1] / order as f64;
    }
    result
}

/// The first terms of the partial derivatives of a function. The derivative with respect to a second argument that it
/// does not have is 0.
fn partial_derivatives(function: Function, a: Series, b: Series, count: usize) -> [Series; 2] {
    let (zero, one) = (Series::constant(0.0), Series::constant(1.0));
    let value = |function: Function| called(function, a, b, count);
    let square = |series: Series| series.multiply(series);
    let by_a = match function {
        Function::Sqrt => Series::constant(0.5).divide(value(function)),
        Function::Sin => value(Function::Cos),
        Function::Cos => value(Function::Sin).scaled(-1.0),
        Function::Tan => one.add(square(value(function))),
        Function::Atan => one.divide(one.add(square(a))),
        Function::Atan2 => {
            let distance = square(a).add(square(b));
            return [b.divide(distance), a.scaled(-1.0).divide(distance)];
        }
        Function::Exp => value(function),
        Function::Exp10 => value(function).scaled(LN_10),
        Function::Ln => one.divide(a),
        Function::Log10 => one.divide(a.scaled(LN_10)),
        Function::Tanh => one.subtract(square(value(function))),
        Function::Power => return power_derivatives(a, b, count),
        Function::Floor => zero,
    };
    [by_a, zero]
}

/// The first terms of the partial derivatives of a power. Only a positive base has values at all exponents, so a base has
/// to be positive if the exponent varies.
fn power_derivatives(base: Series, exponent: Series, count: usize) -> [Series; 2] {
    let (zero, one) = (Series::constant(0.0), Series::constant(1.0));
    if exponent == zero {
        return [zero, zero];
    }
    if exponent.is_constant() {
        let lower = called(Function::Power, base, exponent.subtract(one), count);
        return [exponent.multiply(lower), zero];
    }
    let own = called(Function::Power, base, exponent, count);
    [exponent.multiply(own).divide(base), own.multiply(called(Function::Ln, base, zero, count))]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A series with these first terms.
    fn series(first: &[f64]) -> Series {
        let mut series = Series::constant(0.0);
        series.terms[..first.len()].copy_from_slice(first);
        series
    }

    fn assert_begins(found: Series, expected: &[f64], what: &str) {
        for (order, (found, expected)) in found.terms.iter().zip(expected).enumerate() {
            assert!((found - expected).abs() < 1e-14, "{what}, term {order}: {found} is not {expected}");
        }
    }

    #[test]
    fn functions_have_their_known_series() {
        let (t, next) = (series(&[0.0, 1.0]), series(&[1.0, 1.0]));
        let cases: [(Function, Series, &[f64]); 10] = [
            (Function::Sin, t, &[0.0, 1.0, 0.0, -1.0 / 6.0, 0.0, 1.0 / 120.0]),
            (Function::Cos, t, &[1.0, 0.0, -0.5, 0.0, 1.0 / 24.0, 0.0]),
            (Function::Tan, t, &[0.0, 1.0, 0.0, 1.0 / 3.0, 0.0, 2.0 / 15.0]),
            (Function::Atan, t, &[0.0, 1.0, 0.0, -1.0 / 3.0, 0.0, 0.2]),
            (Function::Tanh, t, &[0.0, 1.0, 0.0, -1.0 / 3.0, 0.0, 2.0 / 15.0]),
            (Function::Exp, t, &[1.0, 1.0, 0.5, 1.0 / 6.0, 1.0 / 24.0]),
            (Function::Sqrt, next, &[1.0, 0.5, -0.125, 0.0625, -5.0 / 128.0]),
            (Function::Ln, next, &[0.0, 1.0, -0.5, 1.0 / 3.0, -0.25]),
            (Function::Floor, next, &[1.0, 0.0, 0.0]),
            (Function::Log10, next, &[0.0, 1.0 / LN_10, -0.5 / LN_10]),
        ];
        for (function, argument, expected) in cases {
            assert_begins(Number::call(function, argument, argument), expected, function.name());
        }
        let exp10 = Number::call(Function::Exp10, t, t);
        assert_begins(exp10, &[1.0, LN_10, LN_10 * LN_10 / 2.0], "exp10");
    }

    #[test]
    fn functions_of_two_arguments_have_their_known_series() {
        let (t, one, three) = (series(&[0.0, 1.0]), Series::constant(1.0), Series::constant(3.0));
        let power = |base, exponent| Number::call(Function::Power, base, exponent);
        assert_begins(power(t, three), &[0.0, 0.0, 0.0, 1.0, 0.0], "t^3");
        assert_begins(power(series(&[2.0, 1.0]), three), &[8.0, 12.0, 6.0, 1.0, 0.0], "(2 + t)^3");
        let two = 2f64.ln();
        assert_begins(power(Series::constant(2.0), t), &[1.0, two, two * two / 2.0], "2^t");
        assert_begins(Number::call(Function::Atan2, t, one), &[0.0, 1.0, 0.0, -1.0 / 3.0], "atan2(t, 1)");
        let from_below = Number::call(Function::Atan2, Series::constant(-1.0), t);
        assert_begins(from_below, &[-std::f64::consts::FRAC_PI_2, 1.0, 0.0, -1.0 / 3.0], "atan2(-1, t)");
    }

    #[test]
    fn quotients_and_products_have_their_known_series() {
        let (one, next) = (Series::constant(1.0), series(&[1.0, 1.0]));
        assert_begins(one.divide(next), &[1.0, -1.0, 1.0, -1.0, 1.0], "1/(1 + t)");
        assert_begins(next.multiply(next), &[1.0, 2.0, 1.0, 0.0], "(1 + t)^2");
    }

    #[test]
    fn a_term_depends_on_no_later_terms_of_the_arguments() {
        let functions = [
            Function::Sqrt,
            Function::Sin,
            Function::Cos,
            Function::Tan,
            Function::Atan,
            Function::Atan2,
            Function::Exp,
            Function::Exp10,
            Function::Ln,
            Function::Log10,
            Function::Tanh,
            Function::Power,
            Function::Floor,
        ];
        let arguments = [series(&[0.3, 0.0, 1.0, -0.5]), series(&[0.7, 0.2, -0.1])];
        for function in functions {
            let [a, b] = arguments;
            let whole = Series::call(function, a, b);
            for count in 1..TERMS {
                let [a, b] = arguments.map(|argument| series(&argument.terms[..count]));
                assert_begins(Series::call(function, a, b), &whole.terms[..count], function.name());
            }
        }
    }

    #[test]
    fn a_derivative_that_does_not_exist_is_not_finite() {
        let t = series(&[0.0, 1.0]);
        for function in [Function::Sqrt, Function::Ln, Function::Log10] {
            assert!(!Series::call(function, t, t).terms[1].is_finite(), "{}", function.name());
        }
        assert!(!Series::constant(1.0).divide(t).terms[1].is_finite());
        // The argument does not move, so neither does the root.
        let zero = Series::constant(0.0);
        assert_eq!(Series::call(Function::Sqrt, zero, zero), zero);
    }

    #[test]
    fn at_a_kink_the_side_ahead_applies() {
        let (zero, points) = (Series::constant(0.0), [[-1.0, 3.0], [0.0, 0.0], [1.0, 2.0]]);
        // -t^2 is below 0 at once, although its slope is 0.
        let falling = series(&[0.0, 0.0, -1.0]);
        assert_eq!(falling.upper_of(zero), zero);
        assert_eq!(falling.lower_of(zero), falling);
        assert_eq!(falling.absolute(), series(&[0.0, 0.0, 1.0]));
        assert_begins(falling.table(&points), &[0.0, 0.0, 3.0], "falling");
        assert_begins(series(&[0.0, 1.0]).table(&points), &[0.0, 2.0, 0.0], "rising");
        assert_eq!(Series::select(falling, zero, falling, zero), zero);
    }
}
