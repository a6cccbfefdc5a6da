//! Effects read from their documents.

use std::path::Path;

use indexmap::IndexMap;
use serde_json::{Map, Value};

use crate::data::drive_timing::{RECORD_START, has_name};
use crate::effects::reach::{NAMES, of_tens};
use crate::effects::{Attachment, Effect, EffectParameter, Form, Gives, Reads, Start};
use patchcord_core::document::fields::{Fields, Findings, list, number, word, words, wrong_type};
use patchcord_core::document::tree::{Content, Node};
use patchcord_core::document::{
    Code, Diagnostic, DocumentKind, Placed, Report, Span, formula as formula_at, suggestion, tree, unit_of,
};
use patchcord_core::patch::same_name;
use patchcord_expr::Formula;

/// The version of the format that this program reads.
const FORMAT: f64 = 1.0;

impl Effect {
    /// Reads an effect; its name is the stem of the file's.
    ///
    /// # Errors
    /// Everything that is wrong with the document, all at once.
    pub fn parse(file: &str, text: &str) -> Result<Effect, Box<Report>> {
        let fail = |findings| Box::new(Report::new(file, text, findings));
        let root = tree::parse(text).map_err(|finding| fail(vec![finding]))?;
        if let Some(finding) = DocumentKind::Effect.instead(&root) {
            return Err(fail(vec![finding]));
        }
        let mut findings = Findings::new();
        let name = Path::new(file).file_stem().map(|stem| stem.to_string_lossy().into_owned());
        let effect = effect(&root, name.unwrap_or_default(), &mut findings);
        findings.iter_mut().for_each(|finding| finding.point_to("docs/effect-format.md"));
        effect.filter(|_| findings.is_empty()).ok_or_else(|| fail(findings))
    }
}

fn effect(root: &Node, name: String, findings: &mut Findings) -> Option<Effect> {
    let mut fields = Fields::of(root, "an effect", findings)?;
    if let Some(version) = fields.need("effect", "the version of the format: 1")
        && number(version, "effect", findings).is_some_and(|version| version != FORMAT)
    {
        let message = "this program reads version 1 of the format of effects";
        findings.push(Diagnostic::at(Code::UnknownVersion, version.span, message));
    }
    let [title, law, physics, source, excitation] = [
        ("title", "what people call it"),
        ("law", "its formula"),
        ("physics", "its physics in a sentence"),
        ("source", "where it is from"),
        ("excitation", "what data must hold for it to be judged"),
    ]
    .map(|(key, meaning)| told(fields.need(key, meaning), key, meaning, findings));
    let mut aliases = IndexMap::new();
    fields.each("aliases", findings, |entry, findings| {
        let when = word(&entry.value, &entry.key, findings);
        aliases.extend(when.map(|when| (entry.key.clone(), when.value)));
    });
    let (mut parameters, mut declared) = (IndexMap::new(), Vec::new());
    fields.each("parameters", findings, |entry, findings| {
        declared.push(entry.key.as_str());
        if NAMES.into_iter().chain(OF_EVERY_FORM).any(|own| own == entry.key) {
            findings.push(same_name(&entry.key, entry.key_span, "parameter", "quantity of every form"));
        }
        if declared.len() == MOST_PARAMETERS + 1 {
            let message = format!("an effect has {MOST_PARAMETERS} parameters at most");
            findings.push(Diagnostic::at(Code::BadNumber, entry.value.span, message));
        }
        let read = parameter(&entry.value, &entry.key, findings);
        parameters.extend(read.map(|read| (entry.key.clone(), read)));
    });
    let forms = fields.need("forms", "the ways to wire it: a list of one or more");
    let nodes = forms.and_then(|node| list(node, "forms", findings)).unwrap_or_default();
    if let Some(none) = forms.filter(|_| nodes.is_empty()) {
        let message = "an effect without forms cannot be wired";
        findings.push(Diagnostic::at(Code::MissingKey, none.span, message));
    }
    let forms = nodes.iter().filter_map(|node| form(node, &parameters, &declared, findings)).collect();
    let parameters = parameters.into_iter().map(|(name, own)| (name, own.value)).collect();
    fields.finish(findings);
    Some(Effect { name, title, law, physics, source, excitation, aliases, parameters, forms })
}

/// A text that readers of a report are told.
fn told(node: Option<&Node>, key: &str, meaning: &str, findings: &mut Findings) -> String {
    let Some(text) = node.and_then(|node| word(node, key, findings)) else { return String::new() };
    if text.value.trim().is_empty() {
        let message = format!("\"{key}\" is empty: it tells {meaning}");
        findings.push(Diagnostic::at(Code::MissingKey, text.span, message));
    }
    text.value
}

/// A parameter, with the place of its reach.
fn parameter(node: &Node, name: &str, findings: &mut Findings) -> Option<Placed<EffectParameter>> {
    let mut fields = Fields::of(node, format!("parameter {name}"), findings)?;
    let reach =
        fields.need("reach", "what it is measured in, as a formula of what is largest: \"sum / own\"");
    let reach = reach.and_then(|node| formula_at(node, "reach", findings));
    let range = fields.need("range", "the least and the largest value searched, in reaches");
    let range = range.and_then(|node| range_of(node, findings));
    let start = fields.need(
        "start",
        "the values from which fits begin, in reaches, or \"spectrum\", \"highest\", \"lowest\"",
    );
    let start = start.and_then(|node| start_of(node, range, findings));
    let none = fields.take("none").and_then(|node| none_of(node, range, findings));
    let description = fields.text("description", findings);
    fields.finish(findings);
    let Placed { value: reach, span } = reach?;
    let is_known = reach.names().iter().all(|name| NAMES.contains(name));
    if is_known {
        check_size(&reach, span, findings);
    }
    if matches!(start, Some(Start::Highest | Start::Lowest)) && reach.names() != [reach.text()] {
        let message =
            format!("\"highest\" and \"lowest\" are those of one name, and the reach is {}", reach.text());
        findings.push(Diagnostic::at(Code::BadNumber, span, message).hint("write the reach as that name"));
    }
    if start == Some(Start::Spectrum) && reach.names().iter().any(|name| !["sample", "record"].contains(name))
    {
        let message = format!("\"spectrum\" gives frequencies, and the reach is {}", reach.text());
        findings.push(Diagnostic::at(Code::UnitMismatch, span, message).hint("measure it in \"1 / record\""));
    }
    let value = EffectParameter { reach, range: range?, start: start?, none, description };
    Some(Placed { value, span })
}

/// Of quantities of ten a reach comes to no more than this, and to no less than one by this.
const MOST_OF_TENS: f64 = 1e12;

fn check_size(reach: &Formula, span: Span, findings: &mut Findings) {
    let text = reach.text();
    let (message, hint) = match of_tens(reach) {
        None => {
            (format!("{text} is no product of powers of what is largest"), "write it like \"sum / own^2\"")
        }
        Some(size) if !(1.0 / MOST_OF_TENS..=MOST_OF_TENS).contains(&size) => (
            format!("{text} comes to {size} where all that it names is ten: nothing can be measured in that"),
            "take smaller powers",
        ),
        Some(_) => return,
    };
    findings.push(Diagnostic::at(Code::BadNumber, span, message).hint(hint));
}

/// Names that formulas of every form have, beside those of what is largest.
const OF_EVERY_FORM: [&str; 2] = ["time_scale", RECORD_START];

/// An effect has no more parameters than this: ranges are gone through corner by corner.
const MOST_PARAMETERS: usize = 12;

/// No parameter is searched further than this, in reaches.
const MOST_REACHES: f64 = 1e6;

fn range_of(node: &Node, findings: &mut Findings) -> Option<[f64; 2]> {
    let nodes = list(node, "range", findings)?;
    let numbers: Vec<_> = nodes.iter().map(|node| number(node, "range", findings)).collect();
    let message = match *numbers.as_slice() {
        [Some(low), Some(high)] if low < high && low.abs().max(high.abs()) <= MOST_REACHES => {
            return Some([low, high]);
        }
        [Some(low), Some(high)] if low < high => {
            format!("\"range\" counts in reaches and goes to {MOST_REACHES} at most, up or down")
        }
        [None, _] | [_, None] => return None,
        _ => "\"range\" takes two numbers, the second above the first".to_owned(),
    };
    findings.push(Diagnostic::at(Code::BadNumber, node.span, message));
    None
}

/// A number within the range, or its upper end.
fn none_of(node: &Node, range: Option<[f64; 2]>, findings: &mut Findings) -> Option<f64> {
    let none = match &node.value {
        Content::Text(text) if text == "upper" => range.map(|[_, high]| high),
        _ => number(node, "none", findings),
    };
    check_within(none?, range, node.span, "there is no effect", findings);
    none
}

/// A parameter begins at no more values than this: each may be joined to each of the others.
const MOST_VALUES: usize = 50;

fn start_of(node: &Node, range: Option<[f64; 2]>, findings: &mut Findings) -> Option<Start> {
    if let Content::Text(text) = &node.value {
        let known = Start::WORDS.iter().find(|(word, _)| word == text).map(|(_, start)| start.clone());
        if known.is_none() {
            let words = Start::WORDS.map(|(word, _)| word);
            let message = format!("\"{text}\" is none of {}, nor a list of values", words.join(", "));
            let hint = suggestion(text, &words);
            findings.push(Diagnostic::at(Code::UnknownName, node.span, message).maybe_hint(hint));
        }
        return known;
    }
    let nodes = list(node, "start", findings)?;
    let values: Vec<f64> = nodes.iter().map(|node| number(node, "start", findings)).collect::<Option<_>>()?;
    if !(1..=MOST_VALUES).contains(&values.len()) {
        let many = format!("\"start\" lists {} values, and takes {MOST_VALUES} at most", values.len());
        let none = "\"start\" lists no value from which a fit could begin".to_owned();
        let message = if values.is_empty() { none } else { many };
        findings.push(Diagnostic::at(Code::BadNumber, node.span, message));
    }
    for (value, node) in values.iter().zip(nodes) {
        check_within(*value, range, node.span, "a fit begins", findings);
    }
    Some(Start::Values(values))
}

/// Tells where a value lies outside the range; a range that cannot be read is told elsewhere.
fn check_within(value: f64, range: Option<[f64; 2]>, span: Span, what: &str, findings: &mut Findings) {
    let Some([low, high]) = range.filter(|[low, high]| !(*low..=*high).contains(&value)) else { return };
    let message = format!("{what} at {value}, outside the range {low} ... {high}");
    findings.push(Diagnostic::at(Code::BadNumber, span, message));
}

fn form(
    node: &Node,
    parameters: &IndexMap<String, Placed<EffectParameter>>,
    declared: &[&str],
    findings: &mut Findings,
) -> Option<Form> {
    let mut fields = Fields::of(node, "a form", findings)?;
    let note = fields.text("note", findings);
    let at = fields.need("at", "where it attaches: motion, store, sum, drive, level or total");
    let at = at.and_then(|node| word(node, "at", findings));
    let at = at.and_then(|word| chosen(&word, Attachment::ALL, Attachment::word, findings));
    let signal = fields.take("signal").and_then(|node| unit_of(node, findings));
    let reads = fields.take("reads").map(|node| words(node, "reads", findings)).unwrap_or_default();
    let allowed = at.map_or(Reads::ALL, Attachment::reads);
    let reads = reads.iter().filter_map(|word| chosen(word, allowed, Reads::word, findings)).collect();
    let allowed = at.map_or(Gives::ALL, Attachment::gives);
    let mut gives = Vec::new();
    fields.each("gives", findings, |entry, findings| {
        let role = Placed { value: entry.key.clone(), span: entry.key_span };
        let role = chosen(&role, allowed, Gives::word, findings);
        let element = word(&entry.value, &entry.key, findings);
        gives.extend(role.zip(element).map(|(role, element)| (role, element.value)));
    });
    let times = fields.take("times").and_then(|node| times_of(node, findings)).unwrap_or(1.0);
    let mut gains = IndexMap::new();
    fields.each("gains", findings, |entry, findings| {
        let read = formula_at(&entry.value, &entry.key, findings);
        gains.extend(read.map(|read| (entry.key.clone(), read)));
    });
    let [drives, elements] = ["drives", "elements"].map(|key| entries(fields.take(key), key, findings));
    let free = fields.take("free").map(|node| words(node, "free", findings)).unwrap_or_default();
    let own = fields.take("parameters").map(|node| words(node, "parameters", findings));
    let own = own.map(|names| known(names, declared, findings));
    let own = own.unwrap_or_else(|| declared.iter().map(|name| (*name).to_owned()).collect());
    fields.finish(findings);
    if own.is_empty() {
        let message = "a form has a parameter at least: its strength, which comes first";
        findings.push(Diagnostic::at(Code::MissingKey, opening(node), message));
    }
    if gives.is_empty() || elements.is_empty() {
        let message = "a form needs \"elements\", and says in \"gives\" what they are wired to";
        findings.push(Diagnostic::at(Code::MissingKey, opening(node), message));
    }
    let free = free.into_iter().filter(|name| is_inside(name, &elements, findings));
    let free = free.map(|name| name.value).collect();
    let gains_told: Vec<Placed<Formula>> = gains.values().cloned().collect();
    let gains = gains.into_iter().map(|(name, gain)| (name, gain.value)).collect();
    let form =
        Form { note, at: at?, signal, reads, gives, times, gains, drives, elements, free, parameters: own };
    check_apart(&form, node, findings);
    check_used(&form, node, findings);
    check_measures(&form, parameters, findings);
    check_gains(&form, &gains_told, findings);
    Some(form)
}

/// So many volts of the sum for a volt that a fragment gives, at most.
const MOST_TIMES: f64 = 1e6;

fn times_of(node: &Node, findings: &mut Findings) -> Option<f64> {
    let value = number(node, "times", findings)?;
    if !(1.0..=MOST_TIMES).contains(&value) {
        let message = format!("\"times\" is a number of 1 ... {MOST_TIMES}, such as 1000, and not {value}");
        findings.push(Diagnostic::at(Code::BadNumber, node.span, message));
    }
    Some(value)
}

/// What formulas of a form name is one thing.
fn check_apart(form: &Form, node: &Node, findings: &mut Findings) {
    let is_taken = |name: &&String| form.gains.contains_key(*name) || form.drives.contains_key(*name);
    for name in form.parameters.iter().filter(is_taken) {
        findings.push(same_name(name, opening(node), "parameter", "gain or drive of this form"));
    }
}

/// Every parameter of a form has to stand in what it wires: of others no data could tell.
fn check_used(form: &Form, node: &Node, findings: &mut Findings) {
    let entries = || form.elements.values().chain(form.drives.values());
    for unused in form.parameters.iter().filter(|name| !entries().any(|entry| has_name(entry, name))) {
        let message = format!("no element and no drive of this form has {unused} in a formula");
        let hint = "leave it out of the form's \"parameters\", or use it";
        findings.push(Diagnostic::at(Code::UnknownName, opening(node), message).hint(hint));
    }
}

/// What a gain is worked out from has to be there where the form attaches.
fn check_gains(form: &Form, gains: &[Placed<Formula>], findings: &mut Findings) {
    let there = form.measures().into_iter().filter(|name| !["sample", "record"].contains(name));
    let known: Vec<&str> =
        there.chain(["time_scale"]).chain(form.parameters.iter().map(String::as_str)).collect();
    for gain in gains {
        check_names(&gain.value, gain.span, &known, findings, |missing| {
            format!("this gain is worked out from {missing}, which the form has not")
        });
    }
}

/// What the parameters of a form are measured in has to be there where it attaches.
fn check_measures(
    form: &Form,
    parameters: &IndexMap<String, Placed<EffectParameter>>,
    findings: &mut Findings,
) {
    let (known, at) = (form.measures(), form.at.word());
    for (name, own) in form.parameters.iter().filter_map(|name| Some((name, parameters.get(name)?))) {
        check_names(&own.value.reach, own.span, &known, findings, |missing| {
            format!("{name} is measured in {missing}, which a form at \"{at}\" with its \"reads\" has not")
        });
    }
}

fn check_names(
    formula: &Formula,
    span: Span,
    known: &[&str],
    findings: &mut Findings,
    message: impl Fn(&str) -> String,
) {
    for missing in formula.names().into_iter().filter(|named| !known.contains(named)) {
        let hint = format!("there are {}", known.join(", "));
        findings.push(Diagnostic::at(Code::UnknownName, span, message(missing)).hint(hint));
    }
}

/// Whether a form has an element of that name.
fn is_inside(name: &Placed<String>, elements: &Map<String, Value>, findings: &mut Findings) -> bool {
    let is_there = elements.contains_key(&name.value);
    if !is_there {
        let known: Vec<&str> = elements.keys().map(String::as_str).collect();
        let message = format!("the form has no element {}", name.value);
        let hint = suggestion(&name.value, &known);
        findings.push(Diagnostic::at(Code::UnknownName, name.span, message).maybe_hint(hint));
    }
    is_there
}

/// The parameters of the effect that a form names.
fn known(names: Vec<Placed<String>>, parameters: &[&str], findings: &mut Findings) -> Vec<String> {
    for name in names.iter().filter(|name| !parameters.contains(&name.value.as_str())) {
        let message = format!("the effect has no parameter {}", name.value);
        let hint = suggestion(&name.value, parameters);
        findings.push(Diagnostic::at(Code::UnknownName, name.span, message).maybe_hint(hint));
    }
    for (place, name) in names.iter().enumerate() {
        if names[..place].iter().any(|before| before.value == name.value) {
            let message = format!("this form has the parameter {} twice", name.value);
            let finding = Diagnostic::at(Code::DuplicateName, name.span, message);
            findings.push(finding.hint("name it once"));
        }
    }
    names.into_iter().map(|name| name.value).collect()
}

fn chosen<T: Copy>(
    text: &Placed<String>,
    all: &[T],
    word: impl Fn(T) -> &'static str,
    findings: &mut Findings,
) -> Option<T> {
    let found = all.iter().copied().find(|one| word(*one) == text.value);
    if found.is_none() {
        let words: Vec<_> = all.iter().map(|one| word(*one)).collect();
        let message = format!("\"{}\" is none of {}", text.value, words.join(", "));
        let hint = suggestion(&text.value, &words);
        findings.push(Diagnostic::at(Code::UnknownName, text.span, message).maybe_hint(hint));
    }
    found
}

/// An object of objects as a value; what stands in these is judged where it is wired.
fn entries(node: Option<&Node>, key: &str, findings: &mut Findings) -> Map<String, Value> {
    let Some(node) = node else { return Map::new() };
    let Content::Object(entries) = &node.value else {
        findings.push(wrong_type(node, key, "an object", &node.value));
        return Map::new();
    };
    for entry in entries.iter().filter(|entry| !matches!(entry.value.value, Content::Object(_))) {
        findings.push(wrong_type(&entry.value, &entry.key, "an object with \"kind\"", &entry.value.value));
    }
    match node.to_value() {
        Value::Object(map) => map,
        _ => Map::new(),
    }
}

fn opening(node: &Node) -> Span {
    Span { start: node.span.start, end: node.span.start + 1 }
}
