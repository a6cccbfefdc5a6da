//! Removes an element, an instance of a macro or a drive, with everything that names its outputs.
//!
//! Its outputs are named by cords, signals and phases, and its signals by the record, the pictures, the formulas of
//! phases and the equations. A cord inside a macro can come from a drive.

use std::collections::HashSet;

use super::equations::{NAME_SECTIONS, remove_equations};
use super::{entries_mut, name_set, ports_of_macros, retain, retain_jacks, retain_names, section_mut, text};
use crate::document::derivative_of;
use crate::document::tree::{Content, KeyValue, Node};
use crate::elements::{Family, find};
use crate::patch::document::instance_prefixes;
use patchcord_expr::Formula;

/// Removes an entry of the section "elements" or "drives", and everything that names its outputs.
///
/// The run stays as long as it was: a phase that waits for a removed relay lasts for its whole time, as it does if the
/// relay never switches.
pub(super) fn remove_entry(root: &mut Node, section: &str, name: &str) {
    let has_ports = section == "elements" && is_instance(root, name);
    if let Some(entries) = section_mut(root, section) {
        entries.retain(|entry| entry.key != name);
    }
    let outputs = RemovedOutputs { name, has_ports, others: name_set(root, &["elements", "drives"]) };
    remove_cords(root, &outputs, section == "drives");
    let signals = remove_signals(root, &outputs);
    let kept_signals = name_set(root, &["signals"]);
    remove_names(root, &RemovedNames { outputs, signals, kept_signals }, section == "drives");
}

/// Whether an element is an instance of a macro. An element of an unknown kind may be one.
fn is_instance(root: &Node, name: &str) -> bool {
    let entry = root.child("elements").and_then(|section| section.child(name));
    let kind = entry.and_then(|entry| text(entry, "kind"));
    kind.is_none_or(|kind| find(Family::Computing, kind).is_none())
}

/// The outputs of an element, an instance or a drive that is removed.
struct RemovedOutputs<'n> {
    /// Its name.
    name: &'n str,
    /// Whether the names of ports and inner elements, such as "L1.out", also mean it.
    has_ports: bool,
    /// The names of the other elements, instances and drives.
    others: HashSet<String>,
}

impl RemovedOutputs<'_> {
    /// Whether a name means one of the outputs. "L1.M.out" belongs to "L1", unless there also is an element "L1.M".
    fn contains(&self, output: &str) -> bool {
        let is_port = || {
            let rest = output.strip_prefix(self.name).filter(|_| self.has_ports);
            let is_longer = |prefix: &&str| prefix.len() > self.name.len();
            let mut owners = instance_prefixes(output).chain([output]).filter(is_longer);
            rest.is_some_and(|rest| rest.starts_with('.')) && !owners.any(|owner| self.others.contains(owner))
        };
        output == self.name || is_port()
    }
}

/// The names that mean nothing after the removal.
struct RemovedNames<'n> {
    /// The outputs that are removed.
    outputs: RemovedOutputs<'n>,
    /// The signals at the outputs.
    signals: HashSet<String>,
    /// The other signals of the patch.
    kept_signals: HashSet<String>,
}

impl RemovedNames<'_> {
    /// Whether a name in the record or in a picture means a removed signal or output. Signals come first.
    fn contains(&self, name: &str) -> bool {
        let is_output = || !self.kept_signals.contains(name) && self.outputs.contains(name);
        self.signals.contains(name) || is_output()
    }

    /// Whether a name in a picture is that of a removed signal or of its derivative.
    fn is_drawn(&self, name: &str) -> bool {
        self.contains(derivative_of(name).map_or(name, |(signal, _)| signal))
    }
}

/// Removes the cords from removed outputs. Only the outputs of drives can be named inside macros.
fn remove_cords(root: &mut Node, outputs: &RemovedOutputs<'_>, is_drive: bool) {
    let ports = ports_of_macros(root);
    let mut keeps = |from: &str| !outputs.contains(from);
    for entry in entries_mut(root, "elements") {
        retain_jacks(&mut entry.value, &ports, &mut keeps);
    }
    if !is_drive {
        return;
    }
    for definition in entries_mut(root, "macros") {
        if name_set(&definition.value, &["inputs", "elements"]).contains(outputs.name) {
            continue;
        }
        for entry in entries_mut(&mut definition.value, "elements") {
            retain_jacks(&mut entry.value, &ports, &mut keeps);
        }
    }
}

/// Removes the signals at removed outputs. Returns their names.
fn remove_signals(root: &mut Node, outputs: &RemovedOutputs<'_>) -> HashSet<String> {
    let mut removed = HashSet::new();
    let is_kept = |signal: &KeyValue| {
        let is_removed = text(&signal.value, "at").is_some_and(|at| outputs.contains(at));
        if is_removed {
            removed.insert(signal.key.clone());
        }
        !is_removed
    };
    if let Some(signals) = section_mut(root, "signals") {
        signals.retain(is_kept);
    }
    removed
}

/// Removes the names from the record, the pictures, the equations and the phases. A list that becomes empty is removed.
fn remove_names(root: &mut Node, removed: &RemovedNames<'_>, is_drive: bool) {
    let other_names = name_set(root, &NAME_SECTIONS);
    let drive = is_drive.then(|| removed.outputs.name.to_owned());
    let quantities: HashSet<String> = removed.signals.iter().cloned().chain(drive).collect();
    let Content::Object(sections) = &mut root.value else { return };
    sections.retain_mut(|section| match section.key.as_str() {
        "record" => retain_names(&mut section.value, &mut |name| !removed.contains(name)),
        "pictures" => retain_items(&mut section.value, |picture| keeps_picture(picture, removed)),
        "equations" => remove_equations(&mut section.value, quantities.clone(), &other_names),
        "run" => {
            if let Content::Object(keys) = &mut section.value.value {
                keys.retain_mut(|key| key.key != "phases" || retain_phases(&mut key.value, removed));
            }
            true
        }
        _ => true,
    });
}

/// Keeps some of the items of a list. Returns whether the list stays.
fn retain_items(list: &mut Node, keeps: impl FnMut(&mut Node) -> bool) -> bool {
    match &mut list.value {
        Content::List(items) => retain(items, keeps),
        _ => true,
    }
}

/// Removes signals from a picture. Returns whether the picture stays: it has signals along both axes.
fn keeps_picture(picture: &mut Node, removed: &RemovedNames<'_>) -> bool {
    let Content::Object(keys) = &mut picture.value else { return true };
    let mut axes = keys.iter_mut().filter(|key| ["x", "y"].contains(&key.key.as_str()));
    axes.all(|axis| retain_names(&mut axis.value, &mut |name| !removed.is_drawn(name)))
}

/// Removes names from a list of phases. Returns whether the list stays.
fn retain_phases(phases: &mut Node, removed: &RemovedNames<'_>) -> bool {
    retain_items(phases, |phase| keeps_phase(phase, removed))
}

/// Removes names from a phase. Returns whether the phase stays. A phase without an action is removed: it sets nothing,
/// or it repeats nothing.
fn keeps_phase(phase: &mut Node, removed: &RemovedNames<'_>) -> bool {
    let Content::Object(keys) = &mut phase.value else { return true };
    keys.retain(|key| key.key != "until" || !waits_for(&key.value, &removed.outputs));
    keys.iter_mut().all(|key| match (key.key.as_str(), &mut key.value) {
        ("set", Node { value: Content::Object(changes), .. }) => {
            retain(changes, |change| !names_signal(&change.value, &removed.signals))
        }
        ("phases", phases) => retain_phases(phases, removed),
        _ => true,
    })
}

/// Whether a phase that ends by this condition waits for a removed output.
fn waits_for(condition: &Node, outputs: &RemovedOutputs<'_>) -> bool {
    match &condition.value {
        Content::Text(relay) => outputs.contains(relay),
        _ => text(condition, "relay").is_some_and(|relay| outputs.contains(relay)),
    }
}

/// Whether the formula for the new value of a parameter names a removed signal.
fn names_signal(formula: &Node, signals: &HashSet<String>) -> bool {
    let Content::Text(text) = &formula.value else { return false };
    Formula::parse(text).is_ok_and(|formula| formula.names().into_iter().any(|name| signals.contains(name)))
}
