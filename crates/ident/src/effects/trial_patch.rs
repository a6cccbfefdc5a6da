//! A small patch that effects of one's own are wired into before they are taken, so that what is wrong with a fragment is told at
//! its place in its own file and not at every junction of a patch.

use std::fmt::Display;
use std::sync::LazyLock;

use crate::effects::Effect;
use crate::effects::attach::{Attached, Role};
use crate::effects::candidate::Candidate;
use crate::effects::reach::Extent;
use crate::effects::sites::Sites;
use patchcord_core::circuit::Circuit;
use patchcord_core::document::tree::{Content, Node};
use patchcord_core::document::{Code, Diagnostic, Report, Severity, Span, tree};
use patchcord_core::ir::Program;
use patchcord_core::patch::{EditError, Patch};

/// The patch: a mass with friction, and two tanks.
static PROBE: LazyLock<Patch> = LazyLock::new(|| {
    Patch::parse("probe.json", include_str!("trial_patch.json")).expect("the trial patch is a document")
});
/// With which its names begin.
const OWN: &str = "probe_";
/// What formulas may name, where the hint tells it of the small patch.
const KNOWN_HINT: &str = "formulas of a form know its parameters, its gains, \"sum\" and what it reads; they leave a pure number: docs/effect-format.md tells more";
/// How far its signals go, in volts,
const EXTENT: f64 = 40.0;
/// what lies between two samples, in seconds,
const SAMPLE: f64 = 0.01;
/// how long a record is,
const RECORD: f64 = 10.0;
/// and the frequencies at which a force is missing, in Hz.
const PEAKS: [f64; 1] = [1.0];

/// Wires every form of an effect, read from this text, wherever it fits.
///
/// # Errors
/// What is wrong with the forms that cannot be wired, each at its elements.
pub(crate) fn check(file: &str, text: &str, effect: &Effect) -> Result<(), Box<Report>> {
    let patch: &Patch = &PROBE;
    let circuit = Circuit::new(patch, &[])?;
    let drives: Vec<&str> = patch.drives.keys().map(String::as_str).collect();
    let sites = Sites::of(&circuit, &drives);
    let all = Attached::all(effect, &sites);
    let root = tree::parse(text).map_err(|finding| Report::new(file, text, vec![finding]))?;
    let elements = elements(&root);
    let mut findings = Vec::new();
    for (number, form) in effect.forms.iter().enumerate() {
        let mut own = all.iter().filter(|attached| std::ptr::eq(attached.form, form));
        let wrong = own.find_map(|attached| wired(attached, patch).err().filter(|own| !is_of_numbers(own)));
        let own = elements.get(number).copied().unwrap_or(&root);
        findings.extend(wrong.map(|error| finding(&error, own)));
    }
    if findings.is_empty() { Ok(()) } else { Err(Box::new(Report::new(file, text, findings))) }
}

fn wired(attached: &Attached<'_>, patch: &Patch) -> Result<(), EditError> {
    let extent = |role: Role<'_>| Some(Extent::of([-EXTENT, EXTENT]).times(role.per_volt()));
    let largest = attached.place.largest(extent, SAMPLE, RECORD);
    let Some(candidate) = Candidate::new(attached, patch, &largest, &PEAKS)? else { return Ok(()) };
    let circuit = Circuit::new(&candidate.graft.patch, &[])?;
    Program::new(&circuit)?;
    Ok(())
}

/// The first thing that is wrong with a form, where it stands in its elements.
fn finding(error: &EditError, elements: &Node) -> Diagnostic {
    let wrong = |what: &dyn Display| format!("this form cannot be wired: {what}");
    let EditError::Text(report) = error else {
        return Diagnostic::at(Code::BadPatch, elements.span, wrong(error));
    };
    let first = report.findings.iter().find(|finding| finding.code.severity() == Severity::Error);
    let Some(first) = first else { return Diagnostic::at(Code::BadPatch, elements.span, wrong(report)) };
    let span = first.span.map_or(elements.span, |span| place(report, span, elements));
    // What names the small patch's own helps nobody.
    let hint = first.hint.clone().map(|hint| if hint.contains(OWN) { KNOWN_HINT.to_owned() } else { hint });
    Diagnostic::at(first.code, span, wrong(&first.message)).maybe_hint(hint)
}

/// Where in the elements of a form something stands that stands there in the patch with them.
fn place(report: &Report, span: Span, elements: &Node) -> Span {
    let Ok(wired) = tree::parse(&report.text) else { return elements.span };
    let keys = wired.keys_to(span.start);
    let ["macros", _, "elements", inner @ ..] = keys.as_slice() else { return elements.span };
    let own = inner.iter().try_fold(elements, |node, key| node.child(key).ok_or(node));
    own.unwrap_or_else(|nearest| nearest).span
}

/// Whether a fault lies in the numbers of the trial, which say nothing of other patches.
fn is_of_numbers(error: &EditError) -> bool {
    let EditError::Text(report) = error else { return false };
    let mut errors = report.findings.iter().filter(|finding| finding.code.severity() == Severity::Error);
    errors.all(|finding| finding.code == Code::SettingOutside)
}

/// The elements of every form.
fn elements(root: &Node) -> Vec<&Node> {
    let Some(Content::List(forms)) = root.child("forms").map(|node| &node.value) else { return Vec::new() };
    forms.iter().map(|form| form.child("elements").unwrap_or(form)).collect()
}
