//! Ranges, units and formulas as documents contain them.

use super::Placed;
use super::code::Code;
use super::diagnostic::{Diagnostic, Span};
use super::fields::{Findings, list, number, word, wrong_type};
use super::tree::{Content, Node};
use patchcord_expr::{Formula, Unit};

/// A list of two numbers, least and largest.
pub fn range(node: &Node, key: &str, findings: &mut Findings) -> Option<(f64, f64)> {
    let bounds = list(node, key, findings)?;
    let [low, high] = bounds else {
        let message = format!("\"{key}\" is a list of two numbers, least and largest");
        findings.push(Diagnostic::at(Code::WrongType, node.span, message));
        return None;
    };
    let (low, high) = (number(low, key, findings)?, number(high, key, findings)?);
    if low > high {
        let message = format!("the least value {low} is above the largest {high}");
        let hint = "a range begins with the least value";
        findings.push(Diagnostic::at(Code::BadNumber, node.span, message).hint(hint));
        return None;
    }
    Some((low, high))
}

/// The unit that a text tells.
pub fn unit_of(node: &Node, findings: &mut Findings) -> Option<Unit> {
    let text = word(node, "unit", findings)?;
    Unit::parse(&text.value)
        .map_err(|error| {
            let at = inside_quotes(text.span, &error.range);
            findings.push(Diagnostic::at(Code::UnknownUnit, at, error.message).maybe_hint(error.hint));
        })
        .ok()
}

/// The place of a part of a quoted text; escapes before it are not counted.
fn inside_quotes(span: Span, range: &std::ops::Range<usize>) -> Span {
    span.part(&(range.start + 1..range.end + 1))
}

/// A number, or a formula in quotes.
pub fn formula(node: &Node, key: &str, findings: &mut Findings) -> Option<Placed<Formula>> {
    let value = match &node.value {
        Content::Number(_) => Formula::constant(number(node, key, findings)?),
        Content::Text(text) => Formula::parse(text)
            .map_err(|error| {
                let at = inside_quotes(node.span, &error.range);
                findings.push(Diagnostic::at(Code::BadFormula, at, error.message).maybe_hint(error.hint));
            })
            .ok()?,
        other => {
            findings.push(wrong_type(node, key, "a number or a formula in quotes", other));
            return None;
        }
    };
    Some(Placed { value, span: node.span })
}
