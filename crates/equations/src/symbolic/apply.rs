//! Functions of expressions, with the rules that give equal characteristics equal normal forms.

use num_traits::{One as _, Signed as _};
use patchcord_expr::Function;

use super::fraction::{Fraction, leads_negative};
use super::monomial::{Atom, CallOrder, Monomial, Operation};
use super::number::{Rational, exact, nearest, square_root};
use super::polynomial::Polynomial;

/// A function of expressions in normal form. The number of arguments must be that of the function.
pub(crate) fn apply(operation: Operation, arguments: Vec<Fraction>) -> Fraction {
    match (operation, arguments.as_slice()) {
        (Operation::Absolute, [argument]) => absolute(argument),
        (Operation::Step, [argument]) => step(argument),
        (Operation::Delay, [delayed, time]) => delay(delayed, time),
        (Operation::Minimum, [first, second]) => first.minimum(second),
        (Operation::Maximum, [first, second]) => first.maximum(second),
        (Operation::Limit, [value, low, high]) => value.maximum(low).minimum(high),
        (Operation::Sign, [argument]) => sign(argument),
        (Operation::Group, [argument]) => argument.clone(),
        (Operation::Call(CallOrder(function)), [argument]) => call(function, argument, argument),
        (Operation::Call(CallOrder(function)), [first, second]) => call(function, first, second),
        _ => opaque(operation, arguments),
    }
}

/// A function without a rule.
pub(crate) fn opaque(operation: Operation, arguments: Vec<Fraction>) -> Fraction {
    Fraction::atom(Atom::function(operation, arguments))
}

/// The absolute value. Factors of known sign are taken out, and |-x| is |x|.
pub(crate) fn absolute(argument: &Fraction) -> Fraction {
    if argument.is_nonnegative() {
        return argument.clone();
    }
    let is_known = |atom: &Atom, exponent: i32| exponent % 2 == 0 || atom.is_nonnegative();
    let (outside, inside) = without_factors(argument, is_known);
    let inside = if leads_negative(&inside) { inside.negated() } else { inside };
    if inside.is_nonnegative() {
        return outside.times(&inside);
    }
    outside.times(&opaque(Operation::Absolute, vec![inside]))
}

/// 1 if the argument is 0 or above, otherwise 0. Factors of the argument that are always above 0 are left out. One that
/// can be 0 stays, because the step of 0 is 1.
pub(crate) fn step(argument: &Fraction) -> Fraction {
    if let Some(number) = argument.as_rational() {
        return Fraction::whole(i64::from(!number.is_negative()));
    }
    if argument.is_nonnegative() {
        return Fraction::whole(1);
    }
    let (_, inside) = without_factors(argument, Atom::has_positive_power);
    opaque(Operation::Step, vec![inside])
}

/// The sign in the written form: 1 above 0, -1 below 0, otherwise 0. Factors that are always above 0 are left out, and
/// that of -x is the negative of that of x.
pub(crate) fn sign(argument: &Fraction) -> Fraction {
    let (_, inside) = without_factors(argument, Atom::has_positive_power);
    let is_negative = !inside.is_zero() && leads_negative(&inside);
    let inside = if is_negative { inside.negated() } else { inside };
    let sign = opaque(Operation::Sign, vec![inside]);
    if is_negative { sign.negated() } else { sign }
}

/// The expression as a product: a part that is not negative, and the rest. The part has the factors that are known not
/// to be negative by `is_known`, and such divisors.
fn without_factors(argument: &Fraction, is_known: impl Fn(&Atom, i32) -> bool) -> (Fraction, Fraction) {
    if argument.is_zero() {
        return (Fraction::whole(1), Fraction::zero());
    }
    let (number, content, _) = argument.numerator().clone().into_primitive();
    let mut outside = Fraction::from(Polynomial::term(number.abs(), content.only(is_known)));
    for (divisor, power) in argument.divisors() {
        if power % 2 == 0 || divisor.is_nonnegative() {
            outside = outside.times(&Fraction::from(divisor.clone()).power(-(power as i32)));
        }
    }
    let inside = argument.over(&outside);
    (outside, inside)
}

/// A mathematical function of one or two arguments. A function of one argument ignores the second.
pub(crate) fn call(function: Function, first: &Fraction, second: &Fraction) -> Fraction {
    if function == Function::Power {
        return power(first, second);
    }
    let numbers = [first, second].map(Fraction::as_rational);
    if let ([Some(a), Some(b)], false) = (&numbers, function == Function::Sqrt) {
        let value = function.apply(nearest(a), nearest(b));
        if value.is_finite() {
            return Fraction::rational(exact(value));
        }
    }
    match function {
        Function::Sqrt => root(first),
        Function::Sin | Function::Tan | Function::Atan | Function::Tanh if leads_negative(first) => {
            plain_call(function, vec![first.negated()]).negated()
        }
        Function::Exp | Function::Exp10 => exponential(function, first),
        Function::Cos if leads_negative(first) => plain_call(function, vec![first.negated()]),
        Function::Atan2 => plain_call(function, vec![first.clone(), second.clone()]),
        _ => plain_call(function, vec![first.clone()]),
    }
}

/// A function without a rule for its arguments.
fn plain_call(function: Function, arguments: Vec<Fraction>) -> Fraction {
    opaque(Operation::Call(CallOrder(function)), arguments)
}

/// An exponential function. The exponential of c ln(x) is x^c.
fn exponential(function: Function, exponent: &Fraction) -> Fraction {
    let logarithm = if function == Function::Exp { Function::Ln } else { Function::Log10 };
    let logarithm_in = |(atom, power): &(Atom, i32)| match atom {
        Atom::Apply(applied) if *power == 1 && applied.operation == Operation::Call(CallOrder(logarithm)) => {
            Some((atom.clone(), applied.arguments[0].clone()))
        }
        _ => None,
    };
    let term = exponent.numerator().as_term().filter(|_| exponent.divisors().len() == 0);
    match term.and_then(|(product, _)| product.factors().iter().find_map(logarithm_in)) {
        Some((atom, base)) => power(&base, &exponent.over(&Fraction::atom(atom))),
        None => plain_call(function, vec![exponent.clone()]),
    }
}

/// A power. Whole exponents multiply out, and half a whole number is a root.
fn power(base: &Fraction, exponent: &Fraction) -> Fraction {
    if let Some(power) = base.whole_power(exponent) {
        return power;
    }
    let doubled = exponent.times(&Fraction::whole(2));
    if let Some(power) = root(base).whole_power(&doubled) {
        return power;
    }
    if let [Some(a), Some(b)] = [base, exponent].map(Fraction::as_rational) {
        let value = Function::Power.apply(nearest(&a), nearest(&b));
        if value.is_finite() {
            return Fraction::rational(exact(value));
        }
    }
    plain_call(Function::Power, vec![base.clone(), exponent.clone()])
}

/// The square root. Squares are taken out: sqrt(4 x^3) is 2 x sqrt(x) for x >= 0.
pub(crate) fn root(argument: &Fraction) -> Fraction {
    if argument.is_zero() {
        return Fraction::zero();
    }
    let (number, content, _) = argument.numerator().clone().into_primitive();
    let factor = if number.is_positive() { square_root(&number).0 } else { Rational::one() };
    let mut outside = Fraction::rational(factor.clone());
    let mut taken = Fraction::rational(&factor * &factor);
    for (atom, exponent) in content.factors() {
        let half = exponent.div_euclid(2);
        let base = Fraction::atom(atom.clone());
        let base = if atom.is_nonnegative() || half % 2 == 0 { base } else { absolute(&base) };
        outside = outside.times(&base.power(half));
        taken = taken.times(&base.power(2 * half));
    }
    let rest = argument.over(&taken);
    match rest.as_rational().is_some_and(|rest| rest.is_one()) {
        true => outside,
        false => outside.times(&plain_call(Function::Sqrt, vec![rest])),
    }
}

/// The value some time ago. A constant has the same value, the delay of a sum is the sum of the delays, and constant
/// factors are taken out.
pub(crate) fn delay(delayed: &Fraction, time: &Fraction) -> Fraction {
    if delayed.is_constant() {
        return delayed.clone();
    }
    if delayed.divisors().len() > 0 {
        return opaque(Operation::Delay, vec![delayed.clone(), time.clone()]);
    }
    let mut sum = Fraction::zero();
    for (product, number) in delayed.numerator().terms() {
        let constant = product.only(|atom, _| matches!(atom, Atom::Symbol(symbol) if symbol.is_constant));
        let varying = product.over(&constant);
        let factor = Fraction::from(Polynomial::term(number.clone(), constant));
        let term = if varying.is_one() {
            factor
        } else {
            let varying = Fraction::from(Polynomial::term(Rational::one(), varying));
            factor.times(&opaque(Operation::Delay, vec![varying, time.clone()]))
        };
        sum = sum.plus(&term);
    }
    sum
}

/// The sum with powers of functions reduced: |x|^2 is x^2, sqrt(x)^2 is x, and the square of a step is the step. `None`
/// if there is nothing to reduce.
pub(super) fn powers_reduced(polynomial: &Polynomial) -> Option<Fraction> {
    let is_reducible = |(atom, exponent): &(Atom, i32)| reduced_power(atom, *exponent).is_some();
    let mut terms = polynomial.terms();
    if !terms.any(|(product, _)| product.factors().iter().any(is_reducible)) {
        return None;
    }
    let mut sum = Fraction::zero();
    for (product, number) in polynomial.terms() {
        let kept = product.only(|atom, exponent| reduced_power(atom, exponent).is_none());
        let mut term = Fraction::from(Polynomial::term(number.clone(), kept));
        for (atom, exponent) in product.factors() {
            if let Some(power) = reduced_power(atom, *exponent) {
                term = term.times(&power);
            }
        }
        sum = sum.plus(&term);
    }
    Some(sum)
}

/// The sum with powers of functions reduced, if that needs no divisors.
pub(crate) fn with_reduced_powers(sum: Polynomial) -> Polynomial {
    match powers_reduced(&sum) {
        Some(reduced) if reduced.divisors().len() == 0 => reduced.numerator().clone(),
        _ => sum,
    }
}

/// A power of a function as an expression with smaller powers; `None` if there is none.
fn reduced_power(atom: &Atom, exponent: i32) -> Option<Fraction> {
    let Atom::Apply(applied) = atom else { return None };
    let argument = applied.arguments.first()?;
    match applied.operation {
        Operation::Step if exponent > 1 => Some(Fraction::atom(atom.clone())),
        Operation::Absolute if exponent.abs() > 1 => Some(square_powers(atom, exponent, &argument.power(2))),
        Operation::Call(CallOrder(Function::Sqrt)) if exponent.abs() > 1 => {
            Some(square_powers(atom, exponent, argument))
        }
        _ => None,
    }
}

/// A power of a factor whose square is an expression.
fn square_powers(atom: &Atom, exponent: i32, square: &Fraction) -> Fraction {
    let pairs = exponent / 2;
    let rest = Monomial::power_of(atom.clone(), exponent - 2 * pairs);
    square.power(pairs).times(&Fraction::from(Polynomial::term(Rational::one(), rest)))
}
