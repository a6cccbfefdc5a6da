//! Names: what a cord may say, and that no name stands for two things.

use std::collections::{HashMap, HashSet};

use crate::document::{Code, Diagnostic, Placed, Span, suggestion};
use crate::patch::{Patch, outlet_name, quantity_name, same_name};

/// Where this much is wrong, names are no longer held against all that are known to guess what was meant.
const MOST_GUESSED: usize = 50;

/// What a name was found to stand for. One that is not known is reported, unless it may be one that could not be
/// read, which has been reported itself.
pub(super) fn found_or_told<'k, T>(
    patch: &Patch,
    name: &Placed<String>,
    found: Option<T>,
    message: impl FnOnce() -> String,
    known: impl FnOnce() -> Vec<&'k str>,
    findings: &mut Vec<Diagnostic>,
) -> Option<T> {
    if found.is_none() && !patch.lost().may_hold(&name.value) {
        let guess = findings.len() < MOST_GUESSED;
        let hint = guess.then(|| suggestion(&name.value, &known())).flatten();
        findings.push(Diagnostic::at(Code::UnknownName, name.span, message()).maybe_hint(hint));
    }
    found
}

/// Names of outlets in the order of the alphabet: those of the graph, and those of the ports of macros.
pub(super) fn outlets<'k, V>(patch: &'k Patch, places: &HashMap<&'k str, V>) -> Vec<&'k str> {
    let mut names: Vec<_> = places.keys().copied().chain(patch.ports.keys().map(String::as_str)).collect();
    names.sort_unstable();
    names
}

/// Reports names that could not be used, and names used twice.
pub(super) fn check(patch: &Patch, findings: &mut Vec<Diagnostic>) {
    let parameters = patch.parameters.iter().map(|(name, parameter)| (name, parameter.span, "parameter"));
    let scales = patch.scales.iter().map(|(name, scale)| (name, scale.span, "scale"));
    let quantities: Vec<_> = parameters.chain(scales).collect();
    twice(&quantities, findings);
    for (name, span, noun) in quantities {
        findings.extend(quantity_name(name, span, noun));
    }
    let drives = patch.drives.iter().map(|(name, drive)| (name, drive.span, "drive"));
    let elements = patch.elements.iter().map(|(name, element)| (name, element.span, "element"));
    let signals = patch.signals.iter().map(|(name, signal)| (name, signal.span, "signal"));
    let noun = |name| if patch.instances.contains_key(name) { "element" } else { "output" };
    let ports = patch.ports.iter().map(|(name, port)| (name, port.span, noun(name)));
    let outlets: Vec<_> = drives.chain(elements).chain(ports).chain(signals).collect();
    twice(&outlets, findings);
    // Names inside macros and of their instances have been looked at when these were written out.
    let inside: HashSet<&String> =
        patch.instances.values().flat_map(|instance| &instance.members).chain(patch.ports.keys()).collect();
    for (name, span, noun) in outlets.into_iter().filter(|(name, ..)| !inside.contains(name)) {
        findings.extend(outlet_name(name, span, noun));
    }
}

fn twice(named: &[(&String, Span, &str)], findings: &mut Vec<Diagnostic>) {
    let mut seen: HashMap<&str, &str> = HashMap::new();
    for (name, span, noun) in named {
        if let Some(first) = seen.insert(name, noun) {
            findings.push(same_name(name, *span, noun, first));
        }
    }
}
