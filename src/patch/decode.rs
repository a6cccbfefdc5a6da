//! From the tree of the text to the patch. Everything wrong is noted, and reading goes on.

use super::code::Code;
use super::diagnostic::{Diagnostic, Span, suggestion};
use super::document::{
    Amount, Entry, FORMAT_VERSION, Parameter, Patch, PictureSpec, Placed, Plug, RunPlan, Scale, Signal,
};
use super::formula::Formula;
use super::tree::{self, Content, Node};
use super::units::Unit;
use crate::elements::{self, Default, Family, Kind, Measure};
use crate::machines::Part;

type Findings = Vec<Diagnostic>;

/// Fills a patch from the tree of its text.
///
/// # Errors
/// When the document is not an object.
pub(super) fn document(root: &Node, patch: &mut Patch) -> Result<(), Diagnostic> {
    let mut findings = Findings::new();
    let Some(mut fields) = Fields::of(root, "a patch", &mut findings) else {
        return Err(findings.remove(0));
    };
    version(&mut fields, &mut findings);
    patch.title = fields.text("title", &mut findings);
    patch.source = fields.text("source", &mut findings);
    patch.machine = fields.take("machine").and_then(|node| word(node, "machine", &mut findings));
    patch.time_scale = time_scale(&mut fields, &mut findings);
    let all = &mut findings;
    fields.each("parameters", all, |name, span, node, all| {
        insert_some(&mut patch.parameters, name, parameter(node, span, all));
    });
    fields.each("scales", all, |name, span, node, all| {
        insert_some(&mut patch.scales, name, scale(node, span, all));
    });
    fields.each("drives", all, |name, span, node, all| {
        insert_some(&mut patch.drives, name, entry(node, span, Family::Drive, all));
    });
    fields.each("elements", all, |name, span, node, all| {
        insert_some(&mut patch.elements, name, entry(node, span, Family::Computing, all));
    });
    fields.each("signals", all, |name, span, node, all| {
        insert_some(&mut patch.signals, name, signal(node, span, all));
    });
    patch.run = fields.take("run").map(|node| run(node, all)).unwrap_or_default();
    patch.record = fields.take("record").map(|node| words(node, "record", all)).unwrap_or_default();
    patch.pictures = fields.take("pictures").map(|node| pictures(node, all)).unwrap_or_default();
    fields.text("note", all);
    fields.text("$schema", all);
    fields.finish(all);
    patch.findings = findings;
    Ok(())
}

fn insert_some<T>(map: &mut indexmap::IndexMap<String, T>, name: &str, value: Option<T>) {
    if let Some(value) = value {
        map.insert(name.to_owned(), value);
    }
}

fn version(fields: &mut Fields<'_>, findings: &mut Findings) {
    let Some(node) = fields.need("patchcord", findings) else { return };
    if number(node, "patchcord", findings).is_some_and(|version| version != FORMAT_VERSION as f64) {
        findings.push(
            Diagnostic::at(Code::UnknownVersion, node.span, "this version of the format is not known")
                .hint(format!("this program reads version {FORMAT_VERSION}")),
        );
    }
}

fn time_scale(fields: &mut Fields<'_>, findings: &mut Findings) -> f64 {
    positive(fields, "time_scale", findings).map_or(1.0, |placed| placed.value)
}

fn parameter(node: &Node, span: Span, findings: &mut Findings) -> Option<Parameter> {
    let mut fields = Fields::of(node, "a parameter", findings)?;
    let value = fields.need("value", findings).and_then(|node| number(node, "value", findings));
    let unit = unit(&mut fields, findings);
    let range = fields.take("range").and_then(|node| range(node, findings));
    let description = fields.text("description", findings);
    fields.text("note", findings);
    fields.finish(findings);
    Some(Parameter { value: value?, unit: unit?, range, description, span })
}

fn range(node: &Node, findings: &mut Findings) -> Option<(f64, f64)> {
    let bounds = list(node, "range", findings)?;
    let [low, high] = bounds else {
        let message = "\"range\" is a list of two numbers, least and largest";
        findings.push(Diagnostic::at(Code::WrongType, node.span, message));
        return None;
    };
    let (low, high) = (number(low, "range", findings)?, number(high, "range", findings)?);
    if low > high {
        let message = format!("the least value {low} is above the largest {high}");
        findings.push(Diagnostic::at(Code::BadNumber, node.span, message));
        return None;
    }
    Some((low, high))
}

fn scale(node: &Node, span: Span, findings: &mut Findings) -> Option<Scale> {
    let mut fields = Fields::of(node, "a scale", findings)?;
    let per_volt = fields.need("per_volt", findings).and_then(|node| formula(node, "per_volt", findings));
    let unit = unit(&mut fields, findings);
    fields.text("description", findings);
    fields.text("note", findings);
    fields.finish(findings);
    Some(Scale { per_volt, unit: unit?, span })
}

fn unit(fields: &mut Fields<'_>, findings: &mut Findings) -> Option<Unit> {
    let node = fields.need("unit", findings)?;
    let text = word(node, "unit", findings)?;
    Unit::parse(&text.value)
        .map_err(|error| {
            let at = inside_quotes(text.span, &error.range);
            findings.push(Diagnostic::at(Code::UnknownUnit, at, error.message).maybe_hint(error.hint));
        })
        .ok()
}

/// The place of a part of a quoted text; escapes before it are not counted.
fn inside_quotes(span: Span, range: &std::ops::Range<usize>) -> Span {
    span.part(&(range.start + 1..range.end + 1))
}

fn entry(node: &Node, span: Span, family: Family, findings: &mut Findings) -> Option<Entry> {
    let mut fields = Fields::of(node, "an element", findings)?;
    let kind = kind(&mut fields, family, findings)?;
    let mut entry = Entry {
        kind,
        plugs: Vec::new(),
        empty_jacks: Vec::new(),
        settings: vec![None; kind.settings.len()],
        unreadable: Vec::new(),
        uses: Vec::new(),
        scale: None,
        note: fields.text("note", findings),
        span,
    };
    plugs(&mut fields, &mut entry, findings);
    settings(&mut fields, "", &mut entry, findings);
    for group in setting_groups(kind) {
        if let Some(node) = fields.take(group)
            && let Some(mut inner) = Fields::of(node, "a group of settings", findings)
        {
            settings(&mut inner, &format!("{group}."), &mut entry, findings);
            inner.finish(findings);
        }
    }
    if family == Family::Drive {
        entry.scale = fields.need("scale", findings).and_then(|node| word(node, "scale", findings));
    } else {
        entry.uses = fields.take("uses").map(|node| uses(node, findings)).unwrap_or_default();
    }
    fields.finish(findings);
    Some(entry)
}

fn kind(fields: &mut Fields<'_>, family: Family, findings: &mut Findings) -> Option<&'static Kind> {
    let node = fields.need("kind", findings)?;
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

/// Cords stand in `in` (for the main input, or as an object of jacks) or under the name of the input.
fn plugs(fields: &mut Fields<'_>, entry: &mut Entry, findings: &mut Findings) {
    let inputs = entry.kind.inputs;
    let Some(main) = inputs.first() else { return };
    if let Some((key_span, node)) = fields.take_with_key("in") {
        match &node.value {
            Content::Object(_) => {
                if let Some(jacks) = Fields::of(node, "\"in\"", findings) {
                    jacks
                        .rest()
                        .for_each(|jack| plug(&jack.key, jack.key_span, &jack.value, entry, findings));
                }
            }
            _ if matches!(main.jacks, elements::Jacks::Gains) => {
                let message = "an amplifier's cords go to inputs with gains";
                let hint = "write \"in\": {\"x1\": [...], \"x10\": [...]}";
                findings.push(Diagnostic::at(Code::WrongType, node.span, message).hint(hint));
                entry.empty_jacks.push(Placed { value: main.name.to_owned(), span: node.span });
            }
            _ => plug(main.name, key_span, node, entry, findings),
        }
    }
    for input in inputs.iter().filter(|input| input.name != "in") {
        if let Some((key_span, node)) = fields.take_with_key(input.name) {
            plug(input.name, key_span, node, entry, findings);
        }
    }
}

fn plug(jack: &str, jack_span: Span, node: &Node, entry: &mut Entry, findings: &mut Findings) {
    let before = entry.plugs.len();
    let jack = Placed { value: jack.to_owned(), span: jack_span };
    for from in words(node, &jack.value, findings) {
        entry.plugs.push(Plug { jack: jack.clone(), from });
    }
    if entry.plugs.len() == before {
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
            Default::Required => fields.need(key, findings),
            _ => fields.take(key),
        };
        match node.map(|node| amount(node, key, setting.measure, findings)) {
            Some(Some(amount)) => entry.settings[index] = Some(amount),
            Some(None) => entry.unreadable.push(index),
            None if setting.default == Default::Required => entry.unreadable.push(index),
            None => {}
        }
    }
}

fn amount(node: &Node, key: &str, measure: Measure, findings: &mut Findings) -> Option<Placed<Amount>> {
    let value = match measure {
        Measure::Flag => Amount::Flag(flag(node, key, findings)?),
        Measure::Choice(words) => Amount::Choice(choice(node, key, words, findings)?),
        Measure::Points => Amount::Points(points(node, key, findings)?),
        _ => Amount::Formula(formula(node, key, findings)?.value),
    };
    Some(Placed { value, span: node.span })
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

fn points(node: &Node, key: &str, findings: &mut Findings) -> Option<Vec<[f64; 2]>> {
    let items = list(node, key, findings)?;
    let points: Option<Vec<[f64; 2]>> = items.iter().map(|item| point(item, key, findings)).collect();
    let points = points?;
    let falling = points.windows(2).position(|pair| pair[1][0] <= pair[0][0]);
    if let Some(index) = falling {
        let message = "the times of a table must rise from point to point";
        findings.push(Diagnostic::at(Code::BadNumber, items[index + 1].span, message));
        return None;
    }
    if points.is_empty() {
        findings.push(Diagnostic::at(Code::BadNumber, node.span, "a table needs at least one point"));
        return None;
    }
    Some(points)
}

fn point(node: &Node, key: &str, findings: &mut Findings) -> Option<[f64; 2]> {
    let pair = list(node, key, findings)?;
    let [time, value] = pair else {
        findings.push(Diagnostic::at(Code::WrongType, node.span, "a point is a list of two numbers"));
        return None;
    };
    Some([number(time, key, findings)?, number(value, key, findings)?])
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

fn signal(node: &Node, span: Span, findings: &mut Findings) -> Option<Signal> {
    let mut fields = Fields::of(node, "a signal", findings)?;
    let at = fields.need("at", findings).and_then(|node| word(node, "at", findings));
    let scale = fields.take("scale").and_then(|node| word(node, "scale", findings));
    let factor = fields.take("factor").and_then(|node| number(node, "factor", findings));
    fields.text("description", findings);
    fields.text("note", findings);
    fields.finish(findings);
    Some(Signal { at: at?, scale, factor: factor.unwrap_or(1.0), span })
}

fn run(node: &Node, findings: &mut Findings) -> RunPlan {
    let Some(mut fields) = Fields::of(node, "\"run\"", findings) else { return RunPlan::default() };
    let plan = RunPlan {
        duration: positive(&mut fields, "for", findings),
        step: positive(&mut fields, "step", findings),
        every: positive(&mut fields, "every", findings),
        repeat: positive(&mut fields, "repeat", findings),
        hold_on_overload: fields
            .take("hold_on_overload")
            .and_then(|node| flag(node, "hold_on_overload", findings))
            .unwrap_or(false),
    };
    if let Some(repeat) = plan.repeat.as_ref().filter(|repeat| repeat.value.fract() != 0.0) {
        findings.push(Diagnostic::at(Code::BadNumber, repeat.span, "\"repeat\" is a whole number of runs"));
    }
    fields.text("note", findings);
    fields.finish(findings);
    plan
}

fn positive(fields: &mut Fields<'_>, key: &'static str, findings: &mut Findings) -> Option<Placed<f64>> {
    let node = fields.take(key)?;
    let value = number(node, key, findings)?;
    if value <= 0.0 {
        let message = format!("\"{key}\" must be above 0, not {value}");
        findings.push(Diagnostic::at(Code::BadNumber, node.span, message));
        return None;
    }
    Some(Placed { value, span: node.span })
}

fn pictures(node: &Node, findings: &mut Findings) -> Vec<PictureSpec> {
    let items = list(node, "pictures", findings).unwrap_or_default();
    items.iter().filter_map(|item| picture(item, findings)).collect()
}

fn picture(node: &Node, findings: &mut Findings) -> Option<PictureSpec> {
    let mut fields = Fields::of(node, "a picture", findings)?;
    let title = fields.text("title", findings);
    let x = match fields.take("x") {
        Some(node) => word(node, "x", findings),
        None => Some(Placed { value: "t".to_owned(), span: node.span }),
    };
    let y = fields.need("y", findings).map(|node| words(node, "y", findings));
    fields.text("note", findings);
    fields.finish(findings);
    Some(PictureSpec { title, x: x?, y: y? })
}

fn formula(node: &Node, key: &str, findings: &mut Findings) -> Option<Placed<Formula>> {
    let value = match &node.value {
        Content::Number(_) => Formula::constant(number(node, key, findings)?),
        Content::Text(text) => Formula::parse(text)
            .map_err(|error| {
                let at = inside_quotes(node.span, &error.range);
                findings.push(Diagnostic::at(Code::BadFormula, at, error.message).maybe_hint(error.hint));
            })
            .ok()?,
        other => {
            findings.push(wrong_type(node, key, "a number or a formula in quotes", other));
            return None;
        }
    };
    Some(Placed { value, span: node.span })
}

fn number(node: &Node, key: &str, findings: &mut Findings) -> Option<f64> {
    let Content::Number(text) = &node.value else {
        findings.push(wrong_type(node, key, "a number", &node.value));
        return None;
    };
    let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
    if value.is_none() {
        let message = format!("{text} is too large to hold");
        let hint = "every number of a patch must be finite";
        findings.push(Diagnostic::at(Code::NotFinite, node.span, message).hint(hint));
    }
    value
}

fn flag(node: &Node, key: &str, findings: &mut Findings) -> Option<bool> {
    let Content::Flag(flag) = node.value else {
        findings.push(wrong_type(node, key, "true or false", &node.value));
        return None;
    };
    Some(flag)
}

fn word(node: &Node, key: &str, findings: &mut Findings) -> Option<Placed<String>> {
    let Content::Text(text) = &node.value else {
        findings.push(wrong_type(node, key, "a text", &node.value));
        return None;
    };
    Some(Placed { value: text.clone(), span: node.span })
}

/// One text, or a list of texts.
fn words(node: &Node, key: &str, findings: &mut Findings) -> Vec<Placed<String>> {
    match &node.value {
        Content::List(items) => items.iter().filter_map(|item| word(item, key, findings)).collect(),
        _ => word(node, key, findings).into_iter().collect(),
    }
}

fn list<'a>(node: &'a Node, key: &str, findings: &mut Findings) -> Option<&'a [Node]> {
    let Content::List(items) = &node.value else {
        findings.push(wrong_type(node, key, "a list", &node.value));
        return None;
    };
    Some(items)
}

fn wrong_type(node: &Node, key: &str, wanted: &str, got: &Content) -> Diagnostic {
    let message = format!("\"{key}\" takes {wanted}, not {}", got.noun());
    Diagnostic::at(Code::WrongType, node.span, message)
}

/// The keys of an object, each taken once; what is left at the end is not known.
struct Fields<'a> {
    entries: Vec<(&'a tree::Entry, bool)>,
    span: Span,
    asked: Vec<&'static str>,
    noun: &'static str,
}

impl<'a> Fields<'a> {
    /// The fields of an object; anything else is noted as wrong.
    fn of(node: &'a Node, noun: &'static str, findings: &mut Findings) -> Option<Self> {
        let Content::Object(entries) = &node.value else {
            let message = format!("{noun} must be an object, not {}", node.value.noun());
            findings.push(Diagnostic::at(Code::WrongType, node.span, message));
            return None;
        };
        note_duplicates(entries, findings);
        let entries = entries.iter().map(|entry| (entry, false)).collect();
        Some(Fields { entries, span: node.span, asked: Vec::new(), noun })
    }

    fn take(&mut self, key: &'static str) -> Option<&'a Node> {
        self.take_with_key(key).map(|(_, node)| node)
    }

    fn take_with_key(&mut self, key: &'static str) -> Option<(Span, &'a Node)> {
        self.asked.push(key);
        let mut found = None;
        for (entry, taken) in self.entries.iter_mut().filter(|(entry, _)| entry.key == key) {
            *taken = true;
            found = found.or(Some((entry.key_span, &entry.value)));
        }
        found
    }

    fn need(&mut self, key: &'static str, findings: &mut Findings) -> Option<&'a Node> {
        let node = self.take(key);
        if node.is_none() {
            let message = format!("{} needs \"{key}\"", self.noun);
            let opening = Span { start: self.span.start, end: self.span.start + 1 };
            findings.push(Diagnostic::at(Code::MissingKey, opening, message));
        }
        node
    }

    /// The text under a key; empty where there is none.
    fn text(&mut self, key: &'static str, findings: &mut Findings) -> String {
        let node = self.take(key);
        node.and_then(|node| word(node, key, findings)).map_or_else(String::new, |text| text.value)
    }

    /// Calls `each` for every named thing of a section.
    fn each(
        &mut self,
        section: &'static str,
        findings: &mut Findings,
        mut each: impl FnMut(&str, Span, &'a Node, &mut Findings),
    ) {
        let Some(node) = self.take(section) else { return };
        let Some(named) = Fields::of(node, "a section of named things", findings) else { return };
        for entry in named.rest() {
            each(&entry.key, entry.key_span, &entry.value, findings);
        }
    }

    /// Every entry that was not taken, the first of each key.
    fn rest(&self) -> impl Iterator<Item = &'a tree::Entry> + use<'a> {
        let left: Vec<_> = self.entries.iter().filter(|(_, taken)| !taken).map(|(entry, _)| *entry).collect();
        let mut seen = std::collections::HashSet::new();
        left.into_iter().filter(move |entry| seen.insert(entry.key.as_str()))
    }

    fn finish(&self, findings: &mut Findings) {
        for entry in self.rest() {
            let message = format!("{} has no key \"{}\"", self.noun, entry.key);
            let hint = suggestion(&entry.key, &self.asked);
            findings.push(Diagnostic::at(Code::UnknownKey, entry.key_span, message).maybe_hint(hint));
        }
    }
}

fn note_duplicates(entries: &[tree::Entry], findings: &mut Findings) {
    let mut seen = std::collections::HashSet::new();
    for entry in entries.iter().filter(|entry| !seen.insert(entry.key.as_str())) {
        let message = format!("\"{}\" stands twice here", entry.key);
        let hint = "keep one of the two: JSON readers would silently drop the other";
        findings.push(Diagnostic::at(Code::DuplicateKey, entry.key_span, message).hint(hint));
    }
}
