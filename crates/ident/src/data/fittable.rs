//! The selection of the parameters of a patch that are fitted to data.
//!
//! A parameter can be fitted if it has a range with more than one value and if something reads it. A drive that a
//! column feeds does not count as a reader, because the data replace its formulas.

use std::collections::HashSet;

use crate::data::codes;
use crate::data::drive_timing::RECORD_START;
use patchcord_core::document::fields::Findings;
use patchcord_core::document::{Code, Diagnostic, Placed, suggestion};
use patchcord_core::patch::{Amount, Parameter, Patch};
use patchcord_expr::Formula;

/// Returns the parameters to fit: the requested ones, or all that can be fitted if `requested` is None. `is_fed` is
/// true for the drives that columns feed. Requested parameters that cannot be fitted are reported.
pub(crate) fn parameters_to_fit(
    patch: &Patch,
    is_fed: &dyn Fn(&str) -> bool,
    requested: Option<&[Placed<String>]>,
    findings: &mut Findings,
) -> Vec<String> {
    let names_read = names_read(patch, is_fed);
    let obstacle = |name: &str, parameter: &Parameter| obstacle(name, parameter, &names_read);
    let Some(requested) = requested else {
        let all = patch.parameters.iter().filter(|(name, parameter)| obstacle(name, parameter).is_none());
        return all.map(|(name, _)| name.clone()).collect();
    };
    let fittable = || {
        let all = patch.parameters.iter().filter(|(name, parameter)| obstacle(name, parameter).is_none());
        all.map(|(name, _)| name.as_str()).collect::<Vec<_>>()
    };
    let mut seen_names = HashSet::new();
    for name in requested {
        let finding = match patch.parameters.get(&name.value) {
            None => Some(unknown_parameter(name, patch, &fittable())),
            Some(parameter) => obstacle(&name.value, parameter)
                .map(|(message, hint)| Diagnostic::at(codes::NOT_FITTABLE, name.span, message).hint(hint)),
        };
        let duplicate = || {
            Diagnostic::at(Code::DUPLICATE_NAME, name.span, format!("\"fit\" lists {} twice", name.value))
                .hint("name it once")
        };
        findings.extend(finding.or_else(|| (!seen_names.insert(&name.value)).then(duplicate)));
    }
    requested.iter().map(|name| name.value.clone()).collect()
}

/// Reports a requested parameter that the patch does not have.
fn unknown_parameter(name: &Placed<String>, patch: &Patch, fittable: &[&str]) -> Diagnostic {
    let message = format!("the patch {} has no parameter {}", patch.file(), name.value);
    let no_candidates = "no parameter of the patch has a range".to_owned();
    Diagnostic::at(Code::UNKNOWN_NAME, name.span, message)
        .hint(suggestion(&name.value, fittable).unwrap_or(no_candidates))
}

/// Returns why a parameter cannot be fitted, and what to do. None if it can be fitted. `names_read` are the names in
/// the formulas of the patch.
fn obstacle(name: &str, parameter: &Parameter, names_read: &HashSet<&str>) -> Option<(String, &'static str)> {
    match parameter.range {
        _ if name == RECORD_START => {
            Some((format!("{name} is not fitted: every record specifies it"), "remove it from \"fit\""))
        }
        None => {
            let message = format!("the parameter {name} has no range to search");
            Some((message, "give it a range in the patch: \"range\": [least, largest]"))
        }
        Some((low, high)) if low == high => {
            let message = format!("the range of the parameter {name} contains only one value");
            Some((message, "widen the range in the patch"))
        }
        _ if !names_read.contains(name) => {
            let message = format!("nothing reads the parameter {name} apart from drives that columns feed");
            Some((message, "remove it from \"fit\""))
        }
        _ => None,
    }
}

/// Returns the names in all formulas of the patch except those of the fed drives.
fn names_read<'p>(patch: &'p Patch, is_fed: &dyn Fn(&str) -> bool) -> HashSet<&'p str> {
    let drives = patch.drives.iter().filter(|(name, _)| !is_fed(name)).map(|(_, drive)| drive);
    let settings = drives.chain(patch.elements.values()).flat_map(|entry| entry.settings.iter().flatten());
    let of_entries = settings.filter_map(|setting| match &setting.value {
        Amount::Formula(formula) => Some(formula),
        _ => None,
    });
    let of_scales = patch.scales.values().filter_map(|scale| scale.per_volt.as_ref());
    let of_instances = patch.instances.values().flat_map(|instance| instance.settings.values());
    let formulas = of_entries
        .chain(of_scales.map(|formula| &formula.value))
        .chain(of_instances.map(|setting| &setting.value.value));
    formulas.flat_map(Formula::names).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_start_of_a_record_is_not_fitted() {
        let file = "tests/clock.json";
        let text = std::fs::read_to_string(file).unwrap();
        let patch = Patch::parse(file, &text).unwrap_or_else(|report| panic!("{report}"));
        let mut findings = Findings::new();
        let fit = parameters_to_fit(&patch, &|name| name == "F", None, &mut findings);
        assert_eq!((fit, findings.len()), (vec!["M".to_owned(), "f".to_owned()], 0));
        let requested = [Placed { value: RECORD_START.to_owned(), span: patch.parameters["f"].span }];
        parameters_to_fit(&patch, &|_| false, Some(&requested), &mut findings);
        assert_eq!(findings[0].message, "record_start is not fitted: every record specifies it");
    }
}
