//! The names of elements, outputs and cords as the panel uses them.
//!
//! A document can name the first output of a macro instance "L1" or "L1.out". The panel always says "L1.out", so that
//! one output has one name.

use std::collections::HashSet;

use patchcord_core::elements::{Jacks, Kind, REFERENCES};
use patchcord_core::machines::{self, DEFAULT_MACHINE, MachineModel};
use patchcord_core::patch::Patch;

/// The gains that are shown if the machine has every gain.
const USUAL_GAINS: &[f64] = &[1.0, 10.0];

/// An output of the patch.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Output {
    /// Its name at the panel: "A1", "+100", "L1.out".
    pub name: String,
    /// The reference, drive or element whose voltage it has. For "L1.out" it is inside the instance: "L1.A1".
    pub element: String,
    /// Whether the panel shows only a signal of it, because it is inside an instance. No cord can begin there.
    pub is_inside: bool,
}

/// The machine of the patch. An unknown machine counts as the one without limits, as in the checker.
pub(crate) fn machine(patch: &Patch) -> &'static MachineModel {
    let name = patch.machine.as_ref();
    name.and_then(|name| machines::find(&name.value)).unwrap_or(DEFAULT_MACHINE)
}

/// The names in the section "elements", in the order of the document: elements and instances of macros.
pub(crate) fn section_names(patch: &Patch) -> Vec<&str> {
    let inside: HashSet<&str> =
        patch.instances.values().flat_map(|instance| &instance.members).map(String::as_str).collect();
    let elements = patch.elements.iter().filter(|(name, _)| !inside.contains(name.as_str()));
    let elements = elements.map(|(name, entry)| (entry.span.start, name.as_str()));
    let instances = patch.instances.iter().filter(|(_, instance)| instance.parent.is_none());
    let instances = instances.map(|(name, instance)| (instance.span.start, name.as_str()));
    let mut names: Vec<_> = elements.chain(instances).collect();
    names.sort_by_key(|(start, _)| *start);
    names.into_iter().map(|(_, name)| name).collect()
}

/// The names of elements, instances of macros and drives.
pub(crate) fn entry_names(patch: &Patch) -> Vec<&str> {
    section_names(patch).into_iter().chain(patch.drives.keys().map(String::as_str)).collect()
}

/// Whether the section "elements" has an element or an instance of this name.
pub(crate) fn is_in_section(patch: &Patch, name: &str) -> bool {
    if let Some(instance) = patch.instances.get(name) {
        return instance.parent.is_none();
    }
    let is_member =
        || patch.instances.values().any(|instance| instance.members.iter().any(|one| one == name));
    patch.elements.contains_key(name) && !is_member()
}

/// All outputs: references, drives, elements and instances, and at the end the elements inside instances at which a
/// signal is read.
pub(crate) fn outputs(patch: &Patch) -> Vec<Output> {
    let alone = |name: &str, is_inside| Output { name: name.to_owned(), element: name.to_owned(), is_inside };
    let sources = REFERENCES.iter().map(|(name, _)| *name).chain(patch.drives.keys().map(String::as_str));
    let mut outputs: Vec<_> = sources.map(|name| alone(name, false)).collect();
    for name in section_names(patch) {
        match patch.instances.get(name) {
            Some(instance) => outputs.extend(instance.outputs.iter().map(|(port, element)| Output {
                name: format!("{name}.{port}"),
                element: element.clone(),
                is_inside: false,
            })),
            None => outputs.push(alone(name, false)),
        }
    }
    let mut listed: HashSet<String> = outputs.iter().map(|output| output.element.clone()).collect();
    for signal in patch.signals.values() {
        let element = &signal.element.value;
        if patch.elements.contains_key(element) && listed.insert(element.clone()) {
            outputs.push(alone(element, true));
        }
    }
    outputs
}

/// The name at the panel of an output that a document names: "L1.out" for the instance "L1".
pub(crate) fn panel_name(patch: &Patch, name: &str) -> String {
    match patch.instances.get(name).and_then(|instance| instance.outputs.keys().next()) {
        Some(port) => format!("{name}.{port}"),
        None => name.to_owned(),
    }
}

/// The cords into an element or an instance: the jack, and the output by its name at the panel.
pub(crate) fn cords_into<'p>(patch: &'p Patch, element: &str) -> Vec<(&'p str, String)> {
    patch.written_cords(element).map(|(jack, from)| (jack, panel_name(patch, from))).collect()
}

/// The gains for which a summing input of this kind has a jack at the panel, also without a cord; ascending.
pub(crate) fn shown_gains(kind: &Kind, machine: &MachineModel) -> &'static [f64] {
    match kind.available_gains(machine) {
        [] => USUAL_GAINS,
        available => available,
    }
}

/// How many cords an input takes; `None` if any number.
pub(crate) fn capacity(jacks: Jacks) -> Option<usize> {
    match jacks {
        Jacks::One => Some(1),
        Jacks::Exactly(count) => Some(count),
        Jacks::Any | Jacks::Gains => None,
    }
}
