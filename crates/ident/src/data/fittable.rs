//! Which parameters of a patch can be fitted to data.

use std::collections::HashSet;

use crate::data::drive_timing::RECORD_START;
use patchcord_core::document::fields::Findings;
use patchcord_core::document::{Code, Diagnostic, Placed, suggestion};
use patchcord_core::patch::{Amount, Parameter, Patch};
use patchcord_expr::Formula;

/// The parameters to fit: those asked for, or else all that can be. `fed` says which drives data feed: what only these read is
/// of no account.
pub(crate) fn to_fit(
    patch: &Patch,
    fed: &dyn Fn(&str) -> bool,
    asked: Option<&[Placed<String>]>,
    findings: &mut Findings,
) -> Vec<String> {
    let read = names_read(patch, fed);
    let why_not = |name: &str, parameter: &Parameter| why_not(name, parameter, &read);
    let Some(asked) = asked else {
        let all = patch.parameters.iter().filter(|(name, parameter)| why_not(name, parameter).is_none());
        return all.map(|(name, _)| name.clone()).collect();
    };
    let fittable = || {
        let all = patch.parameters.iter().filter(|(name, parameter)| why_not(name, parameter).is_none());
        all.map(|(name, _)| name.as_str()).collect::<Vec<_>>()
    };
    let mut seen = HashSet::new();
    for name in asked {
        let finding = match patch.parameters.get(&name.value) {
            None => Some(unknown(name, patch, &fittable())),
            Some(parameter) => why_not(&name.value, parameter)
                .map(|(message, hint)| Diagnostic::at(Code::NotFittable, name.span, message).hint(hint)),
        };
        let twice = || {
            Diagnostic::at(Code::DuplicateName, name.span, format!("{} is to be fitted twice", name.value))
                .hint("name it once")
        };
        findings.extend(finding.or_else(|| (!seen.insert(&name.value)).then(twice)));
    }
    asked.iter().map(|name| name.value.clone()).collect()
}

fn unknown(name: &Placed<String>, patch: &Patch, fittable: &[&str]) -> Diagnostic {
    let message = format!("the patch {} has no parameter {}", patch.file(), name.value);
    let none = "no parameter of the patch has a range".to_owned();
    Diagnostic::at(Code::UnknownName, name.span, message)
        .hint(suggestion(&name.value, fittable).unwrap_or(none))
}

/// Why a parameter cannot be fitted, and what to do about it.
fn why_not(name: &str, parameter: &Parameter, read: &HashSet<&str>) -> Option<(String, &'static str)> {
    match parameter.range {
        _ if name == RECORD_START => {
            Some((format!("{name} is when a record begins, which every record tells"), "leave it out"))
        }
        None => {
            let message = format!("the parameter {name} has no range within which to look for it");
            Some((message, "give it one in the patch: \"range\": [least, largest]"))
        }
        Some((low, high)) if low == high => {
            Some((format!("the range of the parameter {name} holds one value"), "widen it in the patch"))
        }
        _ if !read.contains(name) => {
            let message = format!("nothing reads the parameter {name}, but for drives that the data feed");
            Some((message, "leave it out: it changes nothing"))
        }
        _ => None,
    }
}

/// The names in all formulas of the patch but those of drives that data feed.
fn names_read<'p>(patch: &'p Patch, fed: &dyn Fn(&str) -> bool) -> HashSet<&'p str> {
    let drives = patch.drives.iter().filter(|(name, _)| !fed(name)).map(|(_, drive)| drive);
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
    fn when_a_record_begins_is_not_fitted() {
        let file = "tests/clock.json";
        let text = std::fs::read_to_string(file).unwrap();
        let patch = Patch::parse(file, &text).unwrap_or_else(|report| panic!("{report}"));
        let mut findings = Findings::new();
        let fit = to_fit(&patch, &|name| name == "F", None, &mut findings);
        assert_eq!((fit, findings.len()), (vec!["M".to_owned(), "f".to_owned()], 0));
        let asked = [Placed { value: RECORD_START.to_owned(), span: patch.parameters["f"].span }];
        to_fit(&patch, &|_| false, Some(&asked), &mut findings);
        assert_eq!(findings[0].message, "record_start is when a record begins, which every record tells");
    }
}
