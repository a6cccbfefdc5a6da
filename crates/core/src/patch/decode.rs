//! Decodes the tree of a document into the fields of a patch.
//!
//! Sections are decoded in a fixed order, because macros must be known before elements. Each function takes the keys
//! that it knows from [`Fields`]; `Fields::finish` then reports keys that are missing or unknown. A fault becomes a
//! finding and decoding continues. If an entry cannot be decoded, its name is kept in `UnreadNames`, so that cords from
//! it are not reported as well.

use std::collections::HashSet;

use indexmap::IndexMap;

use super::decode_entry::element_entry;
use super::decode_run::run;
use super::document::{FORMAT_VERSION, Parameter, Patch, PictureSpec, Scale, Signal};
use super::key_synonyms::{patch_advice, scale_advice, signal_advice};
use super::short_forms::{parameter_hint, scale_hint, signal_hint};
use super::{macros, product_hints};
use crate::document::fields::{Fields, Findings, flag, list, number, positive, string, strings, wrong_type};
use crate::document::tree::{self, Content, Node};
use crate::document::{
    Code, Diagnostic, DocumentKind, Placed, Span, any_error, equation_with_tables, factor_violation, formula,
    parse_unit, range,
};
use crate::elements::Family;
use patchcord_expr::{Equation, Unit, nearest};

/// Fills the fields of a patch from the tree of its text.
///
/// # Errors
/// If the document is not an object, is a document of another kind, such as an experiment, or has no key "patchcord".
pub(super) fn document(root: &Node, patch: &mut Patch) -> Result<(), Diagnostic> {
    let mut findings = Findings::new();
    if let Some(finding) = DocumentKind::Patch.wrong_kind(root) {
        return Err(finding);
    }
    let Some(mut fields) = Fields::of(root, "the patch", &mut findings) else {
        return Err(findings.remove(0));
    };
    version(&mut fields, &mut findings);
    patch.title = fields.text("title", &mut findings);
    patch.source = fields.text("source", &mut findings);
    patch.machine = fields.take("machine").and_then(|node| string(node, "machine", &mut findings));
    patch.time_scale = time_scale(&mut fields, &mut findings);
    let unread = &mut patch.unread.names;
    fields.each("parameters", &mut findings, |entry, findings| {
        store(&mut patch.parameters, unread, entry, parameter(entry, findings));
    });
    fields.each("scales", &mut findings, |entry, findings| {
        store(&mut patch.scales, unread, entry, scale(entry, findings));
    });
    fields.each("drives", &mut findings, |entry, findings| {
        store(&mut patch.drives, unread, entry, element_entry(entry, Family::Drive, findings));
    });
    let macros = macros::decode_macros(&mut fields, &mut findings);
    let mut element_section = IndexMap::new();
    fields.each("elements", &mut findings, |entry, findings| {
        store(&mut element_section, unread, entry, macros.section_entry(entry, findings));
    });
    fields.each("signals", &mut findings, |entry, findings| {
        store(&mut patch.signals, unread, entry, signal(entry, findings));
    });
    let equation_list = fields.take("equations");
    patch.equations =
        equation_list.map(|node| equations(node, &[], unread, &mut findings)).unwrap_or_default();
    let positive_feedback = fields.take("positive_feedback");
    patch.positive_feedback =
        positive_feedback.and_then(|node| flag(node, "positive_feedback", &mut findings)).unwrap_or_default();
    patch.run = fields.take("run").map(|node| run(node, &mut findings)).unwrap_or_default();
    patch.record =
        fields.take("record").map(|node| strings(node, "record", &mut findings)).unwrap_or_default();
    patch.pictures = fields.take("pictures").map(|node| pictures(node, &mut findings)).unwrap_or_default();
    patch.note = fields.text("note", &mut findings);
    fields.text("$schema", &mut findings);
    patch.unread.has_unread_section = has_unread_section(&fields, &NAME_SECTIONS);
    fields.finish_with_advice(&patch_advice, &mut findings);
    product_hints::offer_products(root, &mut findings);
    macros::expand_macros(macros, &element_section, patch, &mut findings);
    patch.element_section = element_section;
    report_empty(patch, root, &mut findings);
    patch.findings = findings;
    Ok(())
}

/// Reports a patch without elements and drives, at the opening brace of the document. After other errors, the missing
/// elements may be those that could not be read.
fn report_empty(patch: &Patch, root: &Node, findings: &mut Findings) {
    if any_error(findings) || !patch.elements.is_empty() || !patch.drives.is_empty() {
        return;
    }
    let opening = Span { start: root.span.start, end: root.span.start + 1 };
    let hint = "write \"elements\": {\"A1\": {\"kind\": \"summer\", \"in\": {\"x1\": [\"+100\"]}}}, or begin with \
                `patchcord new`";
    let message = "the patch has neither elements nor drives: nothing can run";
    findings.push(Diagnostic::at(Code::MISSING_KEY, opening, message).hint(hint));
}

/// The sections whose names other parts of the document refer to.
const NAME_SECTIONS: [&str; 5] = ["parameters", "scales", "drives", "elements", "signals"];

/// Whether one of these sections could not be read: it is not an object, or its key is misspelled.
pub(super) fn has_unread_section(fields: &Fields<'_>, sections: &[&str]) -> bool {
    fields.entries.iter().any(|(entry, is_taken)| match is_taken {
        true => sections.contains(&entry.key.as_str()) && !matches!(entry.value.value, Content::Object(_)),
        false => nearest(&entry.key, sections.iter().copied()).is_some(),
    })
}

/// Stores a decoded value under the name of its entry. If there is no value, the name is added to the unread names.
pub(super) fn store<T>(
    section: &mut IndexMap<String, T>,
    unread: &mut HashSet<String>,
    entry: &tree::KeyValue,
    value: Option<T>,
) {
    match value {
        Some(value) => drop(section.insert(entry.key.clone(), value)),
        None => drop(unread.insert(entry.key.clone())),
    }
}

/// Checks the required key "patchcord" with the version of the format.
///
/// Another version is reported, but decoding continues: most keys have the same meaning.
pub(super) fn version(fields: &mut Fields<'_>, findings: &mut Findings) {
    let Some(node) = fields.require("patchcord", "the version of the format: write \"patchcord\": 1") else {
        return;
    };
    if number(node, "patchcord", findings).is_some_and(|version| version != FORMAT_VERSION as f64) {
        findings.push(
            Diagnostic::at(Code::UNKNOWN_VERSION, node.span, "this version of the format is not known")
                .hint(format!("this program reads version {FORMAT_VERSION}")),
        );
    }
}

/// The time scale in machine seconds per problem second; 1 if it is absent or invalid.
fn time_scale(fields: &mut Fields<'_>, findings: &mut Findings) -> f64 {
    let Some(scale) = positive(fields, "time_scale", findings) else { return 1.0 };
    let value = scale.value;
    match factor_violation("\"time_scale\"", scale) {
        None => value,
        Some(finding) => {
            findings.push(finding);
            1.0
        }
    }
}

/// Decodes an entry of "parameters". `None` if the value or the unit cannot be read.
pub(super) fn parameter(entry: &tree::KeyValue, findings: &mut Findings) -> Option<Parameter> {
    let noun = format!("the parameter {}", entry.key);
    let mut fields = Fields::of_with_hint(&entry.value, noun, parameter_hint(entry), findings)?;
    let value_node = fields.require("value", "a number in the unit of the parameter");
    let value = value_node.and_then(|node| number(node, "value", findings));
    let unit = unit(&mut fields, findings);
    let range = fields.take("range").and_then(|node| range(node, "range", findings));
    let description = fields.text("description", findings);
    fields.text("note", findings);
    fields.finish(findings);
    let (span, value_span) = (entry.key_span, value_node?.span);
    Some(Parameter { value: value?, unit: unit?, range, description, span, value_span })
}

/// Decodes an entry of "scales". `None` if the unit cannot be read.
///
/// A scale whose value cannot be read is kept, because its unit is sufficient for the check of other units.
pub(super) fn scale(entry: &tree::KeyValue, findings: &mut Findings) -> Option<Scale> {
    let noun = format!("the scale {}", entry.key);
    let mut fields = Fields::of_with_hint(&entry.value, noun, scale_hint(entry), findings)?;
    let per_volt = fields.require("per_volt", "the value of one volt, in the unit of the scale");
    let per_volt = per_volt.and_then(|node| formula(node, "per_volt", findings));
    let unit = unit(&mut fields, findings);
    fields.text("description", findings);
    fields.text("note", findings);
    fields.finish_with_advice(&scale_advice, findings);
    Some(Scale { per_volt, unit: unit?, span: entry.key_span })
}

/// Decodes the required key "unit".
pub(super) fn unit(fields: &mut Fields<'_>, findings: &mut Findings) -> Option<Unit> {
    let node = fields.require("unit", "such as \"N s/m\", or \"1\" for a pure number")?;
    parse_unit(node, findings)
}

/// Decodes an entry of "signals". `None` if the element cannot be read.
fn signal(entry: &tree::KeyValue, findings: &mut Findings) -> Option<Signal> {
    let noun = format!("the signal {}", entry.key);
    let mut fields = Fields::of_with_hint(&entry.value, noun, signal_hint(entry), findings)?;
    let element = fields.require("at", "the element whose output is read");
    let element = element.and_then(|node| string(node, "at", findings));
    let scale = fields.take("scale").and_then(|node| string(node, "scale", findings));
    let factor = fields.take("factor").and_then(|node| factor(node, findings));
    fields.text("description", findings);
    fields.text("note", findings);
    fields.finish_with_advice(&signal_advice, findings);
    Some(Signal { element: element?, scale, factor: factor.unwrap_or(1.0), span: entry.key_span })
}

/// Decodes the factor of a signal. A factor of 0 is reported.
fn factor(node: &Node, findings: &mut Findings) -> Option<f64> {
    let factor = number(node, "factor", findings)?;
    if factor == 0.0 {
        findings.push(Diagnostic::at(Code::BAD_NUMBER, node.span, "\"factor\" must not be 0"));
    }
    Some(factor)
}

/// What to write in place of an equation that is not a text.
const EQUATIONS_HINT: &str = "write a list of texts, such as [\"x' = v\", \"m v' = -k x\"]";

/// Decodes the list "equations", or a single equation. `tables` has the names of the tables that they can apply.
///
/// An equation that cannot be read may define an auxiliary quantity. The name on its left side is added to the unread
/// names, so that the equations that use it are not reported as well.
pub(super) fn equations(
    node: &Node,
    tables: &[&str],
    unread: &mut HashSet<String>,
    findings: &mut Findings,
) -> Vec<Placed<Equation>> {
    let items = match &node.value {
        Content::List(items) => items.as_slice(),
        _ => std::slice::from_ref(node),
    };
    let mut equations = Vec::new();
    for item in items {
        let Content::Text(text) = &item.value else {
            findings.push(wrong_type(item, "equations", "a text", &item.value).hint(EQUATIONS_HINT));
            continue;
        };
        match equation_with_tables(item, "equations", tables, findings) {
            Some(equation) => equations.push(equation),
            None => {
                let left = text.split('=').next().unwrap_or_default();
                unread.insert(left.trim().to_owned());
            }
        }
    }
    equations
}

/// Decodes the list "pictures".
fn pictures(node: &Node, findings: &mut Findings) -> Vec<PictureSpec> {
    let items = list(node, "pictures", findings).unwrap_or_default();
    items.iter().filter_map(|item| picture(item, findings)).collect()
}

/// Decodes one picture. Without "x" it shows the signals against time. Scales are equal unless the picture says
/// otherwise.
///
/// Time is written as the name "t". The position of this name is that of the picture.
fn picture(node: &Node, findings: &mut Findings) -> Option<PictureSpec> {
    let mut fields = Fields::of(node, "a picture", findings)?;
    let title = fields.text("title", findings);
    let x = match fields.take("x") {
        Some(node) => string(node, "x", findings),
        None => Some(Placed { value: "t".to_owned(), span: node.span }),
    };
    let y = fields
        .require("y", "the signals along the vertical axis")
        .map(|node| picture_signals(node, findings));
    let equal_scales =
        fields.take("equal_scales").and_then(|node| flag(node, "equal_scales", findings)).unwrap_or(true);
    fields.text("note", findings);
    fields.finish(findings);
    Some(PictureSpec { title, x: x?, y: y?, equal_scales })
}

/// Decodes the signals along the vertical axis of a picture. At least one is required.
fn picture_signals(node: &Node, findings: &mut Findings) -> Vec<Placed<String>> {
    if matches!(&node.value, Content::List(items) if items.is_empty()) {
        let message = "the picture shows no signal";
        let hint = "name the signals along the vertical axis, or remove the picture";
        findings.push(Diagnostic::at(Code::MISSING_KEY, node.span, message).hint(hint));
    }
    strings(node, "y", findings)
}
