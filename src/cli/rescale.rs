//! `patchcord scale` of a patch: the same patch with other scales, or with another time scale.
//!
//! The tables of scales and peaks come first, then the changes of the document with the gain rule, the files and the
//! warnings of the new patch. Without `--out` nothing is written.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::failure::{Failure, eprint_report};
use super::files::{path_text, path_texts, quoted};
use super::load::title_of;
use super::outputs::Outputs;
use super::table::Table;
use super::{print, print_json};
use patchcord::circuit::Circuit;
use patchcord::document::{DiagnosticDocument, DocumentKind, Report, plural, tree};
use patchcord::equations::{
    ChangedSetting, RescaleError, RescaleOptions, RescaledOutput, RescaledPatch, RescaledScale, rescale_patch,
};
use patchcord::expr::format_significant;
use patchcord::patch::Patch;

/// The options of `patchcord scale` for a patch.
pub(super) struct Request<'a> {
    /// The file of the patch.
    pub file: &'a Path,
    /// Its text.
    pub text: &'a str,
    /// Where the rescaled patch is written.
    pub out: Option<&'a PathBuf>,
    /// New machine seconds per present machine second.
    pub time: Option<f64>,
    /// Whether a JSON document is printed.
    pub json: bool,
    /// The options of problems that were given.
    pub refused: &'a [&'a str],
}

/// Whether a document is a patch, possibly with faults: it has elements.
pub(super) fn is_patch(text: &str) -> bool {
    let root = tree::parse(text.trim_start_matches('\u{feff}'));
    root.is_ok_and(|root| {
        DocumentKind::of(&root) == Some(DocumentKind::Patch) && root.child("elements").is_some()
    })
}

/// The patch is rescaled and compared before anything is written.
pub(super) fn rescale(request: &Request<'_>) -> Result<(), Failure> {
    if !request.refused.is_empty() {
        let options = request.refused.join(" and ");
        return Err(Failure::usage(format!(
            "{options}: not for a patch, which has its own machine and scales"
        )));
    }
    let folder = request.file.parent().unwrap_or(Path::new(""));
    let patch = Patch::parse_in(folder, &request.file.display().to_string(), request.text)?;
    let outputs = Outputs::of_patch(request.file, &patch);
    outputs.prepare(None, request.out)?;
    check_folder(&patch, folder, request.out)?;
    let rescaled = rescale_patch(&patch, &RescaleOptions { time: request.time }).map_err(failure)?;
    let mut warnings = Circuit::new(&rescaled.patch)?.warnings();
    if let Some(file) = request.out {
        outputs.write(file, rescaled.patch.text().as_bytes())?;
        warnings.file = file.display().to_string();
    }
    if request.json {
        return print_json(&Document::new(&patch, &rescaled, &warnings, request.out));
    }
    print(&text(request, &patch, &rescaled))?;
    eprint_report(&warnings);
    Ok(())
}

/// Checks that the paths of tables in files are valid from the new file too.
///
/// # Errors
/// If the patch has such tables and the new file is in another folder.
fn check_folder(patch: &Patch, folder: &Path, out: Option<&PathBuf>) -> Result<(), Failure> {
    let is_elsewhere = out.is_some_and(|file| file.parent().unwrap_or(Path::new("")) != folder);
    if is_elsewhere && !patch.table_files().is_empty() {
        let message = "the patch reads tables from files: write the new patch into the same folder";
        return Err(Failure::usage(message));
    }
    Ok(())
}

/// The failure for a patch that cannot be rescaled.
fn failure(error: RescaleError) -> Failure {
    match error {
        RescaleError::Patch(report) => report.into(),
        RescaleError::Settings(error) => error.into(),
        other => Failure::data(other.to_string()),
    }
}

/// Significant digits of values in the tables.
const DIGITS: usize = 4;

/// The printed result.
fn text(request: &Request<'_>, patch: &Patch, rescaled: &RescaledPatch) -> String {
    let mut text = format!("{}\n\n", title_of(patch).trim());
    if request.time.is_some() {
        let factor = format_significant(rescaled.time_scale, DIGITS);
        text += &format!("{factor} machine seconds per problem second\n\n");
    }
    if !rescaled.scales.is_empty() {
        text += &format!("{}\n", scale_table(&rescaled.scales));
    }
    text += &output_table(&rescaled.outputs);
    text += &format!("\n{}", peak_lines(&rescaled.outputs));
    text += &format!("\n{}\n{}", comparison_line(rescaled), change_table(&rescaled.changes));
    text += &match request.out {
        Some(file) => format!(
            "\nwrote {}\n\nThen:\n  patchcord check {}\n  patchcord run {}\n",
            path_text(file),
            quoted(file),
            quoted(file)
        ),
        None => "\n--out PATCH.json writes the patch\n".to_owned(),
    };
    text
}

/// The table of the scales.
fn scale_table(scales: &[RescaledScale]) -> String {
    let number = |value: f64| format_significant(value, DIGITS);
    let row = |scale: &RescaledScale| {
        [scale.name.clone(), scale.unit.clone(), number(scale.before), number(scale.after)]
    };
    let rows: Vec<[String; 4]> = scales.iter().map(row).collect();
    Table::from_rows(["scale", "unit", "1 V was", "1 V is"], &rows)
}

/// The table of the peaks.
fn output_table(outputs: &[RescaledOutput]) -> String {
    let row = |output: &RescaledOutput| {
        [
            output.output.clone(),
            output.scale.clone().unwrap_or_default(),
            if output.overloaded { "overload".to_owned() } else { format!("{:.1}", output.before) },
            format_significant(output.factor, DIGITS),
            format!("{:.1}", output.after),
        ]
    };
    let rows: Vec<[String; 5]> = outputs.iter().map(row).collect();
    Table::from_rows(["output", "scale", "peak was in V", "factor", "peak is in V"], &rows)
}

/// Which outputs use the range of their amplifiers, and why the others do not.
fn peak_lines(outputs: &[RescaledOutput]) -> String {
    let good = outputs.iter().filter(|output| output.is_good()).count();
    let mut text = format!("{good} of {} peak between 50 and 95 V\n", plural(outputs.len(), "output"));
    for output in outputs {
        if let Some(reason) = &output.reason {
            text += &format!("  {} peaks at {:.1} V: {reason}\n", output.output, output.after);
        }
    }
    text
}

/// How the new patch was compared with the old one.
fn comparison_line(rescaled: &RescaledPatch) -> String {
    let states = plural(rescaled.compared_states, "random state");
    match (rescaled.compared_states, rescaled.agrees_until.map(|time| format_significant(time, DIGITS))) {
        (0, Some(time)) => format!("the runs of both patches agree within 1e-9 up to t = {time} s"),
        (_, Some(time)) => {
            format!("both patches agree within 1e-9 at {states}, and their runs up to t = {time} s")
        }
        (_, None) => format!("both patches agree within 1e-9 at {states}; the run before overloads"),
    }
}

/// The changes of the document.
fn change_table(changes: &[ChangedSetting]) -> String {
    if changes.is_empty() {
        return "\nnothing has to change\n".to_owned();
    }
    let row = |change: &ChangedSetting| {
        [&change.name, &change.setting, &change.before, &change.after, &change.rule]
            .map(|cell| cell.replace('\n', " "))
    };
    let rows: Vec<[String; 5]> = changes.iter().map(row).collect();
    format!("\n{}", Table::from_rows(["name", "change of", "before", "after", "gain rule (eq. 4-8)"], &rows))
}

/// The result as JSON.
#[derive(Serialize)]
struct Document<'a> {
    ok: bool,
    patch: &'a str,
    title: &'a str,
    diagnostics: Vec<DiagnosticDocument>,
    time_scale: f64,
    scales: &'a [RescaledScale],
    outputs: &'a [RescaledOutput],
    changes: &'a [ChangedSetting],
    compared_states: usize,
    agrees_until: Option<f64>,
    rescaled: &'a serde_json::Value,
    files: Vec<String>,
}

impl<'a> Document<'a> {
    /// The document of a rescaled patch. `warnings` are those of the new patch.
    fn new(patch: &'a Patch, rescaled: &'a RescaledPatch, warnings: &Report, out: Option<&PathBuf>) -> Self {
        Document {
            ok: true,
            patch: patch.file(),
            title: &patch.title,
            diagnostics: warnings.documents(),
            time_scale: rescaled.time_scale,
            scales: &rescaled.scales,
            outputs: &rescaled.outputs,
            changes: &rescaled.changes,
            compared_states: rescaled.compared_states,
            agrees_until: rescaled.agrees_until,
            rescaled: rescaled.patch.value(),
            files: path_texts(out),
        }
    }
}
