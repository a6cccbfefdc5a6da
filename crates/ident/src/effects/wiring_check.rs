//! Checks an effect of a user: every form is wired into a small example patch before the effect is used.
//!
//! This reports a fault in a fragment once, with its position in the effect's file. Otherwise it would appear at every
//! site of the user's patch. The example patch has a mass with friction and two tanks, so that every kind of
//! site occurs. Settings outside 0 ... 1 are ignored, because they depend on its numbers.

use std::fmt::Display;
use std::sync::LazyLock;

use crate::data::codes;
use crate::effects::Effect;
use crate::effects::attach::{EffectPlacement, FormulaQuantity};
use crate::effects::candidate::Candidate;
use crate::effects::reach::Extent;
use crate::effects::sites::Sites;
use patchcord_core::circuit::Circuit;
use patchcord_core::document::tree::{Content, Node};
use patchcord_core::document::{Code, Diagnostic, Report, Severity, Span, tree};
use patchcord_core::ir::Program;
use patchcord_core::patch::{EditError, Patch};

/// The example patch.
static EXAMPLE_PATCH: LazyLock<Patch> = LazyLock::new(|| {
    Patch::parse("probe.json", include_str!("example_patch.json")).expect("the example patch is valid")
});
/// The prefix of all names of the example patch. A hint that contains it would confuse the user.
const NAME_PREFIX: &str = "probe_";
/// The hint that replaces one with names of the example patch.
const NAMES_HINT: &str = "formulas of a form may contain its parameters, its gains, \"sum\" and the words of its \
    \"reads\"; their results must have no unit: see docs/effect-format.md";
/// The assumed amplitude of all signals, in volts. It is well within the range of the machine.
const AMPLITUDE: f64 = 40.0;
/// The assumed sampling interval, in seconds.
const SAMPLING_INTERVAL: f64 = 0.01;
/// The assumed length of the record, in seconds.
const RECORD_LENGTH: f64 = 10.0;
/// The assumed peaks in the spectrum of the residuals, in Hz.
const SPECTRUM_PEAKS: [f64; 1] = [1.0];

/// Wires every form of an effect into the example patch, wherever it fits. `text` is the document of the effect.
///
/// # Errors
/// If a form cannot be wired. The report has the first fault of each such form, at its elements.
pub(crate) fn check(file: &str, text: &str, effect: &Effect) -> Result<(), Box<Report>> {
    let patch: &Patch = &EXAMPLE_PATCH;
    let circuit = Circuit::new(patch)?;
    let drives: Vec<&str> = patch.drives.keys().map(String::as_str).collect();
    let sites = Sites::of(&circuit, &drives);
    let placements = EffectPlacement::all(effect, &sites);
    let root = tree::parse(text).map_err(|finding| Report::new(file, text, vec![finding]))?;
    let elements = elements_of_forms(&root);
    let mut findings = Vec::new();
    for (index, form) in effect.forms.iter().enumerate() {
        let mut of_form = placements.iter().filter(|placement| std::ptr::eq(placement.form, form));
        let error = of_form
            .find_map(|placement| wire(placement, patch).err().filter(|error| !is_about_settings(error)));
        let form_elements = elements.get(index).copied().unwrap_or(&root);
        findings.extend(error.map(|error| finding(&error, form_elements)));
    }
    if findings.is_empty() { Ok(()) } else { Err(Box::new(Report::new(file, text, findings))) }
}

/// Wires one placement and compiles the result.
///
/// Signals of the example patch are assumed to swing by 40 V, so reaches have plausible sizes.
fn wire(placement: &EffectPlacement<'_>, patch: &Patch) -> Result<(), EditError> {
    let extent =
        |quantity: FormulaQuantity<'_>| Some(Extent::of([-AMPLITUDE, AMPLITUDE]).times(quantity.per_volt()));
    let sizes = placement.site.quantity_sizes(extent, SAMPLING_INTERVAL, RECORD_LENGTH);
    let Some(candidate) = Candidate::new(placement, patch, &sizes, &SPECTRUM_PEAKS)? else { return Ok(()) };
    let circuit = Circuit::new(&candidate.graft.patch)?;
    Program::new(&circuit)?;
    Ok(())
}

/// The first fault of a form, with its position in the form's elements.
fn finding(error: &EditError, elements: &Node) -> Diagnostic {
    let message = |cause: &dyn Display| format!("this form cannot be wired: {cause}");
    let EditError::InvalidDocument(report) = error else {
        return Diagnostic::at(codes::BAD_PATCH, elements.span, message(error));
    };
    let first = report.findings.iter().find(|finding| finding.code.severity() == Severity::Error);
    let Some(first) = first else { return Diagnostic::at(codes::BAD_PATCH, elements.span, message(report)) };
    let span = first.span.map_or(elements.span, |span| span_in_effect(report, span, elements));
    let hint =
        first.hint.clone().map(|hint| if hint.contains(NAME_PREFIX) { NAMES_HINT.to_owned() } else { hint });
    Diagnostic::at(first.code, span, message(&first.message)).maybe_hint(hint)
}

/// The position in the form's elements of something at `span` in the extended patch. If it has no exact counterpart,
/// the nearest enclosing entry counts.
fn span_in_effect(report: &Report, span: Span, elements: &Node) -> Span {
    let Ok(extended) = tree::parse(&report.text) else { return elements.span };
    let keys = extended.key_path(span.start);
    let ["macros", _, "elements", inner @ ..] = keys.as_slice() else { return elements.span };
    let counterpart = inner.iter().try_fold(elements, |node, key| node.child(key).ok_or(node));
    counterpart.unwrap_or_else(|nearest| nearest).span
}

/// Whether an error is only about settings out of range, which depend on the numbers of the example patch.
fn is_about_settings(error: &EditError) -> bool {
    let EditError::InvalidDocument(report) = error else { return false };
    let mut errors = report.findings.iter().filter(|finding| finding.code.severity() == Severity::Error);
    errors.all(|finding| finding.code == Code::SETTING_OUTSIDE)
}

/// The "elements" of every form of an effect's document; the form itself if it has none.
fn elements_of_forms(root: &Node) -> Vec<&Node> {
    let Some(Content::List(forms)) = root.child("forms").map(|node| &node.value) else { return Vec::new() };
    forms.iter().map(|form| form.child("elements").unwrap_or(form)).collect()
}
