//! Reads an effect from its document and checks it. docs/effect-format.md describes the format.
//!
//! All faults of a document are collected, each with its position in the text. The checks here need only the document:
//! keys, types, ranges and names. `trial_patch` then checks that each form can be wired.

use std::path::Path;

use indexmap::IndexMap;
use serde_json::{Map, Value};

use crate::data::drive_timing::{RECORD_START, mentions_name};
use crate::effects::reach::{REACH_NAMES, reach_at_ten};
use crate::effects::{Attachment, Effect, EffectParameter, Form, InputRole, OutputRole, StartRule};
use patchcord_core::document::fields::{Fields, Findings, list, number, string, strings, wrong_type};
use patchcord_core::document::tree::{Content, Node};
use patchcord_core::document::{
    Code, Diagnostic, DocumentKind, Placed, Report, Span, formula as formula_at, parse_unit, suggestion, tree,
};
use patchcord_core::patch::duplicate_name;
use patchcord_expr::Formula;

/// The version of the format that this program reads.
const FORMAT_VERSION: f64 = 1.0;

/// Largest number of parameters of an effect. The largest value of a gain is searched over all corners of the
/// parameters' ranges, which are 2^12 for 12 parameters.
const MAX_PARAMETERS: usize = 12;

/// Largest number of start values of a parameter. They are combined with those of the other parameters.
const MAX_START_VALUES: usize = 50;

/// Largest magnitude of a range's ends, in reaches. A larger value can only be a mistake.
const MAX_RANGE: f64 = 1e6;

/// Largest value of a reach whose names are all 10, and the inverse of its least value. It limits the powers in the
/// formula.
const MAX_REACH_AT_TEN: f64 = 1e12;

/// Largest value of `times`: volts of the sum per volt of the fragment's output.
const MAX_OUTPUT_GAIN: f64 = 1e6;

/// Names that the formulas of every form may contain in addition to [`REACH_NAMES`].
const COMMON_NAMES: [&str; 2] = ["time_scale", RECORD_START];

impl Effect {
    /// Reads an effect. Its name is the stem of the file name.
    ///
    /// # Errors
    /// If the document is invalid. The report lists all faults.
    pub fn parse(file: &str, text: &str) -> Result<Effect, Box<Report>> {
        let report = |findings| Box::new(Report::new(file, text, findings));
        let root = tree::parse(text).map_err(|finding| report(vec![finding]))?;
        if let Some(finding) = DocumentKind::Effect.wrong_kind(&root) {
            return Err(report(vec![finding]));
        }
        let mut findings = Findings::new();
        let name = Path::new(file).file_stem().map(|stem| stem.to_string_lossy().into_owned());
        let effect = effect(&root, name.unwrap_or_default(), &mut findings);
        findings.iter_mut().for_each(|finding| finding.set_reference_page("docs/effect-format.md"));
        effect.filter(|_| findings.is_empty()).ok_or_else(|| report(findings))
    }
}

/// The effect of a document. `None` if the document is not an object.
fn effect(root: &Node, name: String, findings: &mut Findings) -> Option<Effect> {
    let mut fields = Fields::of(root, "an effect", findings)?;
    if let Some(version) = fields.require("effect", "the version of the format: 1")
        && number(version, "effect", findings).is_some_and(|version| version != FORMAT_VERSION)
    {
        let message = "this program reads version 1 of the format of effects";
        findings.push(Diagnostic::at(Code::UNKNOWN_VERSION, version.span, message));
    }
    let [title, law, physics, source, excitation] = [
        ("title", "the common name of the effect"),
        ("law", "its formula"),
        ("physics", "its physics in a sentence"),
        ("source", "the literature that describes it"),
        ("excitation", "the motion that data must contain to identify it"),
    ]
    .map(|(key, meaning)| required_text(fields.require(key, meaning), key, meaning, findings));
    let mut aliases = IndexMap::new();
    fields.each("aliases", findings, |entry, findings| {
        let condition = string(&entry.value, &entry.key, findings);
        aliases.extend(condition.map(|condition| (entry.key.clone(), condition.value)));
    });
    let (mut parameters, mut declared) = (IndexMap::new(), Vec::new());
    fields.each("parameters", findings, |entry, findings| {
        declared.push(entry.key.as_str());
        if REACH_NAMES.into_iter().chain(COMMON_NAMES).any(|name| name == entry.key) {
            findings.push(duplicate_name(&entry.key, entry.key_span, "parameter", "quantity of every form"));
        }
        if declared.len() == MAX_PARAMETERS + 1 {
            let message = format!("an effect may have at most {MAX_PARAMETERS} parameters");
            findings.push(Diagnostic::at(Code::BAD_NUMBER, entry.value.span, message));
        }
        let parameter = parameter(&entry.value, &entry.key, findings);
        parameters.extend(parameter.map(|parameter| (entry.key.clone(), parameter)));
    });
    let forms = fields.require("forms", "the ways to wire it: a list of one or more");
    let nodes = forms.and_then(|node| list(node, "forms", findings)).unwrap_or_default();
    if let Some(empty) = forms.filter(|_| nodes.is_empty()) {
        let message = "an effect without forms cannot be wired";
        findings.push(Diagnostic::at(Code::MISSING_KEY, empty.span, message));
    }
    let forms = nodes.iter().filter_map(|node| form(node, &parameters, &declared, findings)).collect();
    let parameters = parameters.into_iter().map(|(name, parameter)| (name, parameter.value)).collect();
    fields.finish(findings);
    Some(Effect { name, title, law, physics, source, excitation, aliases, parameters, forms })
}

/// A text that must not be blank, because reports quote it.
fn required_text(node: Option<&Node>, key: &str, meaning: &str, findings: &mut Findings) -> String {
    let Some(text) = node.and_then(|node| string(node, key, findings)) else { return String::new() };
    if text.value.trim().is_empty() {
        let message = format!("\"{key}\" is empty: it needs {meaning}");
        findings.push(Diagnostic::at(Code::MISSING_KEY, text.span, message));
    }
    text.value
}

/// A parameter, with the position of its reach in the text.
fn parameter(node: &Node, name: &str, findings: &mut Findings) -> Option<Placed<EffectParameter>> {
    let mut fields = Fields::of(node, format!("parameter {name}"), findings)?;
    let reach = fields
        .require("reach", "its unit and size, as a product of powers of the largest values: \"sum / own\"");
    let reach = reach.and_then(|node| formula_at(node, "reach", findings));
    let range = fields.require("range", "the least and the largest value of the search, in reaches");
    let range = range.and_then(|node| range_of(node, findings));
    let start = fields.require(
        "start",
        "the values from which fits start, in reaches, or \"spectrum\", \"highest\", \"lowest\"",
    );
    let start = start.and_then(|node| start_rule_of(node, range, findings));
    let null_value = fields.take("none").and_then(|node| null_value_of(node, range, findings));
    let description = fields.text("description", findings);
    fields.finish(findings);
    let Placed { value: reach, span } = reach?;
    let has_known_names = reach.names().iter().all(|name| REACH_NAMES.contains(name));
    if has_known_names {
        check_reach_size(&reach, span, findings);
    }
    if matches!(start, Some(StartRule::Highest | StartRule::Lowest)) && reach.names() != [reach.text()] {
        let message = format!(
            "\"highest\" and \"lowest\" need a reach that is a single name, but the reach is {}",
            reach.text()
        );
        findings.push(Diagnostic::at(Code::BAD_NUMBER, span, message).hint("write the reach as that name"));
    }
    let is_time = |name: &&str| ["sample", "record"].contains(name);
    if start == Some(StartRule::Spectrum) && reach.names().iter().any(|name| !is_time(name)) {
        let message = format!("\"spectrum\" gives frequencies, but the reach is {}", reach.text());
        let finding = Diagnostic::at(Code::UNIT_MISMATCH, span, message);
        findings.push(finding.hint("write the reach as \"1 / record\""));
    }
    let value = EffectParameter { reach, range: range?, start: start?, null_value, description };
    Some(Placed { value, span })
}

/// Reports a reach that is not a product of powers, or whose powers are absurd.
fn check_reach_size(reach: &Formula, span: Span, findings: &mut Findings) {
    let text = reach.text();
    let least = 1.0 / MAX_REACH_AT_TEN;
    let (message, hint) = match reach_at_ten(reach) {
        None => (
            format!("{text} is not a product of powers of the largest values"),
            "write it like \"sum / own^2\"",
        ),
        Some(size) if !(least..=MAX_REACH_AT_TEN).contains(&size) => (
            format!(
                "{text} is {size} if every name is 10: it must be within {least:e} ... {MAX_REACH_AT_TEN:e}"
            ),
            "use smaller powers",
        ),
        Some(_) => return,
    };
    findings.push(Diagnostic::at(Code::BAD_NUMBER, span, message).hint(hint));
}

/// The range of a parameter, in reaches: two increasing numbers.
fn range_of(node: &Node, findings: &mut Findings) -> Option<[f64; 2]> {
    let nodes = list(node, "range", findings)?;
    let numbers: Vec<_> = nodes.iter().map(|node| number(node, "range", findings)).collect();
    let message = match *numbers.as_slice() {
        [Some(low), Some(high)] if low < high && low.abs().max(high.abs()) <= MAX_RANGE => {
            return Some([low, high]);
        }
        [Some(low), Some(high)] if low < high => {
            format!("\"range\" is in reaches, and its ends must be within -{MAX_RANGE} ... {MAX_RANGE}")
        }
        [None, _] | [_, None] => return None,
        _ => "\"range\" takes two numbers, the second above the first".to_owned(),
    };
    findings.push(Diagnostic::at(Code::BAD_NUMBER, node.span, message));
    None
}

/// The value without effect: a number within the range, or "upper" for its upper end.
fn null_value_of(node: &Node, range: Option<[f64; 2]>, findings: &mut Findings) -> Option<f64> {
    let value = match &node.value {
        Content::Text(text) if text == "upper" => range.map(|[_, high]| high),
        _ => number(node, "none", findings),
    };
    check_within(value?, range, node.span, "none", findings);
    value
}

/// The rule for start values: a keyword, or a list of values within the range.
fn start_rule_of(node: &Node, range: Option<[f64; 2]>, findings: &mut Findings) -> Option<StartRule> {
    if let Content::Text(text) = &node.value {
        let rule = StartRule::KEYWORDS.iter().find(|(word, _)| word == text).map(|(_, rule)| rule.clone());
        if rule.is_none() {
            let words = StartRule::KEYWORDS.map(|(word, _)| word);
            let message = format!("\"{text}\" is not one of {}, and not a list of values", words.join(", "));
            let hint = suggestion(text, &words);
            findings.push(Diagnostic::at(Code::UNKNOWN_NAME, node.span, message).maybe_hint(hint));
        }
        return rule;
    }
    let nodes = list(node, "start", findings)?;
    let values: Vec<f64> = nodes.iter().map(|node| number(node, "start", findings)).collect::<Option<_>>()?;
    if !(1..=MAX_START_VALUES).contains(&values.len()) {
        let too_many =
            format!("\"start\" lists {} values; at most {MAX_START_VALUES} are allowed", values.len());
        let none = "\"start\" lists no value: give one or more".to_owned();
        let message = if values.is_empty() { none } else { too_many };
        findings.push(Diagnostic::at(Code::BAD_NUMBER, node.span, message));
    }
    for (value, node) in values.iter().zip(nodes) {
        check_within(*value, range, node.span, "start", findings);
    }
    Some(StartRule::Values(values))
}

/// Reports a value under a key that is outside the range. A range that cannot be read has a report already.
fn check_within(value: f64, range: Option<[f64; 2]>, span: Span, key: &str, findings: &mut Findings) {
    let Some([low, high]) = range.filter(|[low, high]| !(*low..=*high).contains(&value)) else { return };
    let message = format!("\"{key}\" has the value {value}, outside the range {low} ... {high}");
    findings.push(Diagnostic::at(Code::BAD_NUMBER, span, message));
}

/// A form. `declared` are the names of the effect's parameters; `parameters` those that could be read.
fn form(
    node: &Node,
    parameters: &IndexMap<String, Placed<EffectParameter>>,
    declared: &[&str],
    findings: &mut Findings,
) -> Option<Form> {
    let mut fields = Fields::of(node, "a form", findings)?;
    let note = fields.text("note", findings);
    let attachment = attachment_of(&mut fields, findings);
    let signal = fields.take("signal").and_then(|node| parse_unit(node, findings));
    let reads = inputs_of(&mut fields, attachment, findings);
    let gives = outputs_of(&mut fields, attachment, findings);
    let output_gain = fields.take("times").and_then(|node| output_gain_of(node, findings)).unwrap_or(1.0);
    let gains = gains_of(&mut fields, findings);
    let [drives, elements] = ["drives", "elements"].map(|key| entries(fields.take(key), key, findings));
    let free_states = fields.take("free").map(|node| strings(node, "free", findings)).unwrap_or_default();
    let listed = parameters_of(&mut fields, declared, findings);
    fields.finish(findings);
    check_not_empty(&listed, &gives, &elements, node, findings);
    let free_states = free_states.into_iter().filter(|name| is_element(name, &elements, findings));
    let free_states = free_states.map(|name| name.value).collect();
    let placed_gains: Vec<Placed<Formula>> = gains.values().cloned().collect();
    let gains = gains.into_iter().map(|(name, gain)| (name, gain.value)).collect();
    let form = Form {
        note,
        attachment: attachment?,
        signal,
        reads,
        gives,
        output_gain,
        gains,
        drives,
        elements,
        free_states,
        parameters: listed,
    };
    check_distinct_names(&form, node, findings);
    check_parameters_used(&form, node, findings);
    check_reaches(&form, parameters, findings);
    check_gains(&form, &placed_gains, findings);
    Some(form)
}

/// The kind of site at which a form attaches.
fn attachment_of(fields: &mut Fields<'_>, findings: &mut Findings) -> Option<Attachment> {
    let at = fields.require("at", "where it attaches: motion, store, sum, drive, level or total");
    let word = at.and_then(|node| string(node, "at", findings))?;
    one_of(&word, Attachment::ALL, Attachment::word, findings)
}

/// The inputs of a form's fragment.
fn inputs_of(
    fields: &mut Fields<'_>,
    attachment: Option<Attachment>,
    findings: &mut Findings,
) -> Vec<InputRole> {
    let words = fields.take("reads").map(|node| strings(node, "reads", findings)).unwrap_or_default();
    let allowed = attachment.map_or(InputRole::ALL, Attachment::input_roles);
    words.iter().filter_map(|word| one_of(word, allowed, InputRole::word, findings)).collect()
}

/// The outputs of a form's fragment: the destination, and the name of the element that drives it.
fn outputs_of(
    fields: &mut Fields<'_>,
    attachment: Option<Attachment>,
    findings: &mut Findings,
) -> Vec<(OutputRole, String)> {
    let allowed = attachment.map_or(OutputRole::ALL, Attachment::output_roles);
    let mut gives = Vec::new();
    fields.each("gives", findings, |entry, findings| {
        let role = Placed { value: entry.key.clone(), span: entry.key_span };
        let role = one_of(&role, allowed, OutputRole::word, findings);
        let element = string(&entry.value, &entry.key, findings);
        gives.extend(role.zip(element).map(|(role, element)| (role, element.value)));
    });
    gives
}

/// The value of `times`: volts of the sum per volt of the fragment's output.
fn output_gain_of(node: &Node, findings: &mut Findings) -> Option<f64> {
    let value = number(node, "times", findings)?;
    if !(1.0..=MAX_OUTPUT_GAIN).contains(&value) {
        let message = format!("\"times\" must be within 1 ... {MAX_OUTPUT_GAIN}, got {value}");
        findings.push(Diagnostic::at(Code::BAD_NUMBER, node.span, message));
    }
    Some(value)
}

/// The formulas of a form's gains, with their positions in the text.
fn gains_of(fields: &mut Fields<'_>, findings: &mut Findings) -> IndexMap<String, Placed<Formula>> {
    let mut gains = IndexMap::new();
    fields.each("gains", findings, |entry, findings| {
        let gain = formula_at(&entry.value, &entry.key, findings);
        gains.extend(gain.map(|gain| (entry.key.clone(), gain)));
    });
    gains
}

/// The names of a form's parameters: those that it lists, or else all of the effect.
fn parameters_of(fields: &mut Fields<'_>, declared: &[&str], findings: &mut Findings) -> Vec<String> {
    let listed = fields.take("parameters").map(|node| strings(node, "parameters", findings));
    let listed = listed.map(|names| checked_parameters(names, declared, findings));
    listed.unwrap_or_else(|| declared.iter().map(|name| (*name).to_owned()).collect())
}

/// Reports a form without parameters, and one without elements or outputs.
fn check_not_empty(
    parameters: &[String],
    gives: &[(OutputRole, String)],
    elements: &Map<String, Value>,
    node: &Node,
    findings: &mut Findings,
) {
    if parameters.is_empty() {
        let message = "a form needs at least one parameter: its strength, which comes first";
        findings.push(Diagnostic::at(Code::MISSING_KEY, opening(node), message));
    }
    if gives.is_empty() || elements.is_empty() {
        let message = "a form needs \"elements\", and \"gives\" with the destinations of their outputs";
        findings.push(Diagnostic::at(Code::MISSING_KEY, opening(node), message));
    }
}

/// Reports parameters with the name of a gain or drive, because a formula could not distinguish them.
fn check_distinct_names(form: &Form, node: &Node, findings: &mut Findings) {
    let is_taken = |name: &&String| form.gains.contains_key(*name) || form.drives.contains_key(*name);
    for name in form.parameters.iter().filter(is_taken) {
        findings.push(duplicate_name(name, opening(node), "parameter", "gain or drive of this form"));
    }
}

/// Reports parameters that no element and no drive of the form uses. No data could determine their values.
fn check_parameters_used(form: &Form, node: &Node, findings: &mut Findings) {
    let entries = || form.elements.values().chain(form.drives.values());
    for unused in form.parameters.iter().filter(|name| !entries().any(|entry| mentions_name(entry, name))) {
        let message = format!("no formula of this form's elements and drives contains {unused}");
        let hint = "remove it from the form's \"parameters\", or use it";
        findings.push(Diagnostic::at(Code::UNKNOWN_NAME, opening(node), message).hint(hint));
    }
}

/// Reports gains whose formula contains a name that the form does not have.
fn check_gains(form: &Form, gains: &[Placed<Formula>], findings: &mut Findings) {
    let quantities = form.reach_names().into_iter().filter(|name| !["sample", "record"].contains(name));
    let known: Vec<&str> =
        quantities.chain(["time_scale"]).chain(form.parameters.iter().map(String::as_str)).collect();
    for gain in gains {
        check_names(&gain.value, gain.span, &known, findings, |missing| {
            format!("this gain depends on {missing}, which the form does not have")
        });
    }
}

/// Reports parameters whose reach contains a name that the form does not have.
fn check_reaches(
    form: &Form,
    parameters: &IndexMap<String, Placed<EffectParameter>>,
    findings: &mut Findings,
) {
    let (known, at) = (form.reach_names(), form.attachment.word());
    let of_form = form.parameters.iter().filter_map(|name| Some((name, parameters.get(name)?)));
    for (name, parameter) in of_form {
        check_names(&parameter.value.reach, parameter.span, &known, findings, |missing| {
            format!(
                "the reach of {name} contains {missing}, which a form at \"{at}\" with these \"reads\" does not have"
            )
        });
    }
}

/// Reports every name in a formula that is not known, with the message for that name.
fn check_names(
    formula: &Formula,
    span: Span,
    known: &[&str],
    findings: &mut Findings,
    message: impl Fn(&str) -> String,
) {
    for missing in formula.names().into_iter().filter(|name| !known.contains(name)) {
        let hint = format!("the names here are {}", known.join(", "));
        findings.push(Diagnostic::at(Code::UNKNOWN_NAME, span, message(missing)).hint(hint));
    }
}

/// Whether a form has an element with this name; reports it if not.
fn is_element(name: &Placed<String>, elements: &Map<String, Value>, findings: &mut Findings) -> bool {
    let is_known = elements.contains_key(&name.value);
    if !is_known {
        let known: Vec<&str> = elements.keys().map(String::as_str).collect();
        let message = format!("the form has no element {}", name.value);
        let hint = suggestion(&name.value, &known);
        findings.push(Diagnostic::at(Code::UNKNOWN_NAME, name.span, message).maybe_hint(hint));
    }
    is_known
}

/// The names that a form lists as its parameters. Reports unknown and repeated names.
fn checked_parameters(names: Vec<Placed<String>>, declared: &[&str], findings: &mut Findings) -> Vec<String> {
    for name in names.iter().filter(|name| !declared.contains(&name.value.as_str())) {
        let message = format!("the effect has no parameter {}", name.value);
        let hint = suggestion(&name.value, declared);
        findings.push(Diagnostic::at(Code::UNKNOWN_NAME, name.span, message).maybe_hint(hint));
    }
    for (index, name) in names.iter().enumerate() {
        if names[..index].iter().any(|earlier| earlier.value == name.value) {
            let message = format!("this form has the parameter {} twice", name.value);
            let finding = Diagnostic::at(Code::DUPLICATE_NAME, name.span, message);
            findings.push(finding.hint("name it once"));
        }
    }
    names.into_iter().map(|name| name.value).collect()
}

/// The one of `all` with this word. Reports an unknown word.
fn one_of<T: Copy>(
    text: &Placed<String>,
    all: &[T],
    word: impl Fn(T) -> &'static str,
    findings: &mut Findings,
) -> Option<T> {
    let chosen = all.iter().copied().find(|choice| word(*choice) == text.value);
    if chosen.is_none() {
        let words: Vec<_> = all.iter().map(|choice| word(*choice)).collect();
        let message = format!("\"{}\" is not one of {}", text.value, words.join(", "));
        let hint = suggestion(&text.value, &words);
        findings.push(Diagnostic::at(Code::UNKNOWN_NAME, text.span, message).maybe_hint(hint));
    }
    chosen
}

/// An object of objects as a value. The trial patch checks the contents of the inner objects.
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

/// The position of the opening brace of an object, for a fault of the whole object.
fn opening(node: &Node) -> Span {
    Span { start: node.span.start, end: node.span.start + 1 }
}
