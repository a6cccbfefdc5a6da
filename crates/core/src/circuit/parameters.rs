//! Parameters at the values that the patch or a change gives them.

use indexmap::IndexMap;

use super::scope::Named;
use crate::document::{Code, Diagnostic, suggestion};
use crate::patch::Patch;

/// The parameters of a patch, some of them changed, in the units that they are declared in.
pub(super) fn parameters(
    patch: &Patch,
    changes: &[(String, f64)],
    findings: &mut Vec<Diagnostic>,
) -> IndexMap<String, Named> {
    let known: Vec<&str> = patch.parameters.keys().map(String::as_str).collect();
    for (name, _) in changes.iter().filter(|(name, _)| !patch.parameters.contains_key(name)) {
        let message = format!("there is no parameter {name} to set");
        findings.push(Diagnostic::nowhere(Code::UnknownName, message).maybe_hint(suggestion(name, &known)));
    }
    let named = patch.parameters.iter().map(|(name, parameter)| {
        let change = changes.iter().rev().find(|(changed, _)| changed == name).map(|(_, value)| *value);
        let value = change.unwrap_or(parameter.value);
        let place = change.is_none().then_some(parameter.value_span);
        let checked = parameter.in_si(name, value);
        let value = checked.map_err(|violation| findings.push(violation.diagnostic(place))).ok();
        (name.clone(), Named { unit: parameter.unit.clone(), value })
    });
    named.collect()
}
