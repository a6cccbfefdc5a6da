//! A round of the search: what was tried, and why the best was taken or not.

use crate::effects::Library;
use crate::report::Report;
use crate::report::page::courses::pictures;
use crate::report::page::sheet::{bar, escaped_text, over_noise, table};
use crate::report::places::nowhere_sentence;
use crate::report::rounds::{round_sentence, skipped_trial_sentence, trial_count_text};
use crate::search::round::{Round, Trial};
use patchcord_analysis::instruments::number;
use patchcord_draw::html::escaped;
use patchcord_draw::plot::PlotError;

/// The section of the round at a place, counted from 1.
pub(super) fn section(
    report: &Report<'_>,
    library: &Library,
    place: usize,
    round: &Round,
) -> Result<String, PlotError> {
    let Some(best) = round.trials.first() else { return Ok(String::new()) };
    let nowhere = nowhere_sentence(&report.outcome.places).filter(|_| place == 1);
    let nowhere = nowhere.map(|own| format!("<p>{}</p>\n", escaped(&own))).unwrap_or_default();
    Ok(format!(
        "<section>\n<h2>Round {place}: {}</h2>\n<p class=\"reading\">{}</p>\n{}{}\
         <details open><summary>All of them; a score of {} is needed</summary>\n{}{}{nowhere}</details>\n</section>\n",
        trial_count_text(round),
        escaped(&round_sentence(report.outcome, round)),
        effect(library, best),
        pictures(report, &[("before", &round.before), (&best.named(), &best.stage)])?,
        number(round.needed),
        trials(round),
        left_out(round)
    ))
}

/// The physics of the best.
fn effect(library: &Library, best: &Trial) -> String {
    let Some(effect) = library.get(&best.candidate.effect) else { return String::new() };
    let [title, physics, law] = [&effect.title, &effect.physics, &effect.law].map(escaped_text);
    format!("<p><b>{title}</b>. {physics} <code>{law}</code></p>\n")
}

/// Every trial, the best first.
fn trials(round: &Round) -> String {
    let most = round.before.train.chi2;
    let rows = round.trials.iter().enumerate().map(|(rank, trial)| {
        let cells = vec![
            escaped(&trial.candidate.effect),
            escaped(&trial.candidate.junction),
            escaped(&trial.candidate.reads.join(", ")),
            escaped(&trial.candidate.note),
            number(trial.score),
            bar((trial.stage.train.chi2 / most).sqrt()),
            over_noise(&trial.stage.train),
            over_noise(&trial.stage.test),
            escaped(&remark(round, rank, trial)),
        ];
        (rank == 0, cells)
    });
    let headings =
        ["effect", "at", "reads", "form", "score", "gap that is left", "training", "held back", "why not"];
    table(&headings, rows)
}

/// What was not tried, and why; nothing where everything was.
fn left_out(round: &Round) -> String {
    round.left_out.iter().map(|own| format!("<p>{}</p>\n", escaped(&skipped_trial_sentence(own)))).collect()
}

/// Why a trial is not the one.
fn remark(round: &Round, rank: usize, trial: &Trial) -> String {
    match rank {
        0 if round.taken => "taken".to_owned(),
        _ if trial.score <= round.needed && !trial.stage.gone_through => {
            "explains too little, by a quick look".to_owned()
        }
        _ if trial.score <= round.needed => "explains too little".to_owned(),
        0 if !round.closes_enough() => "leaves too much".to_owned(),
        0 => "the data held back do not bear it out".to_owned(),
        _ if round.is_tied(trial) => "the data cannot tell it from the first".to_owned(),
        _ => match round.lower_in_score(trial) {
            Some(lower) => {
                format!("lower in score by {}, not told apart by the data held back", number(lower))
            }
            None => format!("behind by {} ± {}", number(trial.behind.sum), number(trial.behind.error)),
        },
    }
}
