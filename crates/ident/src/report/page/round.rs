//! The section on a round of the search: all trials, and why the best one was taken or not.
//!
//! The section has the round sentence, the law of the best effect, pictures without and with it, and a table of all
//! trials. The last column of the table says why a trial was taken or not.

use crate::effects::Library;
use crate::report::Report;
use crate::report::effect_sites::inapplicable_effects_sentence;
use crate::report::labels::candidate_label;
use crate::report::page::html_parts::{bar, table};
use crate::report::page::trajectories::pictures;
use crate::report::rounds::{round_sentence, skipped_trial_sentence, trial_count_text};
use crate::report::values::{format_pure_number, residual_texts};
use crate::search::round::{Round, Trial};
use crate::statistics::block_comparison::Advantage;
use maud::{Markup, Render, html};
use patchcord_draw::plot::PlotError;

/// The section of a round. Its number counts from 1. Empty if the round has no trials.
pub(super) fn section(
    report: &Report<'_>,
    library: &Library,
    round_number: usize,
    round: &Round,
) -> Result<Markup, PlotError> {
    let Some(best) = round.trials.first() else { return Ok(Markup::default()) };
    let sites = &report.outcome.effect_sites;
    let inapplicable = inapplicable_effects_sentence(sites).filter(|_| round_number == 1);
    Ok(html! {
        section {
            h2 { "Round " (round_number) ": " (trial_count_text(round)) }
            p.reading { (round_sentence(report.outcome, round)) }
            "\n"
            (law_of(library, best))
            (pictures(report, &[("before", &round.before), (&candidate_label(&best.candidate), &best.model)])?)
            details open {
                summary { "All trials; a score of " (format_pure_number(round.required_delta_bic)) " is required" }
                (trial_table(round))
                (skipped_trials(round))
                @if let Some(sentence) = inapplicable { p { (sentence) } "\n" }
            }
        }
        "\n"
    })
}

/// Title, physics and law of the best effect. Empty if the library does not have it.
fn law_of(library: &Library, best: &Trial) -> Markup {
    html! {
        @if let Some(effect) = library.get(&best.candidate.effect) {
            p { b { (effect.title) } ". " (effect.physics) " " code { (effect.law) } }
            "\n"
        }
    }
}

/// The table of all trials, the best first. The bar shows the rms residual over that without the effect.
fn trial_table(round: &Round) -> Markup {
    let without = round.before.train.chi2;
    let rows = round.trials.iter().enumerate().map(|(rank, trial)| {
        let [train, validation] = residual_texts(&trial.model);
        let cells = vec![
            trial.candidate.effect.render(),
            trial.candidate.site.render(),
            trial.candidate.reads.join(", ").render(),
            trial.candidate.note.render(),
            format_pure_number(trial.delta_bic).render(),
            bar((trial.model.train.chi2 / without).sqrt()),
            train.render(),
            validation.render(),
            remark(round, rank, trial).render(),
        ];
        (rank == 0, cells)
    });
    let headings = ["effect", "at", "reads", "form", "score", "residual", "training", "validation", "remark"];
    table(&headings, rows)
}

/// The effects that could not be tried, with the reason. Empty if all were tried.
fn skipped_trials(round: &Round) -> Markup {
    html! {
        @for sentence in round.skipped.iter().map(skipped_trial_sentence) { p { (sentence) } "\n" }
    }
}

/// Why a trial was taken or not. `rank` is 0 for the best trial.
///
/// Reasons are tested in a fixed order: too low a score, too little explained, not confirmed, tied, and finally how far
/// it is behind.
fn remark(round: &Round, rank: usize, trial: &Trial) -> String {
    match rank {
        0 if round.taken => "taken".to_owned(),
        _ if trial.delta_bic <= round.required_delta_bic && !trial.model.is_thorough => {
            "explains too little in a quick fit".to_owned()
        }
        _ if trial.delta_bic <= round.required_delta_bic => "explains too little".to_owned(),
        0 if !round.has_sufficient_effect() => "leaves too much".to_owned(),
        0 => "not confirmed by the validation data".to_owned(),
        _ if round.is_tied(trial) => "the data cannot distinguish it from the first".to_owned(),
        _ => match round.delta_bic_deficit(trial) {
            Some(deficit) => {
                format!("lower score by {}; the residuals do not distinguish it", format_pure_number(deficit))
            }
            None => {
                let Advantage { sum, standard_error, .. } = trial.best_advantage;
                format!(
                    "chi-squared higher by {} ± {}",
                    format_pure_number(sum),
                    format_pure_number(standard_error)
                )
            }
        },
    }
}
