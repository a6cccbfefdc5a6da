//! Writing macros out: every instance becomes its elements, named "L1.A1".

use std::collections::HashMap;

use indexmap::IndexMap;

use super::check::{check, unused};
use super::outline::{Meaning, Section};
use super::{Feed, Instance, Item, Macros, Port};
use crate::document::fields::Findings;
use crate::document::file::LARGEST;
use crate::document::{Code, Diagnostic, Phase, Placed, Span, any_error};
use crate::patch::document::{Amount, Entry, Patch, Plug};
use crate::patch::names::same_name;
use crate::patch::table_file::TableFile;
use patchcord_expr::Formula;

/// Puts the elements of a document into the patch, instances of macros written out.
pub(in crate::patch) fn write_out(
    mut macros: Macros,
    items: &IndexMap<String, Item>,
    patch: &mut Patch,
    findings: &mut Findings,
) {
    macros.order(findings);
    check(&mut macros, items, patch, findings);
    let Written { elements, instances, ports, lost, full, .. } = Written::of(&macros, items, patch, findings);
    if !any_error(findings) {
        unused(&macros, items, findings);
    }
    (patch.elements, patch.instances, patch.ports) = (elements, instances, ports);
    patch.lost.names.extend(lost);
    patch.lost.section |= full;
    (patch.macros, patch.macros_at) = (macros.defined, macros.span);
    read_ports(patch);
}

/// What is read at a port is read at the element that it is.
fn read_ports(patch: &mut Patch) {
    let Patch { signals, record, pictures, run, ports, .. } = patch;
    let element = |name: &mut Placed<String>| {
        if let Some(port) = ports.get(&name.value) {
            name.value.clone_from(&port.at);
        }
    };
    let is_no_signal = |name: &&mut Placed<String>| !signals.contains_key(&name.value);
    record.iter_mut().filter(is_no_signal).for_each(element);
    for picture in pictures {
        picture.y.iter_mut().chain([&mut picture.x]).filter(is_no_signal).for_each(element);
    }
    signals.values_mut().map(|signal| &mut signal.at).for_each(element);
    run.phases.iter_mut().flat_map(relays).for_each(element);
}

/// The names of the relays that a phase waits for.
fn relays(phase: &mut Phase) -> Vec<&mut Placed<String>> {
    match phase {
        Phase::Operate { until: Some(until), .. } => vec![&mut until.relay],
        Phase::Repeat { phases, .. } => phases.iter_mut().flat_map(relays).collect(),
        _ => Vec::new(),
    }
}

/// A section being written out: that of an instance, or the patch's own.
pub(super) struct Frame<'m> {
    /// What the names of its elements begin with: "L1.".
    pub prefix: String,
    pub section: Section<'m>,
    /// What drives the input ports.
    pub drivers: HashMap<&'m str, Option<String>>,
    /// Where the outermost instance stands.
    pub span: Option<Span>,
}

impl<'m> Frame<'m> {
    /// The name of the instance.
    pub fn name(&self) -> &str {
        self.prefix.strip_suffix('.').unwrap_or_default()
    }

    /// The element, drive or reference that a cord comes from.
    pub fn driver(&self, cord: &str) -> Option<String> {
        match self.section.meaning(cord) {
            Meaning::Outlet(outlet) => Some(format!("{}{outlet}", self.prefix)),
            Meaning::Source => Some(cord.to_owned()),
            Meaning::Input => self.drivers.get(cord).cloned().flatten(),
            _ => None,
        }
    }

    /// The input port that a cord comes from.
    pub fn port(&self, cord: &str) -> Option<&'m str> {
        self.drivers.get_key_value(cord).map(|(port, _)| *port)
    }

    /// A formula in the names of the whole patch: settings of the macro become those of the instance.
    pub fn formula(&self, formula: &Formula) -> Formula {
        match self.section.of {
            Some((_, of)) => formula
                .renamed(&|name| of.settings.contains_key(name).then(|| format!("{}{name}", self.prefix))),
            None => formula.clone(),
        }
    }

    /// The same at its place.
    pub fn placed(&self, formula: &Placed<Formula>) -> Placed<Formula> {
        Placed { value: self.formula(&formula.value), span: formula.span }
    }
}

/// For every port of a section, the jacks that it feeds.
pub(super) type Feeds = HashMap<String, Vec<Feed>>;

/// What has been written out so far.
pub(super) struct Written<'p> {
    pub elements: IndexMap<String, Entry>,
    pub instances: IndexMap<String, Instance>,
    pub ports: IndexMap<String, Port>,
    /// Names that could not be written out.
    pub lost: Vec<String>,
    pub patch: &'p Patch,
    /// Bytes that macros may still be written out to: together as many as a document may have.
    room: usize,
    full: bool,
}

/// What an element or a port takes beside its names, in bytes.
pub(super) const OVERHEAD: usize = 50;
/// What a point of a table takes, in bytes.
const POINT: usize = 32;

impl<'p> Written<'p> {
    fn of(
        macros: &Macros,
        items: &IndexMap<String, Item>,
        patch: &'p Patch,
        findings: &mut Findings,
    ) -> Self {
        let section = Section { items, of: None, lost: &patch.lost.names, macros, drives: &patch.drives };
        let outside = Frame { prefix: String::new(), section, drivers: HashMap::new(), span: None };
        let mut written = Written {
            elements: IndexMap::new(),
            instances: IndexMap::new(),
            ports: IndexMap::new(),
            lost: Vec::new(),
            patch,
            room: LARGEST,
            full: false,
        };
        written.section(&outside, findings);
        written
    }

    /// The elements of a section: their names, and what its ports feed.
    pub fn section(&mut self, frame: &Frame<'_>, findings: &mut Findings) -> (Vec<String>, Feeds) {
        let (mut members, mut feeds) = (Vec::new(), Feeds::new());
        for (name, item) in frame.section.items {
            let flat = format!("{}{name}", frame.prefix);
            if self.full || self.is_taken(&flat, item, findings) {
                continue;
            }
            match item {
                Item::Element(entry) => {
                    self.element(frame, &flat, entry, &mut feeds, findings);
                    members.push(flat);
                }
                Item::Use(made) => members.extend(self.instance(frame, &flat, made, &mut feeds, findings)),
            }
        }
        if !frame.prefix.is_empty() {
            for name in frame.section.lost {
                self.lose(format!("{}{name}", frame.prefix), frame, findings);
            }
        }
        (members, feeds)
    }

    fn is_taken(&self, flat: &str, item: &Item, findings: &mut Findings) -> bool {
        let taken = self.elements.contains_key(flat) || self.ports.contains_key(flat);
        findings.extend(taken.then(|| same_name(flat, item.span(), "element", "element")));
        taken
    }

    fn element(
        &mut self,
        frame: &Frame<'_>,
        flat: &str,
        entry: &Entry,
        feeds: &mut Feeds,
        findings: &mut Findings,
    ) {
        let mut own = Entry { plugs: Vec::new(), ..entry.clone() };
        for Plug { jack, from } in &entry.plugs {
            let Some(driver) = self.driver(frame, from, findings) else {
                own.doubtful = true;
                continue;
            };
            if let Some(port) = frame.port(&from.value) {
                let feed = Feed { element: flat.to_owned(), jack: jack.value.clone() };
                feeds.entry(port.to_owned()).or_default().push(feed);
            }
            let from = Placed { value: driver, span: from.span };
            own.plugs.push(Plug { jack: jack.clone(), from });
        }
        for setting in own.settings.iter_mut().flatten() {
            if let Amount::Formula(formula) = &mut setting.value {
                *formula = frame.formula(formula);
            }
        }
        self.spend(flat.len() + size(&own), frame, findings);
        self.elements.insert(flat.to_owned(), own);
    }

    /// What drives a jack of an element. Outside of all macros a name that is not known stays as it is: it is told
    /// when cords are plugged in.
    fn driver(&self, frame: &Frame<'_>, cord: &Placed<String>, findings: &mut Findings) -> Option<String> {
        match frame.section.meaning(&cord.value) {
            Meaning::Inside(inside) if frame.span.is_none() => {
                findings.push(inside.told(cord));
                None
            }
            Meaning::Unknown | Meaning::Lost if frame.span.is_none() => Some(cord.value.clone()),
            _ => frame.driver(&cord.value),
        }
    }

    /// Notes a name that cannot be written out.
    pub fn lose(&mut self, name: String, frame: &Frame<'_>, findings: &mut Findings) {
        self.spend(name.len(), frame, findings);
        self.lost.push(name);
    }

    /// Takes bytes of an instance from the room that is left; nothing more is written once it is full.
    pub fn spend(&mut self, bytes: usize, frame: &Frame<'_>, findings: &mut Findings) {
        let Some(span) = frame.span.filter(|_| !self.full) else { return };
        match self.room.checked_sub(bytes + OVERHEAD) {
            Some(room) => self.room = room,
            None => {
                let message = format!(
                    "the macros of the patch make more than {} MB when written out",
                    LARGEST / 1_000_000
                );
                findings.push(Diagnostic::at(Code::MacroTooLarge, span, message));
                self.full = true;
            }
        }
    }
}

/// Bytes of an element's note, cords, parts, formulas, points and files.
fn size(entry: &Entry) -> usize {
    let plugs = entry.plugs.iter().map(|plug| plug.jack.value.len() + plug.from.value.len());
    let empty = entry.empty_jacks.iter().map(|jack| jack.value.len() + OVERHEAD);
    let parts = entry.uses.iter().flat_map(|(_, names)| names).map(|name| name.value.len() + OVERHEAD);
    let settings = entry.settings.iter().flatten().map(|setting| match &setting.value {
        Amount::Formula(formula) => formula.text().len(),
        Amount::Points(points) => POINT * points.len(),
        _ => 0,
    });
    let files = entry.files.iter().map(TableFile::size);
    entry.note.len() + plugs.chain(empty).chain(parts).chain(settings).chain(files).sum::<usize>()
}
