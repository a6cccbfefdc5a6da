//! What was measured: columns and records.

use super::Told;
use super::sheet::{escaped_text, number, table};
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
        "<section>\n<h2>What was measured</h2>\n{}{}</section>\n",
        table(&["signal", "column", "noise", "unit", "whence"], outputs),
        table(&["file", "for", "from ... to", "samples", ""], records)
    )
}
