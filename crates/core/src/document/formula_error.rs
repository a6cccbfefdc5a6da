//! Diagnostics for the errors of formulas, at their position in the document.

use super::Placed;
use super::code::Code;
use super::diagnostic::Diagnostic;
use super::wording::suggestion;
use patchcord_expr::{Formula, FormulaError, Scope};

/// The diagnostic for a formula whose unit cannot be determined.
///
/// The code is `UnknownName` if the formula contains a name that `scope` does not have, otherwise `UnitMismatch`.
pub fn unit_mismatch(scope: &dyn Scope, placed: &Placed<Formula>, error: FormulaError) -> Diagnostic {
    let faulty = placed.value.text().get(error.range.clone()).unwrap_or_default();
    let is_unknown_name = placed.value.names().contains(&faulty) && scope.dimension(faulty).is_none();
    if !is_unknown_name {
        return formula_diagnostic(Code::UNIT_MISMATCH, placed, error);
    }
    let hint = error.hint.clone().or_else(|| suggestion(faulty, &scope.names()));
    formula_diagnostic(Code::UNKNOWN_NAME, placed, error).maybe_hint(hint)
}

/// The diagnostic for an error of a formula. Its position is the faulty part of the formula.
///
/// The position assumes that the formula is in quotes: plain numbers have no errors.
pub fn formula_diagnostic(code: Code, placed: &Placed<Formula>, error: FormulaError) -> Diagnostic {
    let inside = error.range.start + 1..error.range.end + 1;
    Diagnostic::at(code, placed.span.subspan(&inside), error.message).maybe_hint(error.hint)
}
