//! What is wrong with a formula, at its place in the document.

use super::Placed;
use super::code::Code;
use super::diagnostic::{Diagnostic, suggestion};
use patchcord_expr::{Formula, FormulaError, Scope};

/// A formula whose unit cannot be told: it names something unknown, or its units do not agree.
pub fn misfit(scope: &dyn Scope, placed: &Placed<Formula>, error: FormulaError) -> Diagnostic {
    let guilty = placed.value.text().get(error.range.clone()).unwrap_or_default();
    let is_name = placed.value.names().contains(&guilty) && scope.dimension(guilty).is_none();
    if !is_name {
        return in_formula(Code::UnitMismatch, placed, error);
    }
    let hint = error.hint.clone().or_else(|| suggestion(guilty, &scope.names()));
    in_formula(Code::UnknownName, placed, error).maybe_hint(hint)
}

/// A formula's own error, at its place in the document. Only a formula in quotes can have one.
pub fn in_formula(code: Code, placed: &Placed<Formula>, error: FormulaError) -> Diagnostic {
    let inside = error.range.start + 1..error.range.end + 1;
    Diagnostic::at(code, placed.span.part(&inside), error.message).maybe_hint(error.hint)
}
