//! Macros and their instances, read off the tree of the text.

use std::collections::HashSet;

use indexmap::IndexMap;

use super::{Item, Macro, MacroOutput, MacroSetting, Macros, Use};
use crate::document::fields::{Fields, Findings, word, words};
use crate::document::tree::{self, Content, Node};
use crate::document::{Code, Diagnostic, Placed, Span, formula, suggestion};
use crate::elements::{self, Family};
use crate::patch::decode::unit;
use crate::patch::decode_entry::entry;
use patchcord_expr::nearest;

/// Keys that an instance has beside its ports and settings.
pub(super) const KEYS: [&str; 3] = ["kind", "note", "uses"];

/// The macros of a document, all their ports first: elements inside one may be instances of another.
pub(in crate::patch) fn read(fields: &mut Fields<'_>, findings: &mut Findings) -> Macros {
    let (mut macros, mut bodies) = (Macros::default(), Vec::new());
    macros.section_lost = is_section_lost(fields);
    let section = fields.rest().find(|entry| entry.key == "macros");
    macros.span = section.map_or(Span::default(), |section| section.value.span);
    fields.each("macros", findings, |named, findings| match header(named, findings) {
        Some((mut header, body)) => {
            if header.outputs.is_empty() || body.is_none() {
                macros.unusable.insert(named.key.clone());
                header.outputs.clear();
            }
            macros.defined.insert(named.key.clone(), header);
            bodies.extend(body.map(|body| (&named.key, body)));
        }
        None => drop(macros.lost.insert(named.key.clone())),
    });
    for (name, body) in bodies {
        let (items, lost) = macros.items(body, findings);
        let own = &mut macros.defined[name];
        (own.items, own.lost) = (items, lost);
    }
    macros
}

/// Whether the section is misspelled or no object, so that its macros are not there.
fn is_section_lost(fields: &Fields<'_>) -> bool {
    match fields.rest().find(|entry| entry.key == "macros") {
        Some(section) => !matches!(section.value.value, Content::Object(_)),
        None => fields.rest().any(|entry| nearest(&entry.key, ["macros"]).is_some()),
    }
}

/// Ports and settings of a macro, and the section of its elements.
fn header<'a>(named: &'a tree::Entry, findings: &mut Findings) -> Option<(Macro, Option<&'a Node>)> {
    let mut fields = Fields::of(&named.value, format!("the macro {}", named.key), findings)?;
    let mut header = Macro {
        note: fields.text("note", findings),
        inputs: IndexMap::new(),
        outputs: IndexMap::new(),
        settings: IndexMap::new(),
        span: named.key_span,
        items: IndexMap::new(),
        lost: HashSet::new(),
    };
    fields.each("inputs", findings, |port, findings| {
        let description = word(&port.value, &port.key, findings).map_or_else(String::new, |word| word.value);
        header.inputs.insert(port.key.clone(), Placed { value: description, span: port.key_span });
    });
    outputs(&mut fields, &mut header, findings);
    fields.each("settings", findings, |named, findings| {
        header.settings.insert(named.key.clone(), setting(named, findings));
    });
    let body = fields.need("elements", "what the macro is made of, as in the section \"elements\"");
    fields.finish(findings);
    Some((header, body))
}

/// Without an output nothing of a macro could be read.
fn outputs(fields: &mut Fields<'_>, header: &mut Macro, findings: &mut Findings) {
    let Some(node) = fields.need("outputs", OUTPUTS) else { return };
    let Some(ports) = Fields::of(node, "\"outputs\"", findings) else { return };
    for port in ports.rest() {
        let output = MacroOutput { at: word(&port.value, &port.key, findings), span: port.key_span };
        header.outputs.insert(port.key.clone(), output);
    }
    if header.outputs.is_empty() {
        let message = "a macro without an output is of no use";
        findings.push(Diagnostic::at(Code::MissingKey, node.span, message).hint(OUTPUTS));
    }
}

const OUTPUTS: &str = "name the ports and the element inside that each is, such as {\"out\": \"A1\"}";

fn setting(named: &tree::Entry, findings: &mut Findings) -> MacroSetting {
    let span = named.key_span;
    let lost = MacroSetting { unit: None, default: None, description: String::new(), span };
    let noun = format!("the setting {}", named.key);
    let Some(mut fields) = Fields::of(&named.value, noun, findings) else { return lost };
    let own = unit(&mut fields, findings);
    let written = fields.take("default");
    let default = written.and_then(|node| formula(node, "default", findings));
    let description = fields.text("description", findings);
    fields.text("note", findings);
    fields.finish(findings);
    // A default that could not be read is not one that is missing.
    let readable = written.is_some() == default.is_some();
    MacroSetting { unit: own.filter(|_| readable), default, description, span }
}

impl Macros {
    /// Reads one more macro, in place of the one of its name. Its elements may be instances of the others.
    pub(in crate::patch) fn define(&mut self, named: &tree::Entry, findings: &mut Findings) {
        let Some((header, body)) = header(named, findings) else { return };
        self.defined.insert(named.key.clone(), header);
        let Some(body) = body else { return };
        let (items, lost) = self.items(body, findings);
        let own = &mut self.defined[&named.key];
        (own.items, own.lost) = (items, lost);
    }

    /// The elements of a section, and the names of those that could not be read.
    fn items(&self, body: &Node, findings: &mut Findings) -> (IndexMap<String, Item>, HashSet<String>) {
        let (mut items, mut lost) = (IndexMap::new(), HashSet::new());
        let Some(fields) = Fields::of(body, "\"elements\"", findings) else { return (items, lost) };
        for named in fields.rest() {
            match self.item(named, findings) {
                Some(item) => drop(items.insert(named.key.clone(), item)),
                None => drop(lost.insert(named.key.clone())),
            }
        }
        (items, lost)
    }

    /// An element, or an instance of a macro where its kind is one.
    pub(in crate::patch) fn item(&self, named: &tree::Entry, findings: &mut Findings) -> Option<Item> {
        match kind_written(named).filter(|kind| elements::find(Family::Computing, &kind.value).is_none()) {
            Some(kind) if self.lost.contains(&kind.value) || self.section_lost => None,
            Some(kind) if self.defined.contains_key(&kind.value) => {
                self.instance(named, kind, findings).map(Item::Use)
            }
            Some(kind) if self.is_near(&kind.value) => {
                findings.push(self.unknown(&kind));
                None
            }
            _ => entry(named, Family::Computing, findings).map(Item::Element),
        }
    }

    /// Whether a kind that is none may be meant for a macro.
    fn is_near(&self, kind: &str) -> bool {
        nearest(kind, self.defined.keys().map(String::as_str)).is_some()
    }

    fn unknown(&self, kind: &Placed<String>) -> Diagnostic {
        let mut known: Vec<&str> = self.defined.keys().map(String::as_str).collect();
        known.extend(elements::names(Family::Computing));
        let message = format!("there is no kind \"{}\" of element, nor a macro of that name", kind.value);
        Diagnostic::at(Code::UnknownKind, kind.span, message).maybe_hint(suggestion(&kind.value, &known))
    }

    fn instance(&self, named: &tree::Entry, of: Placed<String>, findings: &mut Findings) -> Option<Use> {
        let noun = format!("{} (macro {})", named.key, of.value);
        let mut fields = Fields::of(&named.value, noun.as_str(), findings)?;
        let header = &self.defined[&of.value];
        fields.take("kind");
        let note = fields.text("note", findings);
        let (cords, settings) = (IndexMap::new(), IndexMap::new());
        let mut made = Use { of, cords, settings, doubtful: false, note, span: named.key_span };
        for entry in fields.rest() {
            if header.inputs.contains_key(&entry.key) {
                made.plug(entry, findings);
            } else if header.settings.contains_key(&entry.key) {
                made.settings.insert(entry.key.clone(), formula(&entry.value, &entry.key, findings));
            } else {
                made.doubtful = true;
                findings.push(unknown_key(header, &noun, entry));
            }
        }
        Some(made)
    }
}

impl Use {
    fn plug(&mut self, port: &tree::Entry, findings: &mut Findings) {
        let reported = findings.len();
        let cords = words(&port.value, &port.key, findings);
        self.doubtful |= findings.len() > reported;
        self.cords.insert(port.key.clone(), Placed { value: cords, span: port.value.span });
    }
}

fn unknown_key(header: &Macro, noun: &str, entry: &tree::Entry) -> Diagnostic {
    let known: Vec<&str> = header.inputs.keys().chain(header.settings.keys()).map(String::as_str).collect();
    let hint = match suggestion(&entry.key, &known) {
        Some(hint) => hint,
        None => "the macro has neither inputs nor settings".to_owned(),
    };
    let message = format!("\"{}\" is no input and no setting of {noun}", entry.key);
    Diagnostic::at(Code::UnknownKey, entry.key_span, message).hint(hint)
}

/// The kind that an entry names.
fn kind_written(named: &tree::Entry) -> Option<Placed<String>> {
    let Content::Object(entries) = &named.value.value else { return None };
    let kind = entries.iter().find(|entry| entry.key == "kind")?;
    let Content::Text(text) = &kind.value.value else { return None };
    Some(Placed { value: text.clone(), span: kind.value.span })
}
