//! Edits of cords: those of the patch, and those with a loose end.

use std::collections::{HashMap, HashSet};

use patchcord_core::patch::Patch;

use super::history::StepKind;
use super::{Document, Edited, Loose, Refusal};
use crate::command::{CordEnd, CordName};
use crate::event::Place;
use crate::limits::MAX_LOOSE_CORDS;
use crate::wiring;

/// The ends of a cord: an input jack and an output.
#[derive(Debug, Clone, Copy)]
pub(super) struct CordEnds<'c> {
    /// Name of the element with the input.
    pub element: &'c str,
    /// Name of the jack.
    pub jack: &'c str,
    /// Name of the output.
    pub from: &'c str,
}

impl<'c> CordEnds<'c> {
    /// The ends of a named cord.
    pub(super) fn of(name: &'c CordName) -> CordEnds<'c> {
        CordEnds { element: &name.element, jack: &name.jack, from: &name.from }
    }

    /// The jack at the panel.
    fn place(self) -> Place {
        Place { element: Some(self.element.to_owned()), jack: Some(self.jack.to_owned()), ..Place::default() }
    }

    /// Whether a loose cord can have this end instead of the whole cord.
    fn has_end(self, patch: &Patch, end: &CordEnd) -> bool {
        match end {
            CordEnd::Input { element, jack } => self.element == element && self.jack == jack,
            CordEnd::Output { output } => self.has_output(patch, output),
        }
    }

    /// Whether the cord comes from an output, under any of its names.
    fn has_output(self, patch: &Patch, output: &str) -> bool {
        wiring::panel_name(patch, self.from) == wiring::panel_name(patch, output)
    }
}

/// Plugs a cord in.
pub(super) fn plug(document: &Document, cord: CordEnds<'_>) -> Result<Edited, Refusal> {
    let patch = rewired(document, None, Some(cord))?;
    Ok(Edited::patch(patch, format!("plug {} into {}.{}", cord.from, cord.element, cord.jack)))
}

/// Removes a cord.
pub(super) fn unplug(document: &Document, cord: CordEnds<'_>) -> Result<Edited, Refusal> {
    let patch = rewired(document, Some(cord), None)?;
    Ok(Edited::patch(patch, format!("pull {} out of {}.{}", cord.from, cord.element, cord.jack)))
}

/// Moves one end of a cord.
pub(super) fn move_cord(document: &Document, cord: CordEnds<'_>, to: &CordEnd) -> Result<Edited, Refusal> {
    let (moved, target) = match to {
        CordEnd::Input { element, jack } => {
            (CordEnds { element, jack, from: cord.from }, format!("{element}.{jack}"))
        }
        CordEnd::Output { output } => (CordEnds { from: output, ..cord }, output.clone()),
    };
    let patch = rewired(document, Some(cord), Some(moved))?;
    Ok(Edited::patch(
        patch,
        format!("move the cord from {} in {}.{} to {target}", cord.from, cord.element, cord.jack),
    ))
}

/// Puts a cord with a loose end on the panel. If it replaces a cord, that one is removed.
pub(super) fn put_loose(
    document: &Document,
    end: &CordEnd,
    at: [f64; 2],
    replaces: Option<CordEnds<'_>>,
) -> Result<Edited, Refusal> {
    let patch = document.patch();
    match end {
        CordEnd::Input { element, jack } => {
            check_jack(patch, CordEnds { element, jack, from: "" }, replaces)?;
        }
        CordEnd::Output { output } => check_output(patch, output)?,
    }
    if replaces.is_some_and(|cord| !cord.has_end(patch, end)) {
        return Err(Refusal::new("the loose cord must keep one end of the cord that it replaces"));
    }
    check_place(at)?;
    if document.loose.len() >= MAX_LOOSE_CORDS {
        let message = format!("there are {MAX_LOOSE_CORDS} loose cords: plug them in or remove them first");
        return Err(Refusal::new(message));
    }
    let patch = replaces.map(|cord| rewired(document, Some(cord), None)).transpose()?;
    let mut loose = document.loose.clone();
    loose.push(Loose { id: document.next_loose, end: end.clone(), at });
    let kind = if patch.is_some() { StepKind::Patch } else { StepKind::Panel };
    Ok(Edited { patch, loose: Some(loose), label: "drop an end of a cord".to_owned(), kind })
}

/// Plugs the loose end of a cord in.
pub(super) fn plug_loose(document: &Document, id: u64, to: &CordEnd) -> Result<Edited, Refusal> {
    let (cord, others) = take_loose(document, id)?;
    let ends = match (&cord.end, to) {
        (CordEnd::Input { element, jack }, CordEnd::Output { output })
        | (CordEnd::Output { output }, CordEnd::Input { element, jack }) => {
            CordEnds { element, jack, from: output }
        }
        _ => {
            let message = "a cord goes from an output to an input: choose a jack of the other kind";
            return Err(Refusal::new(message).at(end_place(to)));
        }
    };
    Ok(Edited { loose: Some(others), ..plug(document, ends)? })
}

/// Moves the loose end of a cord. The cord keeps its number.
pub(super) fn move_loose(document: &Document, id: u64, at: [f64; 2]) -> Result<Edited, Refusal> {
    check_place(at)?;
    let index = loose_index(document, id)?;
    let mut loose = document.loose.clone();
    loose[index].at = at;
    let label = "move a loose cord".to_owned();
    Ok(Edited { patch: None, loose: Some(loose), label, kind: StepKind::Panel })
}

/// Removes a loose cord.
pub(super) fn remove_loose(document: &Document, id: u64) -> Result<Edited, Refusal> {
    let (_, others) = take_loose(document, id)?;
    let label = "remove a loose cord".to_owned();
    Ok(Edited { patch: None, loose: Some(others), label, kind: StepKind::Panel })
}

/// Removes all cords, also those with a loose end.
pub(super) fn clear(document: &Document) -> Result<Edited, Refusal> {
    let mut editor = document.patch().edit();
    editor.remove_all_cords();
    let edited = Edited::patch(document.reread(editor)?, "remove all cords".to_owned());
    Ok(Edited { loose: Some(Vec::new()), ..edited })
}

/// The loose cord with this number, and the others.
fn take_loose(document: &Document, id: u64) -> Result<(Loose, Vec<Loose>), Refusal> {
    let index = loose_index(document, id)?;
    let mut others = document.loose.clone();
    let cord = others.remove(index);
    Ok((cord, others))
}

/// The index of the loose cord with this number.
fn loose_index(document: &Document, id: u64) -> Result<usize, Refusal> {
    let index = document.loose.iter().position(|cord| cord.id == id);
    index.ok_or_else(|| Refusal::new(format!("there is no loose cord {id}")))
}

/// Checks the place of a loose end.
fn check_place(at: [f64; 2]) -> Result<(), Refusal> {
    match at.iter().all(|coordinate| coordinate.is_finite()) {
        true => Ok(()),
        false => Err(Refusal::new("the loose end must have a place on the panel")),
    }
}

/// Whether a patch has the jack of this end of a cord.
pub(super) fn is_end_of(patch: &Patch, end: &CordEnd) -> bool {
    match end {
        CordEnd::Input { element, jack } => {
            wiring::is_in_section(patch, element) && jack_capacity(patch, element, jack).is_some()
        }
        CordEnd::Output { output } => check_output(patch, output).is_ok(),
    }
}

/// The place of an end of a cord.
fn end_place(end: &CordEnd) -> Place {
    match end {
        CordEnd::Input { element, jack } => CordEnds { element, jack, from: "" }.place(),
        CordEnd::Output { output } => Place { element: Some(output.clone()), ..Place::default() },
    }
}

/// The patch after one cord is pulled and another one is plugged in.
fn rewired(
    document: &Document,
    pulled: Option<CordEnds<'_>>,
    plugged: Option<CordEnds<'_>>,
) -> Result<Patch, Refusal> {
    let patch = document.patch();
    let written = pulled.map(|cord| written_output(patch, cord)).transpose()?;
    if let Some(cord) = plugged {
        check_output(patch, cord.from)?;
        check_jack(patch, cord, pulled)?;
    }
    let mut editor = patch.edit();
    match (pulled.zip(written), plugged) {
        // The cord keeps its place in the list of the jack.
        (Some((cord, written)), Some(other)) if is_replugged(patch, cord, other) => {
            editor.replug(cord.element, &written, other.from)?;
        }
        (removed, added) => {
            if let Some((cord, written)) = removed {
                editor.remove_cord(cord.element, cord.jack, &written)?;
            }
            if let Some(cord) = added {
                editor.add_cord(cord.element, cord.jack, cord.from)?;
            }
        }
    }
    document.reread(editor)
}

/// Whether a cord only gets another output, and no other cord into the element has the old one.
fn is_replugged(patch: &Patch, old: CordEnds<'_>, new: CordEnds<'_>) -> bool {
    let same_output = patch.written_cords(old.element).filter(|(_, from)| old.has_output(patch, from));
    (old.element, old.jack) == (new.element, new.jack) && same_output.count() == 1
}

/// The name of the output of a cord as the document has it: "L1" for "L1.out".
fn written_output(patch: &Patch, cord: CordEnds<'_>) -> Result<String, Refusal> {
    let mut cords = patch.written_cords(cord.element);
    let found = cords.find(|(jack, from)| *jack == cord.jack && cord.has_output(patch, from));
    let CordEnds { element, jack, from } = cord;
    found.map(|(_, written)| written.to_owned()).ok_or_else(|| {
        Refusal::new(format!("there is no cord from {from} in the jack {jack} of {element}")).at(cord.place())
    })
}

/// Checks that a cord can begin at an output.
fn check_output(patch: &Patch, name: &str) -> Result<(), Refusal> {
    let outputs = wiring::outputs(patch);
    let names: Vec<&str> =
        outputs.iter().filter(|output| !output.is_inside).map(|output| output.name.as_str()).collect();
    if names.contains(&wiring::panel_name(patch, name).as_str()) {
        return Ok(());
    }
    Err(Refusal::unknown(format!("there is no output {name}"), name, &names))
}

/// Checks that a cord fits into a jack, after another one is pulled.
///
/// A jack for one cord takes no second one. Any gain is allowed: the checker compares it with the machine.
fn check_jack(patch: &Patch, cord: CordEnds<'_>, pulled: Option<CordEnds<'_>>) -> Result<(), Refusal> {
    let CordEnds { element, jack, .. } = cord;
    if !wiring::is_in_section(patch, element) {
        let message = format!("there is no element {element} with inputs");
        return Err(Refusal::unknown(message, element, &wiring::section_names(patch)));
    }
    let Some(capacity) = jack_capacity(patch, element, jack) else {
        let message = format!("{element} has no jack {jack}: choose one of its jacks");
        return Err(Refusal::new(message).at(cord.place()));
    };
    let mut plugged: Vec<String> =
        wiring::cords_into(patch, element).into_iter().filter(|one| one.0 == jack).map(|one| one.1).collect();
    if let Some(old) = pulled.filter(|old| (old.element, old.jack) == (element, jack))
        && let Some(index) = plugged.iter().position(|from| old.has_output(patch, from))
    {
        plugged.remove(index);
    }
    if capacity.is_some_and(|capacity| plugged.len() >= capacity) {
        let cords = plugged.join(" and ");
        let message = format!(
            "the jack {jack} of {element} is full: pull out or move the cord from {cords} first, or add both \
             voltages in a summer"
        );
        return Err(Refusal::new(message).at(cord.place()));
    }
    Ok(())
}

/// Notes for each element that loses the last cord of a jack which jack that is. The text no longer has such a jack.
pub(super) fn note_pulled(before: &Patch, after: &Patch, pulled: &mut HashMap<String, String>) {
    pulled.retain(|element, _| after.elements.contains_key(element));
    for element in after.elements.keys() {
        let jacks: HashSet<&str> = after.written_cords(element).map(|(jack, _)| jack).collect();
        let mut emptied = before.written_cords(element).filter(|(jack, _)| !jacks.contains(jack));
        if let Some((jack, _)) = emptied.next() {
            pulled.insert(element.clone(), jack.to_owned());
        }
    }
}

/// How many cords a jack takes: `Some(None)` for any number, `None` if there is no such jack.
fn jack_capacity(patch: &Patch, element: &str, jack: &str) -> Option<Option<usize>> {
    if let Some(entry) = patch.elements.get(element) {
        let (input, _) = entry.kind.input(jack)?;
        return Some(wiring::capacity(entry.kind.inputs[input].jacks));
    }
    let definition = patch.macros.get(&patch.instances.get(element)?.macro_name)?;
    definition.inputs.contains_key(jack).then_some(Some(1))
}
