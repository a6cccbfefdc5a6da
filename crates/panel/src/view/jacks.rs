//! The input jacks of elements and instances, with their cords.

use patchcord_core::elements::{Input, Jacks};
use patchcord_core::machines::MachineModel;
use patchcord_core::patch::{ElementEntry, Instance, Patch};
use patchcord_draw::schematic::jack_label;

use crate::event::JackView;
use crate::wiring;

/// The jacks of an instance: the input ports of its macro.
pub(super) fn of_instance(patch: &Patch, name: &str, instance: &Instance) -> Vec<JackView> {
    let cords = wiring::cords_into(patch, name);
    let Some(definition) = patch.macros.get(&instance.macro_name) else { return Vec::new() };
    let view = |port: &String, description: &str| JackView {
        name: port.clone(),
        label: port.clone(),
        description: description.to_owned(),
        required: true,
        most: Some(1),
        cords: outputs_in(&cords, port),
    };
    definition.inputs.iter().map(|(port, description)| view(port, &description.value)).collect()
}

/// The jacks of an element, in the order of its kind. Jacks that the kind does not have, but in which the document has
/// cords, follow at the end.
pub(super) fn of_element(patch: &Patch, name: &str, entry: &ElementEntry) -> Vec<JackView> {
    let rows = JackRows { machine: wiring::machine(patch), entry, cords: wiring::cords_into(patch, name) };
    let mut views: Vec<_> =
        (0..entry.kind.inputs.len()).flat_map(|input| rows.views(&entry.kind.inputs[input], input)).collect();
    for (jack, _) in &rows.cords {
        if views.iter().all(|view| view.name != *jack) {
            views.push(rows.view(jack, (*jack).to_owned(), "", false, None));
        }
    }
    views
}

/// The outputs of the cords in a jack.
fn outputs_in(cords: &[(&str, String)], jack: &str) -> Vec<String> {
    cords.iter().filter(|(other, _)| *other == jack).map(|(_, from)| from.clone()).collect()
}

/// The jacks of one element.
struct JackRows<'p> {
    /// The machine, for its gains and parts.
    machine: &'static MachineModel,
    /// The element.
    entry: &'p ElementEntry,
    /// Its cords: the jack and the output.
    cords: Vec<(&'p str, String)>,
}

impl JackRows<'_> {
    /// The jacks of an input. An input that may stay open is left out if the machine has no part for it and it has no
    /// cord: the Solartron 1451 has no brakes.
    fn views(&self, input: &Input, index: usize) -> Vec<JackView> {
        let kind = self.entry.kind;
        let is_plugged = self.cords.iter().any(|(jack, _)| self.is_jack_of(jack, index));
        let mut parts = kind.parts.iter().filter(|row| row.with == input.name);
        if !is_plugged && !input.required && parts.any(|row| self.machine.count(row.part) == Some(0)) {
            return Vec::new();
        }
        let most = wiring::capacity(input.jacks);
        if input.jacks == Jacks::Gains {
            let gains = self.gains(input, index).into_iter();
            let views = gains.map(|(gain, name)| {
                let is_elsewhere =
                    self.cords.iter().any(|(jack, _)| *jack != name && self.is_jack_of(jack, index));
                let required = input.required && !is_elsewhere;
                self.view(&name, jack_label(input.name, Some(gain)), input.description, required, most)
            });
            return views.collect();
        }
        let has_gains = !self.machine.summer_gains.is_empty();
        // The panel of such a machine has summers only: an inverter is a summer with a cord in a jack of gain 1.
        let label = match kind.name == "inverter" && has_gains {
            true => "1".to_owned(),
            false => jack_label(input.name, None),
        };
        vec![self.view(input.name, label, input.description, input.required, most)]
    }

    /// Whether a jack belongs to an input.
    fn is_jack_of(&self, jack: &str, input: usize) -> bool {
        self.entry.kind.input(jack).is_some_and(|(index, _)| index == input)
    }

    /// The jacks of a summing input by rising gain: those with cords, and those of the machine.
    fn gains(&self, input: &Input, index: usize) -> Vec<(f64, String)> {
        let mut gains: Vec<(f64, String)> = Vec::new();
        for (jack, _) in &self.cords {
            if let Some((_, gain)) = self.entry.kind.input(jack).filter(|(found, _)| *found == index)
                && gains.iter().all(|(_, name)| name != jack)
            {
                gains.push((gain, (*jack).to_owned()));
            }
        }
        for gain in wiring::shown_gains(self.entry.kind, self.machine) {
            if gains.iter().all(|(used, _)| used != gain) {
                gains.push((*gain, format!("{}{gain}", input.name)));
            }
        }
        gains.sort_by(|one, other| one.0.total_cmp(&other.0));
        gains
    }

    /// A jack with its cords.
    fn view(
        &self,
        name: &str,
        label: String,
        description: &str,
        required: bool,
        most: Option<usize>,
    ) -> JackView {
        JackView {
            name: name.to_owned(),
            label,
            description: description.to_owned(),
            required,
            most,
            cords: outputs_in(&self.cords, name),
        }
    }
}
