//! Reads the forms of an effect: where each attaches, its inputs, outputs, gains and elements.

use indexmap::IndexMap;
use serde_json::{Map, Value};

use crate::data::drive_timing::mentions_name;
use crate::effects::{Attachment, EffectParameter, Form, InputRole, OutputRole};
use patchcord_core::document::fields::{Fields, Findings, number, string, strings, wrong_type};
use patchcord_core::document::tree::{Content, Node};
use patchcord_core::document::{
    Code, Diagnostic, Placed, Span, formula as formula_at, parse_unit, suggestion,
};
use patchcord_core::patch::duplicate_name;
use patchcord_expr::Formula;

/// Largest value of `times`: volts of the sum per volt of the fragment's output.
const MAX_OUTPUT_GAIN: f64 = 1e6;

/// A form. `declared` are the names of the effect's parameters; `parameters` those that could be read.
pub(super) fn form(
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

/// An object of objects as a value. `wiring_check` checks the contents of the inner objects.
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
