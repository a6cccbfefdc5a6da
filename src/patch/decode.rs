//! From the tree of the text to the patch. Everything wrong is noted, and reading goes on.

use std::collections::HashSet;

use indexmap::IndexMap;

use super::code::Code;
use super::diagnostic::{Diagnostic, Span, suggestion, told};
use super::document::{
    Amount, Entry, FORMAT_VERSION, Parameter, Patch, PictureSpec, Placed, Plug, RunPlan, Scale, Signal,
};
use super::formula::Formula;
use super::tree::{self, Content, Node};
use super::units::{Unit, nearest};
use crate::elements::{self, Default, Family, Kind, Measure};
use crate::machines::Part;

type Findings = Vec<Diagnostic>;

/// Fills a patch from the tree of its text.
///
/// # Errors
/// When the document is not an object.
pub(super) fn document(root: &Node, patch: &mut Patch) -> Result<(), Diagnostic> {
    let mut findings = Findings::new();
    let Some(mut fields) = Fields::of(root, "the patch", &mut findings) else {
        return Err(findings.remove(0));
    };
    version(&mut fields, &mut findings);
    patch.title = fields.text("title", &mut findings);
    patch.source = fields.text("source", &mut findings);
    patch.machine = fields.take("machine").and_then(|node| word(node, "machine", &mut findings));
    patch.time_scale = time_scale(&mut fields, &mut findings);
    let all = &mut findings;
    let lost = &mut patch.lost.names;
    fields.each("parameters", all, |named, all| {
        keep(&mut patch.parameters, lost, named, parameter(named, all));
    });
    fields.each("scales", all, |named, all| {
        keep(&mut patch.scales, lost, named, scale(named, all));
    });
    fields.each("drives", all, |named, all| {
        keep(&mut patch.drives, lost, named, entry(named, Family::Drive, all));
    });
    fields.each("elements", all, |named, all| {
        keep(&mut patch.elements, lost, named, entry(named, Family::Computing, all));
    });
    fields.each("signals", all, |named, all| {
        keep(&mut patch.signals, lost, named, signal(named, all));
    });
    patch.run = fields.take("run").map(|node| run(node, all)).unwrap_or_default();
    patch.record = fields.take("record").map(|node| words(node, "record", all)).unwrap_or_default();
    patch.pictures = fields.take("pictures").map(|node| pictures(node, all)).unwrap_or_default();
    fields.text("note", all);
    fields.text("$schema", all);
    patch.lost.section = has_lost_section(&fields);
    fields.finish(all);
    patch.findings = findings;
    Ok(())
}

/// The sections in which other parts of the document look for names.
const SECTIONS: [&str; 5] = ["parameters", "scales", "drives", "elements", "signals"];

/// Whether a section is misspelled or no object, so that its names are not there.
fn has_lost_section(fields: &Fields<'_>) -> bool {
    fields.entries.iter().any(|(entry, taken)| match taken {
        true => SECTIONS.contains(&entry.key.as_str()) && !matches!(entry.value.value, Content::Object(_)),
        false => nearest(&entry.key, SECTIONS).is_some(),
    })
}

/// Keeps what was read under its name, or the name alone where it could not be read.
fn keep<T>(
    read: &mut IndexMap<String, T>,
    lost: &mut HashSet<String>,
    named: &tree::Entry,
    value: Option<T>,
) {
    match value {
        Some(value) => drop(read.insert(named.key.clone(), value)),
        None => drop(lost.insert(named.key.clone())),
    }
}

fn version(fields: &mut Fields<'_>, findings: &mut Findings) {
    let Some(node) = fields.need("patchcord", "the version of the format: write \"patchcord\": 1") else {
        return;
    };
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

fn parameter(named: &tree::Entry, findings: &mut Findings) -> Option<Parameter> {
    let mut fields = Fields::of(&named.value, format!("the parameter {}", named.key), findings)?;
    let place = fields.need("value", "a number in the unit of the parameter");
    let value = place.and_then(|node| number(node, "value", findings));
    let unit = unit(&mut fields, findings);
    let range = fields.take("range").and_then(|node| range(node, findings));
    let description = fields.text("description", findings);
    fields.text("note", findings);
    fields.finish(findings);
    let span = named.key_span;
    Some(Parameter { value: value?, unit: unit?, range, description, span, value_span: place?.span })
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
        let hint = "a range begins with the least value";
        findings.push(Diagnostic::at(Code::BadNumber, node.span, message).hint(hint));
        return None;
    }
    Some((low, high))
}

fn scale(named: &tree::Entry, findings: &mut Findings) -> Option<Scale> {
    let mut fields = Fields::of(&named.value, format!("the scale {}", named.key), findings)?;
    let per_volt = fields.need("per_volt", "what one volt stands for, in the unit of the scale");
    let per_volt = per_volt.and_then(|node| formula(node, "per_volt", findings));
    let unit = unit(&mut fields, findings);
    fields.text("description", findings);
    fields.text("note", findings);
    fields.finish(findings);
    Some(Scale { per_volt, unit: unit?, span: named.key_span })
}

fn unit(fields: &mut Fields<'_>, findings: &mut Findings) -> Option<Unit> {
    let node = fields.need("unit", "such as \"N s/m\", or \"1\" for a pure number")?;
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

fn entry(named: &tree::Entry, family: Family, findings: &mut Findings) -> Option<Entry> {
    let noun = format!("the {} {}", family_noun(family), named.key);
    let mut fields = Fields::of(&named.value, noun, findings)?;
    let kind = kind(&mut fields, family, findings)?;
    let mut entry = Entry {
        kind,
        plugs: Vec::new(),
        empty_jacks: Vec::new(),
        doubtful: false,
        settings: vec![None; kind.settings.len()],
        unreadable: Vec::new(),
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
                entry.doubtful = true;
            }
            _ => plug(main.name, key_span, node, entry, findings),
        }
    }
    let named = inputs.iter().filter(|input| input.name != "in" && input.jacks != elements::Jacks::Gains);
    for input in named {
        if let Some((key_span, node)) = fields.take_with_key(input.name) {
            plug(input.name, key_span, node, entry, findings);
        }
    }
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

fn signal(named: &tree::Entry, findings: &mut Findings) -> Option<Signal> {
    let mut fields = Fields::of(&named.value, format!("the signal {}", named.key), findings)?;
    let at = fields.need("at", "the element at whose output it is read");
    let at = at.and_then(|node| word(node, "at", findings));
    let scale = fields.take("scale").and_then(|node| word(node, "scale", findings));
    let factor = fields.take("factor").and_then(|node| factor(node, findings));
    fields.text("description", findings);
    fields.text("note", findings);
    fields.finish(findings);
    Some(Signal { at: at?, scale, factor: factor.unwrap_or(1.0), span: named.key_span })
}

fn factor(node: &Node, findings: &mut Findings) -> Option<f64> {
    let factor = number(node, "factor", findings)?;
    if factor == 0.0 {
        findings.push(Diagnostic::at(Code::BadNumber, node.span, "a signal times 0 shows nothing"));
    }
    Some(factor)
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
    for (key, time) in [("step", &plan.step), ("every", &plan.every)] {
        shorter_than_run(key, time, &plan.duration, findings);
    }
    fields.text("note", findings);
    fields.finish(findings);
    plan
}

fn shorter_than_run(
    key: &str,
    time: &Option<Placed<f64>>,
    duration: &Option<Placed<f64>>,
    findings: &mut Findings,
) {
    if let (Some(time), Some(duration)) = (time, duration)
        && time.value > duration.value
    {
        let message =
            format!("\"{key}\" is {} s, longer than the run of {} s", told(time.value), told(duration.value));
        findings.push(Diagnostic::at(Code::BadNumber, time.span, message));
    }
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
    let y = fields.need("y", "the signals along the vertical axis").map(|node| shown(node, findings));
    fields.text("note", findings);
    fields.finish(findings);
    Some(PictureSpec { title, x: x?, y: y? })
}

/// The signals that a picture shows: one at least.
fn shown(node: &Node, findings: &mut Findings) -> Vec<Placed<String>> {
    if matches!(&node.value, Content::List(items) if items.is_empty()) {
        let message = "the picture shows no signal";
        let hint = "name the signals along the vertical axis, or leave the picture out";
        findings.push(Diagnostic::at(Code::MissingKey, node.span, message).hint(hint));
    }
    words(node, "y", findings)
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
    let quoted_number = matches!(got, Content::Text(text) if text.parse::<f64>().is_ok_and(f64::is_finite));
    let hint = (quoted_number && wanted == "a number").then(|| "take the quotes away".to_owned());
    Diagnostic::at(Code::WrongType, node.span, message).maybe_hint(hint)
}

/// The keys of an object, each taken once; what is left at the end is not known.
struct Fields<'a> {
    entries: Vec<(&'a tree::Entry, bool)>,
    span: Span,
    asked: Vec<&'static str>,
    /// Keys that were needed and are not there, and what they mean.
    missing: Vec<(&'static str, String)>,
    noun: String,
}

impl<'a> Fields<'a> {
    /// The fields of an object; anything else is noted as wrong.
    fn of(node: &'a Node, noun: impl Into<String>, findings: &mut Findings) -> Option<Self> {
        let noun = noun.into();
        let Content::Object(entries) = &node.value else {
            let message = format!("{noun} must be an object, not {}", node.value.noun());
            findings.push(Diagnostic::at(Code::WrongType, node.span, message));
            return None;
        };
        note_duplicates(entries, findings);
        let entries = entries.iter().map(|entry| (entry, false)).collect();
        Some(Fields { entries, span: node.span, asked: Vec::new(), missing: Vec::new(), noun })
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

    /// What must be there; if it is not, [`Fields::finish`] says so.
    fn need(&mut self, key: &'static str, meaning: &str) -> Option<&'a Node> {
        let node = self.take(key);
        if node.is_none() {
            self.missing.push((key, meaning.to_owned()));
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
        mut each: impl FnMut(&'a tree::Entry, &mut Findings),
    ) {
        let Some(node) = self.take(section) else { return };
        let Some(named) = Fields::of(node, format!("\"{section}\""), findings) else { return };
        for entry in named.rest() {
            each(entry, findings);
        }
    }

    /// Every entry that was not taken, the first of each key.
    fn rest(&self) -> impl Iterator<Item = &'a tree::Entry> + use<'a> {
        let left: Vec<_> = self.entries.iter().filter(|(_, taken)| !taken).map(|(entry, _)| *entry).collect();
        let mut seen = HashSet::new();
        left.into_iter().filter(move |entry| seen.insert(entry.key.as_str()))
    }

    /// Reports the keys that are missing and those that are not known.
    fn finish(&mut self, findings: &mut Findings) {
        self.report_missing(findings);
        for entry in self.rest() {
            findings.push(self.unknown(entry).maybe_hint(suggestion(&entry.key, &self.asked)));
        }
    }

    /// Reports the keys that are missing. One that stands there misspelled is not missing but unknown.
    fn report_missing(&mut self, findings: &mut Findings) {
        for (key, meaning) in std::mem::take(&mut self.missing) {
            findings.push(match self.take_near(key) {
                Some(entry) => self.unknown(entry).hint(format!("did you mean \"{key}\"?")),
                None => {
                    let opening = Span { start: self.span.start, end: self.span.start + 1 };
                    let message = format!("{} needs \"{key}\"", self.noun);
                    Diagnostic::at(Code::MissingKey, opening, message).hint(meaning)
                }
            });
        }
    }

    fn take_near(&mut self, key: &str) -> Option<&'a tree::Entry> {
        let near = nearest(key, self.rest().map(|entry| entry.key.as_str()))?;
        let (entry, taken) = self.entries.iter_mut().find(|(entry, _)| entry.key == near)?;
        *taken = true;
        Some(entry)
    }

    fn unknown(&self, entry: &tree::Entry) -> Diagnostic {
        let message = format!("\"{}\" is not a key of {}", entry.key, self.noun);
        Diagnostic::at(Code::UnknownKey, entry.key_span, message)
    }
}

fn note_duplicates(entries: &[tree::Entry], findings: &mut Findings) {
    let mut seen = HashSet::new();
    for entry in entries.iter().filter(|entry| !seen.insert(entry.key.as_str())) {
        let message = format!("\"{}\" stands here more than once", entry.key);
        let hint = "keep one of them: JSON readers would silently drop the others";
        findings.push(Diagnostic::at(Code::DuplicateKey, entry.key_span, message).hint(hint));
    }
}
