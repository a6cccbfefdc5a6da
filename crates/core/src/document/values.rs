//! Reads ranges, units, formulas and equations from the values of a document.
//!
//! Every reader returns `None` for a wrong value and adds a diagnostic to the findings, so reading can continue.

use super::Placed;
use super::code::Code;
use super::diagnostic::{Diagnostic, Span};
use super::fields::{Findings, list, number, string, wrong_type};
use super::quantity::{Quantity, unit_rule};
use super::tree::{Content, Node};
use super::typed_number::without_separators;
use patchcord_expr::{Equation, Formula, FormulaError, Unit};

/// Reads a list of two numbers, the lower and the upper bound.
///
/// `None` if the value is not such a list or if the lower bound exceeds the upper one. Equal bounds are allowed.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::{range, tree};
///
/// let (node, mut findings) = (tree::parse("[0, 5]")?, Vec::new());
/// assert_eq!(range(&node, "range", &mut findings), Some((0.0, 5.0)));
/// let node = tree::parse("[5, 0]")?;
/// assert_eq!(range(&node, "range", &mut findings), None);
/// assert_eq!(findings[0].message, "the least value 5 is above the largest 0");
/// # Ok::<(), patchcord_core::document::Diagnostic>(())
/// ```
pub fn range(node: &Node, key: &str, findings: &mut Findings) -> Option<(f64, f64)> {
    let bounds = list(node, key, findings)?;
    let [low, high] = bounds else {
        let message = format!("\"{key}\" must be a list of two numbers: the least and the largest value");
        let hint = may_have_decimal_commas(bounds).then(|| "write decimal points: 0.5, not 0,5".to_owned());
        findings.push(Diagnostic::at(Code::WRONG_TYPE, node.span, message).maybe_hint(hint));
        return None;
    };
    let (low, high) = (number(low, key, findings)?, number(high, key, findings)?);
    if low > high {
        let message = format!("the least value {low} is above the largest {high}");
        let hint = "a range begins with the least value";
        findings.push(Diagnostic::at(Code::BAD_NUMBER, node.span, message).hint(hint));
        return None;
    }
    Some((low, high))
}

/// Whether a list may be two numbers with a decimal comma: it has three or four whole numbers.
fn may_have_decimal_commas(items: &[Node]) -> bool {
    let is_whole = |item: &Node| match &item.value {
        Content::Number(text) => text.bytes().all(|byte| byte.is_ascii_digit() || byte == b'-'),
        _ => false,
    };
    (3..=4).contains(&items.len()) && items.iter().all(is_whole)
}

/// Reads the text of a unit, such as "m/s". `None` if the value is not a text or not a unit.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::{parse_unit, tree};
///
/// let (node, mut findings) = (tree::parse("\"N s/m\"")?, Vec::new());
/// let unit = parse_unit(&node, &mut findings).expect("a unit");
/// assert_eq!(unit.text(), "N s/m");
/// assert!(findings.is_empty());
/// # Ok::<(), patchcord_core::document::Diagnostic>(())
/// ```
pub fn parse_unit(node: &Node, findings: &mut Findings) -> Option<Unit> {
    let text = string(node, "unit", findings)?;
    Unit::parse(&text.value)
        .map_err(|error| {
            let span = inside_quotes(text.span, &error.range);
            findings.push(Diagnostic::at(Code::UNKNOWN_UNIT, span, error.message).maybe_hint(error.hint));
        })
        .ok()
}

/// The position of a part of a quoted text. It is shifted if escapes precede the part.
fn inside_quotes(span: Span, range: &std::ops::Range<usize>) -> Span {
    span.subspan(&(range.start + 1..range.end + 1))
}

/// The diagnostic for a text that is not a formula. A number with a unit, such as "8 s", gets a message of its own.
/// `unit` is the unit of a number alone.
fn formula_syntax_error(
    text: &str,
    span: Span,
    key: &str,
    unit: Option<&str>,
    error: FormulaError,
) -> Diagnostic {
    let span = inside_quotes(span, &error.range);
    match Quantity::parse(text) {
        Some(quantity) => {
            let message = format!("\"{}\" has a unit, but {}", text.trim(), unit_rule(key));
            Diagnostic::at(Code::BAD_FORMULA, span, message).hint(quantity.formula_hint(unit))
        }
        None => {
            let advised = without_separators(text).map(|advised| format!("write {advised}"));
            Diagnostic::at(Code::BAD_FORMULA, span, error.message).maybe_hint(advised.or(error.hint))
        }
    }
}

/// Reads a number, or a formula in quotes. `None` if the value is of another type or the formula has a syntax error.
///
/// The names and units in the formula are not checked here.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::{formula, tree};
///
/// let (node, mut findings) = (tree::parse("\"2 * k\"")?, Vec::new());
/// let placed = formula(&node, "per_volt", &mut findings).expect("a formula");
/// assert_eq!(placed.value.names(), ["k"]);
/// # Ok::<(), patchcord_core::document::Diagnostic>(())
/// ```
pub fn formula(node: &Node, key: &str, findings: &mut Findings) -> Option<Placed<Formula>> {
    formula_in(node, key, None, findings)
}

/// Like [`formula`]. `unit` is the unit of a number alone, such as "Hz" or "unit of the scale"; the hint about a number
/// with a unit names it. `None` if it is not known.
pub(crate) fn formula_in(
    node: &Node,
    key: &str,
    unit: Option<&str>,
    findings: &mut Findings,
) -> Option<Placed<Formula>> {
    let value = match &node.value {
        Content::Number(_) => Formula::constant(number(node, key, findings)?),
        Content::Text(text) => Formula::parse(text)
            .map_err(|error| findings.push(formula_syntax_error(text, node.span, key, unit, error)))
            .ok()?,
        other => {
            findings.push(wrong_type(node, key, "a number or a formula in quotes", other));
            return None;
        }
    };
    Some(Placed { value, span: node.span })
}

/// Reads an equation in quotes. `None` if the value is not a text or the equation has a syntax error.
///
/// The names and units in the equation are not checked here.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::{equation, tree};
///
/// let (node, mut findings) = (tree::parse("\"m x'' = -k x\"")?, Vec::new());
/// let placed = equation(&node, "equations", &mut findings).expect("an equation");
/// assert_eq!(placed.value.names(), ["m", "x''", "k", "x"]);
/// assert!(findings.is_empty());
/// # Ok::<(), patchcord_core::document::Diagnostic>(())
/// ```
pub fn equation(node: &Node, key: &str, findings: &mut Findings) -> Option<Placed<Equation>> {
    equation_with_tables(node, key, &[], findings)
}

/// Like [`equation`]. The equation can also apply the tables with these names.
pub(crate) fn equation_with_tables(
    node: &Node,
    key: &str,
    tables: &[&str],
    findings: &mut Findings,
) -> Option<Placed<Equation>> {
    let Placed { value: text, span } = string(node, key, findings)?;
    let value = Equation::parse(&text, tables)
        .map_err(|error| {
            let span = inside_quotes(span, &error.range);
            findings.push(Diagnostic::at(Code::BAD_FORMULA, span, error.message).maybe_hint(error.hint));
        })
        .ok()?;
    Some(Placed { value, span })
}
