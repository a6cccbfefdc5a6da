//! Reads an effect from its document and checks it. docs/effect-format.md describes the format.
//!
//! All faults of a document are collected, each with its position in the text. The checks here need only the document:
//! keys, types, ranges and names. `form` reads the forms. `wiring_check` then checks that
//! each form can be wired.

mod form;

use std::path::Path;

use indexmap::IndexMap;

use crate::data::drive_timing::RECORD_START;
use crate::effects::reach::{REACH_NAMES, reach_at_ten};
use crate::effects::{Effect, EffectParameter, StartRule};
use patchcord_core::document::fields::{Fields, Findings, list, number, string};
use patchcord_core::document::tree::{Content, Node};
use patchcord_core::document::{
    Code, Diagnostic, DocumentKind, Placed, Report, Span, formula as formula_at, suggestion, tree,
};
use patchcord_core::patch::duplicate_name;
use patchcord_expr::Formula;

use form::form;

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
    let (parameters, declared) = parameters_of(&mut fields, findings);
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

/// The parameters that could be read, with the positions of their reaches in the text, and the names of all.
fn parameters_of<'n>(
    fields: &mut Fields<'n>,
    findings: &mut Findings,
) -> (IndexMap<String, Placed<EffectParameter>>, Vec<&'n str>) {
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
    (parameters, declared)
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
