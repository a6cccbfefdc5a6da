//! The HTML page of a report. It shows the search step by step with pictures, in one file that needs no other.
//!
//! The sections follow the order of the search: data, fit of the original patch, missing force, rounds, comparison.
//! Pictures are embedded as SVG. [`html!`] escapes all other texts that are inserted.

mod comparison;
mod data_section;
mod detectability;
mod discriminating_experiment;
mod html_parts;
mod localisation;
mod original_fit;
mod round;
mod search_log;
mod trajectories;

use crate::effects::Library;
use crate::fit::fitted_model::FittedModel;
use crate::report::Report;
use crate::report::values::residual_texts;
use crate::search::outcome::Outcome;
use crate::search::verdict::Verdict;
use maud::{Markup, html};
use patchcord_draw::plot::PlotError;

/// The page of a report. `library` has the effects that were tried.
///
/// # Errors
/// If a picture cannot be drawn.
pub(super) fn page(report: &Report<'_>, library: &Library) -> Result<String, PlotError> {
    let title = match report.experiment.title.as_str() {
        "" => &report.experiment.file,
        title => title,
    };
    let body = html! {
        (header(report, title))
        main { (sections(report, library)?) }
        "\n"
    };
    Ok(patchcord_draw::html::page(title, body))
}

/// The title, the verdict and the summary.
fn header(report: &Report<'_>, title: &str) -> Markup {
    html! {
        header {
            h1 { (title) }
            p.verdict { (report.sentence()) }
            "\n"
            p { (summary(report)) }
            "\n"
        }
        "\n"
    }
}

/// All sections, in the order of the search.
fn sections(report: &Report<'_>, library: &Library) -> Result<Markup, PlotError> {
    let outcome = report.outcome;
    Ok(html! {
        (data_section::section(report))
        (original_fit::section(report)?)
        (localisation::section(outcome)?)
        (search_log::section(outcome))
        @for (index, round) in outcome.rounds.iter().enumerate() {
            (round::section(report, library, index + 1, round)?)
        }
        (comparison::section(report)?)
        (discriminating_experiment::section(outcome))
        @if !outcome.detection_limits.is_empty() {
            (detectability::section(&outcome.detection_limits, library))
        }
    })
}

/// The residuals before and after the search, in a sentence or two.
///
/// Residuals are rms values over the noise, in training and in validation.
fn summary(report: &Report<'_>) -> String {
    let Outcome { base, .. } = report.outcome;
    let reported = report.outcome.reported_model();
    let residual = |model: &FittedModel| {
        let [train, validation] = residual_texts(model);
        format!("{train} times the noise in the training data, {validation} times in the validation data")
    };
    match report.outcome.verdict {
        Verdict::Named | Verdict::Ambiguous => {
            format!(
                "The residual of the original patch is {}. With the missing effects it is {}.",
                residual(base),
                residual(reported)
            )
        }
        Verdict::NothingMissing | Verdict::CannotJudge if !base.residuals_are_coloured() => {
            format!("The residual of the patch looks like noise: {}.", residual(base))
        }
        _ => format!("The residual of the patch is {}. It does not look like noise.", residual(base)),
    }
}
