//! The values of the parameters: those of the patch, or those that a change gives them.
//!
//! Sweeps and fits change parameters through this module, so a changed value passes the same checks as one in the
//! document.

use indexmap::IndexMap;

use super::scope::Quantity;
use crate::document::{Code, Diagnostic, suggestion};
use crate::patch::Patch;

/// The parameters of a patch with their values in SI units. `changes` are in the declared units.
///
/// If a parameter is changed several times, the last change counts. Reports changes of unknown parameters, and values
/// outside the range of a parameter. Such a parameter has no value.
pub(super) fn parameters(
    patch: &Patch,
    changes: &[(String, f64)],
    findings: &mut Vec<Diagnostic>,
) -> IndexMap<String, Quantity> {
    let known: Vec<&str> = patch.parameters.keys().map(String::as_str).collect();
    for (name, _) in changes.iter().filter(|(name, _)| !patch.parameters.contains_key(name)) {
        let message = format!("there is no parameter {name} to set");
        let hint = suggestion(name, &known);
        findings.push(Diagnostic::without_span(Code::UNKNOWN_NAME, message).maybe_hint(hint));
    }
    let quantities = patch.parameters.iter().map(|(name, parameter)| {
        let change = changes.iter().rev().find(|(changed, _)| changed == name).map(|(_, value)| *value);
        let value = change.unwrap_or(parameter.value);
        // A changed value is not in the document and so has no position.
        let span = change.is_none().then_some(parameter.value_span);
        let checked = parameter.in_si(name, value);
        let value = checked.map_err(|violation| findings.push(violation.diagnostic(span))).ok();
        (name.clone(), Quantity { unit: parameter.unit.clone(), value })
    });
    quantities.collect()
}
