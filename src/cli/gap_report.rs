//! Formats the result of a search for missing effects as text.
//!
//! The sentences come from `patchcord::ident::report`, which the HTML page uses as well. This file only arranges them
//! with tables. Residuals are rms values over the noise, in training and in test data.

use super::table::Table;
use patchcord::format::number;
use patchcord::ident::design::detectability::{DetectionLimit, best_places};
use patchcord::ident::fit::problem::Problem;
use patchcord::ident::localise::Localisation;
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

/// The number of trials that are listed per round.
const MAX_TRIALS: usize = 8;

/// The report: result, parameters, gaps, search path, places, detection limits and rounds.
///
/// The most important part is first: the verdict. The rounds, which explain it, are last.
pub(super) fn text(report: &Report<'_>) -> String {
    let Report { experiment, problem, outcome } = *report;
    let mut text = format!("{}: {}\n", experiment.file, report.sentence());
    text += &format!("\n{}", parameters(outcome).text());
    text.extend(undetermined_sentence(outcome.reported_model()).map(|own| format!("{own}\n")));
    text += &format!("\n{}", gaps(problem, outcome).text());
    text.extend(report.doubts().into_iter().map(|own| own + "\n"));
    if !outcome.agreement.is_reproduced {
        text += &format!("\nbefore: {}\n", starts_sentence(&outcome.agreement));
    }
    text += &path_text(outcome);
    text += &places_text(&outcome.localisations);
    let is_negative = matches!(outcome.verdict, Verdict::NothingMissing | Verdict::CannotJudge);
    if is_negative && !outcome.detection_limits.is_empty() {
        let table = weakest(&outcome.detection_limits, "weakest detectable");
        text += &format!(
            "\nweakest effects that these data would have shown, each at the place and \
             values where it is easiest to detect\n\n{table}"
        );
    }
    for (number, round) in outcome.rounds.iter().enumerate() {
        text += &format!("\n{}\n\n{}", heading(number + 1, round, outcome), trials(round));
        text.extend(round.skipped.iter().map(|own| format!("{}\n", skipped_trial_sentence(own))));
    }
    text.extend(nowhere_sentence(&outcome.places).map(|own| format!("\n{own}\n")));
    text
}

/// The table of fitted parameters.
///
/// Parameters of named effects follow those of the patch; the last column says to which of them each belongs.
fn parameters(outcome: &Outcome) -> Table {
    let stage = outcome.reported_model();
    let mut table = Table::new(["fitted", "value", "standard error", "95 %", "unit", "of"]);
    for (place, name) in stage.variant.fit.iter().enumerate() {
        let value = estimate_text(stage, place);
        let (error, interval) = (error_text(stage, place), interval_text(stage.uncertainty(place)));
        table.row([name.clone(), value, error, interval, stage.unit(place).to_owned(), owner(outcome, name)]);
    }
    table
}

/// The table of rms residuals in units of the noise, before and after.
fn gaps(problem: &Problem, outcome: &Outcome) -> Table {
    let mut table = Table::new(["gap, in noise", "train", "test"]);
    for (what, stage) in [("before", &outcome.base), ("after", outcome.reported_model())] {
        let cells = [&stage.train, &stage.test].map(|fitted| number(fitted.normalised_rms()));
        table.row([format!("{what} ({})", problem.outputs.join(", ")), cells[0].clone(), cells[1].clone()]);
    }
    table
}

/// The table of changes from the patch to the result; empty if there is only one.
fn path_text(outcome: &Outcome) -> String {
    if !outcome.has_detailed_log() {
        return String::new();
    }
    let mut table = Table::new(["search path", "train", "test"]);
    for change in &outcome.search_log {
        let [train, test] = change.residual_rms.map(number);
        table.row([action_text(&change.action), train, test]);
    }
    format!("\n{}", table.text())
}

/// The table of places at which an unknown input explains the gap; empty if there are none.
fn places_text(found: &[Localisation]) -> String {
    let Some(sentence) = localisation_sentence(found) else { return String::new() };
    let mut text = format!("\nfound without the library: {sentence}\n\n");
    let mut table = Table::new(["at", "unit", "explained over time", "evidence", "depends on"]);
    for own in found {
        let share = format!("{} %", number(100.0 * own.explained_fraction));
        let (at, unit) = (own.junction.clone(), own.unit.clone());
        table.row([at, unit, share, number(own.evidence), dependence(own)]);
    }
    text += &table.text();
    text
}

/// The quantity on which the unknown input depends, and what a curve over that quantity explains.
fn dependence(own: &Localisation) -> String {
    let share = own
        .best_curve
        .map(|best| format!(", which explains {} %", number(100.0 * own.curves[best].explained_fraction)));
    own.best_regressor().to_owned() + &share.unwrap_or_default()
}

/// The table of detection limits, one row per effect. `heading` is that of the strength.
pub(super) fn weakest(found: &[DetectionLimit], heading: &str) -> String {
    let mut table = Table::new(["effect", "at", "parameter", heading, "with"]);
    for limit in best_places(found) {
        let from = limit_text(limit).unwrap_or_else(|| "not detectable".to_owned());
        let (effect, at, parameter) = (limit.effect.clone(), limit.junction.clone(), limit.parameter.clone());
        table.row([effect, at, parameter, from, parameter_values_text(&limit.other_parameters)]);
    }
    table.text()
}

/// The number of the round, counted from 1, the number of trials, and the result.
fn heading(place: usize, round: &Round, outcome: &Outcome) -> String {
    format!("round {place}: {}. {}", trial_count_text(round), round_sentence(outcome, round))
}

/// The table of the best trials of a round, one per effect and place.
///
/// Trials of the same effect at the same place with other forms or signals are not repeated; the best is listed.
fn trials(round: &Round) -> String {
    let mut each: Vec<&Trial> = Vec::new();
    for trial in &round.trials {
        if each.iter().all(|own| own.label() != trial.label()) {
            each.push(trial);
        }
    }
    let mut table = Table::new(["effect", "at", "score", "train", "test"]);
    for trial in each.iter().take(MAX_TRIALS) {
        let (effect, at) = (trial.candidate.effect.clone(), trial.candidate.junction.clone());
        let [train, test] =
            [&trial.model.train, &trial.model.test].map(|fitted| number(fitted.normalised_rms()));
        table.row([effect, at, number(trial.delta_bic), train, test]);
    }
    match each.len().saturating_sub(MAX_TRIALS) {
        0 => table.text(),
        more => format!("{}and {more} more\n", table.text()),
    }
}
