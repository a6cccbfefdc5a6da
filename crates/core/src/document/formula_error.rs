//! Diagnostics for the errors of formulas and equations, at their position in the document.

use std::ops::Range;

use super::Placed;
use super::code::Code;
use super::diagnostic::Diagnostic;
use super::fields::Findings;
use super::wording::suggestion;
use patchcord_expr::{Expression, Formula, FormulaError, Node, Operator, Scope, Unit};

/// The advice about units that differ if no scale can be named.
pub(crate) const ADVICE_WITHOUT_SCALES: &str =
    "multiply or divide by parameters until both sides have the same unit";

/// The diagnostic for a formula whose unit cannot be determined.
///
/// The code is `UnknownName` if the formula contains a name that `scope` does not have, otherwise `UnitMismatch`.
/// `expected` describes the right unit of the formula, such as "a number of volts"; `None` if it is not known.
pub fn unit_mismatch(
    scope: &dyn Scope,
    placed: &Placed<Formula>,
    error: FormulaError,
    expected: Option<&str>,
) -> Diagnostic {
    let formula = &placed.value;
    let faulty = formula.text().get(error.range.clone()).unwrap_or_default();
    let is_unknown_name = formula.names().contains(&faulty) && scope.dimension(faulty).is_none();
    if !is_unknown_name {
        return dimension_diagnostic(scope, placed, error);
    }
    let advice = unit_advice(scope, formula.text(), &[formula.root()], &error, expected);
    let hint = advice
        .map(|advice| format!("numbers have no units in formulas: {advice}"))
        .or_else(|| error.hint.clone())
        .or_else(|| suggestion(faulty, &scope.names()));
    formula_diagnostic(Code::UNKNOWN_NAME, placed, error).maybe_hint(hint)
}

/// What to do about an unknown name that is the unit of a number, as in "5 * V". `None` for other names, and for one
/// that differs from a known name only in its capitals.
///
/// `roots` are the trees of the text: one for a formula, two for an equation. The error is that about the name.
pub(crate) fn unit_advice(
    scope: &dyn Scope,
    text: &str,
    roots: &[&Node],
    error: &FormulaError,
    expected: Option<&str>,
) -> Option<String> {
    let is_unknown_unit = |name: &str| {
        let is_known = scope.names().iter().any(|known| known.eq_ignore_ascii_case(name));
        !is_known && Unit::parse(name).is_ok()
    };
    let name = text.get(error.range.clone()).filter(|name| is_unknown_unit(name))?;
    let quantity = roots.iter().find_map(|root| number_with_unit(root, error.range.start))?;
    let mut names = roots.iter().flat_map(|root| root.names());
    Some(match expected.filter(|_| names.all(is_unknown_unit)) {
        Some(expected) => format!("{expected} is expected here; a quantity {name} must be a parameter"),
        None => {
            let [number, unit] = quantity.map(|range| text.get(range).unwrap_or_default());
            format!(
                "declare {number} {unit} as a parameter, with \"value\": {number} and \"unit\": \"{unit}\"; or declare \
                 {name}, if it is a quantity"
            )
        }
    })
}

/// The ranges of a number and of its unit, if the last factor of the unit begins at a byte of the formula: `9.81` and
/// `m/s2` for the byte of `s2`. `None` if no number precedes the factor.
fn number_with_unit(node: &Node, start: usize) -> Option<[Range<usize>; 2]> {
    match &node.expression {
        Expression::Binary(operator, left, right) => {
            let before = if right.range.start == start { leading_number(left) } else { None };
            // A number that is divided by something has no unit.
            let is_product = *operator == Operator::Multiply;
            let before =
                before.filter(|(_, unit)| is_product || *operator == Operator::Divide && unit.is_some());
            before
                .map(|(number, unit)| [number, unit.unwrap_or(start)..right.range.end])
                .or_else(|| number_with_unit(left, start))
                .or_else(|| number_with_unit(right, start))
        }
        Expression::Negate(inner) => number_with_unit(inner, start),
        Expression::Call(_, arguments) | Expression::Apply(_, arguments) => {
            arguments.iter().find_map(|argument| number_with_unit(argument, start))
        }
        Expression::Number(_) | Expression::Name(_) => None,
    }
}

/// The number with which a product begins, and the first byte of the units that follow it, if there are any. `None` if
/// the product has other factors.
fn leading_number(node: &Node) -> Option<(Range<usize>, Option<usize>)> {
    match &node.expression {
        Expression::Number(_) => Some((node.range.clone(), None)),
        Expression::Negate(inner) => leading_number(inner),
        Expression::Binary(Operator::Multiply | Operator::Divide, left, right) if is_unit(right) => {
            let (number, unit) = leading_number(left)?;
            Some((number, unit.or(Some(right.range.start))))
        }
        _ => None,
    }
}

/// Whether a node is the name of a unit, or a power of it.
fn is_unit(node: &Node) -> bool {
    match &node.expression {
        Expression::Name(name) => Unit::parse(name).is_ok(),
        Expression::Binary(Operator::Power, base, _) => is_unit(base),
        _ => false,
    }
}

/// The diagnostic for units that differ in a formula or an equation. Without a hint of its own, it advises parameters,
/// and also scales if the scope has them.
pub(crate) fn dimension_diagnostic<T>(
    scope: &dyn Scope,
    placed: &Placed<T>,
    mut error: FormulaError,
) -> Diagnostic {
    if !scope.has_scales() {
        error.hint.get_or_insert_with(|| ADVICE_WITHOUT_SCALES.to_owned());
    }
    formula_diagnostic(Code::UNIT_MISMATCH, placed, error)
}

/// The diagnostic for an error of a formula or an equation. Its position is the faulty part of the formula.
///
/// The position assumes that the formula is in quotes: plain numbers have no errors.
pub fn formula_diagnostic<T>(code: Code, placed: &Placed<T>, error: FormulaError) -> Diagnostic {
    let inside = error.range.start + 1..error.range.end + 1;
    Diagnostic::at(code, placed.span.subspan(&inside), error.message).maybe_hint(error.hint)
}

/// Reports an angular frequency for a quantity whose unit counts cycles, such as Hz. `None` after a report.
///
/// Only frequencies of drives are converted. The names of the formula are in `scope`.
pub(crate) fn check_cycles(
    placed: &Placed<Formula>,
    scope: &dyn Scope,
    unit: &Unit,
    findings: &mut Findings,
) -> Option<()> {
    if !unit.counts_cycles() || !placed.value.is_angular(scope).unwrap_or(false) {
        return Some(());
    }
    let message = format!("{} is an angular frequency, but {unit} is expected here", placed.value.text());
    let hint = "divide it by (2 * pi)";
    findings.push(Diagnostic::at(Code::UNIT_MISMATCH, placed.span, message).hint(hint));
    None
}
