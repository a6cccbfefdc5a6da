//! Decodes macros and their instances.
//!
//! The ports and settings of all macros are decoded before any of their elements. An element inside one macro can
//! therefore be an instance of any other. The keys of an instance are the ports and settings of its macro, so an
//! instance can be decoded only if its macro is known.
//!
//! ```text
//! "macros": {"decay": {
//!   "inputs": {"in": "the voltage that decays"},
//!   "outputs": {"out": "A"},
//!   "settings": {"start": {"unit": "V", "default": 50}},
//!   "elements": {"A": {"kind": "integrator", "in": {"x1": ["in", "A"]}, "initial": "start"}}
//! }},
//! "elements": {"D1": {"kind": "decay", "in": "+100", "start": 20}}
//! ```

use std::collections::HashSet;

use indexmap::IndexMap;

use super::{InstanceEntry, Macro, MacroOutput, MacroSetting, Macros, SectionEntry};
use crate::document::fields::{Fields, Findings, string};
use crate::document::tree::{self, Content, Node};
use crate::document::{Code, Diagnostic, Placed, Span, formula, suggestion};
use crate::elements::{self, Family};
use crate::patch::decode::unit;
use crate::patch::decode_entry::{cords, element_entry};
use patchcord_expr::nearest;

/// Keys that every instance may have in addition to its ports and settings.
pub(super) const INSTANCE_KEYS: [&str; 3] = ["kind", "note", "uses"];

/// Decodes the section "macros" of a document.
///
/// A macro without outputs or without elements is kept, but marked as unusable.
pub(in crate::patch) fn decode_macros(fields: &mut Fields<'_>, findings: &mut Findings) -> Macros {
    let (mut macros, mut bodies) = (Macros::default(), Vec::new());
    macros.is_section_unread = is_section_unread(fields);
    let section = fields.remaining().find(|entry| entry.key == "macros");
    macros.span = section.map_or(Span::default(), |section| section.value.span);
    fields.each("macros", findings, |entry, findings| match header(entry, findings) {
        Some((mut header, body)) => {
            if header.outputs.is_empty() || body.is_none() {
                macros.unusable.insert(entry.key.clone());
                header.outputs.clear();
            }
            macros.defined.insert(entry.key.clone(), header);
            bodies.extend(body.map(|body| (&entry.key, body)));
        }
        None => drop(macros.unread.insert(entry.key.clone())),
    });
    for (name, body) in bodies {
        let (entries, unread) = macros.section_entries(body, findings);
        let definition = &mut macros.defined[name];
        (definition.entries, definition.unread) = (entries, unread);
    }
    macros
}

/// Whether the section "macros" could not be read: it is not an object, or its key is misspelled.
fn is_section_unread(fields: &Fields<'_>) -> bool {
    match fields.remaining().find(|entry| entry.key == "macros") {
        Some(section) => !matches!(section.value.value, Content::Object(_)),
        None => fields.remaining().any(|entry| nearest(&entry.key, ["macros"]).is_some()),
    }
}

/// Decodes the ports and settings of a macro. Returns the macro without its elements, and the node with the elements.
///
/// The elements are decoded later, when all macros are known.
fn header<'a>(entry: &'a tree::KeyValue, findings: &mut Findings) -> Option<(Macro, Option<&'a Node>)> {
    let mut fields = Fields::of(&entry.value, format!("the macro {}", entry.key), findings)?;
    let mut header = Macro {
        note: fields.text("note", findings),
        inputs: IndexMap::new(),
        outputs: IndexMap::new(),
        settings: IndexMap::new(),
        span: entry.key_span,
        entries: IndexMap::new(),
        unread: HashSet::new(),
    };
    fields.each("inputs", findings, |port, findings| {
        let description =
            string(&port.value, &port.key, findings).map_or_else(String::new, |word| word.value);
        header.inputs.insert(port.key.clone(), Placed { value: description, span: port.key_span });
    });
    outputs(&mut fields, &mut header, findings);
    fields.each("settings", findings, |entry, findings| {
        header.settings.insert(entry.key.clone(), setting(entry, findings));
    });
    let body =
        fields.require("elements", "the elements of the macro, in the form of the section \"elements\"");
    fields.finish(findings);
    Some((header, body))
}

/// Decodes the output ports of a macro. At least one is required, because a macro without outputs has no effect.
fn outputs(fields: &mut Fields<'_>, header: &mut Macro, findings: &mut Findings) {
    let Some(node) = fields.require("outputs", OUTPUTS_HINT) else { return };
    let Some(ports) = Fields::of(node, "\"outputs\"", findings) else { return };
    for port in ports.remaining() {
        let output = MacroOutput { element: string(&port.value, &port.key, findings), span: port.key_span };
        header.outputs.insert(port.key.clone(), output);
    }
    if header.outputs.is_empty() {
        let message = "a macro needs at least one output";
        findings.push(Diagnostic::at(Code::MISSING_KEY, node.span, message).hint(OUTPUTS_HINT));
    }
}

/// The hint for missing outputs.
const OUTPUTS_HINT: &str = "name the ports and the element of each port, such as {\"out\": \"A1\"}";

/// Decodes a setting of a macro. If a part cannot be read, the setting is kept without a unit.
fn setting(entry: &tree::KeyValue, findings: &mut Findings) -> MacroSetting {
    let span = entry.key_span;
    let unread = MacroSetting { unit: None, default: None, description: String::new(), span };
    let noun = format!("the setting {}", entry.key);
    let Some(mut fields) = Fields::of(&entry.value, noun, findings) else { return unread };
    let unit = unit(&mut fields, findings);
    let default_node = fields.take("default");
    let default = default_node.and_then(|node| formula(node, "default", findings));
    let description = fields.text("description", findings);
    fields.text("note", findings);
    fields.finish(findings);
    // A default that could not be read is not a missing default: instances need not specify the setting.
    let is_readable = default_node.is_some() == default.is_some();
    MacroSetting { unit: unit.filter(|_| is_readable), default, description, span }
}

impl Macros {
    /// Decodes a macro and adds it, or replaces the macro with its name. Its elements may be instances of the others.
    pub(in crate::patch) fn define(&mut self, entry: &tree::KeyValue, findings: &mut Findings) {
        let Some((header, body)) = header(entry, findings) else { return };
        self.defined.insert(entry.key.clone(), header);
        let Some(body) = body else { return };
        let (entries, unread) = self.section_entries(body, findings);
        let definition = &mut self.defined[&entry.key];
        (definition.entries, definition.unread) = (entries, unread);
    }

    /// Decodes the section "elements" of a macro. Returns the entries, and the names of those that could not be read.
    fn section_entries(
        &self,
        body: &Node,
        findings: &mut Findings,
    ) -> (IndexMap<String, SectionEntry>, HashSet<String>) {
        let (mut entries, mut unread) = (IndexMap::new(), HashSet::new());
        let Some(fields) = Fields::of(body, "\"elements\"", findings) else { return (entries, unread) };
        for source in fields.remaining() {
            match self.section_entry(source, findings) {
                Some(entry) => drop(entries.insert(source.key.clone(), entry)),
                None => drop(unread.insert(source.key.clone())),
            }
        }
        (entries, unread)
    }

    /// Decodes an element, or an instance if the kind is the name of a macro. `None` if it cannot be read.
    ///
    /// No fault is reported for a kind that may be an unread macro. A kind that resembles the name of a macro gets a
    /// suggestion.
    pub(in crate::patch) fn section_entry(
        &self,
        source: &tree::KeyValue,
        findings: &mut Findings,
    ) -> Option<SectionEntry> {
        match written_kind(source).filter(|kind| elements::find(Family::Computing, &kind.value).is_none()) {
            Some(kind) if self.unread.contains(&kind.value) || self.is_section_unread => None,
            Some(kind) if self.defined.contains_key(&kind.value) => {
                self.instance_entry(source, kind, findings).map(SectionEntry::Instance)
            }
            Some(kind) if self.is_similar_to_macro(&kind.value) => {
                findings.push(self.unknown_kind(&kind));
                None
            }
            _ => element_entry(source, Family::Computing, findings).map(SectionEntry::Element),
        }
    }

    /// Whether an unknown kind is probably a misspelled name of a macro.
    fn is_similar_to_macro(&self, kind: &str) -> bool {
        nearest(kind, self.defined.keys().map(String::as_str)).is_some()
    }

    /// The diagnostic for an unknown kind, with a suggestion among macros and kinds.
    fn unknown_kind(&self, kind: &Placed<String>) -> Diagnostic {
        let mut candidates: Vec<&str> = self.defined.keys().map(String::as_str).collect();
        candidates.extend(elements::names(Family::Computing));
        let message = format!("there is no kind \"{}\" of element, nor a macro of that name", kind.value);
        Diagnostic::at(Code::UNKNOWN_KIND, kind.span, message)
            .maybe_hint(suggestion(&kind.value, &candidates))
    }

    /// Decodes an instance of a macro, whose keys are the ports and settings of the macro.
    fn instance_entry(
        &self,
        source: &tree::KeyValue,
        macro_name: Placed<String>,
        findings: &mut Findings,
    ) -> Option<InstanceEntry> {
        let noun = format!("{} (macro {})", source.key, macro_name.value);
        let mut fields = Fields::of(&source.value, noun.as_str(), findings)?;
        let definition = &self.defined[&macro_name.value];
        fields.take("kind");
        let note = fields.text("note", findings);
        let (cords, settings) = (IndexMap::new(), IndexMap::new());
        let span = source.key_span;
        let mut instance = InstanceEntry { macro_name, cords, settings, is_incomplete: false, note, span };
        for entry in fields.remaining() {
            if definition.inputs.contains_key(&entry.key) {
                instance.plug_port(entry, findings);
            } else if definition.settings.contains_key(&entry.key) {
                instance.settings.insert(entry.key.clone(), formula(&entry.value, &entry.key, findings));
            } else {
                instance.is_incomplete = true;
                findings.push(unknown_key(definition, &noun, entry));
            }
        }
        Some(instance)
    }
}

impl InstanceEntry {
    /// Decodes the cords into an input port.
    fn plug_port(&mut self, port: &tree::KeyValue, findings: &mut Findings) {
        let findings_before = findings.len();
        let cords = cords(&port.value, &port.key, findings);
        self.is_incomplete |= findings.len() > findings_before;
        self.cords.insert(port.key.clone(), Placed { value: cords, span: port.value.span });
    }
}

/// The diagnostic for a key of an instance that is neither a port nor a setting of its macro.
fn unknown_key(definition: &Macro, noun: &str, entry: &tree::KeyValue) -> Diagnostic {
    let ports_then_settings = definition.inputs.keys().chain(definition.settings.keys());
    let candidates: Vec<&str> = ports_then_settings.map(String::as_str).collect();
    let hint = match suggestion(&entry.key, &candidates) {
        Some(hint) => hint,
        None => "the macro has neither inputs nor settings".to_owned(),
    };
    let message = format!("\"{}\" is neither an input nor a setting of {noun}", entry.key);
    Diagnostic::at(Code::UNKNOWN_KEY, entry.key_span, message).hint(hint)
}

/// The text under the key "kind" of an entry. `None` if there is no such text; nothing is reported.
fn written_kind(entry: &tree::KeyValue) -> Option<Placed<String>> {
    let Content::Object(entries) = &entry.value.value else { return None };
    let kind = entries.iter().find(|entry| entry.key == "kind")?;
    let Content::Text(text) = &kind.value.value else { return None };
    Some(Placed { value: text.clone(), span: kind.value.span })
}
