//! What a search did, step by step, with pictures: one HTML file that needs no other.

mod base;
mod courses;
mod detectability;
mod discriminating_experiment;
mod end;
mod localisation;
mod measured;
mod round;
mod search_log;
mod sheet;

use crate::effects::Library;
use crate::fit::fitted_model::Stage;
use crate::report::Report;
use crate::report::page::sheet::over_noise;
use crate::search::outcome::Outcome;
use crate::search::verdict::Verdict;
use patchcord_draw::html;
use patchcord_draw::html::escaped;
use patchcord_draw::plot::PlotError;

/// The page of a report; `library` has the effects that were tried.
///
/// # Errors
/// If a picture cannot be drawn.
pub(super) fn page(report: &Report<'_>, library: &Library) -> Result<String, PlotError> {
    let title = match report.experiment.title.as_str() {
        "" => &report.experiment.file,
        title => title,
    };
    let mut body = format!(
        "<header>\n<h1>{}</h1>\n<p class=\"verdict\">{}</p>\n<p>{}</p>\n</header>\n<main>\n",
        escaped(title),
        escaped(&report.sentence()),
        escaped(&in_short(report))
    );
    body += &measured::section(report);
    body += &base::section(report)?;
    body += &localisation::section(report.outcome)?;
    body += &search_log::section(report.outcome);
    for (place, round) in report.outcome.rounds.iter().enumerate() {
        body += &round::section(report, library, place + 1, round)?;
    }
    body += &end::section(report)?;
    body += &discriminating_experiment::section(report.outcome);
    if !report.outcome.limits.is_empty() {
        body += &detectability::section(&report.outcome.limits, library);
    }
    body += "</main>\n";
    Ok(html::page(title, &body))
}

fn in_short(report: &Report<'_>) -> String {
    let Outcome { base, .. } = report.outcome;
    let after = report.outcome.told();
    let gap = |stage: &Stage| {
        format!(
            "{} times the noise in training, {} on data held back",
            over_noise(&stage.train),
            over_noise(&stage.test)
        )
    };
    match report.outcome.verdict {
        Verdict::Named | Verdict::Ambiguous => {
            format!(
                "The patch as it was leaves {}. With what is missing it leaves {}.",
                gap(base),
                gap(after)
            )
        }
        Verdict::NothingMissing | Verdict::CannotJudge if !base.leaves_structure() => {
            format!("What the patch leaves looks like noise: {}.", gap(base))
        }
        _ => format!("The patch leaves {}, and that does not look like noise.", gap(base)),
    }
}
