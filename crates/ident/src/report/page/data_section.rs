//! The section on the data: columns, records and noise.
//!
//! The noise of a column is specified in the experiment or estimated without a model. Estimates are listed
//! separately, so that a wrong specification is visible.

use crate::data::columns::record_columns;
use crate::data::experiment::Experiment;
use crate::report::Report;
use crate::report::page::html_parts::table;
use crate::report::values::{format_pure_number, percent_text};
use maud::{Markup, html};
use patchcord_expr::Unit;

/// Tables of the columns with their noise, of the records, and of the columns' properties.
pub(super) fn section(report: &Report<'_>) -> Markup {
    html! {
        section {
            h2 { "Data" }
            (noise_table(report))
            (record_table(report.experiment))
            (column_table(report.experiment))
        }
        "\n"
    }
}

/// The table of the columns with their noise: first the signals, then the drives that have noise.
///
/// A drive without specified noise appears only if its estimate is above 0.
fn noise_table(report: &Report<'_>) -> Markup {
    let Report { experiment, problem, .. } = report;
    let row = |name: &str, column: &str, sigma: f64, unit: &Unit, source: &str| {
        (false, [name, column, &format_pure_number(sigma), unit.text(), source].map(str::to_owned).to_vec())
    };
    let source = |is_specified| if is_specified { "specified" } else { "estimated without a model" };
    let drives = experiment.drives.iter().zip(&problem.drive_sigma);
    let drives = drives.filter(|(drive, sigma)| drive.sigma.is_some() || **sigma > 0.0);
    let drives = drives.map(|(drive, sigma)| {
        row(&drive.drive, &drive.column, *sigma, &drive.unit, source(drive.sigma.is_some()))
    });
    let outputs = experiment.outputs.iter().zip(&problem.sigma);
    let outputs = outputs.enumerate().map(|(index, (output, sigma))| {
        let source = match experiment.has_known_noise(index) {
            true => source(output.sigma.is_some()),
            false => "a millionth of the range, because no noise is visible",
        };
        row(&output.signal, &output.column, *sigma, &output.unit, source)
    });
    table(&["signal or drive", "column", "noise", "unit", "source of the noise"], outputs.chain(drives))
}

/// The table of the records, first those for training.
fn record_table(experiment: &Experiment) -> Markup {
    let records = [("training", &experiment.train), ("validation", &experiment.validation)];
    let records = records
        .into_iter()
        .flat_map(|(purpose, records)| records.iter().map(move |record| (purpose, record)));
    let records = records.map(|(purpose, record)| {
        let ends = format!(
            "{} ... {} s",
            format_pure_number(record.begin),
            format_pure_number(record.begin + record.duration())
        );
        let every = format!("every {} s", format_pure_number(record.interval));
        (false, vec![record.name.clone(), purpose.to_owned(), ends, record.len().to_string(), every])
    });
    table(&["file", "purpose", "time", "samples", "interval"], records)
}

/// Properties of the columns of the training records that are found without a model.
fn column_table(experiment: &Experiment) -> Markup {
    let columns = experiment.train.iter().flat_map(|record| {
        record_columns(experiment, record).into_iter().map(move |column| (&record.name, column))
    });
    let rows = columns.map(|(file, column)| {
        let properties = &column.statistics;
        let text = |value: Option<f64>| value.map_or("none".to_owned(), format_pure_number);
        let noise = properties.noise.as_ref();
        let cells = vec![
            file.clone(),
            column.column.to_owned(),
            format!("{} {}", column.noun, column.name),
            text(noise.map(|noise| noise.sigma)),
            noise.map_or("", |noise| noise.kind.as_str()).to_owned(),
            text(properties.quantum),
            column.unit.to_owned(),
            properties.missing.to_string(),
            percent_text((100.0 * properties.repeated_fraction).round()),
        ];
        (false, cells)
    });
    let headings = ["file", "column", "is", "noise", "kind of noise", "step", "unit", "missing", "repeated"];
    html! {
        details {
            summary { "Properties of the columns, found without a model" }
            (table(&headings, rows))
        }
        "\n"
    }
}
