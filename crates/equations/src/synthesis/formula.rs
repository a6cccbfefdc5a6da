//! The text of constant expressions as formulas of a patch: products such as `k / m * x / x_dot / 10`.
//!
//! Factors have the order of the gain rule (eq. 4-8): the coefficient, input scale / output scale, the gain, and the
//! time scale.

use num_traits::{One as _, Signed as _, Zero as _};
use patchcord_expr::{format_significant, round_significant};
use serde_json::Value;

use super::expressions::Expressions;
use crate::symbolic::{Atom, CallOrder, Fraction, Monomial, Operation, Polynomial, Rational, nearest};

/// The longest text of a formula in bytes. The parser accepts a few more.
const LONGEST: usize = 1900;
/// The digits from which every number is read again without a change.
pub(super) const EXACT_DIGITS: usize = 17;
/// The digits of the largest numerator and denominator that are written. Longer ones come from functions of numbers, such
/// as ln(10), which are not exact.
const LONGEST_PART: usize = 6;
/// The digits of a number that was computed from other numbers. The rest is rounding.
const COMPUTED_DIGITS: usize = 15;

/// The formula of a setting: a product of a number and powers of texts, in the order in which they are multiplied.
#[derive(Debug, Clone)]
pub(super) struct SettingFormula {
    /// The number.
    number: Rational,
    /// The factors, each once.
    factors: Vec<Factor>,
    /// The exponent of the time scale, which is the last factor.
    time_scale: i32,
    /// Whether all factors have a text. A table and a delay have none.
    is_writable: bool,
}

/// A power of a text.
#[derive(Debug, Clone)]
struct Factor {
    /// The text of the base.
    text: String,
    /// Whether the base is a sum, which needs parentheses.
    is_sum: bool,
    /// The exponent, which is not 0.
    exponent: i32,
}

impl SettingFormula {
    /// The product without factors: 1.
    pub(super) fn one() -> Self {
        SettingFormula { number: Rational::one(), factors: Vec::new(), time_scale: 0, is_writable: true }
    }

    /// The product with an expression.
    pub(super) fn times(self, factor: &Fraction, expressions: &Expressions<'_>) -> Self {
        self.times_power(factor, 1, expressions)
    }

    /// The quotient by an expression, which is not 0.
    pub(super) fn over(self, factor: &Fraction, expressions: &Expressions<'_>) -> Self {
        self.times_power(factor, -1, expressions)
    }

    /// The product with a text that is no sum, such as a function of numbers.
    pub(super) fn times_text(mut self, text: &str) -> Self {
        self.multiply(Some(text.to_owned()), false, 1);
        self
    }

    /// The product with a number.
    pub(super) fn times_number(mut self, number: f64) -> Self {
        match Fraction::number(number).as_rational() {
            Some(number) => self.number *= number,
            None => self.is_writable = false,
        }
        self
    }

    /// The quotient by a number, which is not 0.
    pub(super) fn over_number(mut self, number: f64) -> Self {
        match Fraction::number(number).as_rational() {
            Some(number) if !number.is_zero() => self.number /= number,
            _ => self.is_writable = false,
        }
        self
    }

    /// The product with a power of the time scale.
    pub(super) fn times_time_scale(mut self, exponent: i32) -> Self {
        self.time_scale += exponent;
        self
    }

    /// The product with a power of an expression.
    fn times_power(mut self, factor: &Fraction, exponent: i32, expressions: &Expressions<'_>) -> Self {
        if factor.is_zero() {
            self.number = Rational::zero();
            self.is_writable &= exponent > 0;
            return self;
        }
        let (number, content, rest) = with_common_factors(factor.numerator());
        self.number *= number.pow(exponent);
        let mut powers: Vec<(Option<String>, bool, i32)> = Vec::new();
        for (atom, power) in content.factors() {
            powers.push((atom_text(atom, expressions), false, power * exponent));
        }
        if !rest.is_one() {
            powers.push((sum_text(&rest, expressions), true, exponent));
        }
        for (divisor, power) in factor.divisors() {
            powers.push((sum_text(divisor, expressions), true, -(power as i32) * exponent));
        }
        // Factors come before divisors: `k / m`, whatever the order of the symbols.
        powers.sort_by_key(|(_, _, exponent)| *exponent < 0);
        for (text, is_sum, exponent) in powers {
            self.multiply(text, is_sum, exponent);
        }
        self
    }

    /// Multiplies by a power of a text. `None` is a base without a text.
    fn multiply(&mut self, text: Option<String>, is_sum: bool, exponent: i32) {
        let Some(text) = text else {
            self.is_writable = false;
            return;
        };
        match self.factors.iter().position(|factor| factor.text == text) {
            Some(known) if self.factors[known].exponent + exponent == 0 => drop(self.factors.remove(known)),
            Some(known) => self.factors[known].exponent += exponent,
            None => self.factors.push(Factor { text, is_sum, exponent }),
        }
    }

    /// The text of the product. `None` if a factor has no text.
    pub(super) fn text(&self) -> Option<String> {
        if !self.is_writable {
            return None;
        }
        if self.number.is_zero() {
            return Some("0".to_owned());
        }
        let (lead, divisor) = number_parts(&self.number.abs());
        let is_alone = lead.is_none() && divisor.is_none() && self.time_scale == 0;
        let is_alone = is_alone && self.factors.len() == 1 && !self.number.is_negative();
        let mut text = lead.unwrap_or_default();
        for factor in self.ordered() {
            append(&mut text, &factor.text(is_alone), factor.exponent > 0);
        }
        if let Some(divisor) = divisor {
            append(&mut text, &divisor, false);
        }
        if self.time_scale != 0 {
            append(&mut text, &power_text("time_scale", self.time_scale.abs()), self.time_scale > 0);
        }
        let sign = if self.number.is_negative() { "-" } else { "" };
        Some(if text.is_empty() { format!("{sign}1") } else { sign.to_owned() + &text })
    }

    /// The text of the product as a factor: a sum is in parentheses.
    pub(super) fn factor_text(&self) -> Option<String> {
        let text = self.text()?;
        let is_sum = self.factors.iter().any(|factor| factor.is_sum) && !text.starts_with('(');
        Some(if is_sum { format!("({text})") } else { text })
    }

    /// The factors, with divisors at the beginning moved to the end: `force / M` and not `1 / M * force`.
    fn ordered(&self) -> impl Iterator<Item = &Factor> {
        let first = self.factors.iter().position(|factor| factor.exponent > 0).unwrap_or(0);
        let (divisors, rest) = self.factors.split_at(first);
        rest.iter().chain(divisors)
    }

    /// The product as a setting of a document: a formula, or its value if it contains no name or has no text.
    pub(super) fn setting(&self, value: f64) -> Value {
        let has_names = !self.factors.is_empty() || self.time_scale != 0;
        match self.text().filter(|text| has_names && !self.number.is_zero() && text.len() <= LONGEST) {
            Some(text) => text.into(),
            None => json_number(value),
        }
    }
}

impl Factor {
    /// The text of the factor without the sign of its exponent. A sum that is alone needs no parentheses.
    fn text(&self, is_alone: bool) -> String {
        let exponent = self.exponent.abs();
        if self.is_sum && !(is_alone && self.exponent == 1) {
            return power_text(&format!("({})", self.text), exponent);
        }
        power_text(&self.text, exponent)
    }
}

/// The text of a power with a positive exponent.
fn power_text(base: &str, exponent: i32) -> String {
    if exponent == 1 { base.to_owned() } else { format!("{base}^{exponent}") }
}

/// Adds a factor or a divisor to the text of a product.
fn append(text: &mut String, factor: &str, is_multiplied: bool) {
    if text.is_empty() && !is_multiplied {
        text.push('1');
    }
    if !text.is_empty() {
        text.push_str(if is_multiplied { " * " } else { " / " });
    }
    text.push_str(factor);
}

/// A sum as number x product x rest, with the factors that all terms have. So `h + 2 * a / d^2` has none, although
/// `2 * (0.5 * d^2 * h + a) / d^2` is the same.
fn with_common_factors(sum: &Polynomial) -> (Rational, Monomial, Polynomial) {
    let (number, content) = (common_number(sum), common_product(sum));
    let rest = sum.times_term(&content.power(-1), &number.recip());
    (number, content, rest)
}

/// The smallest number of a sum, if all others are whole multiples of it, otherwise 1. It is negative if all numbers are:
/// `q - r` and not `-(r - q)`.
fn common_number(sum: &Polynomial) -> Rational {
    let numbers = || sum.terms().map(|(_, number)| number);
    let least = numbers().map(Rational::abs).min().unwrap_or_else(Rational::one);
    let is_common = numbers().all(|number| (number / &least).is_integer());
    let size = if is_common { least } else { Rational::one() };
    if numbers().all(Rational::is_negative) { -size } else { size }
}

/// The product of the factors of all terms: each with its smallest exponent, or with its largest one if all exponents are
/// negative.
fn common_product(sum: &Polynomial) -> Monomial {
    let mut products = sum.terms().map(|(product, _)| product);
    let first = products.next().cloned().unwrap_or_default();
    let opposite = first.power(-1);
    let (least, opposite) = products.fold((first, opposite), |(least, opposite), product| {
        (least.common(product), opposite.common(&product.power(-1)))
    });
    let most = opposite.power(-1);
    least.only(|_, exponent| exponent > 0).times(&most.only(|_, exponent| exponent < 0))
}

/// A positive number as a factor in front of a product and a divisor after it. `None` for 1.
fn number_parts(number: &Rational) -> (Option<String>, Option<String>) {
    let [top, bottom] = [number.numer(), number.denom()].map(|part| {
        let text = part.to_string();
        (text != "1").then_some(text)
    });
    let is_power_of_ten = |text: &String| text.trim_end_matches('0') == "1";
    if top.is_none() && bottom.as_ref().is_none_or(is_power_of_ten) {
        let short =
            |text: String| if text.len() > LONGEST_PART { format!("1e{}", text.len() - 1) } else { text };
        return (None, bottom.map(short));
    }
    let value = nearest(number);
    let is_long = [&top, &bottom].into_iter().flatten().any(|part| part.len() > LONGEST_PART);
    if is_long || Fraction::number(value).as_rational().as_ref() == Some(number) {
        return (Some(format_significant(value, EXACT_DIGITS)), None);
    }
    (top, bottom)
}

/// The text of a sum: positive terms first, and of these the ones without divisors. `None` if a factor has no text.
fn sum_text(sum: &Polynomial, expressions: &Expressions<'_>) -> Option<String> {
    let mut terms: Vec<([bool; 2], String)> = Vec::new();
    for (product, number) in sum.terms() {
        let mut term = SettingFormula { number: number.abs(), ..SettingFormula::one() };
        for (atom, power) in product.factors() {
            term.multiply(atom_text(atom, expressions), false, *power);
        }
        let has_divisor = product.factors().iter().any(|(_, power)| *power < 0);
        terms.push(([number.is_negative(), has_divisor], term.text()?));
    }
    terms.sort_by_key(|(place, _)| *place);
    let mut text = String::new();
    for ([is_negative, _], term) in terms {
        text += match (text.is_empty(), is_negative) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        text += &term;
    }
    Some(text)
}

/// The text of a factor. `None` for a function that formulas do not have.
fn atom_text(atom: &Atom, expressions: &Expressions<'_>) -> Option<String> {
    let applied = match atom {
        Atom::Symbol(symbol) => return Some(expressions.name(*symbol).to_owned()),
        Atom::Apply(applied) => applied,
    };
    let argument = |argument: &Fraction| SettingFormula::one().times(argument, expressions).text();
    let name = match applied.operation {
        Operation::Step => return Some(step_text(&argument(applied.arguments.first()?)?)),
        Operation::Absolute => "abs",
        Operation::Minimum => "min",
        Operation::Maximum => "max",
        // The argument in parentheses.
        Operation::Group => "",
        Operation::Call(CallOrder(function)) => function.name(),
        Operation::Table(_)
        | Operation::TableSlope(_)
        | Operation::Delay
        | Operation::Limit
        | Operation::Sign => return None,
    };
    let arguments: Option<Vec<String>> = applied.arguments.iter().map(argument).collect();
    Some(format!("{name}({})", arguments?.join(", ")))
}

/// The step of an expression in the functions of formulas. The angle of the point (|x|, min(x, 0)) is -pi/4 if x is below
/// 0, otherwise 0, for x of any unit.
fn step_text(argument: &str) -> String {
    format!("(1 + floor(atan2(min({argument}, 0), abs({argument}))))")
}

/// A number of a document, without the rounding of its computation. A whole number has no decimal point.
pub(super) fn json_number(value: f64) -> Value {
    exact_number(round_significant(value, COMPUTED_DIGITS))
}

/// A number of a document with all its digits. A whole number has no decimal point.
pub(super) fn exact_number(value: f64) -> Value {
    let is_whole = value.fract() == 0.0 && value.abs() < 1e15;
    if is_whole { Value::from(value as i64) } else { Value::from(value) }
}
