//! Writes sums: grouping, order, and the factors of each term.

use num_traits::{One as _, Signed as _};
use patchcord_expr::Dimension;

use super::Writer;
use super::maxima::with_maxima;
use crate::notation::Notation;
use crate::symbolic::{Atom, Fraction, Monomial, Operation, Polynomial, Rational, SymbolKind, nearest};

/// A term of a sum: a number, a constant product and a product of variables.
#[derive(Clone)]
struct Term {
    number: Rational,
    constant: Monomial,
    variable: Monomial,
}

/// The place of a part in a sum: its class, its degree, its variables and its constants.
type Rank = (u8, i32, Vec<(u32, i32)>, Vec<(u32, i32)>);

/// A part of a sum: one term, or terms with a common factor.
struct Part {
    /// The number in front. It is the common factor of the numbers if there are several terms.
    number: Rational,
    constant: Monomial,
    /// The variables that all terms have in common.
    variable: Monomial,
    /// The rest of each term; empty if there is only one.
    inside: Polynomial,
}

impl Writer<'_> {
    /// A sum of terms over its divisors.
    pub(super) fn sum(&self, value: &Fraction, dimension: Option<Dimension>) -> Notation {
        let divisors: Vec<Notation> = value
            .divisors()
            .map(|(divisor, power)| {
                let base = self.polynomial(divisor, self.sum_dimension(divisor));
                raised(base, power as i32)
            })
            .collect();
        let of_divisors = value.divisors().fold(Dimension::NONE, |product, (divisor, power)| {
            product.times(self.sum_dimension(divisor).unwrap_or(Dimension::NONE).power(f64::from(power)))
        });
        let dimension = dimension.map(|dimension| dimension.times(of_divisors));
        let top = self.polynomial(&with_maxima(value.numerator()), dimension);
        if divisors.is_empty() {
            return top;
        }
        match top {
            Notation::Negative(inner) => Notation::Negative(Box::new(quotient(vec![*inner], divisors))),
            top => quotient(vec![top], divisors),
        }
    }

    /// A sum without divisors.
    fn polynomial(&self, sum: &Polynomial, dimension: Option<Dimension>) -> Notation {
        if let Some(factored) = self.factored(sum, dimension) {
            return factored;
        }
        let mut parts = self.parts(sum);
        parts.sort_by_cached_key(|part| self.rank(part));
        let first_positive = parts.iter().position(|part| !part.number.is_negative());
        if let Some(position) = first_positive {
            parts[..=position].rotate_right(1);
        }
        let mut terms: Vec<Notation> = parts.iter().map(|part| self.part(part, dimension)).collect();
        match terms.len() {
            0 => number(0.0),
            1 => terms.remove(0),
            _ => Notation::Sum(terms),
        }
    }

    /// A sum as (constants) x variables, if all terms have the same variables and none of them stands alone: (a - b) x.
    fn factored(&self, sum: &Polynomial, dimension: Option<Dimension>) -> Option<Notation> {
        let mut products = sum.terms().map(|(product, _)| product.only(|atom, _| !atom.is_constant()));
        let first = products.next()?;
        let variable = products.fold(first, |common, product| common.common(&product));
        if sum.terms().len() < 2 || variable.is_one() {
            return None;
        }
        let inside = sum.times_term(&variable.power(-1), &Rational::one());
        let constants = inside.terms().filter(|(product, _)| product.is_constant());
        if constants.count() == 0 || self.parts(sum).len() == 1 {
            return None;
        }
        let dimension = dimension.map(|dimension| dimension.over(self.product_dimension(&variable)));
        let is_negative = inside.terms().all(|(_, number)| number.is_negative());
        let factor = self.polynomial(&if is_negative { inside.negated() } else { inside }, dimension);
        let variables = self.factors(&variable, 1);
        let top = joined([factor].into_iter().chain(variables).collect());
        let divisors = self.factors(&variable, -1);
        let written = if divisors.is_empty() { top } else { quotient(vec![top], divisors) };
        Some(if is_negative { Notation::Negative(Box::new(written)) } else { written })
    }

    /// The terms of a sum, with those grouped that have the same constant factor.
    fn parts(&self, sum: &Polynomial) -> Vec<Part> {
        let mut groups: Vec<Vec<Term>> = Vec::new();
        for (product, coefficient) in sum.terms() {
            let constant = product.only(|atom, _| atom.is_constant());
            let term = Term { number: coefficient.clone(), variable: product.over(&constant), constant };
            let is_same =
                |group: &&mut Vec<Term>| !term.constant.is_one() && group[0].constant == term.constant;
            match groups.iter_mut().find(is_same) {
                Some(group) => group.push(term),
                None => groups.push(vec![term]),
            }
        }
        groups.into_iter().map(part).collect()
    }

    /// The place of a part in a sum: terms of low degree first, then in the order of the variables. Constants are last,
    /// but come before terms of time only, and before dry friction, which has the sign of a quantity.
    fn rank(&self, part: &Part) -> Rank {
        let inside = part.inside.terms().map(|(product, _)| product).max().cloned().unwrap_or_default();
        let variable = part.variable.times(&inside);
        let is_time = |atom: &Atom| matches!(atom, Atom::Symbol(symbol) if self.system.symbols.entry(*symbol).kind == SymbolKind::Time);
        let is_of_time = variable.factors().iter().all(|(atom, _)| is_time(atom));
        let is_sign = |(atom, _): &(Atom, i32)| matches!(atom, Atom::Apply(applied) if applied.operation == Operation::Sign);
        let class = match variable.factors() {
            [] => 1,
            factors if factors.iter().any(is_sign) => 3,
            _ => 2 * u8::from(is_of_time),
        };
        let degree = variable.factors().iter().map(|(_, exponent)| exponent.max(&0)).sum();
        let order = |product: &Monomial| {
            product.factors().iter().map(|(atom, exponent)| (first_symbol(atom), *exponent)).collect()
        };
        (class, degree, order(&variable), order(&part.constant))
    }

    /// One part of a sum, with its sign.
    fn part(&self, part: &Part, dimension: Option<Dimension>) -> Notation {
        let outside = self.product_dimension(&part.constant).times(self.product_dimension(&part.variable));
        let mut variables = self.factors(&part.variable, 1);
        let mut unit = None;
        if part.inside.is_zero() {
            unit = dimension.map(|dimension| dimension.over(outside)).filter(|unit| !unit.is_dimensionless());
        } else {
            let inside = self.polynomial(&part.inside, dimension.map(|dimension| dimension.over(outside)));
            // The sum comes before the last variable: mu (1 - x^2) v.
            let place = variables.len().saturating_sub(1);
            variables.insert(place, inside);
        }
        let divisors = self.factors(&part.variable, -1);
        let constants = [self.factors(&part.constant, 1), self.factors(&part.constant, -1)];
        let unit = unit.map(|unit| self.unit_text(unit));
        let written = product(&part.number.abs(), unit, constants, [variables, divisors]);
        if part.number.is_negative() { Notation::Negative(Box::new(written)) } else { written }
    }

    /// The factors of a product with positive (`sign` 1) or negative (-1) exponents, each raised to its power.
    fn factors(&self, product: &Monomial, sign: i32) -> Vec<Notation> {
        let wanted = product.factors().iter().filter(|(_, exponent)| exponent.signum() == sign);
        wanted.map(|(atom, exponent)| raised(self.factor(atom), exponent.abs())).collect()
    }
}

/// The part that consists of terms with the same constant factor.
fn part(group: Vec<Term>) -> Part {
    let mut terms = group.into_iter();
    let Some(first) = terms.next() else {
        let (constant, variable) = (Monomial::default(), Monomial::default());
        return Part { number: Rational::one(), constant, variable, inside: Polynomial::default() };
    };
    let rest: Vec<Term> = terms.collect();
    let Term { number, constant, variable } = first.clone();
    if rest.is_empty() {
        return Part { number, constant, variable, inside: Polynomial::default() };
    }
    let all = || rest.iter().chain([&first]);
    let variable = rest.iter().fold(variable, |common, term| common.common(&term.variable));
    let size = number.abs();
    let is_equal = all().all(|term| term.number.abs() == size);
    let is_negative = all().all(|term| term.number.is_negative());
    let size = if is_equal { size } else { Rational::one() };
    let number = if is_negative { -size } else { size };
    let mut inside = Polynomial::default();
    all().for_each(|term| inside.add_term(term.variable.over(&variable), &(&term.number / &number)));
    Part { number, constant, variable, inside }
}

/// A product: number, constants and variables, each with its divisors.
fn product(
    coefficient: &Rational,
    unit: Option<String>,
    [constants, constant_divisors]: [Vec<Notation>; 2],
    [variables, divisors]: [Vec<Notation>; 2],
) -> Notation {
    let (top, bottom) = number_parts(coefficient);
    let is_one = top == 1.0 && unit.is_none();
    let lead = (!is_one).then_some(Notation::Number { value: top, unit });
    let below: Vec<Notation> = bottom.map(number).into_iter().chain(constant_divisors).collect();
    let above: Vec<Notation> = lead.into_iter().chain(constants).collect();
    if !divisors.is_empty() {
        let top = above.into_iter().chain(variables).collect();
        return quotient(top, below.into_iter().chain(divisors).collect());
    }
    if below.is_empty() {
        return joined(above.into_iter().chain(variables).collect());
    }
    if above.is_empty() || variables.is_empty() {
        return quotient(above.into_iter().chain(variables).collect(), below);
    }
    let factor = quotient(above, below);
    joined([factor].into_iter().chain(variables).collect())
}

/// A number as a decimal, or as a quotient of small whole numbers if its decimal does not end soon.
fn number_parts(number: &Rational) -> (f64, Option<f64>) {
    let value = nearest(number);
    let digits =
        format!("{value:e}").split('e').next().map_or(0, |mantissa| mantissa.trim_start_matches('-').len());
    let is_small = |part: f64| part.abs() < LARGEST_PART;
    let (top, bottom) = (nearest(&number.numer().clone().into()), nearest(&number.denom().clone().into()));
    if digits > LONGEST_DECIMAL && is_small(top) && is_small(bottom) {
        (top, Some(bottom))
    } else {
        (value, None)
    }
}

/// Digits of a decimal that is written as such, with its point.
const LONGEST_DECIMAL: usize = 7;
/// Numerators and denominators below this number are written as a quotient.
const LARGEST_PART: f64 = 1e4;

/// A pure number.
fn number(value: f64) -> Notation {
    Notation::Number { value, unit: None }
}

/// A product of factors; 1 if there are none.
fn joined(mut factors: Vec<Notation>) -> Notation {
    match factors.len() {
        0 => number(1.0),
        1 => factors.remove(0),
        _ => Notation::Product(factors),
    }
}

/// A quotient of products.
fn quotient(top: Vec<Notation>, bottom: Vec<Notation>) -> Notation {
    Notation::Quotient(Box::new(joined(top)), Box::new(joined(bottom)))
}

/// A power with a positive whole exponent.
fn raised(base: Notation, exponent: i32) -> Notation {
    match exponent {
        1 => base,
        _ => Notation::Power(Box::new(base), Box::new(number(f64::from(exponent)))),
    }
}

/// The first symbol of a factor, which decides its place.
fn first_symbol(atom: &Atom) -> u32 {
    match atom {
        Atom::Symbol(symbol) => symbol.index,
        Atom::Apply(applied) => {
            let mut first = u32::MAX;
            for argument in &applied.arguments {
                argument.contains(&mut |symbol| {
                    first = first.min(symbol.index);
                    false
                });
            }
            first
        }
    }
}
