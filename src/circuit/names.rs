//! Names: what a cord may say, and that no name stands for two things.

use std::collections::HashMap;

use super::scope::TIME_SCALE;
use crate::elements::REFERENCES;
use crate::patch::{Callee, Code, Diagnostic, Patch, Placed, Span, suggestion};

/// Columns of the recorded table that are no signals.
const COLUMNS: [&str; 3] = ["t", "run", "phase"];

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

/// Names in the order of the alphabet.
pub(super) fn sorted<'k, V>(places: &HashMap<&'k str, V>) -> Vec<&'k str> {
    let mut names: Vec<_> = places.keys().copied().collect();
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
        quantity_name(name, span, noun, findings);
    }
    let drives = patch.drives.iter().map(|(name, drive)| (name, drive.span, "drive"));
    let elements = patch.elements.iter().map(|(name, element)| (name, element.span, "element"));
    let signals = patch.signals.iter().map(|(name, signal)| (name, signal.span, "signal"));
    let outlets: Vec<_> = drives.chain(elements).chain(signals).collect();
    twice(&outlets, findings);
    for (name, span, noun) in outlets {
        outlet_name(name, span, noun, findings);
    }
}

fn twice(named: &[(&String, Span, &str)], findings: &mut Vec<Diagnostic>) {
    let mut seen: HashMap<&str, &str> = HashMap::new();
    for (name, span, noun) in named {
        if let Some(first) = seen.insert(name, noun) {
            let message = format!("the {noun} {name} has the name of {}", with_article(first));
            findings.push(Diagnostic::at(Code::DuplicateName, *span, message).hint("rename one of them"));
        }
    }
}

fn with_article(noun: &str) -> String {
    let article = if noun.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
    format!("{article} {noun}")
}

fn quantity_name(name: &str, span: Span, noun: &str, findings: &mut Vec<Diagnostic>) {
    let starts = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    let plain = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let reserved = name == "pi" || name == TIME_SCALE || Callee::named(name).is_some();
    if starts && plain && !reserved {
        return;
    }
    let message = format!("\"{name}\" cannot name {}", with_article(noun));
    let hint = if reserved {
        "the name has a meaning of its own in formulas"
    } else {
        "formulas read letters, digits and _, a letter first"
    };
    findings.push(Diagnostic::at(Code::BadName, span, message).hint(hint));
}

fn outlet_name(name: &str, span: Span, noun: &str, findings: &mut Vec<Diagnostic>) {
    let plain = name.chars().all(|c| c.is_alphanumeric() || "_-.".contains(c));
    let starts = name.starts_with(char::is_alphabetic);
    let reserved = COLUMNS.contains(&name) || REFERENCES.iter().any(|(reference, _)| *reference == name);
    if starts && plain && !reserved {
        return;
    }
    let message = format!("\"{name}\" cannot name {}", with_article(noun));
    let hint = if reserved {
        "the machine uses this name itself"
    } else {
        "use letters, digits, _ - . and a letter first"
    };
    findings.push(Diagnostic::at(Code::BadName, span, message).hint(hint));
}
