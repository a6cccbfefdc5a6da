//! The section on the fit of the original patch.
//!
//! A correlation of the residual with a signal, or with its magnitude, is a hint at the kind of the missing effect. A
//! row is highlighted if the correlation is larger than chance explains.

use crate::report::Report;
use crate::report::fit_quality::starts_sentence;
use crate::report::page::html_parts::{parameter_table, table};
use crate::report::page::trajectories::pictures;
use crate::report::values::{format_pure_number, residual_texts};
use crate::residuals::correlation::{Correlation, LaggedCorrelation};
use maud::{Markup, html};
use patchcord_draw::plot::PlotError;

/// The fitted parameters, pictures of the fit and of its residual, and the correlations of the residual.
pub(super) fn section(report: &Report<'_>) -> Result<Markup, PlotError> {
    let base = &report.outcome.base;
    Ok(html! {
        section {
            h2 { "The original patch" }
            (fit_text(report))
            (parameter_table(report.outcome, base))
            (pictures(report, &[("original patch", base)])?)
            (correlation_table(&report.outcome.correlations))
        }
        "\n"
    })
}

/// What was fitted, and how large the residual is.
fn fit_text(report: &Report<'_>) -> Markup {
    let [train, validation] = residual_texts(&report.outcome.base);
    html! {
        p {
            "The parameters and initial voltages of " (report.experiment.patch_name)
            " are fitted to the training data. The result is " a href="fitted.json" { "fitted.json" }
            ". The residual is " (train) " times the noise (rms). In the validation data, where \
            only initial voltages and declared offsets are fitted, it is " (validation)
            " times the noise. Check of the fit: " (starts_sentence(&report.outcome.agreement)) "."
        }
        "\n"
    }
}

/// The correlations of the residual with signals and drives. Rows above the level of chance stand out.
///
/// A lag of 0 is not printed.
fn correlation_table(correlations: &[Correlation]) -> Markup {
    let text = |lagged: LaggedCorrelation| match lagged.lag {
        0.0 => format_pure_number(lagged.value),
        lag => format!("{}, {} s later", format_pure_number(lagged.value), format_pure_number(lag)),
    };
    let is_significant = |correlation: &Correlation| correlation.strongest() > correlation.chance_limit;
    let rows = correlations.iter().map(|correlation| {
        let cells = vec![
            correlation.output.clone(),
            correlation.quantity.clone(),
            text(correlation.signed),
            text(correlation.magnitude),
            format_pure_number(correlation.chance_limit),
        ];
        (is_significant(correlation), cells)
    });
    let summary = match correlations.iter().any(is_significant) {
        true => "highlighted values exceed chance",
        false => "none exceeds chance",
    };
    let headings = ["residual of", "with", "signal itself", "magnitude of the signal", "by chance at most"];
    html! {
        details {
            summary { "Strongest correlations of the residual; " (summary) }
            (table(&headings, rows))
        }
        "\n"
    }
}
