//! Sums of products.

use std::collections::BTreeMap;
use std::hash::{Hash, Hasher};

use num_traits::{One as _, Signed as _, Zero as _};

use super::fraction::Fraction;
use super::monomial::{Atom, Monomial, Operation};
use super::number::Rational;

/// A sum of products with numbers in front of them. No number is 0.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(crate) struct Polynomial {
    /// The numbers, by product.
    terms: BTreeMap<Monomial, Rational>,
}

impl Polynomial {
    /// A number.
    pub(crate) fn constant(number: Rational) -> Self {
        Self::term(number, Monomial::default())
    }

    /// A product with a number in front of it.
    pub(crate) fn term(number: Rational, product: Monomial) -> Self {
        let terms = (!number.is_zero()).then_some((product, number));
        Polynomial { terms: terms.into_iter().collect() }
    }

    /// The terms in ascending order of their products.
    pub(crate) fn terms(
        &self,
    ) -> impl DoubleEndedIterator<Item = (&Monomial, &Rational)> + ExactSizeIterator {
        self.terms.iter()
    }

    /// Whether the sum is empty.
    pub(crate) fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    /// The number, if the sum is one.
    pub(crate) fn as_constant(&self) -> Option<Rational> {
        match self.as_term() {
            Some((product, number)) => product.is_one().then(|| number.clone()),
            None => self.is_zero().then(Rational::zero),
        }
    }

    /// The only term, if there is exactly one.
    pub(crate) fn as_term(&self) -> Option<(&Monomial, &Rational)> {
        self.terms.iter().next().filter(|_| self.terms.len() == 1)
    }

    /// Whether the sum is the number 1.
    pub(crate) fn is_one(&self) -> bool {
        self.as_term().is_some_and(|(product, number)| product.is_one() && number.is_one())
    }

    /// Whether the sum cannot be negative: no term can be, or terms that can be are covered by an absolute value, as
    /// in |x| - x.
    pub(crate) fn is_nonnegative(&self) -> bool {
        let is_safe =
            |(product, number): &(&Monomial, &Rational)| number.is_positive() && product.is_nonnegative();
        if self.terms.iter().all(|term| is_safe(&term)) {
            return true;
        }
        let covering = self.terms.iter().filter(is_safe).filter_map(|(product, number)| {
            let (rest, inside) = product.absolute_factor()?;
            Some((product, inside.times_term(&rest, number)))
        });
        let mut left = self.clone();
        for (product, inside) in covering {
            for covered in [inside.negated(), inside] {
                if covered.terms.iter().all(|(product, number)| left.terms.get(product) == Some(number)) {
                    left = left.plus(&covered.negated());
                    left.terms.remove(product);
                    break;
                }
            }
        }
        left.terms.iter().all(|term| is_safe(&term))
    }

    /// Whether the sum is always above 0: no term can be negative, and one is above 0.
    pub(crate) fn is_positive(&self) -> bool {
        let is_safe =
            |(product, number): (&Monomial, &Rational)| number.is_positive() && product.is_nonnegative();
        self.terms.iter().all(is_safe) && self.terms.keys().any(Monomial::is_positive)
    }

    /// Adds a term.
    pub(crate) fn add_term(&mut self, product: Monomial, number: &Rational) {
        let sum = self.terms.remove(&product).map_or_else(|| number.clone(), |own| own + number);
        if !sum.is_zero() {
            self.terms.insert(product, sum);
        }
    }

    /// The sum of two sums.
    pub(crate) fn plus(&self, other: &Polynomial) -> Polynomial {
        let mut sum = self.clone();
        other.terms.iter().for_each(|(product, number)| sum.add_term(product.clone(), number));
        sum
    }

    /// The product with one term.
    pub(crate) fn times_term(&self, product: &Monomial, number: &Rational) -> Polynomial {
        let terms = self.terms.iter().map(|(own, coefficient)| (own.times(product), coefficient * number));
        Polynomial { terms: terms.filter(|(_, number)| !number.is_zero()).collect() }
    }

    /// The product of two sums, multiplied out. If that would take more than [`MOST_PRODUCTS`] products, each sum becomes
    /// one factor.
    pub(crate) fn times(&self, other: &Polynomial) -> Polynomial {
        let lengths = [self.terms.len(), other.terms.len()];
        if lengths.iter().all(|length| *length > 1) && lengths[0] * lengths[1] > MOST_PRODUCTS {
            return self.grouped().times(&other.grouped());
        }
        let mut result = Polynomial::default();
        for (product, number) in &self.terms {
            for (other, coefficient) in &other.terms {
                result.add_term(product.times(other), &(number * coefficient));
            }
        }
        result
    }

    /// The sum as one term: its numbers and factors in common times a group. It must not be empty.
    fn grouped(&self) -> Polynomial {
        let (number, content, rest) = self.clone().into_primitive();
        let group = Atom::function(Operation::Group, vec![Fraction::from(rest)]);
        Polynomial::term(number, content.times(&Monomial::power_of(group, 1)))
    }

    /// The sum with every number negated.
    pub(crate) fn negated(&self) -> Polynomial {
        Polynomial { terms: self.terms.iter().map(|(product, number)| (product.clone(), -number)).collect() }
    }

    /// The term with the greatest product. The sum must not be empty.
    fn leading(&self) -> (&Monomial, &Rational) {
        self.terms.last_key_value().expect("the sum has a term")
    }

    /// The sum as number x product x rest. The rest has no factor in common to all terms and begins with the number 1.
    /// The sum must not be empty.
    pub(crate) fn into_primitive(self) -> (Rational, Monomial, Polynomial) {
        let mut products = self.terms.keys();
        let first = products.next().cloned().unwrap_or_default();
        let content = products.fold(first, |content, product| content.common(product));
        let number = self.leading().1.clone();
        let divide = |(product, own): (Monomial, Rational)| (product.over(&content), own / &number);
        let rest = Polynomial { terms: self.terms.into_iter().map(divide).collect() };
        (number, content, rest)
    }

    /// The quotient if the division leaves no remainder.
    pub(crate) fn divided_by(&self, divisor: &Polynomial) -> Option<Polynomial> {
        if self.is_zero() {
            return Some(Polynomial::default());
        }
        let (lead, number) = divisor.leading();
        let (own, others) = (self.exponents(), divisor.exponents());
        // An exponent of the quotient is between the differences of the least and of the greatest exponents. Otherwise the
        // division does not end.
        let is_possible = |product: &Monomial| {
            product.factors().iter().all(|(atom, exponent)| {
                let [own, other] = [&own, &others].map(|range| range.get(atom).copied().unwrap_or_default());
                (own.0 - other.0..=own.1 - other.1).contains(exponent)
            })
        };
        let (mut rest, mut quotient) = (self.clone(), Polynomial::default());
        for _ in 0..MOST_TERMS {
            if rest.is_zero() {
                return Some(quotient);
            }
            let (top, coefficient) = rest.leading();
            let (product, factor) = (top.over(lead), coefficient / number);
            if !is_possible(&product) {
                return None;
            }
            for (own, number) in &divisor.terms {
                rest.add_term(own.times(&product), &-(number * &factor));
            }
            quotient.add_term(product, &factor);
        }
        None
    }

    /// The least and the greatest exponent of every factor; terms without the factor have the exponent 0.
    fn exponents(&self) -> BTreeMap<&Atom, (i32, i32)> {
        let mut exponents: BTreeMap<&Atom, (i32, i32, usize)> = BTreeMap::new();
        for product in self.terms.keys() {
            for (atom, exponent) in product.factors() {
                let known = exponents.entry(atom).or_insert((*exponent, *exponent, 0));
                *known = (known.0.min(*exponent), known.1.max(*exponent), known.2 + 1);
            }
        }
        let with_zero = |(least, greatest, count): (i32, i32, usize)| {
            if count < self.terms.len() { (least.min(0), greatest.max(0)) } else { (least, greatest) }
        };
        exponents.into_iter().map(|(atom, range)| (atom, with_zero(range))).collect()
    }

    /// The sum in powers of a factor: the exponents with the sums that multiply them.
    pub(crate) fn by_powers(&self, atom: &Atom) -> BTreeMap<i32, Polynomial> {
        let mut powers: BTreeMap<i32, Polynomial> = BTreeMap::new();
        for (product, number) in &self.terms {
            let exponent = product.exponent(atom);
            let rest = product.over(&Monomial::power_of(atom.clone(), exponent));
            powers.entry(exponent).or_default().add_term(rest, number);
        }
        powers
    }

    /// All factors of all terms.
    pub(crate) fn atoms(&self) -> impl Iterator<Item = &Atom> {
        self.terms.keys().flat_map(|product| product.factors().iter().map(|(atom, _)| atom))
    }
}

/// Adds the terms to a hash. Equal numbers have equal numerators and denominators.
impl Hash for Polynomial {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.terms.len().hash(state);
        for (product, number) in &self.terms {
            product.hash(state);
            number.numer().hash(state);
            number.denom().hash(state);
        }
    }
}

/// Products of two terms at most when sums are multiplied out. Longer expressions would take seconds.
pub(crate) const MOST_PRODUCTS: usize = 1000;

/// Terms of a quotient at most. A division with more is given up: the quotient would be no simplification.
const MOST_TERMS: usize = 400;
