//! Parts: what the elements take against what the machine has.

use std::collections::HashMap;

use super::macros;
use crate::document::{Code, Diagnostic, Placed};
use crate::elements::Takes;
use crate::machines::{Machine, Part};
use crate::patch::{Entry, Patch};

/// The parts that the patch takes; reports what the machine does not have.
pub(super) fn check(patch: &Patch, machine: &Machine, findings: &mut Vec<Diagnostic>) -> Vec<(Part, usize)> {
    listed_parts(patch, findings);
    let used: Vec<_> = Part::ALL.iter().map(|part| (*part, total(patch, *part))).collect();
    for (part, count) in &used {
        if let Some(owned) = machine.count(*part).filter(|owned| owned < count) {
            findings.push(exceeded(patch, machine, *part, *count, owned));
        }
    }
    used.into_iter().filter(|(_, count)| *count > 0).collect()
}

fn total(patch: &Patch, part: Part) -> usize {
    patch.elements.values().map(|entry| taken(entry, part)).sum()
}

/// How many of a part an element takes.
pub(super) fn taken(entry: &Entry, part: Part) -> usize {
    let rows = entry.kind.parts.iter().filter(|takes| takes.part == part && applies(entry, takes));
    rows.map(|takes| takes.count).sum()
}

fn applies(entry: &Entry, takes: &Takes) -> bool {
    let named = |name: &str| {
        name == takes.with || name.strip_prefix(takes.with).is_some_and(|rest| rest.starts_with('.'))
    };
    let set = entry
        .kind
        .settings
        .iter()
        .zip(&entry.settings)
        .any(|(row, value)| value.is_some() && named(row.name));
    let plugged = entry.plugs.iter().any(|plug| {
        entry
            .kind
            .input(&plug.jack.value)
            .is_some_and(|(index, _)| entry.kind.inputs[index].name == takes.with)
    });
    takes.with.is_empty() || set || plugged
}

/// The element that takes one too many is where the reader has to look.
fn exceeded(patch: &Patch, machine: &Machine, part: Part, count: usize, owned: usize) -> Diagnostic {
    let mut left = owned;
    let guilty = patch.elements.iter().find(|(_, entry)| match left.checked_sub(taken(entry, part)) {
        Some(rest) => {
            left = rest;
            false
        }
        None => true,
    });
    let owned = if owned == 0 { "none".to_owned() } else { owned.to_string() };
    let message = format!("the patch takes {}, and the {} has {owned}", part.counted(count), machine.name);
    let hint = Some("do with fewer, or patch it on the machine \"unlimited\"".to_owned());
    let span = guilty.map(|(name, entry)| macros::place(patch, name).unwrap_or(entry.span));
    Diagnostic { code: Code::Inventory, span, message, hint }
}

/// Holds the parts that elements list against what they are made of and against each other.
fn listed_parts(patch: &Patch, findings: &mut Vec<Diagnostic>) {
    let mut owners: HashMap<(&str, &str), &str> = HashMap::new();
    for (name, entry) in &patch.elements {
        for (key, names) in &entry.uses {
            number_listed(name, entry, key, names, findings);
            for part in names {
                if let Some(owner) = owners.insert((&key.value, &part.value), name) {
                    let message = if owner == name {
                        format!("{name} lists {} twice", part.value)
                    } else {
                        format!("{} is used by {owner} and by {name}", part.value)
                    };
                    let hint = "every part is on the machine once";
                    findings.push(Diagnostic::at(Code::PartTwice, part.span, message).hint(hint));
                }
            }
        }
    }
}

fn number_listed(
    name: &str,
    entry: &Entry,
    key: &Placed<String>,
    names: &[Placed<String>],
    findings: &mut Vec<Diagnostic>,
) {
    let Some(part) = Part::ALL.iter().find(|part| part.key() == key.value) else { return };
    let wanted = taken(entry, *part);
    if names.len() != wanted {
        let message = format!("{name} is made of {} and lists {}", part.counted(wanted), names.len());
        let hint = "list as many as it is made of, or leave the list out";
        findings.push(Diagnostic::at(Code::PartCount, key.span, message).hint(hint));
    }
}
