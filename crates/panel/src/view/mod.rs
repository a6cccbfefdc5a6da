//! The events that show a document: the patch with all its parts, the kinds and machines, and the equations.

mod equations;
mod jacks;
mod probes;
mod quantities;
mod settings;
mod static_check;

use std::collections::HashMap;

use patchcord_core::circuit::{Circuit, Quantities, part_count};
use patchcord_core::document::Report;
use patchcord_core::elements::{Family, Kind, OutputStage, REGISTRY};
use patchcord_core::machines::{self, DEFAULT_MACHINE, MachineModel, Part};
use patchcord_core::patch::{ElementEntry, Instance, Patch};
use patchcord_draw::schematic::{SettingValue, settings_of_element};

use crate::command::PROTOCOL_VERSION;
use crate::document::{Document, prefix};
use crate::event::{
    ElementView, Event, KindView, LooseView, MachineView, ParameterView, PartView, PatchView,
};
use crate::wiring;
pub use equations::equations;
pub use probes::{usual_meter, usual_scopes};
use settings::SettingViewer;
pub use static_check::static_check_event;

/// The first event of a session.
pub fn hello() -> Event {
    Event::Hello {
        protocol: PROTOCOL_VERSION,
        kinds: REGISTRY.iter().map(|kind| kind_view(kind)).collect(),
        machines: machines::ALL.iter().map(|machine| machine_view(machine)).collect(),
    }
}

/// A kind of element. Parts that only some settings or inputs need are not listed.
fn kind_view(kind: &Kind) -> KindView {
    let always = kind.parts.iter().filter(|row| row.with.is_empty());
    KindView {
        name: kind.name.to_owned(),
        summary: kind.summary.to_owned(),
        law: kind.law.to_owned(),
        parts: always.map(|row| row.part.key().to_owned()).collect(),
        prefix: prefix(kind.name).to_owned(),
    }
}

/// A machine.
fn machine_view(machine: &MachineModel) -> MachineView {
    let parts = |inventory: &[(Part, usize)]| {
        inventory.iter().map(|(part, count)| (part.key().to_owned(), *count)).collect()
    };
    MachineView {
        name: machine.name.to_owned(),
        title: machine.title.to_owned(),
        parts: machine.inventory.map(parts),
        summer_gains: machine.summer_gains.to_vec(),
        integrator_gains: machine.integrator_gains.to_vec(),
    }
}

/// The patch as the page shows it. The report is about the patch, and `runs` is whether the machine can run it. With
/// faults, only the settings that depend on one have no value.
pub fn patch_view(document: &Document, report: &Report, runs: bool) -> PatchView {
    let patch = document.patch();
    let machine = patch.machine.as_ref().map_or(DEFAULT_MACHINE.name, |machine| &machine.value);
    let loose = document.loose().iter();
    let run = &patch.run;
    let quantities = Quantities::of(patch);
    PatchView {
        revision: document.revision(),
        file: patch.file().to_owned(),
        title: patch.title.clone(),
        source: patch.source.clone(),
        note: patch.note.clone(),
        machine: machine.to_owned(),
        time_scale: patch.time_scale,
        duration: run.longest_repetition(),
        step: run.step.as_ref().map(|step| step.value),
        parameters: parameters(patch),
        elements: elements(&SettingViewer::new(patch, &quantities, report)),
        outputs: quantities::outputs(patch, &quantities),
        signals: quantities::signals(patch, &quantities),
        loose: loose.map(|cord| LooseView { id: cord.id, end: cord.end.clone(), at: cord.at }).collect(),
        parts: parts(patch),
        undo: document.undo_label().map(str::to_owned),
        redo: document.redo_label().map(str::to_owned),
        runs,
    }
}

/// The parameters of a patch.
fn parameters(patch: &Patch) -> Vec<ParameterView> {
    let parameters = patch.parameters.iter();
    let view = parameters.map(|(name, parameter)| ParameterView {
        name: name.clone(),
        value: parameter.value,
        unit: parameter.unit.text().to_owned(),
        range: parameter.range.map(|(low, high)| [low, high]),
        description: parameter.description.clone(),
    });
    view.collect()
}

/// The parts of the machine: those that it has, and those that the patch uses.
fn parts(patch: &Patch) -> Vec<PartView> {
    let machine = wiring::machine(patch);
    let view = |part: &Part| PartView {
        key: part.key().to_owned(),
        used: patch.elements.values().map(|entry| part_count(entry, *part)).sum(),
        available: machine.count(*part),
    };
    let parts = Part::ALL.iter().map(view);
    parts.filter(|part| part.used > 0 || part.available.is_some_and(|count| count > 0)).collect()
}

/// Drives, elements and instances, in the order of the document.
fn elements(viewer: &SettingViewer<'_>) -> Vec<ElementView> {
    let patch = viewer.patch;
    let drives = patch.drives.iter().map(|(name, entry)| element_view(viewer, name, entry));
    let section = wiring::section_names(patch).into_iter().filter_map(|name| {
        let instance = patch.instances.get(name).map(|instance| instance_view(viewer, name, instance));
        instance.or_else(|| Some(element_view(viewer, name, patch.elements.get(name)?)))
    });
    drives.chain(section).collect()
}

/// An element or a drive.
fn element_view(viewer: &SettingViewer<'_>, name: &str, entry: &ElementEntry) -> ElementView {
    let is_drive = entry.kind.family == Family::Drive;
    ElementView {
        name: name.to_owned(),
        kind: entry.kind.name.to_owned(),
        family: if is_drive { "drive" } else { "element" },
        note: entry.note.clone(),
        jacks: jacks::of_element(viewer.patch, name, entry),
        outputs: vec![name.to_owned()],
        settings: viewer.of_element(name, entry),
        lamp: has_lamp(entry),
        parts: part_names([entry]),
    }
}

/// An instance of a macro: its ports are jacks and outputs, and its lamp lights with any amplifier inside.
fn instance_view(viewer: &SettingViewer<'_>, name: &str, instance: &Instance) -> ElementView {
    let patch = viewer.patch;
    let members: Vec<_> = instance.members.iter().filter_map(|member| patch.elements.get(member)).collect();
    ElementView {
        name: name.to_owned(),
        kind: instance.macro_name.clone(),
        family: "instance",
        note: instance.note.clone(),
        jacks: jacks::of_instance(patch, name, instance),
        outputs: instance.outputs.keys().map(|port| format!("{name}.{port}")).collect(),
        settings: viewer.of_instance(name, instance),
        lamp: members.iter().any(|entry| has_lamp(entry)),
        parts: part_names(members),
    }
}

/// The settings of all potentiometers by their names, each from 0 to 1.
pub fn pot_settings(circuit: &Circuit) -> HashMap<&str, f64> {
    let elements = circuit.elements().into_iter();
    let pots = elements.filter(|element| matches!(element.kind.name, "pot" | "free-pot"));
    let settings = pots.filter_map(|pot| {
        let settings = settings_of_element(circuit, pot);
        let setting = settings.iter().find(|setting| setting.name == "setting")?;
        match setting.value {
            SettingValue::Number(number) => Some((pot.name.as_str(), number)),
            _ => None,
        }
    });
    settings.collect()
}

/// Whether an element has an overload lamp.
fn has_lamp(entry: &ElementEntry) -> bool {
    entry.kind.output != OutputStage::Passive
}

/// The keys of the parts that elements use, with the names that the patch gives them.
fn part_names<'p>(entries: impl IntoIterator<Item = &'p ElementEntry>) -> Vec<(String, Vec<String>)> {
    let entries: Vec<_> = entries.into_iter().collect();
    let used = Part::ALL.iter().filter(|part| entries.iter().any(|entry| part_count(entry, **part) > 0));
    let names = |part: &Part| {
        let lists = entries.iter().flat_map(|entry| &entry.machine_parts);
        let lists = lists.filter(|(key, _)| key.value == part.key());
        lists.flat_map(|(_, names)| names.iter().map(|name| name.value.clone())).collect()
    };
    used.map(|part| (part.key().to_owned(), names(part))).collect()
}

#[cfg(test)]
mod tests;
