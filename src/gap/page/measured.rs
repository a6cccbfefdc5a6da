//! What was measured: columns and records.

use super::Told;
use super::sheet::{escaped_text, number, table};
use crate::gap::examine::columns;
use crate::gap::experiment::Experiment;
use crate::html::escaped;

pub(super) fn section(told: &Told<'_>) -> String {
    let Told { experiment, problem, .. } = told;
    let outputs = experiment.outputs.iter().zip(&problem.sigma).map(|(output, sigma)| {
        let whence = if output.sigma.is_some() { "told" } else { "estimated without a model" };
        let cells =
            [&output.signal, &output.column, &number(*sigma), output.unit.text(), whence].map(escaped_text);
        (false, cells.to_vec())
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
        table(&["signal", "column", "noise", "unit", "whence"], outputs),
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
