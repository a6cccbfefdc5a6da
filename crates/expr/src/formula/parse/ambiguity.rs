//! The error for a product without a sign after a division, such as `a / b c`, and the two ways to write it.
//!
//! The hint replaces the whole product, so that the text with the replacement has no such fault. A number with a unit,
//! such as `9.81 m/s2 / L x`, cannot be in an equation, so the hint puts a parameter in its place.

use std::ops::Range;

use crate::formula::error::FormulaError;
use crate::formula::expression::Operator;
use crate::units::Unit;

/// The maximum length of a product that the hint writes out, in bytes.
const MAX_WRITTEN_LENGTH: usize = 120;

/// The names for a parameter in a hint. The first that the equation does not use is taken.
const PARAMETER_NAMES: [&str; 5] = ["p", "q", "p_1", "p_2", "p_3"];

/// A factor of a product.
pub(super) struct Factor {
    /// The operator before it. `None` for the first factor, and for one without a sign.
    pub operator: Option<Operator>,
    /// The bytes of the text that the factor covers.
    pub range: Range<usize>,
}

/// Returns the error for the first factor without a sign that follows a division. `None` if no factor does.
///
/// `has_name` is whether the equation contains a name.
pub(super) fn ambiguous_product(
    text: &str,
    factors: &[Factor],
    has_name: &dyn Fn(&str) -> bool,
) -> Option<FormulaError> {
    let is_ambiguous = |pair: &&[Factor]| pair[0].is_divisor() && pair[1].operator.is_none();
    let pair = factors.windows(2).find(is_ambiguous)?;
    let range = pair[0].range.start..pair[1].range.end;
    let message = "a product without a sign after a division is ambiguous";
    Some(FormulaError::new(range, message).with_hint(hint(text, factors, has_name)))
}

impl Factor {
    /// Whether the factor is the divisor of a quotient.
    fn is_divisor(&self) -> bool {
        self.operator == Some(Operator::Divide)
    }
}

/// Returns the hint: the two ways to write the product, and what to do about a number with a unit in it.
fn hint(text: &str, factors: &[Factor], has_name: &dyn Fn(&str) -> bool) -> String {
    let (first, last) = (&factors[0], &factors[factors.len() - 1]);
    if last.range.end - first.range.start > MAX_WRITTEN_LENGTH {
        return "put the quotient in parentheses, or its divisor with the factors that follow it".to_owned();
    }
    let written: Vec<Written<'_>> =
        factors.iter().map(|factor| (factor.operator, &text[factor.range.clone()])).collect();
    let product = both_ways(&written);
    let unit_length = unit_length(text, factors);
    if unit_length == 0 {
        return format!("write {product}");
    }
    let number = &text[first.range.start..factors[unit_length].range.end];
    if !factors[..=unit_length].iter().any(Factor::is_divisor) {
        return format!("write {product}; if {number} is a number with a unit, declare it as a parameter");
    }
    let name = PARAMETER_NAMES.into_iter().find(|name| !has_name(name)).unwrap_or(PARAMETER_NAMES[0]);
    let parameter: [Written<'_>; 1] = [(None, name)];
    let with_parameter: Vec<Written<'_>> =
        parameter.iter().chain(&written[unit_length + 1..]).copied().collect();
    let units: Vec<&str> = written[1..=unit_length].iter().map(|(_, unit)| *unit).collect();
    format!(
        "numbers have no units in equations: declare {number} as a parameter {name} and write {}; if {} are \
         quantities, write {product}",
        both_ways(&with_parameter),
        units.join(" and ")
    )
}

/// The operator before a factor, and the text of the factor.
type Written<'t> = (Option<Operator>, &'t str);

/// Writes a product with parentheses around each ambiguous quotient, and around each ambiguous divisor. Without an
/// ambiguity the two are the same.
fn both_ways(factors: &[Written<'_>]) -> String {
    let [quotients, divisors] = [with_quotients(factors), with_divisors(factors)];
    if quotients == divisors { quotients } else { format!("{quotients} or {divisors}") }
}

/// Writes `(a / b) c` for `a / b c`.
fn with_quotients(factors: &[Written<'_>]) -> String {
    let mut written = String::new();
    let mut follows_division = false;
    for (operator, factor) in factors {
        written = match operator {
            Some(operator) => format!("{written} {} {factor}", sign(*operator)),
            None if written.is_empty() => (*factor).to_owned(),
            None if follows_division => format!("({written}) {factor}"),
            None => format!("{written} {factor}"),
        };
        follows_division = *operator == Some(Operator::Divide);
    }
    written
}

/// Writes `a / (b c)` for `a / b c`.
fn with_divisors(factors: &[Written<'_>]) -> String {
    let has_sign = |(_, factor): &(usize, &Written<'_>)| factor.0.is_some();
    let signs = factors.iter().enumerate().filter(has_sign).map(|(index, _)| index);
    let starts: Vec<usize> = [0].into_iter().chain(signs).chain([factors.len()]).collect();
    let groups = starts.windows(2).map(|bounds| {
        let group = &factors[bounds[0]..bounds[1]];
        let joined = group.iter().map(|(_, factor)| *factor).collect::<Vec<_>>().join(" ");
        match group[0].0 {
            Some(Operator::Divide) if group.len() > 1 => format!(" / ({joined})"),
            Some(operator) => format!(" {} {joined}", sign(operator)),
            None => joined,
        }
    });
    groups.collect()
}

/// Returns the sign of a multiplication or a division.
fn sign(operator: Operator) -> char {
    if operator == Operator::Divide { '/' } else { '*' }
}

/// Returns the number of factors that are the unit of the first one: 2 for `9.81 m/s2 / L`. 0 if the first factor is no
/// number, or if no unit follows it.
///
/// With blanks around the sign, a divisor counts as a quantity: `5 N / m` has the unit N. After a division, a factor
/// without a sign is no part of the unit.
fn unit_length(text: &str, factors: &[Factor]) -> usize {
    let number = text[factors[0].range.clone()].trim_start_matches(['-', ' ']);
    if !number.starts_with(|first: char| first.is_ascii_digit() || first == '.') {
        return 0;
    }
    let mut has_divisor = false;
    let is_part = |pair: &&[Factor]| {
        let between = &text[pair[0].range.end..pair[1].range.start];
        let is_linked = match pair[1].operator {
            None => !has_divisor,
            Some(_) => between == "/" && pair[0].range != factors[0].range,
        };
        has_divisor |= pair[1].is_divisor();
        is_linked && is_unit(&text[pair[1].range.clone()])
    };
    factors.windows(2).take_while(is_part).count()
}

/// Whether a factor is the name of a unit, also with a power.
fn is_unit(factor: &str) -> bool {
    factor.starts_with(|first: char| first.is_ascii_alphabetic()) && Unit::parse(factor).is_ok()
}
