//! The value of an expression.

use std::collections::HashMap;
use std::sync::Arc;

use super::application::Application;
use super::fraction::Fraction;
use super::monomial::{Atom, CallOrder, Monomial, Operation};
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
    Evaluation::new(values).fraction(fraction)
}

/// The sum of the sizes of the terms of an expression.
pub(crate) fn term_size(fraction: &Fraction, values: &dyn Values) -> f64 {
    let mut evaluation = Evaluation::new(values);
    let top: f64 = fraction.numerator().terms().map(|term| evaluation.term(term).abs()).sum();
    evaluation.over_divisors(top, fraction).abs()
}

/// Sum of the terms of an expression, as a share of their sizes, up to which it is 0.
pub(super) const ZERO_SHARE: f64 = 1e-12;

/// Whether the value of an expression jumps exactly at a point: the argument of a step is 0 there.
pub(crate) fn is_at_switch(expression: &Fraction, values: &dyn Values) -> bool {
    expression.has_step()
        && expression.has_factor(&mut |atom| {
            let step = atom.as_function().filter(|applied| applied.operation == Operation::Step);
            step.is_some_and(|applied| {
                let argument = &applied.arguments[0];
                value(argument, values).abs() <= ZERO_SHARE * term_size(argument, values)
            })
        })
}

/// The expressions at whose zeros an expression has a corner or jumps: the arguments of its absolute values and steps.
pub(crate) fn corner_arguments(expression: &Fraction) -> Vec<Fraction> {
    let mut found = Vec::new();
    expression.has_factor(&mut |atom| {
        if let Some(applied) = atom.as_function()
            && matches!(applied.operation, Operation::Absolute | Operation::Step)
        {
            found.push(applied.arguments[0].clone());
        }
        false
    });
    found
}

/// An evaluation at a point, with the values of functions that were found so far.
struct Evaluation<'v> {
    values: &'v dyn Values,
    /// The values of functions.
    known: HashMap<*const Application, f64>,
}

impl<'v> Evaluation<'v> {
    /// An evaluation with these values.
    fn new(values: &'v dyn Values) -> Self {
        Evaluation { values, known: HashMap::new() }
    }

    /// The value of an expression.
    fn fraction(&mut self, fraction: &Fraction) -> f64 {
        let top = self.sum(fraction.numerator());
        self.over_divisors(top, fraction)
    }

    /// A number over the divisors of an expression.
    fn over_divisors(&mut self, top: f64, fraction: &Fraction) -> f64 {
        fraction.divisors().fold(top, |top, (divisor, power)| top / self.sum(divisor).powi(power as i32))
    }

    /// The value of a sum.
    fn sum(&mut self, polynomial: &Polynomial) -> f64 {
        polynomial.terms().map(|term| self.term(term)).sum()
    }

    /// The value of a term.
    fn term(&mut self, (product, number): (&Monomial, &Rational)) -> f64 {
        let factors = product.factors().iter().map(|(atom, exponent)| self.factor(atom).powi(*exponent));
        factors.fold(nearest(number), |product, factor| product * factor)
    }

    /// The value of a factor.
    fn factor(&mut self, atom: &Atom) -> f64 {
        let applied = match atom {
            Atom::Symbol(symbol) => return self.values.symbol(*symbol),
            Atom::Apply(applied) => applied,
        };
        let key = Arc::as_ptr(applied);
        if let Some(known) = self.known.get(&key) {
            return *known;
        }
        let value = self.function(applied);
        self.known.insert(key, value);
        value
    }

    /// The value of a function.
    fn function(&mut self, applied: &Application) -> f64 {
        let values = self.values;
        let mut argument =
            |index: usize| applied.arguments.get(index).map_or(0.0, |argument| self.fraction(argument));
        match applied.operation {
            Operation::Absolute => argument(0).abs(),
            Operation::Step => f64::from(u8::from(argument(0) >= 0.0)),
            Operation::Call(CallOrder(function)) => function.apply(argument(0), argument(1)),
            Operation::Table(table) => values.table(table, argument(0)),
            Operation::TableSlope(table) => values.slope(table, argument(0)),
            Operation::Minimum => argument(0).min(argument(1)),
            Operation::Maximum => argument(0).max(argument(1)),
            Operation::Limit => argument(0).max(argument(1)).min(argument(2)),
            Operation::Sign => {
                let value = argument(0);
                f64::from(i8::from(value > 0.0) - i8::from(value < 0.0))
            }
            Operation::Group => argument(0),
            Operation::Delay => values.delayed(&applied.arguments[0], argument(1)),
        }
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

    #[test]
    fn absolute_values_and_steps_have_corners() {
        assert!(corner_arguments(&read("x^2 + sin(y)")).is_empty());
        // max(x, 1) = (x + 1 + |x - 1|) / 2.
        let cases = [
            ("y max(x, 1)", &["x - 1"][..]),
            ("step(y) + abs(x - abs(y + 2))", &["y", "y + 2", "x - abs(y + 2)"][..]),
        ];
        for (expression, expected) in cases {
            let found = corner_arguments(&read(expression));
            assert_eq!(found.len(), expected.len(), "{expression}");
            for argument in expected.iter().map(|argument| read(argument)) {
                assert!(found.contains(&argument) || found.contains(&argument.negated()), "{argument:?}");
            }
        }
    }
}
