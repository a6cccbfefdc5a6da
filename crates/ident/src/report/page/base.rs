//! The patch as it is, fitted.

use crate::report::Report;
use crate::report::fit_quality::starts_sentence;
use crate::report::page::courses::pictures;
use crate::report::page::sheet::{over_noise, parameters, table};
use crate::residuals::correlation::{Correlation, Lagged};
use patchcord_analysis::instruments::number;
use patchcord_draw::html::escaped;
use patchcord_draw::plot::PlotError;

pub(super) fn section(report: &Report<'_>) -> Result<String, PlotError> {
    let stage = &report.outcome.base;
    Ok(format!(
        "<section>\n<h2>The patch as it is</h2>\n<p>{} is fitted to the training data: its parameters, and the voltages with which its integrators begin. \
         So it stands in <a href=\"fitted.json\">fitted.json</a>. \
         What it leaves is {} times the noise (rms); on the data held back, where only those voltages and declared offsets are fitted, {}. Besides, {}.</p>\n{}{}{}</section>\n",
        escaped(report.experiment.patch.file()),
        over_noise(&stage.train),
        over_noise(&stage.test),
        starts_sentence(&report.outcome.agreement),
        parameters(report.outcome, stage),
        pictures(report, &[("the patch as it is", stage)])?,
        goes_with(&report.outcome.correlations)
    ))
}

/// What the residuals go with.
fn goes_with(found: &[Correlation]) -> String {
    let told = |own: Lagged| match own.lag {
        0.0 => number(own.value),
        lag => format!("{}, {} s later", number(own.value), number(lag)),
    };
    let rows = found.iter().map(|own| {
        let cells =
            vec![escaped(&own.output), escaped(&own.with), told(own.own), told(own.size), number(own.chance)];
        (own.strongest() > own.chance, cells)
    });
    let stands_out = match found.iter().any(|own| own.strongest() > own.chance) {
        true => "those that are more than chance stand out",
        false => "none is more than chance",
    };
    let headings = ["what is left of", "goes with", "itself", "its size", "by chance up to"];
    format!(
        "<details><summary>What it leaves goes with, as correlations where they are strongest; {stands_out}</summary>\n{}</details>\n",
        table(&headings, rows)
    )
}
