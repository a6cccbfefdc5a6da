//! What a search did, step by step, with pictures: one HTML file that needs no other.

mod base;
mod context;
mod courses;
mod detectability;
mod discriminating_experiment;
mod end;
mod localisation;
mod measured;
mod round;
mod search_log;
mod sheet;

use crate::fit::fitted_model::Stage;
use crate::report::page::sheet::over_noise;
use crate::report::sentence::verdict_sentence;
use crate::search::outcome::Outcome;
use crate::search::verdict::Verdict;
use patchcord_draw::html;
use patchcord_draw::html::escaped;
use patchcord_draw::plot::PlotError;

pub use context::Told;

/// The page.
///
/// # Errors
/// When a picture cannot be drawn.
pub fn page(told: &Told<'_>) -> Result<String, PlotError> {
    let title = match told.experiment.title.as_str() {
        "" => &told.experiment.file,
        title => title,
    };
    let mut body = format!(
        "<header>\n<h1>{}</h1>\n<p class=\"verdict\">{}</p>\n<p>{}</p>\n</header>\n<main>\n",
        escaped(title),
        escaped(&verdict_sentence(told.outcome)),
        escaped(&in_short(told))
    );
    body += &measured::section(told);
    body += &base::section(told)?;
    body += &localisation::section(told.outcome)?;
    body += &search_log::section(told.outcome);
    for (place, round) in told.outcome.rounds.iter().enumerate() {
        body += &round::section(told, place + 1, round)?;
    }
    body += &end::section(told)?;
    body += &discriminating_experiment::section(told.outcome);
    if !told.outcome.limits.is_empty() {
        body += &detectability::section(&told.outcome.limits, told.library);
    }
    body += "</main>\n";
    Ok(html::page(title, &body))
}

fn in_short(told: &Told<'_>) -> String {
    let Outcome { base, .. } = told.outcome;
    let after = told.outcome.told();
    let gap = |stage: &Stage| {
        format!(
            "{} times the noise in training, {} on data held back",
            over_noise(&stage.train),
            over_noise(&stage.test)
        )
    };
    match told.outcome.verdict {
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
