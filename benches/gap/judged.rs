//! What the search said of a case, held against the truth.

use std::fmt::Write as _;
use std::time::Instant;

use patchcord::gap::Experiment;
use patchcord::gap::effect::Library;
use patchcord::gap::score::{colour, memory};
use patchcord::gap::search::{Means, Outcome as Found, Verdict};
use patchcord::gap::stage::Problem;

use crate::Outcome;
use crate::hidden::{Hidden, Truth};

/// How an answer stands to the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Judgement {
    /// Every effect is named, and nothing else; or nothing is missing, and that is said.
    Right,
    /// One of two is named, and nothing else.
    Half,
    /// The truth is among two.
    Among,
    /// Something is missing, and nothing is named.
    Refused,
    /// Something is named that is not there.
    Wrong,
    /// Nothing is missing, and something is said to be.
    FalseAlarm,
}

/// A case judged.
pub struct Judged {
    pub number: usize,
    pub truth: Truth,
    pub verdict: &'static str,
    /// Name and junction of what was named.
    pub named: Vec<(String, String)>,
    pub judgement: Judgement,
    pub seconds: f64,
    /// What was tried, for a reader.
    pub tried: String,
}

impl Judged {
    pub fn of(number: usize, hidden: &Hidden, library: &Library) -> Outcome<Judged> {
        let truth = hidden.truth(number)?;
        let began = Instant::now();
        let experiment = Experiment::read(&hidden.experiment(number)).map_err(|error| error.to_string())?;
        let problem = Problem::of(&experiment)?;
        let with = Means { library, threads: 1, seed: 1 };
        let found = problem.search(&experiment.patch, &experiment.fit, &with, |_, _| ())?;
        let seconds = began.elapsed().as_secs_f64();
        let Some(found) = found else { return Err(format!("case {number} cannot be run").into()) };
        let named = named(&found);
        let judgement = judgement(&truth, &found, &named);
        let tried = tried(&problem, &found);
        Ok(Judged { number, truth, verdict: found.verdict.as_str(), named, judgement, seconds, tried })
    }

    /// The case in a line.
    pub fn line(&self) -> String {
        let named: Vec<_> = self.named.iter().map(|(name, at)| format!("{name}@{at}")).collect();
        format!(
            "{:04} {:<44} {:7.2}  {:<15} {:<44} {:?} {:.1} s",
            self.number,
            self.truth.what,
            self.truth.egnr,
            self.verdict,
            named.join("+"),
            self.judgement,
            self.seconds
        )
    }
}

fn named(found: &Found) -> Vec<(String, String)> {
    if !matches!(found.verdict, Verdict::Named | Verdict::Ambiguous) {
        return Vec::new();
    }
    let rounds = found.rounds.iter().filter(|round| round.taken);
    let trials = rounds.flat_map(|round| round.trials.iter().take(1).chain(round.rivals()));
    trials.map(|trial| (trial.candidate.effect.clone(), trial.candidate.junction.clone())).collect()
}

fn judgement(truth: &Truth, found: &Found, named: &[(String, String)]) -> Judgement {
    let is_there = |(name, _): &(String, String)| truth.effects.iter().any(|(own, _)| own == name);
    let is_named = |(name, _): &(String, String)| named.iter().any(|(own, _)| own == name);
    match found.verdict {
        Verdict::NothingMissing if truth.effects.is_empty() => Judgement::Right,
        Verdict::UnknownEffect | Verdict::Named | Verdict::Ambiguous if truth.effects.is_empty() => {
            Judgement::FalseAlarm
        }
        Verdict::UnknownEffect if truth.what.starts_with("unknown") => Judgement::Right,
        Verdict::NothingMissing | Verdict::UnknownEffect | Verdict::CannotJudge => Judgement::Refused,
        Verdict::Ambiguous if named.iter().any(is_there) => Judgement::Among,
        Verdict::Named if named.iter().all(is_there) && truth.effects.iter().all(is_named) => {
            Judgement::Right
        }
        Verdict::Named if named.iter().all(is_there) => Judgement::Half,
        _ => Judgement::Wrong,
    }
}

/// What was tried: the base, and the first trials of every round.
fn tried(problem: &Problem, found: &Found) -> String {
    let mut text = String::new();
    let base = &found.base.train;
    let over = |chi2: f64, count: usize| chi2 / count as f64;
    let _ = writeln!(
        text,
        "     base {:.3} colour {:.1} memory {:.1} knobs {:?} sigma {:?} steps {}",
        over(base.chi2, base.count),
        colour(base),
        memory(base),
        base.point.knobs,
        problem.sigma,
        problem.steps
    );
    for round in &found.rounds {
        let _ = writeln!(
            text,
            "     needed {:.1}, confirmed by {:.1} +- {:.1}, tied {}, taken {}",
            round.needed, round.confirmed.sum, round.confirmed.error, round.tied, round.taken
        );
        for trial in round.trials.iter().take(60) {
            let (train, test) = (&trial.stage.train, &trial.stage.test);
            let _ = writeln!(
                text,
                "       {:<26} {:<5} score {:>9.1} train {:.3} test {:.3} colour {:.1} memory {:.1} behind {:.1} +- {:.1} {:?}",
                trial.candidate.effect,
                trial.candidate.junction,
                trial.score,
                over(train.chi2, train.count),
                over(test.chi2, test.count),
                colour(train),
                memory(train),
                trial.behind.sum,
                trial.behind.error,
                &train.point.knobs[round.before.train.point.knobs.len()..]
            );
        }
    }
    let _ = write!(text, "     left {:.3}", found.left);
    text
}
