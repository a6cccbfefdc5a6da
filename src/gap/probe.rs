//! A small patch that effects of one's own are wired into before they are taken, so that what is wrong with a fragment is told at
//! its place in its own file and not at every junction of a patch.

use super::candidate::Candidate;
use super::effect::Effect;
use super::graft::{Attached, Role};
use super::model::ModelError;
use super::site::Sites;
use crate::circuit::Circuit;
use crate::patch::tree::{self, Content};
use crate::patch::{Code, Diagnostic, EditError, Patch, Report, Severity, Span};
use crate::program::Program;

/// The patch: a mass with friction, and two tanks.
static PROBE: &str = include_str!("probe.json");
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
pub(super) fn check(file: &str, text: &str, effect: &Effect) -> Result<(), Box<Report>> {
    let patch = Patch::parse("probe.json", PROBE)?;
    let circuit = Circuit::new(&patch, &[])?;
    let drives: Vec<&str> = patch.drives.keys().map(String::as_str).collect();
    let sites = Sites::of(&circuit, &drives);
    let (all, spans) = (Attached::all(effect, &sites), spans(text));
    let mut findings = Vec::new();
    for (number, form) in effect.forms.iter().enumerate() {
        let mut own = all.iter().filter(|attached| std::ptr::eq(attached.form, form));
        let wrong = own.find_map(|attached| wired(attached, &patch).err().filter(|own| !is_of_numbers(own)));
        findings.extend(wrong.map(|error| finding(&error, spans.get(number).copied().unwrap_or_default())));
    }
    if findings.is_empty() { Ok(()) } else { Err(Box::new(Report::new(file, text, findings))) }
}

fn wired(attached: &Attached<'_>, patch: &Patch) -> Result<(), ModelError> {
    let ends = |role: Role<'_>| Some([-EXTENT, EXTENT].map(|volts| volts * role.per_volt()));
    let largest = attached.place.largest(ends, SAMPLE, RECORD);
    let Some(candidate) = Candidate::new(attached, patch, &largest, &PEAKS)? else { return Ok(()) };
    let circuit = Circuit::new(&candidate.graft.patch, &[])?;
    Program::new(&circuit)?;
    Ok(())
}

/// The first thing that is wrong with a form, where its elements stand.
fn finding(error: &ModelError, span: Span) -> Diagnostic {
    let (ModelError::Patch(report) | ModelError::Edit(EditError::Text(report))) = error else {
        return Diagnostic::at(Code::BadPatch, span, format!("this form cannot be wired: {error}"));
    };
    let first = report.findings.iter().find(|finding| finding.code.severity() == Severity::Error);
    let Some(first) = first else { return Diagnostic::at(Code::BadPatch, span, "this form cannot be wired") };
    Diagnostic::at(first.code, span, format!("this form cannot be wired: {}", first.message))
        .maybe_hint(first.hint.clone())
}

/// Whether a fault lies in the numbers of the trial, which say nothing of other patches.
fn is_of_numbers(error: &ModelError) -> bool {
    let (ModelError::Patch(report) | ModelError::Edit(EditError::Text(report))) = error else { return false };
    let mut errors = report.findings.iter().filter(|finding| finding.code.severity() == Severity::Error);
    errors.all(|finding| finding.code == Code::SettingOutside)
}

/// Where the elements of every form stand.
fn spans(text: &str) -> Vec<Span> {
    let root = tree::parse(text).ok();
    let forms = root.as_ref().and_then(|root| root.child("forms"));
    let Some(Content::List(forms)) = forms.map(|node| &node.value) else { return Vec::new() };
    forms.iter().map(|form| form.child("elements").unwrap_or(form).span).collect()
}
