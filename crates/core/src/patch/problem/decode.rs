//! Decodes the tree of a document into a problem.
//!
//! The sections are decoded first. Then parts with wrong names are removed, and the patch of the problem gets its scales
//! and signals. Equations follow, because their parser needs the names of the tables. The checks of [`super::check`]
//! and [`super::initial`] come last.

use indexmap::IndexMap;

use super::entries::{drive, quantity, table};
use super::key_synonyms::problem_advice;
use super::{Problem, ProblemTable, check, initial, names};
use crate::document::fields::{Fields, Findings};
use crate::document::tree::Node;
use crate::document::{Code, Diagnostic, DocumentKind, Placed, Span, any_error, format_number};
use crate::patch::decode::{equations, has_unread_section, parameter, store, version};
use crate::patch::decode_run::run;
use crate::patch::{Patch, RunPlan, Scale, Signal, product_hints};
use patchcord_expr::{Equation, Formula, Unit, split_primes};

/// The page that describes problems, for hints.
const REFERENCE_PAGE: &str = "docs/problem-format.md";

/// The form of a problem, for a document that is no object.
pub(super) const DOCUMENT_HINT: &str = "a problem is {\"patchcord\": 1, \"quantities\": {...}, \"equations\": [...], \
                                        \"run\": {...}}: see docs/problem-format.md";

/// The sections whose names other parts of the document use.
const NAME_SECTIONS: [&str; 4] = ["parameters", "quantities", "drives", "tables"];

/// The reference whose voltage is 0. The signals of a problem are there.
const GROUND: &str = "ground";

/// Fills a problem from the tree of its text.
///
/// # Errors
/// If the document is not an object, or is a document of another kind.
pub(super) fn document(root: &Node, problem: &mut Problem) -> Result<(), Diagnostic> {
    let mut findings = Findings::new();
    if let Some(finding) = DocumentKind::Problem.wrong_kind(root) {
        return Err(finding);
    }
    let hint = Some(DOCUMENT_HINT.to_owned());
    let Some(mut fields) = Fields::of_with_hint(root, "the problem", hint, &mut findings) else {
        return Err(findings.remove(0));
    };
    version(&mut fields, &mut findings);
    texts(&mut fields, &mut problem.patch, &mut findings);
    let declared = sections(&mut fields, problem, &mut findings);
    names::check(problem, &mut findings);
    check::check_drives(problem, &mut findings);
    complete_patch(problem, &declared.drive_units);
    equations_section(&mut fields, problem, &declared.tables, &mut findings);
    run_section(&mut fields, &mut problem.patch, &mut findings);
    let lacks_section = lacks_section(&fields);
    if !lacks_section && root.child("quantities").is_none() {
        findings.push(without_quantities(root));
    }
    problem.patch.unread.has_unread_section |= lacks_section || problem.quantities.is_empty();
    fields.finish_with_advice(&problem_advice, &mut findings);
    product_hints::offer_products(root, &mut findings);
    check::check_derivatives(problem, &mut findings);
    initial::check(problem, &mut findings);
    check::check_equations(problem, &mut findings);
    if !any_error(&findings) {
        report_empty(problem, root, &mut findings);
        check::warn_of_unused(problem, &mut findings);
    }
    findings.iter_mut().for_each(|finding| finding.set_reference_page(REFERENCE_PAGE));
    problem.patch.findings = findings;
    Ok(())
}

/// Decodes the texts for readers.
fn texts(fields: &mut Fields<'_>, patch: &mut Patch, findings: &mut Findings) {
    patch.title = fields.text("title", findings);
    patch.source = fields.text("source", findings);
    patch.note = fields.text("note", findings);
    fields.text("$schema", findings);
}

/// What the sections declare in addition to the parts that could be read.
struct Declared {
    /// The units of the drives.
    drive_units: IndexMap<String, Unit>,
    /// The names of all tables, also of those that could not be read.
    tables: Vec<String>,
}

/// Decodes the sections with parameters, quantities, drives and tables.
fn sections(fields: &mut Fields<'_>, problem: &mut Problem, findings: &mut Findings) -> Declared {
    let Problem { patch, quantities, tables } = problem;
    let Patch { parameters, drives, unread, .. } = patch;
    let unread = &mut unread.names;
    let mut declared = Declared { drive_units: IndexMap::new(), tables: Vec::new() };
    fields.each("parameters", findings, |entry, findings| {
        store(parameters, unread, entry, parameter(entry, findings));
    });
    fields.each("quantities", findings, |entry, findings| {
        store(quantities, unread, entry, quantity(entry, findings));
    });
    fields.each("drives", findings, |entry, findings| {
        let (drive, unit) = drive(entry, findings).unzip();
        store(drives, unread, entry, drive);
        declared.drive_units.extend(unit.map(|unit| (entry.key.clone(), unit)));
    });
    fields.each("tables", findings, |entry, findings| {
        store(tables, unread, entry, table(entry, findings));
        declared.tables.push(entry.key.clone());
    });
    declared
}

/// Gives the patch of a problem a scale for each quantity without primes and for each drive, a signal for each of these
/// quantities, and the dimensions of the tables.
///
/// The quantities and drives are recorded, so that the circuit does not report them as unused.
fn complete_patch(problem: &mut Problem, drive_units: &IndexMap<String, Unit>) {
    let Problem { patch, quantities, tables } = problem;
    let placed = |name: &str, span: Span| Placed { value: name.to_owned(), span };
    for (name, quantity) in quantities.iter().filter(|(name, _)| split_primes(name).1 == 0) {
        let span = quantity.span;
        let (element, scale) = (placed(GROUND, span), Some(placed(name, span)));
        patch.signals.insert(name.clone(), Signal { element, scale, factor: 1.0, span });
        patch.scales.insert(name.clone(), scale_of(&quantity.unit, 1.0, span));
        patch.record.push(placed(name, span));
    }
    for (name, drive) in &patch.drives {
        if let Some(unit) = drive_units.get(name) {
            patch.scales.insert(name.clone(), scale_of(unit, UNITS_PER_VOLT_OF_DRIVE, drive.span));
            patch.record.push(placed(name, drive.span));
        }
    }
    let dimensions = |table: &ProblemTable| (table.input_unit.dimension(), table.output_unit.dimension());
    let tables = tables.iter().map(|(name, table)| (name.clone(), dimensions(table)));
    patch.problem_tables = Some(tables.collect());
}

/// The number of units per volt in the scale of a drive. The voltage of a drive is limited to 100 V, and this number is so
/// large that the limit is never reached.
const UNITS_PER_VOLT_OF_DRIVE: f64 = 1e9;

/// A scale with this number of units per volt.
fn scale_of(unit: &Unit, per_volt: f64, span: Span) -> Scale {
    let per_volt = Some(Placed { value: Formula::constant(per_volt), span });
    Scale { per_volt, unit: unit.clone(), span }
}

/// Decodes the required section "equations". `declared` has the names of all tables.
///
/// Equations with a table that could not be read are left out, because their dimensions are not known. They may define
/// auxiliary quantities, so unknown names are then not reported.
fn equations_section(
    fields: &mut Fields<'_>,
    problem: &mut Problem,
    declared: &[String],
    findings: &mut Findings,
) {
    let meaning = "the equations of the quantities, such as [\"m x'' = -k x\"]";
    let Some(node) = fields.require("equations", meaning) else { return };
    let names: Vec<&str> = declared.iter().map(String::as_str).collect();
    let Problem { patch, tables, .. } = problem;
    patch.equations = equations(node, &names, &mut patch.unread.names, findings);
    let mut unreadable = names;
    unreadable.retain(|name| !tables.contains_key(*name));
    if !unreadable.is_empty() {
        patch.unread.has_unread_section = true;
        let is_used =
            |equation: &Equation| unreadable.iter().any(|name| check::applies_table(equation, name));
        patch.equations.retain(|placed| !is_used(&placed.value));
    }
}

/// Decodes the required section "run". It must have a length, a step or a tolerance, and no phases.
fn run_section(fields: &mut Fields<'_>, patch: &mut Patch, findings: &mut Findings) {
    let meaning = "the length of the run in s: \"run\": {\"for\": 10, \"step\": 0.01}";
    let Some(node) = fields.require("run", meaning) else { return };
    let reported = findings.len();
    patch.run = run(node, findings);
    if let Some(phases) = node.child("phases") {
        patch.run.phases.clear();
        let message = "the run of a problem has no phases";
        let hint =
            "write \"for\", the length of the run; add phases to the patch that `patchcord scale` makes";
        findings.push(Diagnostic::at(Code::UNKNOWN_KEY, phases.span, message).hint(hint));
    } else if findings.len() == reported {
        report_missing_times(node, &patch.run, findings);
    }
}

/// A run has this number of steps in the hint about a missing step.
const ADVISED_STEPS: f64 = 1000.0;
/// The length of a run in s for the hint about a missing step, if the run has none.
const ADVISED_LENGTH: f64 = 10.0;

/// Reports the times that a run lacks: its length, and its step or tolerance.
fn report_missing_times(node: &Node, run: &RunPlan, findings: &mut Findings) {
    let length = run.duration.as_ref().map(|duration| duration.value);
    if length.is_none() {
        let finding = Diagnostic::at(Code::MISSING_KEY, opening(node), "\"run\" needs \"for\"");
        findings.push(finding.hint("the length of the run in s"));
    }
    if run.step.is_none() && run.tolerance.is_none() {
        let step = format_number(length.unwrap_or(ADVISED_LENGTH) / ADVISED_STEPS);
        let hint = format!("write \"step\": {step}, in s, or \"tolerance\": 1e-6 for steps that adapt");
        let message = "\"run\" needs \"step\" or \"tolerance\"";
        findings.push(Diagnostic::at(Code::MISSING_KEY, opening(node), message).hint(hint));
    }
}

/// The position of the brace with which an object begins.
fn opening(node: &Node) -> Span {
    Span { start: node.span.start, end: node.span.start + 1 }
}

/// The diagnostic for a problem without the key "quantities".
fn without_quantities(root: &Node) -> Diagnostic {
    let hint = "the unknowns with their units: \"quantities\": {\"x\": {\"unit\": \"mm\", \"initial\": 50}}";
    Diagnostic::at(Code::MISSING_KEY, opening(root), "the problem needs \"quantities\"").hint(hint)
}

/// Whether a section of names could not be read: it is not an object, or its key is misspelled or another word for it.
fn lacks_section(fields: &Fields<'_>) -> bool {
    let means_section =
        |key: &str| problem_advice(key).is_some_and(|advice| NAME_SECTIONS.contains(&advice.key));
    has_unread_section(fields, &NAME_SECTIONS) || fields.remaining().any(|entry| means_section(&entry.key))
}

/// Reports empty sections of quantities or equations, if there is no other error.
fn report_empty(problem: &Problem, root: &Node, findings: &mut Findings) {
    let sections = [
        ("quantities", problem.quantities.is_empty(), "\"x\": {\"unit\": \"mm\", \"initial\": 50}"),
        ("equations", problem.patch.equations.is_empty(), "\"m x'' = -k x\""),
    ];
    for (section, is_empty, example) in sections {
        let span = root.child(section).map_or(root.span, |node| node.span);
        if is_empty {
            let message = format!("the problem has no {section}");
            let hint = format!("write {section}, such as {example}");
            findings.push(Diagnostic::at(Code::MISSING_KEY, span, message).hint(hint));
        }
    }
}
