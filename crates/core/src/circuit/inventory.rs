//! The inventory: compares the parts that the elements use with the parts of the machine.
//!
//! Each kind lists the parts that it needs, some of them only with a certain setting or input. A patch can also list
//! the parts of the machine that each element uses, such as "A7". Such lists are checked for their length and for
//! repetitions. The methods of [`Circuit`] for parts are at the end.

use std::collections::HashMap;

use super::{Circuit, macros};
use crate::document::{Code, Diagnostic, Placed};
use crate::elements::PartUse;
use crate::machines::{MachineModel, Part};
use crate::patch::{ElementEntry, Patch};

/// The parts that the patch uses, with their numbers. Reports parts of which the machine has too few.
pub(super) fn check(
    patch: &Patch,
    machine: &MachineModel,
    findings: &mut Vec<Diagnostic>,
) -> Vec<(Part, usize)> {
    check_part_lists(patch, findings);
    let used: Vec<_> = Part::ALL.iter().map(|part| (*part, total_count(patch, *part))).collect();
    for (part, count) in &used {
        if let Some(available) = machine.count(*part).filter(|available| available < count) {
            findings.push(too_few_parts(patch, machine, *part, *count, available));
        }
    }
    used.into_iter().filter(|(_, count)| *count > 0).collect()
}

/// Number of parts of one type that the whole patch uses.
fn total_count(patch: &Patch, part: Part) -> usize {
    patch.elements.values().map(|entry| part_count(entry, part)).sum()
}

/// Number of parts of one type that an element uses.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::part_count;
/// use patchcord_core::machines::Part;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
///
/// let limit = serde_json::json!({"upper": 10});
/// let limited = ElementBuilder::new("summer").cords("x1", ["+100"]).set("limit", limit);
/// let patch = PatchBuilder::new("limited").element("A1", limited).build()?;
/// let parts = [Part::Summer, Part::DiodePair, Part::Relay];
/// assert_eq!(parts.map(|part| part_count(&patch.elements["A1"], part)), [1, 1, 0]);
/// # Ok::<(), Box<patchcord_core::document::Report>>(())
/// ```
pub fn part_count(entry: &ElementEntry, part: Part) -> usize {
    let rows = entry.kind.parts.iter().filter(|part_use| part_use.part == part && applies(entry, part_use));
    rows.map(|part_use| part_use.count).sum()
}

/// Whether an element needs the part of a row of its kind.
///
/// A row with a condition names a setting or an input in `with`. It applies if the patch gives this setting, one of
/// the settings of this group ("limit.upper" for "limit"), or a cord into this input.
fn applies(entry: &ElementEntry, part_use: &PartUse) -> bool {
    let is_named = |name: &str| {
        name == part_use.with || name.strip_prefix(part_use.with).is_some_and(|rest| rest.starts_with('.'))
    };
    let is_set = entry
        .kind
        .settings
        .iter()
        .zip(&entry.settings)
        .any(|(setting, value)| value.is_some() && is_named(setting.name));
    let is_plugged = entry.plugs.iter().any(|plug| {
        entry
            .kind
            .input(&plug.jack.value)
            .is_some_and(|(index, _)| entry.kind.inputs[index].name == part_use.with)
    });
    part_use.with.is_empty() || is_set || is_plugged
}

/// The diagnostic for too few parts. It points to the first element for which no part remains.
///
/// The elements take their parts in the order of the document. An element inside an instance is reported at the
/// position of the instance, where the user can change the number.
fn too_few_parts(
    patch: &Patch,
    machine: &MachineModel,
    part: Part,
    count: usize,
    available: usize,
) -> Diagnostic {
    let mut remaining = available;
    let first_without =
        patch.elements.iter().find(|(_, entry)| match remaining.checked_sub(part_count(entry, part)) {
            Some(rest) => {
                remaining = rest;
                false
            }
            None => true,
        });
    let available = if available == 0 { "none".to_owned() } else { available.to_string() };
    let message = format!("the patch uses {}, and the {} has {available}", part.counted(count), machine.name);
    let hint = "use fewer of them, or write \"machine\": \"unlimited\", which has any number of parts";
    let span = first_without.map(|(name, entry)| macros::instance_span(patch, name).unwrap_or(entry.span));
    Diagnostic { code: Code::INVENTORY, span, message, hint: Some(hint.to_owned()) }
}

/// Checks the lists of machine parts: their length, and that no part is listed twice.
fn check_part_lists(patch: &Patch, findings: &mut Vec<Diagnostic>) {
    let mut owners: HashMap<(&str, &str), &str> = HashMap::new();
    for (name, entry) in &patch.elements {
        for (key, names) in &entry.machine_parts {
            check_list_length(name, entry, key, names, findings);
            for part in names {
                if let Some(owner) = owners.insert((&key.value, &part.value), name) {
                    let message = if owner == name {
                        format!("{name} lists {} twice", part.value)
                    } else {
                        format!("{} is used by {owner} and by {name}", part.value)
                    };
                    let hint = "the machine has each part once";
                    findings.push(Diagnostic::at(Code::PART_TWICE, part.span, message).hint(hint));
                }
            }
        }
    }
}

/// Reports a list whose length differs from the number of parts that the element uses.
///
/// `key` is the type of the parts, such as "summers". An unknown type was reported when the patch was read.
fn check_list_length(
    name: &str,
    entry: &ElementEntry,
    key: &Placed<String>,
    names: &[Placed<String>],
    findings: &mut Vec<Diagnostic>,
) {
    let Some(part) = Part::ALL.iter().find(|part| part.key() == key.value) else { return };
    let expected = part_count(entry, *part);
    if names.len() != expected {
        let message = format!("{name} consists of {} and lists {}", part.counted(expected), names.len());
        let hint = "list as many parts as the element consists of, or remove the list";
        findings.push(Diagnostic::at(Code::PART_COUNT, key.span, message).hint(hint));
    }
}

impl Circuit {
    /// The parts of the machine that the circuit uses, with their numbers. Unused parts are not listed.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::machines::Part;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let inverter = ElementBuilder::new("inverter").cord("in", "+100");
    /// let builder = PatchBuilder::new("inverter").machine("solartron-1451");
    /// let circuit = Circuit::new(&builder.element("A1", inverter).build()?)?;
    /// assert_eq!(circuit.parts(), [(Part::Summer, 1)]);
    /// assert_eq!(circuit.machine().count(Part::Summer), Some(16));
    /// # Ok(())
    /// # }
    /// ```
    pub fn parts(&self) -> &[(Part, usize)] {
        &self.parts
    }

    /// The parts of the machine that an element uses, with their numbers, in the order of its kind.
    ///
    /// Empty for drives, references and unknown names.
    pub fn parts_of(&self, element: &str) -> Vec<(Part, usize)> {
        let Some(entry) = self.patch.elements.get(element) else { return Vec::new() };
        let mut parts: Vec<(Part, usize)> = Vec::new();
        for part_use in entry.kind.parts {
            let count = part_count(entry, part_use.part);
            if count > 0 && parts.iter().all(|(part, _)| *part != part_use.part) {
                parts.push((part_use.part, count));
            }
        }
        parts
    }

    /// Names of the machine's parts of one type that the patch lists for an element, such as "A7".
    pub fn part_names(&self, element: &str, part: Part) -> Vec<String> {
        let entry = self.patch.elements.get(element);
        let entries = entry.into_iter().flat_map(|entry| &entry.machine_parts);
        let of_this_part = entries.filter(|(key, _)| key.value == part.key());
        of_this_part.flat_map(|(_, names)| names.iter().map(|name| name.value.clone())).collect()
    }
}
