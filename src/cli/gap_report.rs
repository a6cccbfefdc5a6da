//! What a search found, in words.

use super::table::Table;
use patchcord::gap::Experiment;
use patchcord::gap::report::error;
use patchcord::gap::search::{Outcome, Round, Trial, Verdict};
use patchcord::gap::stage::{Problem, Stage};
use patchcord::instruments::Display;

/// So many trials are told of every round.
const TOLD: usize = 8;

pub(super) fn told(experiment: &Experiment, problem: &Problem, outcome: &Outcome) -> String {
    let mut text = format!("{}: {}\n", experiment.file, sentence(outcome));
    text += &format!("\n{}", parameters(outcome.told()).text());
    text += &format!("\n{}", gaps(problem, outcome).text());
    for (number, round) in outcome.rounds.iter().enumerate() {
        text += &format!("\n{}\n\n{}", heading(number + 1, round), trials(round).text());
    }
    text
}

fn named(trial: &Trial) -> String {
    format!("{} at {}", trial.candidate.effect, trial.candidate.junction)
}

/// The verdict.
fn sentence(outcome: &Outcome) -> String {
    let taken = outcome.rounds.iter().filter(|round| round.taken);
    let told = |round: &Round| {
        let rivals = round.trials.iter().take(1).chain(round.rivals());
        rivals.map(named).collect::<Vec<_>>().join(" or ")
    };
    let effects = taken.map(told).collect::<Vec<_>>().join(", and ");
    match outcome.verdict {
        Verdict::Named => format!("{effects} is missing"),
        Verdict::Ambiguous => format!("{effects} is missing: these data cannot tell"),
        Verdict::NothingMissing => "nothing is missing that these data would show".to_owned(),
        Verdict::UnknownEffect => "something is missing that the library does not have".to_owned(),
        Verdict::CannotJudge => "these data cannot judge".to_owned(),
    }
}

fn parameters(stage: &Stage) -> Table {
    let mut table = Table::new(["fitted", "value", "standard error", "unit"]);
    for (place, name) in stage.version.fit.iter().enumerate() {
        let unit = stage.version.patch.parameters.get(name).map_or("1", |own| own.unit.text());
        let number = |value: f64| Display::new("", 1.0).number(value);
        let cells = [number(stage.train.point.knobs[place]), number(error(&stage.train, place))];
        table.row([name.clone(), cells[0].clone(), cells[1].clone(), unit.to_owned()]);
    }
    table
}

/// What the patch leaves unexplained, over the noise: rms.
fn gaps(problem: &Problem, outcome: &Outcome) -> Table {
    let mut table = Table::new(["gap, in noise", "train", "test"]);
    for (what, stage) in [("before", &outcome.base), ("after", outcome.told())] {
        let over = |chi2: f64, count: usize| Display::new("", 1.0).number((chi2 / count as f64).sqrt());
        let cells = [&stage.train, &stage.test].map(|fitted| over(fitted.chi2, fitted.count));
        table.row([format!("{what} ({})", problem.outputs.join(", ")), cells[0].clone(), cells[1].clone()]);
    }
    table
}

fn heading(number: usize, round: &Round) -> String {
    let taken = if round.taken { "the first is taken" } else { "none is taken" };
    let needed = Display::new("", 1.0).number(round.needed);
    let count = round.trials.len();
    format!(
        "round {number}: {count} effects and places tried; a score of {needed} is needed, and the test has to agree: {taken}"
    )
}

fn trials(round: &Round) -> Table {
    let mut table = Table::new(["effect", "at", "score", "train", "test"]);
    for trial in round.trials.iter().take(TOLD) {
        let number = |value: f64| Display::new("", 1.0).number(value);
        let over = |chi2: f64, count: usize| number((chi2 / count as f64).sqrt());
        let (train, test) = (&trial.stage.train, &trial.stage.test);
        table.row([
            trial.candidate.effect.clone(),
            trial.candidate.junction.clone(),
            number(trial.score),
            over(train.chi2, train.count),
            over(test.chi2, test.count),
        ]);
    }
    table
}
