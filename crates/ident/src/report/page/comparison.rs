//! The section that compares the patch before and after the search.
//!
//! With several taken rounds it also has pictures of the original patch and of the final one. A single round shows the
//! same pictures in its own section.

use crate::fit::fitted_model::FittedModel;
use crate::report::Report;
use crate::report::fit_quality::steps_sentence;
use crate::report::page::html_parts::{parameter_table, table};
use crate::report::page::trajectories::pictures;
use crate::report::values::{format_pure_number, residual_texts};
use crate::search::outcome::taken_rounds;
use maud::{Markup, html};
use patchcord_draw::plot::PlotError;

/// Residuals before and after, doubts, and the fitted patch with the named effects.
pub(super) fn section(report: &Report<'_>) -> Result<Markup, PlotError> {
    Ok(html! {
        section {
            h2 { "Before and after" }
            (residual_table(&report.outcome.base, report.outcome.reported_model()))
            @for note in notes(report) { p { (note) } "\n" }
            @if report.outcome.verdict.has_names() { (named_effects(report)?) }
        }
        "\n"
    })
}

/// The table of the residuals before and after the search.
fn residual_table(base: &FittedModel, reported: &FittedModel) -> Markup {
    let rows = [("before", base), ("after", reported)].map(|(label, model)| {
        let [training, validation] = residual_texts(model);
        (false, vec![label.to_owned(), training, validation, format_pure_number(model.ljung_box_z)])
    });
    table(
        &[
            "residual over noise, rms",
            "training",
            "validation",
            "distance from white, in standard deviations",
        ],
        rows.into_iter(),
    )
}

/// The sentence on the steps of the solver, and the doubts. If the steps are too coarse, the doubts say so.
fn notes(report: &Report<'_>) -> impl Iterator<Item = String> {
    let refinement = &report.outcome.step_refinement;
    let steps = refinement.is_sufficient().then(|| steps_sentence(refinement));
    steps.into_iter().chain(report.doubts())
}

/// The fitted parameters with the named effects, pictures, and a link to the patch.
fn named_effects(report: &Report<'_>) -> Result<Markup, PlotError> {
    let (base, reported) = (&report.outcome.base, report.outcome.reported_model());
    Ok(html! {
        (parameter_table(report.outcome, reported))
        // With one taken round, its section has the same pictures.
        @if taken_rounds(&report.outcome.rounds).count() > 1 {
            (pictures(report, &[("before", base), ("after", reported)])?)
        }
        p {
            "The patch with the missing effects is " a href="augmented.json" { "augmented.json" } ": "
            code { "patchcord run augmented.json" } " runs it, "
            code { "patchcord draw augmented.json --plot augmented.svg" } " draws it."
        }
        "\n"
    })
}
