//! `patchcord gap --check`: properties of the data, sites of effects, and detection limits.
//!
//! The sentences and the rows of the tables come from `patchcord::ident::report::check`. This file only arranges them:
//! a section per record, then the sites, then the detection limits.

use super::table::Table;
use patchcord::ident::Experiment;
use patchcord::ident::design::detectability::Detectability;
use patchcord::ident::effects::Library;
use patchcord::ident::effects::effect_sites::EffectSites;
use patchcord::ident::report::check::{CheckReport, LimitsCheck, RecordCheck};
use patchcord::ident::report::detection_limits::{DETECTION_LIMIT_HEADINGS, detection_limit_rows};

/// The report on the data and on the sites of effects.
///
/// This part is printed at once. The detection limits follow after a fit, which takes longer.
pub(super) fn text(experiment: &Experiment, sites: &EffectSites) -> String {
    let report = CheckReport::new(experiment, sites);
    let records: String = report.records().map(record_text).collect();
    format!("{}{records}\n{}", lines(&report.summary_lines()), lines(&report.site_lines()))
}

/// The section of a record: heading, table and notes.
fn record_text(record: RecordCheck) -> String {
    let mut table = Table::with(record.column_headings);
    record.rows.into_iter().for_each(|row| table.row(row));
    let notes = if record.notes.is_empty() { String::new() } else { format!("\n{}", lines(&record.notes)) };
    format!("\n{}\n\n{}{notes}", record.heading, table.text())
}

/// The report on the weakest detectable effects.
pub(super) fn limits_text(
    experiment: &Experiment,
    sites: &EffectSites,
    detectability: &Detectability,
    library: &Library,
) -> String {
    let LimitsCheck { solver_warning, skipped, introduction, undetectable, .. } =
        CheckReport::new(experiment, sites).limits(detectability, library);
    let warning = solver_warning.map_or(String::new(), |warning| format!("\n{warning}\n"));
    let before = warning + &lines(&skipped);
    if detectability.limits.is_empty() {
        return before;
    }
    let table = Table::from_rows(DETECTION_LIMIT_HEADINGS, &detection_limit_rows(&detectability.limits));
    let undetectable =
        if undetectable.is_empty() { String::new() } else { format!("\n{}", lines(&undetectable)) };
    format!("{before}\n{introduction}\n\n{table}{undetectable}")
}

/// Each text on a line.
fn lines(texts: &[String]) -> String {
    texts.iter().map(|text| format!("{text}\n")).collect()
}
