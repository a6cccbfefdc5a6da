//! Checks that names are valid and unique, and resolves the names that cords and signals use.

use std::collections::{HashMap, HashSet};

use crate::document::{Code, Diagnostic, MAX_SUGGESTIONS, Placed, Span, suggestion};
use crate::patch::{Patch, check_output_name, check_quantity_name, duplicate_name};

/// Passes on what a name refers to, and reports the name if it refers to nothing.
///
/// An unknown name is not reported if the part of the document that may define it could not be read: that fault was
/// reported itself. `message` and `known` are only called for a report.
pub(super) fn found_or_report<'k, T>(
    patch: &Patch,
    name: &Placed<String>,
    found: Option<T>,
    message: impl FnOnce() -> String,
    known: impl FnOnce() -> Vec<&'k str>,
    findings: &mut Vec<Diagnostic>,
) -> Option<T> {
    if found.is_none() && !patch.unread_names().can_include(&name.value) {
        let has_suggestion = findings.len() < MAX_SUGGESTIONS;
        let hint = has_suggestion.then(|| suggestion(&name.value, &known())).flatten();
        findings.push(Diagnostic::at(Code::UNKNOWN_NAME, name.span, message()).maybe_hint(hint));
    }
    found
}

/// Names of all outputs in alphabetical order: those in `indices`, and the outputs of macros' instances.
pub(super) fn output_names<'k, V>(patch: &'k Patch, indices: &HashMap<&'k str, V>) -> Vec<&'k str> {
    let mut names: Vec<_> =
        indices.keys().copied().chain(patch.instance_outputs.keys().map(String::as_str)).collect();
    names.sort_unstable();
    names
}

/// Reports invalid names and names that are used twice.
///
/// Parameters and scales share one set of names, which formulas use. Drives, elements, outputs of instances and
/// signals share the other set.
///
/// Rules: see [`check_quantity_name`] and [`check_output_name`].
pub(super) fn check(patch: &Patch, findings: &mut Vec<Diagnostic>) {
    let parameters = patch.parameters.iter().map(|(name, parameter)| (name, parameter.span, "parameter"));
    let scales = patch.scales.iter().map(|(name, scale)| (name, scale.span, "scale"));
    let quantities: Vec<_> = parameters.chain(scales).collect();
    report_duplicates(&quantities, findings);
    for (name, span, noun) in quantities {
        findings.extend(check_quantity_name(name, span, noun));
    }
    let drives = patch.drives.iter().map(|(name, drive)| (name, drive.span, "drive"));
    let elements = patch.elements.iter().map(|(name, element)| (name, element.span, "element"));
    let signals = patch.signals.iter().map(|(name, signal)| (name, signal.span, "signal"));
    let noun = |name| if patch.instances.contains_key(name) { "element" } else { "output" };
    let instance_outputs =
        patch.instance_outputs.iter().map(|(name, output)| (name, output.span, noun(name)));
    let outputs: Vec<_> = drives.chain(elements).chain(instance_outputs).chain(signals).collect();
    report_duplicates(&outputs, findings);
    // The names inside macros and instances were checked when the macros were expanded.
    let members = patch.instances.values().flat_map(|instance| &instance.members);
    let from_macros: HashSet<&String> = members.chain(patch.instance_outputs.keys()).collect();
    for (name, span, noun) in outputs.into_iter().filter(|(name, ..)| !from_macros.contains(name)) {
        findings.extend(check_output_name(name, span, noun));
    }
}

/// Reports every name that occurs twice. Each entry is a name, its position, and what it names.
fn report_duplicates(named: &[(&String, Span, &str)], findings: &mut Vec<Diagnostic>) {
    let mut first_nouns: HashMap<&str, &str> = HashMap::new();
    for (name, span, noun) in named {
        if let Some(first) = first_nouns.insert(name, noun) {
            findings.push(duplicate_name(name, *span, noun, first));
        }
    }
}
