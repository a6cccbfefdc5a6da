//! What a search found, in words.

use super::table::Table;
use patchcord::ident::Experiment;
use patchcord::ident::design::detectability::{Limit, best_places};
use patchcord::ident::fit::problem::Problem;
use patchcord::ident::localise as whereabouts;
use patchcord::ident::localise::Whereabouts;
use patchcord::ident::search::round::{Round, Trial};
use patchcord::ident::search::{Outcome, Verdict};
use patchcord::instruments::number;

/// So many trials are told of every round.
const TOLD: usize = 8;

pub(super) fn told(experiment: &Experiment, problem: &Problem, outcome: &Outcome) -> String {
    let mut text = format!("{}: {}\n", experiment.file, outcome.sentence());
    text += &format!("\n{}", parameters(outcome).text());
    text.extend(outcome.told().untold().map(|own| format!("{own}\n")));
    text += &format!("\n{}", gaps(problem, outcome).text());
    text.extend(outcome.doubts(experiment).into_iter().map(|own| own + "\n"));
    if !outcome.agreement.is_same {
        text += &format!("\nbefore: {}\n", outcome.agreement.sentence());
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
        text.extend(round.left_out.iter().map(|own| format!("{}\n", own.sentence())));
    }
    text.extend(outcome.places.nowhere_told().map(|own| format!("\n{own}\n")));
    text
}

fn parameters(outcome: &Outcome) -> Table {
    let stage = outcome.told();
    let mut table = Table::new(["fitted", "value", "standard error", "95 %", "unit", "of"]);
    for (place, name) in stage.version.fit.iter().enumerate() {
        let value = stage.number_told(place);
        let (error, interval) = (stage.error_told(place), stage.interval_told(place));
        table.row([name.clone(), value, error, interval, stage.unit(place).to_owned(), outcome.owner(name)]);
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
        table.row([change.did.clone(), train, test]);
    }
    format!("\n{}", table.text())
}

/// Where and when something is missing.
fn place(found: &[Whereabouts]) -> String {
    let Some(sentence) = whereabouts::sentence(found) else { return String::new() };
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
        let from = limit.told().unwrap_or_else(|| "not at all".to_owned());
        let (effect, at, parameter) = (limit.effect.clone(), limit.junction.clone(), limit.parameter.clone());
        table.row([effect, at, parameter, from, limit.beside.told()]);
    }
    table.text()
}

fn heading(place: usize, round: &Round, outcome: &Outcome) -> String {
    format!("round {place}: {}. {}", round.tried_told(), outcome.round_told(round))
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
