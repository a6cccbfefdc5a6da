//! What was measured: columns and records.

use crate::data::columns::columns;
use crate::data::experiment::Experiment;
use crate::report::Report;
use crate::report::page::sheet::{escaped_text, table};
use patchcord_analysis::instruments::number;
use patchcord_draw::html::escaped;
use patchcord_expr::Unit;

pub(super) fn section(report: &Report<'_>) -> String {
    let Report { experiment, problem, .. } = report;
    let row = |name, column, sigma: f64, unit: &Unit, whence| {
        (false, [name, column, &number(sigma), unit.text(), whence].map(escaped_text).to_vec())
    };
    let whence = |is_told| if is_told { "told" } else { "estimated without a model" };
    let drives = experiment.drives.iter().zip(&problem.drive_sigma);
    let drives = drives.filter(|(feed, sigma)| feed.sigma.is_some() || **sigma > 0.0);
    let drives = drives.map(|(feed, sigma)| {
        row(&feed.drive, &feed.column, *sigma, &feed.unit, whence(feed.sigma.is_some()))
    });
    let outputs = experiment.outputs.iter().zip(&problem.sigma);
    let outputs = outputs.enumerate().map(|(place, (output, sigma))| {
        let whence = match experiment.shows_noise(place) {
            true => whence(output.sigma.is_some()),
            false => "a millionth of its range, as no noise is seen",
        };
        row(&output.signal, &output.column, *sigma, &output.unit, whence)
    });
    let records = [("training", &experiment.train), ("held back", &experiment.test)];
    let records =
        records.into_iter().flat_map(|(used, records)| records.iter().map(move |record| (used, record)));
    let records = records.map(|(used, record)| {
        let ends = format!("{} ... {} s", number(record.begin), number(record.begin + record.duration()));
        let every = format!("every {} s", number(record.interval));
        (false, vec![escaped(&record.name), used.to_owned(), ends, record.len().to_string(), every])
    });
    format!(
        "<section>\n<h2>What was measured</h2>\n{}{}{}</section>\n",
        table(&["signal or drive", "column", "noise", "unit", "whence"], outputs.chain(drives)),
        table(&["file", "for", "from ... to", "samples", ""], records),
        looked_at(experiment)
    )
}

/// What the columns of the training records are like without any model.
fn looked_at(experiment: &Experiment) -> String {
    let all = experiment
        .train
        .iter()
        .flat_map(|record| columns(experiment, record).into_iter().map(move |column| (&record.name, column)));
    let rows = all.map(|(file, column)| {
        let is = &column.is;
        let found = |value: Option<f64>| value.map_or("none".to_owned(), number);
        let noise = is.noise.as_ref();
        let cells = vec![
            escaped(file),
            escaped(column.column),
            format!("{} {}", column.noun, escaped(column.name)),
            found(noise.map(|noise| noise.sigma)),
            noise.map_or("", |noise| noise.kind.as_str()).to_owned(),
            found(is.quantum),
            escaped(column.unit),
            is.missing.to_string(),
            format!("{} %", number((100.0 * is.repeats).round())),
        ];
        (false, cells)
    });
    let headings = ["file", "column", "is", "noise seen", "", "step", "unit", "missing", "repeated"];
    format!(
        "<details><summary>What the columns are like without a model</summary>\n{}</details>\n",
        table(&headings, rows)
    )
}
