//! Writes absolute values as minima and maxima where that is shorter.
//!
//! The normal form has |x| only: max(a, b) is (a + b + |a - b|) / 2. A reader expects the maximum. Each term c |x| can
//! also be written 2 c max(x, 0) - c x or 2 c max(-x, 0) + c x. The choice with the fewest terms is taken. Then terms
//! outside of a maximum are moved into it: max(x, 0) - x is max(0, -x). An input between two constants is a limit.

mod limits;

use num_traits::{One as _, Signed as _, Zero as _};

use crate::symbolic::{
    Atom, Fraction, Monomial, Operation, Polynomial, Rational, whole, with_reduced_powers,
};
use limits::{limited, unnested};

/// A sum with its absolute values as limits, minima and maxima where that is shorter. A long sum keeps them, because the
/// search for the shortest form would take long.
pub(super) fn with_maxima(sum: &Polynomial) -> Polynomial {
    if sum.terms().len() > LONGEST_SUM {
        return sum.clone();
    }
    let (mut rest, mut written) = (sum.clone(), Polynomial::default());
    loop {
        let items = outermost(&rest);
        if items.is_empty() {
            return squares_joined(&rest.plus(&written));
        }
        if let Some(sum) = unnested(&items, &rest).or_else(|| limited(&items, &rest)) {
            rest = sum;
            continue;
        }
        let mut items = last_of_each_term(items);
        items.truncate(MOST_TOGETHER);
        for item in &items {
            rest.add_term(item.product(), &-item.number.clone());
        }
        let signs = best_signs(&items, &rest);
        rest = left_over(&items, &signs, &rest);
        for (item, sign) in items.iter().zip(signs) {
            let (product, number) =
                if sign == 0 { (item.product(), item.number.clone()) } else { item.maximum(sign, &mut rest) };
            written.add_term(product, &number);
        }
    }
}

/// Terms of a sum with minima and maxima at most.
const LONGEST_SUM: usize = 100;

/// Most absolute values that are compared together: the number of choices is 3 to this power.
const MOST_TOGETHER: usize = 6;

/// A term number x factor x |inside|.
struct Item {
    number: Rational,
    factor: Monomial,
    atom: Atom,
    inside: Polynomial,
}

impl Item {
    /// The product of the term.
    fn product(&self) -> Monomial {
        self.factor.times(&Monomial::power_of(self.atom.clone(), 1))
    }

    /// The term with max(sign x inside, 0), after terms of the rest that fit were moved into the maximum.
    fn maximum(&self, sign: i64, rest: &mut Polynomial) -> (Monomial, Rational) {
        let number = &self.number * whole(2);
        let (mut first, mut second) =
            (self.inside.times_term(&Monomial::default(), &whole(sign)), Polynomial::default());
        let mut is_two_sided = false;
        for cancels in [true, false] {
            for (product, own) in first.clone().terms() {
                let outer = self.factor.times(product);
                let outside = coefficient(rest, &outer);
                let moved = &outside / &number;
                let is_moved = if cancels { moved == -own } else { is_two_sided && !outside.is_zero() };
                if is_moved {
                    is_two_sided = true;
                    rest.add_term(outer, &-outside);
                    first.add_term(product.clone(), &moved);
                    second.add_term(product.clone(), &moved);
                }
            }
        }
        let (first, second, number) = without_content(&first, &second, number);
        let (mut first, mut second) = (first, second);
        let (outer, number) = self.with_constant_one(self.factor.clone(), number, [&mut first, &mut second]);
        let negatives =
            first.terms().chain(second.terms()).filter(|(_, number)| number.is_negative()).count();
        let is_minimum = number.is_negative() && 2 * negatives > first.terms().len() + second.terms().len();
        let (operation, arguments, number) = if is_minimum {
            (Operation::Minimum, [first.negated(), second.negated()], -number)
        } else {
            (Operation::Maximum, [first, second], number)
        };
        let arguments = arguments.into_iter().map(Fraction::from).collect();
        let atom = Atom::function(operation, arguments);
        (outer.times(&Monomial::power_of(atom, 1)), number)
    }

    /// Moves a factor from the outside of a maximum to its arguments: max(L - x, 0) / L becomes max(1 - x/L, 0). Returns
    /// the product and the number that remain outside.
    fn with_constant_one(
        &self,
        outer: Monomial,
        number: Rational,
        arguments: [&mut Polynomial; 2],
    ) -> (Monomial, Rational) {
        let [first, second] = arguments;
        let divides = |product: &Monomial| {
            let exponents = product.factors().iter();
            let is_divided = |(atom, own): &(Atom, i32)| *own > 0 && outer.exponent(atom) <= -own;
            !product.is_one() && product.is_nonnegative() && exponents.clone().all(is_divided)
        };
        let found = first.terms().chain(second.terms()).find(|(product, _)| divides(product));
        let Some((constant, size)) = found.map(|(product, size)| (product.clone(), size.abs())) else {
            return (outer, number);
        };
        for argument in [first, second] {
            *argument = argument.times_term(&constant.power(-1), &size.recip());
        }
        (outer.times(&constant), number * size)
    }
}

/// Two arguments in written form and the number outside, with the numbers that both have in common outside.
fn without_content(
    first: &Polynomial,
    second: &Polynomial,
    number: Rational,
) -> (Polynomial, Polynomial, Rational) {
    let written = [first, second].map(with_maxima);
    let mut numbers = written.iter().flat_map(|sum| sum.terms().map(|(_, number)| number.abs()));
    let Some(content) = numbers.next() else { return (first.clone(), second.clone(), number) };
    if !numbers.all(|number| number == content) {
        return (first.clone(), second.clone(), number);
    }
    let [first, second] = [first, second].map(|sum| sum.times_term(&Monomial::default(), &content.recip()));
    (first, second, number * content)
}

/// The number in front of a product; 0 if the sum does not have it.
fn coefficient(sum: &Polynomial, product: &Monomial) -> Rational {
    sum.terms().find(|(own, _)| *own == product).map_or_else(Rational::zero, |(_, number)| number.clone())
}

/// The most deeply nested absolute values of a sum, in the order of its terms. Those inside others come later.
fn outermost(sum: &Polynomial) -> Vec<Item> {
    let mut items: Vec<(usize, Item)> =
        sum.terms().flat_map(|(product, number)| absolute_values(product, number)).collect();
    let deepest = items.iter().map(|(depth, _)| *depth).max().unwrap_or_default();
    items.retain(|(depth, _)| *depth == deepest);
    items.into_iter().map(|(_, item)| item).collect()
}

/// The absolute values of sums without divisor in a term, each with the depth of its nesting.
fn absolute_values(product: &Monomial, number: &Rational) -> Vec<(usize, Item)> {
    let found = product.factors().iter().filter_map(|(atom, exponent)| match atom {
        Atom::Apply(applied) if applied.operation == Operation::Absolute && *exponent == 1 => {
            let inside = &applied.arguments[0];
            let factor = product.over(&Monomial::power_of(atom.clone(), 1));
            let (number, atom) = (number.clone(), atom.clone());
            let item = Item { number, factor, atom, inside: inside.numerator().clone() };
            (inside.divisors().len() == 0).then(|| (inside.absolute_depth(), item))
        }
        _ => None,
    });
    found.collect()
}

/// The last absolute value of each term.
fn last_of_each_term(items: Vec<Item>) -> Vec<Item> {
    let mut last: Vec<Item> = Vec::new();
    for item in items {
        if last.last().is_some_and(|before| before.product() == item.product()) {
            last.pop();
        }
        last.push(item);
    }
    last
}

/// For each item, how it is written: 1 as max(x, 0), -1 as max(-x, 0), 0 as |x|. The choice leaves the fewest terms.
fn best_signs(items: &[Item], rest: &Polynomial) -> Vec<i64> {
    let choices = 3usize.pow(items.len() as u32);
    let signs = |choice: usize| -> Vec<i64> {
        let digit = |index: usize| [0, 1, -1][choice / 3usize.pow(index as u32) % 3];
        (0..items.len()).map(digit).collect()
    };
    let cost = |choice: &usize| {
        let signs = signs(*choice);
        let left = left_over(items, &signs, rest);
        let maxima = signs.iter().filter(|sign| **sign != 0).count();
        // A number such as 1/2 in front of an absolute value indicates a maximum.
        let halves =
            items.iter().zip(&signs).filter(|(item, sign)| **sign == 0 && is_half(&item.number)).count();
        (left.terms().len() + halves, maxima)
    };
    signs((0..choices).min_by_key(cost).unwrap_or_default())
}

/// What remains of the rest if each item is written as its sign says: c |x| is 2 c max(x, 0) - c x.
fn left_over(items: &[Item], signs: &[i64], rest: &Polynomial) -> Polynomial {
    let left = items.iter().zip(signs).fold(rest.clone(), |left, (item, sign)| {
        left.plus(&item.inside.times_term(&item.factor, &(&item.number * whole(-*sign))))
    });
    with_reduced_powers(left)
}

/// Whether a number is an odd multiple of 1/2.
fn is_half(number: &Rational) -> bool {
    !number.is_integer() && (number * whole(2)).is_integer()
}

/// The sum with products x max(x, 0) as squares of the maximum.
fn squares_joined(sum: &Polynomial) -> Polynomial {
    let maxima: Vec<Atom> = sum.atoms().filter(|atom| positive_part(atom).is_some()).cloned().collect();
    maxima.iter().fold(sum.clone(), |sum, atom| match positive_part(atom) {
        Some(inside) => with_square(&sum, atom, &inside),
        None => sum,
    })
}

/// The expression x of a factor max(x, 0).
fn positive_part(atom: &Atom) -> Option<Polynomial> {
    let Atom::Apply(applied) = atom else { return None };
    let [first, second] = applied.arguments.as_slice() else { return None };
    let is_positive_part =
        applied.operation == Operation::Maximum && second.is_zero() && first.divisors().len() == 0;
    is_positive_part.then(|| first.numerator().clone())
}

/// The sum with x max(x, 0) as max(x, 0)^2 for one maximum.
fn with_square(sum: &Polynomial, maximum: &Atom, inside: &Polynomial) -> Polynomial {
    let mut joined = Polynomial::default();
    for (mut exponent, mut factor) in sum.by_powers(maximum) {
        while exponent > 0
            && let Some(quotient) = factor.divided_by(inside)
            && !has_new_divisors(&quotient, &factor)
        {
            (exponent, factor) = (exponent + 1, quotient);
        }
        joined =
            joined.plus(&factor.times_term(&Monomial::power_of(maximum.clone(), exponent), &Rational::one()));
    }
    joined
}

/// Whether a quotient has divisors that the dividend does not have.
fn has_new_divisors(quotient: &Polynomial, dividend: &Polynomial) -> bool {
    let (_, before, _) = dividend.clone().into_primitive();
    let (_, after, _) = quotient.clone().into_primitive();
    after.factors().iter().any(|(atom, exponent)| *exponent < before.exponent(atom).min(0))
}
