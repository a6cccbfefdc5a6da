//! What a search did, step by step, with pictures: one HTML file that needs no other.

mod apart;
mod base;
mod courses;
mod end;
mod limits;
mod measured;
mod round;
mod sheet;
mod way;
mod whereabouts;

use super::effect::Library;
use super::experiment::Experiment;
use super::problem::Problem;
use super::search::{Outcome, Verdict};
use super::stage::Stage;
use patchcord_draw::html::{self, escaped};
use patchcord_draw::plot::PlotError;
use sheet::over_noise;

/// What a page is made of.
#[derive(Debug, Clone, Copy)]
pub struct Told<'a> {
    /// What was asked.
    pub experiment: &'a Experiment,
    /// What the patch was held against.
    pub problem: &'a Problem,
    /// What was found.
    pub outcome: &'a Outcome,
    /// The effects that were tried.
    pub library: &'a Library,
}

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
        escaped(&told.outcome.sentence()),
        escaped(&in_short(told))
    );
    body += &measured::section(told);
    body += &base::section(told)?;
    body += &whereabouts::section(told.outcome)?;
    body += &way::section(told.outcome);
    for (place, round) in told.outcome.rounds.iter().enumerate() {
        body += &round::section(told, place + 1, round)?;
    }
    body += &end::section(told)?;
    body += &apart::section(told.outcome);
    if !told.outcome.limits.is_empty() {
        body += &limits::section(&told.outcome.limits, told.library);
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
