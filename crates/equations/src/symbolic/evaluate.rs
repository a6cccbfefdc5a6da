//! The value of an expression.

use super::fraction::Fraction;
use super::monomial::{Application, Atom, CallOrder, Monomial, Operation};
use super::number::{Rational, nearest};
use super::polynomial::Polynomial;
use super::symbol::Symbol;

/// What an expression is evaluated with.
pub(crate) trait Values {
    /// The value of a symbol.
    fn symbol(&self, symbol: Symbol) -> f64;
    /// The value of a table at an abscissa.
    fn table(&self, table: u32, at: f64) -> f64;
    /// The slope of a table at an abscissa.
    fn slope(&self, table: u32, at: f64) -> f64;
    /// The value of an expression some time ago.
    fn delayed(&self, expression: &Fraction, time: f64) -> f64;
}

/// The value of an expression.
pub(crate) fn value(fraction: &Fraction, values: &dyn Values) -> f64 {
    let top = sum(fraction.numerator(), values);
    fraction.divisors().fold(top, |top, (divisor, power)| top / sum(divisor, values).powi(power as i32))
}

/// The sum of the sizes of the terms of an expression.
pub(crate) fn term_size(fraction: &Fraction, values: &dyn Values) -> f64 {
    let size: f64 =
        fraction.numerator().terms().map(|(product, number)| term(product, number, values).abs()).sum();
    fraction
        .divisors()
        .fold(size, |size, (divisor, power)| size / sum(divisor, values).abs().powi(power as i32))
}

/// Sum of the terms of an expression, as a share of their sizes, up to which it is 0.
pub(super) const ZERO_SHARE: f64 = 1e-12;

/// Whether the value of an expression jumps exactly at a point: the argument of a step is 0 there.
pub(crate) fn is_at_switch(expression: &Fraction, values: &dyn Values) -> bool {
    let mut is_found = false;
    expression.with_factors(&mut |atom| {
        if let Atom::Apply(applied) = atom
            && applied.operation == Operation::Step
        {
            let argument = &applied.arguments[0];
            is_found |= value(argument, values).abs() <= ZERO_SHARE * term_size(argument, values);
        }
        None
    });
    is_found
}

/// The value of a sum.
fn sum(polynomial: &Polynomial, values: &dyn Values) -> f64 {
    polynomial.terms().map(|(product, number)| term(product, number, values)).sum()
}

/// The value of a product with a number in front of it.
fn term(product: &Monomial, number: &Rational, values: &dyn Values) -> f64 {
    let factors = product.factors().iter().map(|(atom, exponent)| factor(atom, values).powi(*exponent));
    factors.fold(nearest(number), |product, factor| product * factor)
}

/// The value of a factor.
fn factor(atom: &Atom, values: &dyn Values) -> f64 {
    match atom {
        Atom::Symbol(symbol) => values.symbol(*symbol),
        Atom::Apply(applied) => applied_value(applied, values),
    }
}

/// The value of a function.
fn applied_value(applied: &Application, values: &dyn Values) -> f64 {
    let argument =
        |index: usize| applied.arguments.get(index).map_or(0.0, |argument| value(argument, values));
    match applied.operation {
        Operation::Absolute => argument(0).abs(),
        Operation::Step => f64::from(u8::from(argument(0) >= 0.0)),
        Operation::Call(CallOrder(function)) => function.apply(argument(0), argument(1)),
        Operation::Table(table) => values.table(table, argument(0)),
        Operation::TableSlope(table) => values.slope(table, argument(0)),
        Operation::Minimum => argument(0).min(argument(1)),
        Operation::Maximum => argument(0).max(argument(1)),
        Operation::Limit => argument(0).max(argument(1)).min(argument(2)),
        Operation::Sign => f64::from(i8::from(argument(0) > 0.0) - i8::from(argument(0) < 0.0)),
        Operation::Delay => values.delayed(&applied.arguments[0], argument(1)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Point;
    use crate::testing::reading::read;

    #[test]
    fn a_step_jumps_where_its_argument_is_0() {
        let jumps_at = |x: f64| is_at_switch(&read("y + 2 sign(x - 1)"), &Point([x, 5.0, 0.0, 0.0, 0.0]));
        assert!(jumps_at(1.0));
        assert!(!jumps_at(0.9) && !jumps_at(1.1));
    }
}
