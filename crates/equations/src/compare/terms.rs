//! Compares two expressions of one quantity term by term.

use std::collections::BTreeMap;

use num_traits::Signed as _;

use crate::symbolic::{Fraction, Monomial, Polynomial, Rational, Values, nearest, value};

/// A term that differs between the stated equation and the wiring.
#[derive(Debug, Clone)]
pub(crate) struct TermDifference {
    /// The term as the equation states it; 0 if it has none.
    pub stated: Fraction,
    /// The term that the wiring has; 0 if it has none.
    pub wired: Fraction,
    /// How they differ.
    pub kind: DifferenceKind,
}

/// How a term differs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum DifferenceKind {
    /// The sign is wrong.
    Sign,
    /// The term of the wiring is this many times the stated one.
    Factor(f64),
    /// The wiring does not have the term.
    Missing,
    /// The equation does not have the term.
    Extra,
}

/// Relative deviation of a factor or of a threshold up to which it is right. Settings are often rounded to three digits, like the
/// readings of the voltmeter that they come from.
pub(super) const TOLERANCE: f64 = 1e-3;

/// The terms in which two expressions of a quantity differ, for the present values of the parameters.
pub(crate) fn differences(stated: &Fraction, wired: &Fraction, values: &dyn Values) -> Vec<TermDifference> {
    let (divisors, [stated, wired]) = Fraction::over_common_divisors([stated, wired]);
    let [stated, wired] = [stated, wired].map(|sum| by_variables(&sum));
    let mut products: Vec<&Monomial> = stated.keys().chain(wired.keys()).collect();
    products.sort_unstable();
    products.dedup();
    let none = Polynomial::default();
    let term = |factor: &Polynomial, product: &Monomial| {
        let numerator = Fraction::from(factor.times_term(product, &Rational::from_integer(1.into())));
        divisors.iter().fold(numerator, |term, (divisor, power)| {
            term.over(&Fraction::from(divisor.clone()).power(*power as i32))
        })
    };
    let difference = |product: &Monomial| {
        let [own, other] = [&stated, &wired].map(|terms| terms.get(product).unwrap_or(&none));
        let kind = kind(own, other, values)?;
        Some(TermDifference { stated: term(own, product), wired: term(other, product), kind })
    };
    products.into_iter().filter_map(difference).collect()
}

/// The factors of a sum by their product of variables. A factor is constant in a run.
fn by_variables(sum: &Polynomial) -> BTreeMap<Monomial, Polynomial> {
    let mut terms: BTreeMap<Monomial, Polynomial> = BTreeMap::new();
    for (product, number) in sum.terms() {
        let constant = product.only(|atom, _| atom.is_constant());
        terms.entry(product.over(&constant)).or_default().add_term(constant, number);
    }
    terms
}

/// How the wired factor of a product differs from the stated one. `None` if they are equal.
fn kind(stated: &Polynomial, wired: &Polynomial, values: &dyn Values) -> Option<DifferenceKind> {
    let [own, other] = [stated, wired].map(|factor| value(&Fraction::from(factor.clone()), values));
    if stated.is_zero() {
        return (other != 0.0).then_some(DifferenceKind::Extra);
    }
    if wired.is_zero() {
        return (own != 0.0).then_some(DifferenceKind::Missing);
    }
    let ratio = Fraction::from(wired.clone()).over(&Fraction::from(stated.clone()));
    let factor = match ratio.as_rational() {
        Some(number) => nearest(&number),
        None if own == other => 1.0,
        None if own == 0.0 => return Some(DifferenceKind::Extra),
        None if other == 0.0 => return Some(DifferenceKind::Missing),
        None => other / own,
    };
    kind_of_factor(factor)
}

/// How a term differs that is this many times the stated one. `None` if it does not.
pub(super) fn kind_of_factor(factor: f64) -> Option<DifferenceKind> {
    if (factor - 1.0).abs() < TOLERANCE {
        None
    } else if (factor + 1.0).abs() < TOLERANCE {
        Some(DifferenceKind::Sign)
    } else {
        Some(DifferenceKind::Factor(factor))
    }
}

/// Whether an expression begins with a minus sign in every term.
pub(crate) fn is_negative(fraction: &Fraction) -> bool {
    fraction.numerator().terms().all(|(_, number)| number.is_negative())
}
