//! Replaces factors of an expression. A function that occurs at several places is rewritten once.

use std::collections::HashMap;
use std::sync::Arc;

use super::application::Application;
use super::apply::apply;
use super::fraction::Fraction;
use super::monomial::Atom;
use super::polynomial::Polynomial;

/// A replacement of factors, with the functions that were rewritten so far.
pub(super) struct Replacement<'r> {
    /// The expression for a factor. A factor stays if it is `None`.
    replace: &'r mut dyn FnMut(&Atom) -> Option<Fraction>,
    /// The rewritten functions.
    known: HashMap<*const Application, Fraction>,
}

impl<'r> Replacement<'r> {
    /// A replacement. It has one result for equal factors.
    pub(super) fn new(replace: &'r mut dyn FnMut(&Atom) -> Option<Fraction>) -> Self {
        Replacement { replace, known: HashMap::new() }
    }

    /// The expression with some factors replaced, also inside functions.
    pub(super) fn rewritten(&mut self, fraction: &Fraction) -> Fraction {
        let top = self.sum(fraction.numerator());
        fraction.divisors().fold(top, |top, (divisor, power)| {
            let divisor = self.sum(divisor);
            top.times(&divisor.power(-(power as i32)))
        })
    }

    /// A sum with some factors replaced.
    fn sum(&mut self, polynomial: &Polynomial) -> Fraction {
        let mut sum = Fraction::zero();
        for (product, number) in polynomial.terms() {
            let mut term = Fraction::rational(number.clone());
            for (atom, exponent) in product.factors() {
                term = term.times(&self.factor(atom).power(*exponent));
            }
            sum = sum.plus(&term);
        }
        sum
    }

    /// A factor, or the expression that replaces it.
    fn factor(&mut self, atom: &Atom) -> Fraction {
        let Atom::Apply(applied) = atom else {
            return (self.replace)(atom).unwrap_or_else(|| Fraction::atom(atom.clone()));
        };
        let key = Arc::as_ptr(applied);
        if let Some(known) = self.known.get(&key) {
            return known.clone();
        }
        let value = match (self.replace)(atom) {
            Some(value) => value,
            None => {
                let arguments = applied.arguments.iter().map(|argument| self.rewritten(argument));
                apply(applied.operation, arguments.collect())
            }
        };
        self.known.insert(key, value.clone());
        value
    }
}

#[cfg(test)]
mod tests {
    use patchcord_expr::Function;

    use super::super::apply::call;
    use super::*;
    use crate::testing::reading::read;
    use crate::testing::symbol;

    #[test]
    fn a_function_that_occurs_often_is_rewritten_once() {
        let [x, y] = ["x", "y"].map(|name| Fraction::symbol(symbol(name)));
        // Each level contains the one below it twice.
        let nested = |inner: &Fraction| {
            (0..60).fold(inner.clone(), |value, _| {
                call(Function::Sin, &value, &value).plus(&call(Function::Cos, &value, &value))
            })
        };
        let mut count = 0;
        let rewritten = nested(&x).mapped(&mut |own| {
            count += 1;
            if own == symbol("x") { y.clone() } else { Fraction::symbol(own) }
        });
        assert_eq!(rewritten, nested(&y));
        assert_eq!(count, 2);
        assert!(rewritten.minus(&nested(&y)).is_zero());
        assert!(!rewritten.contains(&mut |own| own == symbol("x")));
    }

    #[test]
    fn a_function_is_replaced_with_its_arguments() {
        let sine = read("sin(x)").numerator().atoms().next().cloned();
        let found = read("sin(x)^2 + y abs(sin(x) + x)/sin(x)")
            .with_factors(&mut |atom| (Some(atom) == sine.as_ref()).then(|| read("2 z")));
        assert_eq!(found, read("4 z^2 + y abs(2 z + x)/(2 z)"));
    }
}
