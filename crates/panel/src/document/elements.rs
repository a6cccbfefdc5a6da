//! Adds and removes elements and drives.

use patchcord_core::circuit::part_count;
use patchcord_core::document::Span;
use patchcord_core::elements::{self, Family, Kind, REGISTRY};
use patchcord_core::machines::Part;
use patchcord_core::patch::{Patch, PatchEditor, check_output_name};
use patchcord_expr::Formula;

use super::kinds::{new_element, prefix};
use super::{Document, Edited, Refusal};
use crate::command::CordEnd;
use crate::event::Place;
use crate::wiring;

/// Adds an element or a drive, with the settings that it must have and without cords.
pub(super) fn add(document: &Document, kind: &str, name: Option<&str>) -> Result<Edited, Refusal> {
    let patch = document.patch();
    let found =
        [Family::Computing, Family::Drive].into_iter().find_map(|family| elements::find(family, kind));
    let kind = found.ok_or_else(|| {
        let known: Vec<_> = REGISTRY.iter().map(|kind| kind.name).collect();
        Refusal::unknown(format!("there is no kind {kind}"), kind, &known)
    })?;
    check_parts(patch, kind)?;
    let name = match name {
        Some(name) => checked_name(patch, name)?,
        None => free_name(prefix(kind.name), |name| is_taken(patch, name)),
    };
    let (element, mut editor) = (new_element(kind.name), patch.edit());
    match kind.family {
        Family::Drive => {
            let scale = volt_scale(patch, &mut editor);
            editor.put_drive(&name, element.set("scale", scale));
        }
        _ => editor.put_element(&name, element),
    }
    Ok(Edited::patch(document.reread(editor)?, format!("add {name}")))
}

/// Removes an element, a drive or an instance, with its cords.
pub(super) fn remove(document: &Document, name: &str) -> Result<Edited, Refusal> {
    let patch = document.patch();
    if !["elements", "drives"].into_iter().any(|section| is_written(patch, section, name)) {
        let message = format!("there is no element {name} to remove");
        return Err(Refusal::unknown(message, name, &wiring::entry_names(patch)));
    }
    let mut editor = patch.edit();
    editor.remove_element(name)?;
    let edited = Edited::patch(document.reread(editor)?, format!("remove {name}"));
    let belongs = |output: &str| {
        let port = output.strip_prefix(name).and_then(|rest| rest.strip_prefix('.'));
        output == name || (patch.instances.contains_key(name) && port.is_some())
    };
    let mut loose = document.loose().to_vec();
    loose.retain(|cord| match &cord.end {
        CordEnd::Input { element, .. } => element != name,
        CordEnd::Output { output } => !belongs(output),
    });
    Ok(Edited { loose: Some(loose), ..edited })
}

/// Checks that the machine has the parts for one more element of a kind.
fn check_parts(patch: &Patch, kind: &Kind) -> Result<(), Refusal> {
    let machine = wiring::machine(patch);
    for part in Part::ALL {
        let always = kind.parts.iter().filter(|row| row.part == *part && row.with.is_empty());
        let needed: usize = always.map(|row| row.count).sum();
        let Some(available) = machine.count(*part).filter(|_| needed > 0) else { continue };
        let counts = patch.elements.iter().map(|(name, entry)| (name.as_str(), part_count(entry, *part)));
        let users: Vec<_> = counts.filter(|(_, count)| *count > 0).collect();
        let used: usize = users.iter().map(|(_, count)| *count).sum();
        if used + needed > available {
            let names: Vec<_> = users.iter().map(|(name, _)| *name).collect();
            let use_text = match names.as_slice() {
                [] => String::new(),
                names => format!(", and {} use {used}: remove one of them first", names.join(", ")),
            };
            return Err(Refusal::new(format!(
                "an element of kind {} needs {}, but the {} has {}{use_text}",
                kind.name,
                part.counted(needed),
                machine.name,
                part.counted(available)
            )));
        }
    }
    Ok(())
}

/// A name that a user chose, if an element can have it.
fn checked_name(patch: &Patch, name: &str) -> Result<String, Refusal> {
    if let Some(finding) = check_output_name(name, Span::default(), "element") {
        return Err(Refusal::new(format!("{}: {}", finding.message, finding.advice())));
    }
    if is_taken(patch, name) {
        let place = Place { element: Some(name.to_owned()), ..Place::default() };
        return Err(Refusal::new(format!("{name} exists already: choose another name")).at(place));
    }
    Ok(name.to_owned())
}

/// Whether something in the document has a name, also if the entry has a fault.
fn is_taken(patch: &Patch, name: &str) -> bool {
    ["drives", "elements", "signals"].into_iter().any(|section| is_written(patch, section, name))
        || patch.elements.contains_key(name)
        || wiring::outputs(patch).iter().any(|output| output.name == name)
}

/// Whether a section of the document has an entry of this name.
fn is_written(patch: &Patch, section: &str, name: &str) -> bool {
    patch.value().get(section).is_some_and(|entries| entries.get(name).is_some())
}

/// The first free name that consists of a prefix and a number from 1.
fn free_name(prefix: &str, is_taken: impl Fn(&str) -> bool) -> String {
    let mut number = 1;
    loop {
        let name = format!("{prefix}{number}");
        if !is_taken(&name) {
            return name;
        }
        number += 1;
    }
}

/// The scale for a new drive: 1 V of the quantity per volt. It is added if the patch does not have it.
fn volt_scale(patch: &Patch, editor: &mut PatchEditor) -> String {
    let is_one = |formula: &Formula| formula.text().trim().parse::<f64>().is_ok_and(|value| value == 1.0);
    let mut scales = patch.scales.iter();
    let found = scales.find(|(_, scale)| {
        scale.unit.text() == "V" && scale.per_volt.as_ref().is_some_and(|placed| is_one(&placed.value))
    });
    if let Some((name, _)) = found {
        return name.clone();
    }
    let is_taken = |name: &str| patch.parameters.contains_key(name) || patch.scales.contains_key(name);
    let name = if is_taken("volt") { free_name("volt", is_taken) } else { "volt".to_owned() };
    editor.put_scale(&name, 1, "V");
    name
}
