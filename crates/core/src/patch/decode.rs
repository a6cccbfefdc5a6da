//! From the tree of the text to the patch. Everything wrong is noted, and reading goes on.

use std::collections::HashSet;

use indexmap::IndexMap;

use super::decode_entry::entry;
use super::decode_run::run;
use super::document::{FORMAT_VERSION, Parameter, Patch, PictureSpec, Scale, Signal};
use super::macros;
use crate::document::fields::{Fields, Findings, list, number, positive, word, words};
use crate::document::tree::{self, Content, Node};
use crate::document::{Code, Diagnostic, DocumentKind, Placed, Span, any_error, formula, range, unit_of};
use crate::elements::Family;
use patchcord_expr::{Unit, nearest};

/// Fills a patch from the tree of its text.
///
/// # Errors
/// When the document is not an object.
pub(super) fn document(root: &Node, patch: &mut Patch) -> Result<(), Diagnostic> {
    let mut findings = Findings::new();
    if let Some(finding) = DocumentKind::Patch.instead(root) {
        return Err(finding);
    }
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
    let macros = macros::read(&mut fields, all);
    let mut elements = IndexMap::new();
    fields.each("elements", all, |named, all| {
        keep(&mut elements, lost, named, macros.item(named, all));
    });
    fields.each("signals", all, |named, all| {
        keep(&mut patch.signals, lost, named, signal(named, all));
    });
    patch.run = fields.take("run").map(|node| run(node, all)).unwrap_or_default();
    patch.record = fields.take("record").map(|node| words(node, "record", all)).unwrap_or_default();
    patch.pictures = fields.take("pictures").map(|node| pictures(node, all)).unwrap_or_default();
    patch.note = fields.text("note", all);
    fields.text("$schema", all);
    patch.lost.section = has_lost_section(&fields);
    fields.finish(all);
    macros::write_out(macros, &elements, patch, all);
    patch.own = elements;
    if patch.elements.is_empty() && patch.drives.is_empty() && !any_error(all) {
        all.push(empty(root));
    }
    patch.findings = findings;
    Ok(())
}

fn empty(root: &Node) -> Diagnostic {
    let opening = Span { start: root.span.start, end: root.span.start + 1 };
    let hint = "write \"elements\": {\"A1\": {\"kind\": \"summer\", \"in\": {\"x1\": [\"+100\"]}}}, or begin with \
                `patchcord new`";
    Diagnostic::at(Code::MissingKey, opening, "the patch has neither elements nor drives: nothing can run")
        .hint(hint)
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

pub(super) fn parameter(named: &tree::Entry, findings: &mut Findings) -> Option<Parameter> {
    let mut fields = Fields::of(&named.value, format!("the parameter {}", named.key), findings)?;
    let place = fields.need("value", "a number in the unit of the parameter");
    let value = place.and_then(|node| number(node, "value", findings));
    let unit = unit(&mut fields, findings);
    let range = fields.take("range").and_then(|node| range(node, "range", findings));
    let description = fields.text("description", findings);
    fields.text("note", findings);
    fields.finish(findings);
    let span = named.key_span;
    Some(Parameter { value: value?, unit: unit?, range, description, span, value_span: place?.span })
}

pub(super) fn scale(named: &tree::Entry, findings: &mut Findings) -> Option<Scale> {
    let mut fields = Fields::of(&named.value, format!("the scale {}", named.key), findings)?;
    let per_volt = fields.need("per_volt", "what one volt stands for, in the unit of the scale");
    let per_volt = per_volt.and_then(|node| formula(node, "per_volt", findings));
    let unit = unit(&mut fields, findings);
    fields.text("description", findings);
    fields.text("note", findings);
    fields.finish(findings);
    Some(Scale { per_volt, unit: unit?, span: named.key_span })
}

pub(super) fn unit(fields: &mut Fields<'_>, findings: &mut Findings) -> Option<Unit> {
    let node = fields.need("unit", "such as \"N s/m\", or \"1\" for a pure number")?;
    unit_of(node, findings)
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
