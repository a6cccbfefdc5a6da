//! The section on the data: columns, records and noise.
//!
//! The noise of a column is specified in the experiment or estimated without a model. Estimates are listed
//! separately, so that a wrong specification is visible.

use crate::data::columns::record_columns;
use crate::data::experiment::Experiment;
use crate::report::Report;
use crate::report::page::html_parts::table;
use maud::{Markup, html};
use patchcord_analysis::format::number;
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
        (false, [name, column, &number(sigma), unit.text(), source].map(str::to_owned).to_vec())
    };
    let source = |is_specified| if is_specified { "specified" } else { "estimated without a model" };
    let drives = experiment.drives.iter().zip(&problem.drive_sigma);
    let drives = drives.filter(|(feed, sigma)| feed.sigma.is_some() || **sigma > 0.0);
    let drives = drives.map(|(feed, sigma)| {
        row(&feed.drive, &feed.column, *sigma, &feed.unit, source(feed.sigma.is_some()))
    });
    let outputs = experiment.outputs.iter().zip(&problem.sigma);
    let outputs = outputs.enumerate().map(|(place, (output, sigma))| {
        let source = match experiment.has_known_noise(place) {
            true => source(output.sigma.is_some()),
            false => "a millionth of the range, because no noise is visible",
        };
        row(&output.signal, &output.column, *sigma, &output.unit, source)
    });
    table(&["signal or drive", "column", "noise", "unit", "source of the noise"], outputs.chain(drives))
}

/// The table of the records, first those for training.
fn record_table(experiment: &Experiment) -> Markup {
    let records = [("training", &experiment.train), ("validation", &experiment.test)];
    let records = records
        .into_iter()
        .flat_map(|(purpose, records)| records.iter().map(move |record| (purpose, record)));
    let records = records.map(|(purpose, record)| {
        let ends = format!("{} ... {} s", number(record.begin), number(record.begin + record.duration()));
        let every = format!("every {} s", number(record.interval));
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
        let text = |value: Option<f64>| value.map_or("none".to_owned(), number);
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
            format!("{} %", number((100.0 * properties.repeated_fraction).round())),
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
