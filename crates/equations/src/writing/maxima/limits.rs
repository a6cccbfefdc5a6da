//! Writes absolute values as limits.
//!
//! An input between two constants has two normal forms. That of two diodes is (|x - low| - |x - high| + low + high)/2,
//! and that of the minimum of a maximum has one absolute value inside another. The second one is first rewritten as the
//! first one.

use num_traits::{One as _, Signed as _};

use super::{Item, coefficient, with_maxima};
use crate::symbolic::{
    Atom, Fraction, Monomial, Operation, Polynomial, Rational, absolute, whole, with_reduced_powers,
};

/// The sum with one nested absolute value rewritten. `None` if there is none.
///
/// For a constant d <= 0, |n (|w| + w) + d| is |2 n w + d| - n (|w| - w). The sum must also have |w| with the number that
/// makes a limit of both.
pub(super) fn unnested(items: &[Item], sum: &Polynomial) -> Option<Polynomial> {
    let mut sorted: Vec<&Item> = items.iter().collect();
    // The terms with one absolute value are rewritten before those with another, so that their numbers keep their ratio.
    sorted.sort_by(|one, other| one.atom.cmp(&other.atom));
    sorted.into_iter().find_map(|item| {
        let mut clamps =
            item.inside.terms().filter_map(|(product, number)| Clamp::of(&item.inside, product, number));
        let is_in_sum = |clamp: &Clamp| {
            coefficient(sum, &item.factor.times(&clamp.product)) == -(&item.number * &clamp.size)
        };
        clamps.find(is_in_sum).map(|clamp| clamp.unnested(item, sum))
    })
}

/// The inside of an absolute value as size (|w| + w) + offset, or the negative of that, with a constant offset <= 0.
struct Clamp {
    /// The product with |w|.
    product: Monomial,
    /// The number in front of it, without its sign.
    size: Rational,
    /// The sum size x w.
    slope: Polynomial,
    /// The offset.
    offset: Polynomial,
}

impl Clamp {
    /// The clamp that consists of one term of an inside and the rest of it.
    fn of(inside: &Polynomial, product: &Monomial, number: &Rational) -> Option<Self> {
        let (factor, argument) = product.absolute_factor()?;
        if !factor.is_constant() || !factor.is_nonnegative() {
            return None;
        }
        let mut rest = inside.clone();
        rest.add_term(product.clone(), &-number.clone());
        let slope = argument.times_term(&factor, number);
        let upright = |sum: &Polynomial| sum.times_term(&Monomial::default(), &number.signum());
        [slope.clone(), slope.negated()].into_iter().find_map(|slope| {
            let offset = upright(&rest.plus(&slope.negated()));
            let [variable, _] = by_variation(&offset);
            let is_clamp = variable.is_zero() && !offset.is_zero() && offset.negated().is_nonnegative();
            let (product, size) = (product.clone(), number.abs());
            is_clamp.then(|| Clamp { product, size, slope: upright(&slope), offset })
        })
    }

    /// The sum with the absolute value of the clamp rewritten.
    fn unnested(&self, item: &Item, sum: &Polynomial) -> Polynomial {
        let inside = self.slope.plus(&self.slope).plus(&self.offset);
        let outer = absolute(&Fraction::from(inside)).numerator().plus(&self.slope);
        let mut sum = sum.plus(&outer.times_term(&item.factor, &item.number));
        sum.add_term(item.product(), &-item.number.clone());
        sum.add_term(item.factor.times(&self.product), &-(&item.number * &self.size));
        with_reduced_powers(sum)
    }
}

/// The sum with the first two terms that are a limit together in this form. `None` if there are none.
pub(super) fn limited(items: &[Item], sum: &Polynomial) -> Option<Polynomial> {
    let knees: Vec<Knee> = items.iter().map(Knee::of).collect();
    let mut pairs =
        (0..items.len()).flat_map(|first| (first + 1..items.len()).map(move |second| [first, second]));
    pairs.find_map(|indices| {
        let pair = Knees::of(indices.map(|index| &knees[index])).filter(|pair| !pair.is_dead_zone(sum))?;
        let mut sum = sum.plus(&pair.limit());
        for item in indices.map(|index| &items[index]) {
            sum.add_term(item.product(), &-item.number.clone());
        }
        Some(sum)
    })
}

/// A term as ±factor x |input + offset|. The number and the constants in front of it are inside.
struct Knee {
    is_positive: bool,
    factor: Monomial,
    input: Polynomial,
    offset: Polynomial,
}

impl Knee {
    /// The parts of a term.
    fn of(item: &Item) -> Self {
        let constants = item.factor.only(is_nonnegative_constant);
        let inside = item.inside.times_term(&constants, &item.number.abs());
        let [input, offset] = by_variation(&inside);
        Knee { is_positive: item.number.is_positive(), factor: item.factor.over(&constants), input, offset }
    }
}

/// The sum ±factor x (|input + upper| - |input + lower|) with constants upper >= lower.
struct Knees {
    /// 1 or -1.
    sign: i64,
    factor: Monomial,
    input: Polynomial,
    upper: Polynomial,
    lower: Polynomial,
}

impl Knees {
    /// The sum of two terms, if they have opposite signs and insides that differ by a constant of known sign.
    fn of([first, second]: [&Knee; 2]) -> Option<Self> {
        if first.factor != second.factor || first.is_positive == second.is_positive || first.input.is_zero() {
            return None;
        }
        let other = if second.input == first.input {
            second.offset.clone()
        } else if second.input.negated() == first.input {
            second.offset.negated()
        } else {
            return None;
        };
        let (sign, own) = (if first.is_positive { 1 } else { -1 }, first.offset.clone());
        let difference = own.plus(&other.negated());
        let (sign, upper, lower) = if difference.is_nonnegative() {
            (sign, own, other)
        } else if difference.negated().is_nonnegative() {
            (-sign, other, own)
        } else {
            return None;
        };
        Some(Knees { sign, factor: first.factor.clone(), input: first.input.clone(), upper, lower })
    }

    /// Whether the sum makes a dead zone of it: the input less the limit. That is written with maxima.
    fn is_dead_zone(&self, sum: &Polynomial) -> bool {
        let cancels = |(product, own): (&Monomial, &Rational)| {
            coefficient(sum, &self.factor.times(product)) == own * whole(-2 * self.sign)
        };
        self.input.terms().all(cancels)
    }

    /// The same as 2 limit(input, -upper, -lower) + upper + lower, with constant factors in front of the limit and
    /// constant terms outside.
    fn limit(&self) -> Polynomial {
        let none = Monomial::default();
        let (mut number, mut arguments) =
            (whole(2 * self.sign), [self.input.clone(), self.upper.negated(), self.lower.negated()]);
        if self.input.terms().all(|(_, number)| number.is_negative()) {
            // limit(-x, low, high) is -limit(x, -high, -low).
            (number, arguments) = (-number, [self.input.negated(), self.lower.clone(), self.upper.clone()]);
        }
        let [written, shift] = by_variation(&with_maxima(&arguments[0]));
        let constants = self.upper.plus(&self.lower).times_term(&none, &whole(self.sign));
        let constants = constants.plus(&shift.times_term(&none, &number));
        let arguments = arguments.map(|argument| argument.plus(&shift.negated()));
        let (size, content) = (common_size(&written), common_constants(&arguments));
        let share = |sum: Polynomial| Fraction::from(sum.times_term(&content.power(-1), &size.recip()));
        let arguments = Vec::from(arguments.map(share));
        let atom = Atom::function(Operation::Limit, arguments);
        let mut sum = constants;
        sum.add_term(content.times(&Monomial::power_of(atom, 1)), &(number * size));
        sum.times_term(&self.factor, &Rational::one())
    }
}

/// Whether a power of a factor is constant and not negative.
fn is_nonnegative_constant(atom: &Atom, exponent: i32) -> bool {
    atom.is_constant() && (exponent % 2 == 0 || atom.is_nonnegative())
}

/// The terms of a sum that vary, and its constants.
fn by_variation(sum: &Polynomial) -> [Polynomial; 2] {
    let mut parts = [Polynomial::default(), Polynomial::default()];
    for (product, number) in sum.terms() {
        parts[usize::from(product.is_constant())].add_term(product.clone(), number);
    }
    parts
}

/// The size of the numbers of a sum if all are equal. Otherwise 1/2, which leaves no number in front of a limit.
fn common_size(sum: &Polynomial) -> Rational {
    let mut sizes = sum.terms().map(|(_, number)| number.abs());
    let first = sizes.next().unwrap_or_else(Rational::one);
    if sizes.all(|size| size == first) { first } else { whole(2).recip() }
}

/// The constants that are not negative and that all terms of three sums have in common.
fn common_constants(sums: &[Polynomial; 3]) -> Monomial {
    let mut products = sums.iter().flat_map(|sum| sum.terms().map(|(product, _)| product));
    let first = products.next().cloned().unwrap_or_default();
    products.fold(first, |common, product| common.common(product)).only(is_nonnegative_constant)
}
