//! Parameters at the values that the patch or a change gives them.

use indexmap::IndexMap;

use super::scope::Named;
use crate::document::{Code, Diagnostic, Span, behind, suggestion, told};
use crate::patch::{Parameter, Patch};

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
        let fine = in_range(name, value, parameter, place, findings);
        let value = fine.then(|| parameter.unit.to_si(value));
        (name.clone(), Named { unit: parameter.unit.clone(), value })
    });
    named.collect()
}

fn in_range(
    name: &str,
    value: f64,
    parameter: &Parameter,
    span: Option<Span>,
    findings: &mut Vec<Diagnostic>,
) -> bool {
    let unit = behind(parameter.unit.text());
    if !parameter.unit.to_si(value).is_finite() {
        let message = format!("{name} is set to {value}{unit}, which cannot be reckoned with");
        let hint = Some("every number of a patch must be finite".to_owned());
        findings.push(Diagnostic { code: Code::NotFinite, span, message, hint });
        return false;
    }
    let outside = parameter.range.filter(|(low, high)| value < *low || value > *high);
    let Some((low, high)) = outside else { return true };
    let [value, low, high] = [value, low, high].map(told);
    let message = format!("{name} = {value}{unit} is outside its range {low} ... {high}{unit}");
    let hint = "widen the range in the patch if the circuit can take it".to_owned();
    findings.push(Diagnostic { code: Code::OutsideRange, span, message, hint: Some(hint) });
    false
}
