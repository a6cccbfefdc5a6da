//! Elements and drives, read off the tree of the text.

use super::decode_curve::{Mirror, curve, points};
use super::document::{Amount, Entry, Plug};
use super::table_file::{self, Purpose};
use crate::document::fields::{Fields, Findings, flag, word, words};
use crate::document::tree::{self, Content, Node};
use crate::document::{Code, Diagnostic, Placed, Span, formula, suggestion};
use crate::elements::{self, Default, Family, Jacks, Kind, Measure};
use crate::machines::Part;

pub(super) fn entry(named: &tree::Entry, family: Family, findings: &mut Findings) -> Option<Entry> {
    let noun = format!("the {} {}", family_noun(family), named.key);
    let mut fields = Fields::of(&named.value, noun, findings)?;
    let kind = kind(&mut fields, family, findings)?;
    let mut entry = Entry {
        kind,
        plugs: Vec::new(),
        empty_jacks: Vec::new(),
        doubtful: false,
        settings: vec![None; kind.settings.len()],
        files: Vec::new(),
        uses: Vec::new(),
        scale: None,
        note: fields.text("note", findings),
        span: named.key_span,
    };
    plugs(&mut fields, &mut entry, findings);
    settings(&mut fields, "", &mut entry, findings);
    for group in setting_groups(kind) {
        if let Some(node) = fields.take(group)
            && let Some(mut inner) = Fields::of(node, format!("\"{group}\""), findings)
        {
            settings(&mut inner, &format!("{group}."), &mut entry, findings);
            inner.finish(findings);
        }
    }
    if family == Family::Drive {
        let scale = fields.need("scale", "the scale of what the drive gives");
        entry.scale = scale.and_then(|node| word(node, "scale", findings));
    } else {
        entry.uses = fields.take("uses").map(|node| uses(node, findings)).unwrap_or_default();
    }
    entry.doubtful |= fields.rest().next().is_some();
    fields.finish(findings);
    Some(entry)
}

fn kind(fields: &mut Fields<'_>, family: Family, findings: &mut Findings) -> Option<&'static Kind> {
    let Some(node) = fields.need("kind", &format!("one of {}", elements::names(family).join(", "))) else {
        // Which keys it may have depends on the kind: only this one can be missed.
        fields.report_missing(findings);
        return None;
    };
    let name = word(node, "kind", findings)?;
    let found = elements::find(family, &name.value);
    if found.is_none() {
        let message = format!("there is no kind \"{}\" of {}", name.value, family_noun(family));
        let hint =
            misplaced(family, &name.value).or_else(|| suggestion(&name.value, &elements::names(family)));
        findings.push(Diagnostic::at(Code::UnknownKind, node.span, message).maybe_hint(hint));
    }
    found
}

fn family_noun(family: Family) -> &'static str {
    if family == Family::Drive { "drive" } else { "element" }
}

fn misplaced(family: Family, name: &str) -> Option<String> {
    let (other, section) =
        if family == Family::Drive { (Family::Computing, "elements") } else { (Family::Drive, "drives") };
    elements::find(other, name).map(|_| format!("a \"{name}\" stands in \"{section}\""))
}

/// An amplifier's cords stand in `in`, as an object of jacks; others under the name of their input.
fn plugs(fields: &mut Fields<'_>, entry: &mut Entry, findings: &mut Findings) {
    let inputs = entry.kind.inputs;
    if inputs.first().is_some_and(|main| main.jacks == Jacks::Gains) {
        if let Some(node) = fields.take("in") {
            jacks(node, entry, findings);
        }
        return;
    }
    for input in inputs {
        match fields.take_with_key(input.name) {
            // Jacks with gains on an element that has none are told one by one.
            Some((_, node)) if matches!(node.value, Content::Object(_)) => jacks(node, entry, findings),
            Some((key_span, node)) => plug(input.name, key_span, node, entry, findings),
            None => {}
        }
    }
}

fn jacks(node: &Node, entry: &mut Entry, findings: &mut Findings) {
    if !matches!(node.value, Content::Object(_)) {
        let message = "an amplifier's cords go to inputs with gains";
        let hint = "write \"in\": {\"x1\": [...], \"x10\": [...]}";
        findings.push(Diagnostic::at(Code::WrongType, node.span, message).hint(hint));
        entry.doubtful = true;
        return;
    }
    let Some(jacks) = Fields::of(node, "\"in\"", findings) else { return };
    jacks.rest().for_each(|jack| plug(&jack.key, jack.key_span, &jack.value, entry, findings));
}

fn plug(jack: &str, jack_span: Span, node: &Node, entry: &mut Entry, findings: &mut Findings) {
    let reported = findings.len();
    let jack = Placed { value: jack.to_owned(), span: jack_span };
    let cords = words(node, &jack.value, findings);
    entry.doubtful |= findings.len() > reported;
    entry.plugs.extend(cords.into_iter().map(|from| Plug { jack: jack.clone(), from }));
    if matches!(&node.value, Content::List(items) if items.is_empty()) {
        entry.empty_jacks.push(Placed { value: jack.value, span: node.span });
    }
}

fn setting_groups(kind: &Kind) -> Vec<&'static str> {
    let mut groups: Vec<_> =
        kind.settings.iter().filter_map(|setting| Some(setting.name.split_once('.')?.0)).collect();
    groups.dedup();
    groups
}

/// Reads the settings whose names are the prefix and a key of these fields.
fn settings(fields: &mut Fields<'_>, prefix: &str, entry: &mut Entry, findings: &mut Findings) {
    for (index, setting) in entry.kind.settings.iter().enumerate() {
        let Some(key) = setting.name.strip_prefix(prefix).filter(|key| !key.contains('.')) else { continue };
        let node = match setting.default {
            Default::Required => fields.need(key, setting.description),
            _ => fields.take(key),
        };
        let Some(node) = node else { continue };
        match purpose(setting.measure, entry).filter(|_| matches!(node.value, Content::Object(_))) {
            Some(purpose) => entry.files.extend(table_file::asked(node, index, purpose, findings)),
            None => entry.settings[index] = amount(node, key, setting.measure, entry, findings),
        }
    }
}

/// What the points of a setting are for, if it holds points.
fn purpose(measure: Measure, entry: &Entry) -> Option<Purpose> {
    match measure {
        Measure::Points => Some(Purpose::InTime),
        Measure::Curve(symmetry) => Some(Purpose::Curve(mirror(entry, symmetry))),
        _ => None,
    }
}

/// The value of a setting of an entry, of which the settings before it in the kind's order are read.
pub(super) fn amount(
    node: &Node,
    key: &str,
    measure: Measure,
    entry: &Entry,
    findings: &mut Findings,
) -> Option<Placed<Amount>> {
    let value = match measure {
        Measure::Flag => Amount::Flag(flag(node, key, findings)?),
        Measure::Choice(words) => Amount::Choice(choice(node, key, words, findings)?),
        Measure::Points => Amount::Points(points(node, key, findings)?),
        Measure::Curve(symmetry) => Amount::Points(curve(node, key, mirror(entry, symmetry), findings)?),
        _ => Amount::Formula(formula(node, key, findings)?.value),
    };
    Some(Placed { value, span: node.span })
}

/// What the setting that tells the symmetry of a curve says: none, odd or even, in this order.
fn mirror(entry: &Entry, symmetry: &str) -> Mirror {
    let chosen = entry.kind.setting(symmetry).and_then(|index| entry.settings[index].as_ref());
    match chosen.map(|placed| &placed.value) {
        Some(Amount::Choice(1)) => Mirror::Odd,
        Some(Amount::Choice(2)) => Mirror::Even,
        _ => Mirror::None,
    }
}

fn choice(node: &Node, key: &str, known: &[&str], findings: &mut Findings) -> Option<usize> {
    let chosen = word(node, key, findings)?;
    let index = known.iter().position(|word| *word == chosen.value);
    if index.is_none() {
        let message = format!("\"{}\" is no {key}", chosen.value);
        let hint = suggestion(&chosen.value, known);
        findings.push(Diagnostic::at(Code::UnknownName, node.span, message).maybe_hint(hint));
    }
    index
}

fn uses(node: &Node, findings: &mut Findings) -> Vec<(Placed<String>, Vec<Placed<String>>)> {
    let Some(fields) = Fields::of(node, "\"uses\"", findings) else { return Vec::new() };
    let mut used = Vec::new();
    for item in fields.rest() {
        if !Part::ALL.iter().any(|part| part.key() == item.key) {
            let keys: Vec<_> = Part::ALL.iter().map(|part| part.key()).collect();
            let message = format!("no machine has \"{}\"", item.key);
            let hint = suggestion(&item.key, &keys);
            findings.push(Diagnostic::at(Code::UnknownKey, item.key_span, message).maybe_hint(hint));
            continue;
        }
        let names = words(&item.value, &item.key, findings);
        used.push((Placed { value: item.key.clone(), span: item.key_span }, names));
    }
    used
}
