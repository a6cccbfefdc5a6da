//! Formats the result of a search for missing effects as text.
//!
//! The sentences come from `patchcord::ident::report`, which the HTML page uses as well. This file only arranges them
//! with tables. Residuals are rms values over the noise, in training and in validation data.

use super::table::Table;
use patchcord::ident::effects::PlacedEffect;
use patchcord::ident::fit::problem::Problem;
use patchcord::ident::localise::Localisation;
use patchcord::ident::report::Report;
use patchcord::ident::report::detection_limits::{
    DETECTION_LIMIT_HEADINGS, DETECTION_LIMITS_INTRODUCTION, detection_limit_rows,
};
use patchcord::ident::report::effect_sites::inapplicable_effects_sentence;
use patchcord::ident::report::fit_quality::starts_sentence;
use patchcord::ident::report::localisation::{dependence_text, localisation_sentence};
use patchcord::ident::report::rounds::{round_sentence, skipped_trial_sentence, trial_count_text};
use patchcord::ident::report::search_log::action_text;
use patchcord::ident::report::values::{
    error_text, estimate_text, format_pure_number, interval_text, owner, percent_text, residual_texts,
    undetermined_sentence,
};
use patchcord::ident::search::round::{Round, Trial};
use patchcord::ident::search::{Outcome, Verdict};

/// The number of trials that are listed per round.
const MAX_TRIALS: usize = 8;

/// The report: result, parameters, gaps, search path, junctions, detection limits and rounds.
///
/// The most important part is first: the verdict. The rounds, which explain it, are last.
pub(super) fn text(report: &Report<'_>) -> String {
    let Report { experiment, problem, outcome } = *report;
    let mut text = format!("{}: {}\n", experiment.file, report.sentence());
    text += &format!("\n{}", parameters(outcome).text());
    text.extend(undetermined_sentence(outcome.reported_model()).map(|sentence| sentence + "\n"));
    text += &format!("\n{}", gaps(problem, outcome).text());
    text.extend(report.doubts().into_iter().map(|doubt| doubt + "\n"));
    if !outcome.agreement.is_reproduced {
        text += &format!("\nbefore: {}\n", starts_sentence(&outcome.agreement));
    }
    text += &path_text(outcome);
    text += &localisation_text(&outcome.localisations);
    let is_negative = matches!(outcome.verdict, Verdict::NothingMissing | Verdict::CannotJudge);
    if is_negative && !outcome.detection_limits.is_empty() {
        let rows = detection_limit_rows(&outcome.detection_limits);
        let table = Table::from_rows(DETECTION_LIMIT_HEADINGS, &rows);
        text += &format!("\n{DETECTION_LIMITS_INTRODUCTION}\n\n{table}");
    }
    for (number, round) in outcome.rounds.iter().enumerate() {
        text += &format!("\n{}\n\n{}", heading(number + 1, round, outcome), trials(round));
        text.extend(round.skipped.iter().map(|skipped| skipped_trial_sentence(skipped) + "\n"));
    }
    text.extend(
        inapplicable_effects_sentence(&outcome.effect_sites).map(|sentence| format!("\n{sentence}\n")),
    );
    text
}

/// The table of fitted parameters.
///
/// Parameters of named effects follow those of the patch; the last column says to which of them each belongs.
fn parameters(outcome: &Outcome) -> Table {
    let model = outcome.reported_model();
    let mut table = Table::new(["fitted", "value", "standard error", "95 %", "unit", "of"]);
    for (index, name) in model.variant.fit.iter().enumerate() {
        let value = estimate_text(model, index);
        let (error, interval) = (error_text(model, index), interval_text(model.uncertainty(index)));
        table.row([name.clone(), value, error, interval, model.unit(index).to_owned(), owner(outcome, name)]);
    }
    table
}

/// The table of rms residuals in units of the noise, before and after.
fn gaps(problem: &Problem, outcome: &Outcome) -> Table {
    let mut table = Table::new(["gap, in noise", "train", "test"]);
    for (when, model) in [("before", &outcome.base), ("after", outcome.reported_model())] {
        let [train, validation] = residual_texts(model);
        table.row([format!("{when} ({})", problem.outputs.join(", ")), train, validation]);
    }
    table
}

/// The table of changes from the patch to the result; empty if there is only one.
fn path_text(outcome: &Outcome) -> String {
    if !outcome.has_detailed_log() {
        return String::new();
    }
    let mut table = Table::new(["search path", "train", "test"]);
    for entry in &outcome.search_log {
        let [train, validation] = entry.residual_rms.map(format_pure_number);
        table.row([action_text(&entry.action), train, validation]);
    }
    format!("\n{}", table.text())
}

/// The table of junctions at which an unknown input explains the gap; empty if there are none.
fn localisation_text(localisations: &[Localisation]) -> String {
    let Some(sentence) = localisation_sentence(localisations) else { return String::new() };
    let mut table = Table::new(["at", "unit", "explained over time", "evidence", "depends on"]);
    for localisation in localisations {
        let share = percent_text(100.0 * localisation.explained_fraction);
        let (junction, unit) = (localisation.junction.clone(), localisation.unit.clone());
        table.row([
            junction,
            unit,
            share,
            format_pure_number(localisation.evidence),
            dependence_text(localisation),
        ]);
    }
    format!("\nfound without the library: {sentence}\n\n{}", table.text())
}

/// The number of the round, counted from 1, the number of trials, and the result.
fn heading(round_number: usize, round: &Round, outcome: &Outcome) -> String {
    format!("round {round_number}: {}. {}", trial_count_text(round), round_sentence(outcome, round))
}

/// The table of the best trials of a round, one per effect and site.
///
/// Trials of the same effect at the same site with other forms or signals are not repeated; the best is listed.
fn trials(round: &Round) -> String {
    let mut listed: Vec<&Trial> = Vec::new();
    for trial in &round.trials {
        if listed.iter().all(|other| other.placed_effect() != trial.placed_effect()) {
            listed.push(trial);
        }
    }
    let mut table = Table::new(["effect", "at", "score", "train", "test"]);
    for trial in listed.iter().take(MAX_TRIALS) {
        let PlacedEffect { effect, site } = trial.placed_effect();
        let [train, validation] = residual_texts(&trial.model);
        table.row([effect, site, format_pure_number(trial.delta_bic), train, validation]);
    }
    match listed.len().saturating_sub(MAX_TRIALS) {
        0 => table.text(),
        more => format!("{}and {more} more\n", table.text()),
    }
}
