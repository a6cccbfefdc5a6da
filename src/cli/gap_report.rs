//! What a search found, in words.

use super::table::Table;
use patchcord::ident::design::detectability::{Limit, best_places};
use patchcord::ident::fit::problem::Problem;
use patchcord::ident::localise::Whereabouts;
use patchcord::ident::report::Report;
use patchcord::ident::report::detection_limits::limit_text;
use patchcord::ident::report::fit_quality::starts_sentence;
use patchcord::ident::report::localisation::localisation_sentence;
use patchcord::ident::report::places::nowhere_sentence;
use patchcord::ident::report::rounds::{round_sentence, skipped_trial_sentence, trial_count_text};
use patchcord::ident::report::search_log::action_text;
use patchcord::ident::report::values::{
    error_text, estimate_text, interval_text, owner, parameter_values_text, undetermined_sentence,
};
use patchcord::ident::search::round::{Round, Trial};
use patchcord::ident::search::{Outcome, Verdict};
use patchcord::instruments::number;

/// So many trials are told of every round.
const TOLD: usize = 8;

pub(super) fn told(report: &Report<'_>) -> String {
    let Report { experiment, problem, outcome } = *report;
    let mut text = format!("{}: {}\n", experiment.file, report.sentence());
    text += &format!("\n{}", parameters(outcome).text());
    text.extend(undetermined_sentence(outcome.told()).map(|own| format!("{own}\n")));
    text += &format!("\n{}", gaps(problem, outcome).text());
    text.extend(report.doubts().into_iter().map(|own| own + "\n"));
    if !outcome.agreement.is_same {
        text += &format!("\nbefore: {}\n", starts_sentence(&outcome.agreement));
    }
    text += &way(outcome);
    text += &place(&outcome.whereabouts);
    let told = matches!(outcome.verdict, Verdict::NothingMissing | Verdict::CannotJudge);
    if told && !outcome.limits.is_empty() {
        let table = weakest(&outcome.limits, "weakest that would have shown");
        text += &format!(
            "\nwhat these data would have shown, every effect where it shows best of all places and values that were tried\n\n{table}"
        );
    }
    for (number, round) in outcome.rounds.iter().enumerate() {
        text += &format!("\n{}\n\n{}", heading(number + 1, round, outcome), trials(round));
        text.extend(round.left_out.iter().map(|own| format!("{}\n", skipped_trial_sentence(own))));
    }
    text.extend(nowhere_sentence(&outcome.places).map(|own| format!("\n{own}\n")));
    text
}

fn parameters(outcome: &Outcome) -> Table {
    let stage = outcome.told();
    let mut table = Table::new(["fitted", "value", "standard error", "95 %", "unit", "of"]);
    for (place, name) in stage.version.fit.iter().enumerate() {
        let value = estimate_text(stage, place);
        let (error, interval) = (error_text(stage, place), interval_text(stage.known(place)));
        table.row([name.clone(), value, error, interval, stage.unit(place).to_owned(), owner(outcome, name)]);
    }
    table
}

/// What the patch leaves unexplained, over the noise: rms.
fn gaps(problem: &Problem, outcome: &Outcome) -> Table {
    let mut table = Table::new(["gap, in noise", "train", "test"]);
    for (what, stage) in [("before", &outcome.base), ("after", outcome.told())] {
        let cells = [&stage.train, &stage.test].map(|fitted| number(fitted.over_noise()));
        table.row([format!("{what} ({})", problem.outputs.join(", ")), cells[0].clone(), cells[1].clone()]);
    }
    table
}

/// The way to what is told, where it is longer than one effect.
fn way(outcome: &Outcome) -> String {
    if !outcome.has_a_way() {
        return String::new();
    }
    let mut table = Table::new(["the way there", "train", "test"]);
    for change in &outcome.way {
        let [train, test] = change.left.map(number);
        table.row([action_text(&change.did), train, test]);
    }
    format!("\n{}", table.text())
}

/// Where and when something is missing.
fn place(found: &[Whereabouts]) -> String {
    let Some(sentence) = localisation_sentence(found) else { return String::new() };
    let mut text = format!("\nfound without the library: {sentence}\n\n");
    let mut table = Table::new(["at", "unit", "closes of the gap over time", "evidence", "goes with"]);
    for own in found {
        let share = format!("{} %", number(100.0 * own.explains));
        let (at, unit) = (own.junction.clone(), own.unit.clone());
        table.row([at, unit, share, number(own.evidence), goes_with(own)]);
    }
    text += &table.text();
    text
}

/// What a force goes with, and what the curve over that closes by itself.
fn goes_with(own: &Whereabouts) -> String {
    let share =
        own.best.map(|best| format!(", as which it closes {} %", number(100.0 * own.curves[best].explains)));
    own.best_against().to_owned() + &share.unwrap_or_default()
}

/// The weakest of every effect that shows, in a column of this name.
pub(super) fn weakest(found: &[Limit], heading: &str) -> String {
    let mut table = Table::new(["effect", "at", "parameter", heading, "with"]);
    for limit in best_places(found) {
        let from = limit_text(limit).unwrap_or_else(|| "not at all".to_owned());
        let (effect, at, parameter) = (limit.effect.clone(), limit.junction.clone(), limit.parameter.clone());
        table.row([effect, at, parameter, from, parameter_values_text(&limit.beside)]);
    }
    table.text()
}

fn heading(place: usize, round: &Round, outcome: &Outcome) -> String {
    format!("round {place}: {}. {}", trial_count_text(round), round_sentence(outcome, round))
}

/// The best trials, every effect once at every place, and how many more there are.
fn trials(round: &Round) -> String {
    let mut each: Vec<&Trial> = Vec::new();
    for trial in &round.trials {
        if each.iter().all(|own| own.named() != trial.named()) {
            each.push(trial);
        }
    }
    let mut table = Table::new(["effect", "at", "score", "train", "test"]);
    for trial in each.iter().take(TOLD) {
        let (effect, at) = (trial.candidate.effect.clone(), trial.candidate.junction.clone());
        let [train, test] = [&trial.stage.train, &trial.stage.test].map(|fitted| number(fitted.over_noise()));
        table.row([effect, at, number(trial.score), train, test]);
    }
    match each.len().saturating_sub(TOLD) {
        0 => table.text(),
        more => format!("{}and {more} more behind these\n", table.text()),
    }
}
