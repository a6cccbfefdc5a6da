//! Decodes elements and drives.
//!
//! The kind decides which keys an entry has, so the kind is decoded first. Cords, settings and groups of settings such
//! as "limit" follow. A setting that refers to a CSV file is only noted here; `table_file` reads the file later.
//!
//! ```text
//! "A1": {"kind": "summer", "in": {"x1": ["D", "P2"]}, "limit": {"upper": 20}}
//! "P2": {"kind": "pot", "in": "A1", "setting": "k / m", "uses": {"fixed_pots": ["P7"]}}
//! ```

use super::cord_faults::{not_a_name, number_at_unknown_jack};
use super::decode_curve::{Symmetry, curve, time_points};
use super::document::{Amount, ElementEntry, Plug};
use super::short_forms::entry_hint;
use super::table_file::{self, TablePurpose};
use crate::document::fields::{Fields, Findings, flag, string, strings};
use crate::document::tree::{self, Content, Node};
use crate::document::{Code, Diagnostic, Placed, Span, formula_in, suggestion};
use crate::elements::{self, Family, Kind, Setting, SettingDefault, SettingQuantity};
use crate::machines::Part;

/// The unit of a drive's signal and that of its rate, as hints describe them.
#[derive(Clone, Copy)]
pub(super) struct SignalUnits<'a> {
    /// The unit of the signal.
    pub value: &'a str,
    /// The unit of the signal per second.
    pub rate: &'a str,
}

/// The units of a signal with a scale. Elements have no settings in these units.
pub(super) const UNITS_OF_SCALE: SignalUnits<'static> =
    SignalUnits { value: SettingQuantity::Signal.unit(), rate: SettingQuantity::SignalRate.unit() };

impl<'a> SignalUnits<'a> {
    /// The unit of a setting of this quantity, or the form of its value, in words.
    fn of(self, quantity: SettingQuantity) -> &'a str {
        match quantity {
            SettingQuantity::Signal => self.value,
            SettingQuantity::SignalRate => self.rate,
            _ => quantity.unit(),
        }
    }
}

/// Decodes an element or a drive. `None` if its kind cannot be read.
///
/// An element and a drive differ in two keys: only a drive has "scale", and only an element has "uses".
pub(super) fn element_entry(
    source: &tree::KeyValue,
    family: Family,
    findings: &mut Findings,
) -> Option<ElementEntry> {
    entry_with(source, family, UNITS_OF_SCALE, findings, |fields, entry, findings| match family {
        Family::Drive => {
            let scale = fields.require("scale", "the scale of the drive's output");
            entry.scale = scale.and_then(|node| string(node, "scale", findings));
        }
        _ => {
            entry.machine_parts =
                fields.take("uses").map(|node| machine_parts(node, findings)).unwrap_or_default();
        }
    })
}

/// Decodes the keys that all elements and drives have, and then those that `decode_other_keys` takes. `None` if the kind
/// cannot be read. Hints about settings name the `units` of the signal.
///
/// A key that is left over may be a misspelled jack, so the entry then counts as incomplete.
pub(super) fn entry_with(
    source: &tree::KeyValue,
    family: Family,
    units: SignalUnits<'_>,
    findings: &mut Findings,
    decode_other_keys: impl FnOnce(&mut Fields<'_>, &mut ElementEntry, &mut Findings),
) -> Option<ElementEntry> {
    let noun = format!("the {} {}", family_noun(family), source.key);
    let mut fields = Fields::of_with_hint(&source.value, noun, entry_hint(source, family), findings)?;
    let kind = kind(&mut fields, family, findings)?;
    let mut entry = ElementEntry {
        kind,
        plugs: Vec::new(),
        empty_jacks: Vec::new(),
        is_incomplete: false,
        settings: vec![None; kind.settings.len()],
        table_files: Vec::new(),
        machine_parts: Vec::new(),
        scale: None,
        note: fields.text("note", findings),
        span: source.key_span,
    };
    plugs(&mut fields, &mut entry, findings);
    settings(&mut fields, "", units, &mut entry, findings);
    for group in setting_groups(kind) {
        if let Some(node) = fields.take(group)
            && let Some(mut inner) = Fields::of(node, format!("\"{group}\""), findings)
        {
            let group = format!("{group}.");
            settings(&mut inner, &group, units, &mut entry, findings);
            inner.finish_with_advice(&|key| elements::key_advice(kind, &group, key), findings);
        }
    }
    decode_other_keys(&mut fields, &mut entry, findings);
    entry.is_incomplete |= fields.remaining().next().is_some();
    fields.finish_with_advice(&|key| elements::key_advice(kind, "", key), findings);
    Some(entry)
}

/// Decodes the required key "kind". A kind of the other family gets a hint about the section.
fn kind(fields: &mut Fields<'_>, family: Family, findings: &mut Findings) -> Option<&'static Kind> {
    let Some(node) = fields.require("kind", &format!("one of {}", elements::names(family).join(", "))) else {
        // The permitted keys depend on the kind. Without it, only the missing kind is reported.
        fields.report_missing(findings);
        return None;
    };
    let name = string(node, "kind", findings)?;
    let kind = elements::find(family, &name.value);
    if kind.is_none() {
        let message = format!("there is no kind \"{}\" of {}", name.value, family_noun(family));
        let hint = elements::kind_hint(family, &name.value)
            .or_else(|| suggestion(&name.value, &elements::names(family)));
        findings.push(Diagnostic::at(Code::UNKNOWN_KIND, node.span, message).maybe_hint(hint));
    }
    kind
}

/// The name of a family in messages.
fn family_noun(family: Family) -> &'static str {
    if family == Family::Drive { "drive" } else { "element" }
}

/// Decodes the cords of an element.
///
/// The cords of an amplifier are in the object "in", by jack: `"in": {"x1": ["A1"], "x10": ["P2"]}`. Other elements
/// have a key for each input: `"in": "A1"`.
fn plugs(fields: &mut Fields<'_>, entry: &mut ElementEntry, findings: &mut Findings) {
    if entry.kind.has_gains() {
        if let Some(node) = fields.take("in") {
            jacks(node, entry, findings);
        }
        return;
    }
    for input in entry.kind.inputs {
        match fields.take_with_key(input.name) {
            // Jacks with gains on an element without gains are decoded too, so that each of them is reported later.
            Some((_, node)) if matches!(node.value, Content::Object(_)) => jacks(node, entry, findings),
            Some((key_span, node)) => plug(input.name, key_span, node, entry, findings),
            None => {}
        }
    }
}

/// Decodes an object of jacks, each with a cord or a list of cords.
fn jacks(node: &Node, entry: &mut ElementEntry, findings: &mut Findings) {
    if !matches!(node.value, Content::Object(_)) {
        let message = "an amplifier's cords go to inputs with gains";
        findings.push(Diagnostic::at(Code::WRONG_TYPE, node.span, message).hint(bare_cords_hint(node)));
        entry.is_incomplete = true;
        return;
    }
    let Some(jacks) = Fields::of(node, "\"in\"", findings) else { return };
    for jack in jacks.remaining() {
        match number_at_unknown_jack(entry.kind, jack) {
            Some(finding) => {
                findings.push(finding);
                entry.is_incomplete = true;
            }
            None => plug(&jack.key, jack.key_span, &jack.value, entry, findings),
        }
    }
}

/// The hint for cords without the names of their inputs: the same cords at the input with gain 1.
fn bare_cords_hint(node: &Node) -> String {
    let names = strings(node, "in", &mut Findings::new());
    let quoted: Vec<_> = names.iter().map(|name| format!("\"{}\"", name.value)).collect();
    let cords = if quoted.is_empty() { "\"A1\"".to_owned() } else { quoted.join(", ") };
    format!("write \"in\": {{\"x1\": [{cords}]}}, or another gain than 1 in the name, such as x10")
}

/// Decodes the cords of one jack: a name or a list of names.
///
/// Every cord gets the span of the jack's key. Later checks group the cords of a jack by it.
fn plug(jack: &str, jack_span: Span, node: &Node, entry: &mut ElementEntry, findings: &mut Findings) {
    let findings_before = findings.len();
    let jack = Placed { value: jack.to_owned(), span: jack_span };
    let cords = cords(node, &jack.value, findings);
    entry.is_incomplete |= findings.len() > findings_before;
    entry.plugs.extend(cords.into_iter().map(|from| Plug { jack: jack.clone(), from }));
    if matches!(&node.value, Content::List(items) if items.is_empty()) {
        entry.empty_jacks.push(Placed { value: jack.value, span: node.span });
    }
}

/// Decodes the cords into an input: the name of an output or a list of names. Other values are reported and left out.
pub(super) fn cords(node: &Node, input: &str, findings: &mut Findings) -> Vec<Placed<String>> {
    let items = match &node.value {
        Content::List(items) => items.as_slice(),
        _ => std::slice::from_ref(node),
    };
    items.iter().filter_map(|item| cord(item, input, findings)).collect()
}

/// Decodes the name of the output from which a cord into an input comes.
fn cord(node: &Node, input: &str, findings: &mut Findings) -> Option<Placed<String>> {
    match &node.value {
        Content::Text(name) => Some(Placed { value: name.clone(), span: node.span }),
        _ => {
            findings.push(not_a_name(node, input));
            None
        }
    }
}

/// The groups of settings of a kind: "limit" for "limit.lower" and "limit.upper". Each is an object in the document.
fn setting_groups(kind: &Kind) -> Vec<&'static str> {
    let mut groups: Vec<_> =
        kind.settings.iter().filter_map(|setting| Some(setting.name.split_once('.')?.0)).collect();
    groups.dedup();
    groups
}

/// Decodes the settings whose names consist of the prefix and a key of `fields`. The prefix is empty, or a group and a
/// dot.
fn settings(
    fields: &mut Fields<'_>,
    prefix: &str,
    units: SignalUnits<'_>,
    entry: &mut ElementEntry,
    findings: &mut Findings,
) {
    for (index, setting) in entry.kind.settings.iter().enumerate() {
        let Some(key) = setting.name.strip_prefix(prefix).filter(|key| !key.contains('.')) else { continue };
        let node = match setting.default {
            SettingDefault::Required => fields.require(key, &meaning(key, setting)),
            _ => fields.take(key),
        };
        let Some(node) = node else { continue };
        match table_purpose(setting.quantity, entry).filter(|_| matches!(node.value, Content::Object(_))) {
            Some(purpose) => {
                entry.table_files.extend(table_file::decode_table_file(node, index, purpose, findings));
            }
            None => entry.settings[index] = amount(node, key, (setting.quantity, units), entry, findings),
        }
    }
}

/// The meaning of a setting for the hint if it is missing. A choice lists its words.
fn meaning(key: &str, setting: &Setting) -> String {
    let SettingQuantity::Choice(words) = setting.quantity else { return setting.description.to_owned() };
    let written: Vec<_> = words.iter().map(|word| format!("\"{key}\": \"{word}\"")).collect();
    format!("{}: write {}", setting.description, written.join(" or "))
}

/// The purpose of the points of a setting. `None` if the setting does not consist of points.
fn table_purpose(quantity: SettingQuantity, entry: &ElementEntry) -> Option<TablePurpose> {
    match quantity {
        SettingQuantity::Points => Some(TablePurpose::Time),
        SettingQuantity::Curve(symmetry_setting) => {
            Some(TablePurpose::Curve(symmetry(entry, symmetry_setting)))
        }
        _ => None,
    }
}

/// Decodes the value of a setting. `None` after a report.
///
/// The settings before it, in the order of the kind, must have been decoded into `entry`: the checks of a curve depend
/// on its symmetry.
pub(super) fn amount(
    node: &Node,
    key: &str,
    (quantity, units): (SettingQuantity, SignalUnits<'_>),
    entry: &ElementEntry,
    findings: &mut Findings,
) -> Option<Placed<Amount>> {
    let value = match quantity {
        SettingQuantity::Flag => Amount::Flag(flag(node, key, findings)?),
        SettingQuantity::Choice(words) => Amount::Choice(choice(node, key, words, findings)?),
        SettingQuantity::Points => Amount::Points(time_points(node, key, findings)?),
        SettingQuantity::Curve(symmetry_setting) => {
            Amount::Points(curve(node, key, symmetry(entry, symmetry_setting), findings)?)
        }
        _ => Amount::Formula(formula_in(node, key, Some(units.of(quantity)), findings)?.value),
    };
    Some(Placed { value, span: node.span })
}

/// The symmetry of a curve, from the setting with this name. Its words are none, odd and even, in this order.
fn symmetry(entry: &ElementEntry, setting: &str) -> Symmetry {
    let chosen = entry.kind.setting(setting).and_then(|index| entry.settings[index].as_ref());
    match chosen.map(|placed| &placed.value) {
        Some(Amount::Choice(1)) => Symmetry::Odd,
        Some(Amount::Choice(2)) => Symmetry::Even,
        _ => Symmetry::None,
    }
}

/// Decodes one of several words. Returns the index of the word.
fn choice(node: &Node, key: &str, permitted: &[&'static str], findings: &mut Findings) -> Option<usize> {
    let chosen = string(node, key, findings)?;
    let index = permitted.iter().position(|word| *word == chosen.value);
    if index.is_none() {
        let message = format!("\"{}\" is not a value of \"{key}\"", chosen.value);
        let meant = elements::meant_word(&chosen.value, permitted);
        let hint = meant
            .map(|word| format!("write \"{key}\": \"{word}\""))
            .or_else(|| suggestion(&chosen.value, permitted));
        findings.push(Diagnostic::at(Code::UNKNOWN_NAME, node.span, message).maybe_hint(hint));
    }
    index
}

/// Decodes the object "uses": the names of the machine's parts that an element uses, by key of the part.
fn machine_parts(node: &Node, findings: &mut Findings) -> Vec<(Placed<String>, Vec<Placed<String>>)> {
    let Some(fields) = Fields::of(node, "\"uses\"", findings) else { return Vec::new() };
    let mut parts = Vec::new();
    for item in fields.remaining() {
        if !Part::ALL.iter().any(|part| part.key() == item.key) {
            let keys: Vec<_> = Part::ALL.iter().map(|part| part.key()).collect();
            let message = format!("no machine has \"{}\"", item.key);
            let hint = suggestion(&item.key, &keys);
            findings.push(Diagnostic::at(Code::UNKNOWN_KEY, item.key_span, message).maybe_hint(hint));
            continue;
        }
        let names = strings(&item.value, &item.key, findings);
        parts.push((Placed { value: item.key.clone(), span: item.key_span }, names));
    }
    parts
}
