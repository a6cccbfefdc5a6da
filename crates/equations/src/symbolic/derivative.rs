//! The derivative of an expression with respect to one symbol.

use std::collections::HashMap;
use std::sync::Arc;

use num_traits::One as _;
use patchcord_expr::Function;

use super::application::Application;
use super::apply::{apply, call, delay, step};
use super::fraction::Fraction;
use super::monomial::{Atom, CallOrder, Monomial, Operation};
use super::number::{Rational, whole};
use super::polynomial::Polynomial;
use super::symbol::Symbol;

/// The derivative of an expression with respect to a symbol.
///
/// `rate` is the derivative of a symbol: 1 for the symbol of a partial derivative and 0 for all others, or the rate of
/// every symbol for a derivative with respect to time. At a corner it is the derivative on one side.
pub(crate) fn derivative(fraction: &Fraction, rate: &mut dyn FnMut(Symbol) -> Fraction) -> Fraction {
    Differentiation { rate, known: HashMap::new() }.fraction(fraction)
}

/// A differentiation, with the derivatives of functions that were found so far.
struct Differentiation<'r> {
    /// The derivative of a symbol.
    rate: &'r mut dyn FnMut(Symbol) -> Fraction,
    /// The derivatives of functions.
    known: HashMap<*const Application, Fraction>,
}

impl Differentiation<'_> {
    /// The derivative of an expression.
    fn fraction(&mut self, fraction: &Fraction) -> Fraction {
        let top = self.polynomial(fraction.numerator());
        let mut result = fraction.divisors().fold(top, |top, (divisor, power)| {
            top.times(&Fraction::from(divisor.clone()).power(-(power as i32)))
        });
        for (divisor, power) in fraction.divisors() {
            let inner = self.polynomial(divisor);
            let factor = Fraction::whole(i64::from(power)).over(&Fraction::from(divisor.clone()));
            result = result.minus(&fraction.times(&factor).times(&inner));
        }
        result
    }

    /// The derivative of a sum.
    fn polynomial(&mut self, polynomial: &Polynomial) -> Fraction {
        let mut sum = Fraction::zero();
        for (product, number) in polynomial.terms() {
            for (atom, exponent) in product.factors() {
                let inner = self.atom(atom);
                if inner.is_zero() {
                    continue;
                }
                let rest = product.over(&Monomial::power_of(atom.clone(), 1));
                let outer = Polynomial::term(number * whole(i64::from(*exponent)), rest);
                sum = sum.plus(&Fraction::from(outer).times(&inner));
            }
        }
        sum
    }

    /// The derivative of a factor.
    fn atom(&mut self, atom: &Atom) -> Fraction {
        let applied = match atom {
            Atom::Symbol(symbol) => return (self.rate)(*symbol),
            Atom::Apply(applied) => applied,
        };
        let key = Arc::as_ptr(applied);
        if let Some(known) = self.known.get(&key) {
            return known.clone();
        }
        let mut sum = Fraction::zero();
        for (index, argument) in applied.arguments.iter().enumerate() {
            let inner = self.fraction(argument);
            if !inner.is_zero() {
                sum = sum.plus(&outer_derivative(atom, applied, index, &inner).times(&inner));
            }
        }
        self.known.insert(key, sum.clone());
        sum
    }
}

/// The derivative of a function with respect to one of its arguments. `inner` is the derivative of the argument.
fn outer_derivative(atom: &Atom, applied: &Application, index: usize, inner: &Fraction) -> Fraction {
    let one = Fraction::whole(1);
    let [first, last] = [applied.arguments.first(), applied.arguments.last()]
        .map(|argument| argument.cloned().unwrap_or_default());
    match applied.operation {
        // The sign: twice the step, less 1.
        Operation::Absolute => step(&first).times(&Fraction::whole(2)).minus(&one),
        Operation::Table(table) => apply(Operation::TableSlope(table), vec![first]),
        // The chain rule multiplies by the inner derivative, so the delayed rate is divided by it.
        Operation::Delay if index == 0 => delay(inner, &last).over(inner),
        Operation::Group => one,
        // The normal form has no minimum, maximum, limit or sign.
        Operation::Step
        | Operation::TableSlope(_)
        | Operation::Delay
        | Operation::Minimum
        | Operation::Maximum
        | Operation::Limit
        | Operation::Sign => Fraction::zero(),
        Operation::Call(CallOrder(function)) => {
            call_derivative(function, index, &Fraction::atom(atom.clone()), [&first, &last])
        }
    }
}

/// The derivative of a mathematical function with respect to one of its arguments. `own` is its value.
fn call_derivative(
    function: Function,
    index: usize,
    own: &Fraction,
    [first, last]: [&Fraction; 2],
) -> Fraction {
    let one = Fraction::whole(1);
    match function {
        Function::Sqrt => one.over(&own.times(&Fraction::whole(2))),
        Function::Sin => call(Function::Cos, first, first),
        Function::Cos => call(Function::Sin, first, first).negated(),
        Function::Tan => one.plus(&own.power(2)),
        Function::Atan => one.over(&one.plus(&first.power(2))),
        Function::Atan2 => {
            let square = first.power(2).plus(&last.power(2));
            if index == 0 { last.over(&square) } else { first.negated().over(&square) }
        }
        Function::Exp => own.clone(),
        Function::Exp10 => own.times(&Fraction::number(std::f64::consts::LN_10)),
        Function::Ln => one.over(first),
        Function::Log10 => one.over(&first.times(&Fraction::number(std::f64::consts::LN_10))),
        Function::Tanh => one.minus(&own.power(2)),
        Function::Power if index == 0 => last.times(own).over(first),
        Function::Power => own.times(&call(Function::Ln, first, first)),
        _ => Fraction::zero(),
    }
}

/// The partial derivative with respect to one symbol.
pub(crate) fn partial_derivative(fraction: &Fraction, of: Symbol) -> Fraction {
    derivative(fraction, &mut |symbol| {
        let value = if symbol == of { Rational::one() } else { whole(0) };
        Fraction::rational(value)
    })
}
