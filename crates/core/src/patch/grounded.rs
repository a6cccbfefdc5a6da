//! A copy of a patch whose open inputs are plugged to ground, so that it can run.
//!
//! On a real machine an open input is at 0 V, and the machine computes with it. The checker reports it, because it is
//! nearly always a fault.

use std::collections::HashSet;

use super::cord_faults::{OpenInput, open_inputs};
use super::document::{ElementEntry, Patch};
use super::macros::SectionEntry;
use super::render::{DocumentEdit, render};
use crate::elements::Jacks;
use crate::machines::{self, MachineModel};

/// The reference at 0 V.
const GROUND: &str = "ground";

impl Patch {
    /// A copy of the patch with "ground" plugged into every input that [`Circuit::new`](crate::circuit::Circuit::new)
    /// reports as open, by the code `no-driver`. Inputs inside macros and ports of instances count too.
    ///
    /// An input with gains is plugged at the smallest gain of the machine. An input with two poles of which one is open
    /// keeps the other. Elements of which a part could not be read stay as they are.
    ///
    /// `None` if no input is open, or if the text of the copy would be longer than 16 MB.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// let integrator = ElementBuilder::new("integrator").set("initial", 50);
    /// let patch = PatchBuilder::new("open").element("A1", integrator).build()?;
    /// assert!(Circuit::new(&patch).is_err());
    /// let grounded = patch.with_grounded_inputs().expect("an input is open");
    /// assert_eq!(grounded.written_cords("A1").collect::<Vec<_>>(), [("x1", "ground")]);
    /// assert!(Circuit::new(&grounded)?.patch().with_grounded_inputs().is_none());
    /// # Ok::<(), Box<patchcord_core::document::Report>>(())
    /// ```
    pub fn with_grounded_inputs(&self) -> Option<Patch> {
        let cords = ground_cords(self);
        if cords.is_empty() {
            return None;
        }
        let text = render(self.text(), &cords).ok()?;
        Patch::parse_with(self.table_access.clone(), &self.file, &text).ok()
    }
}

/// The cords that ground the open inputs of a patch.
///
/// The checker sees a macro only through its instances, so inputs of macros without instances do not count.
fn ground_cords(patch: &Patch) -> Vec<DocumentEdit> {
    let used_macros: HashSet<&str> =
        patch.instances.values().map(|instance| instance.macro_name.as_str()).collect();
    let patch_section = (vec!["elements"], &patch.element_section);
    let macro_sections = patch.macros.iter().filter(|(name, _)| used_macros.contains(name.as_str()));
    let macro_sections = macro_sections
        .map(|(name, definition)| (vec!["macros", name.as_str(), "elements"], definition.section()));
    let mut cords = Vec::new();
    for (section_path, section) in [patch_section].into_iter().chain(macro_sections) {
        for (name, entry) in section {
            let element: Vec<_> =
                section_path.iter().copied().chain([name.as_str()]).map(str::to_owned).collect();
            let cord =
                |jack| DocumentEdit::AddCord { element: element.clone(), jack, from: GROUND.to_owned() };
            cords.extend(open_jacks(patch, entry).into_iter().map(cord));
        }
    }
    cords
}

/// The open jacks of an element or an instance, each as the keys from its entry to the jack. A jack occurs once for
/// every cord that is missing there.
fn open_jacks(patch: &Patch, entry: &SectionEntry) -> Vec<Vec<String>> {
    match entry {
        SectionEntry::Element(element) => {
            let machine = machine(patch);
            let jacks = open_inputs(element).into_iter().flat_map(|open_input| {
                let jack = jack_path(element, &open_input, machine);
                std::iter::repeat_n(jack, open_input.least - open_input.count)
            });
            jacks.collect()
        }
        SectionEntry::Instance(instance) => {
            let definition = patch.macros.get(instance.macro_name());
            let ports = definition.into_iter().flat_map(|definition| instance.open_ports(definition));
            ports.map(|port| vec![port.to_owned()]).collect()
        }
    }
}

/// The keys from an element to the jack that grounds an open input: a jack with an empty list of cords, or else the one
/// with the smallest gain.
fn jack_path(element: &ElementEntry, open_input: &OpenInput<'_>, machine: &MachineModel) -> Vec<String> {
    let (kind, row) = (element.kind, &element.kind.inputs[open_input.input]);
    let jack = match open_input.empty_jack {
        Some(jack) => jack.value.clone(),
        None if row.jacks == Jacks::Gains => {
            format!("{}{}", row.name, kind.available_gains(machine).first().unwrap_or(&1.0))
        }
        None => row.name.to_owned(),
    };
    let group = kind.has_gains().then(|| "in".to_owned());
    group.into_iter().chain([jack]).collect()
}

/// The machine of the patch; the default machine if its name is not known.
fn machine(patch: &Patch) -> &'static MachineModel {
    let named = patch.machine.as_ref().and_then(|name| machines::find(&name.value));
    named.unwrap_or(machines::DEFAULT_MACHINE)
}

#[cfg(test)]
mod tests;
