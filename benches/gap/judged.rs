//! What the search said of a case, held against the truth.

use std::fmt::Write as _;
use std::time::Instant;

use serde_json::Value;

use crate::Outcome;
use crate::hidden::{Effect, Hidden, Truth, in_si};
use patchcord::expr::Unit;
use patchcord::ident::Experiment;
use patchcord::ident::effects::Library;
use patchcord::ident::fit::problem::Problem;
use patchcord::ident::report::Report;
use patchcord::ident::search::{Means, Outcome as Found, Verdict};

/// How an answer stands to the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Judgement {
    /// Every effect is named, and nothing else; or nothing is missing, and that is said.
    Right,
    /// One of two is named, and nothing else.
    Half,
    /// The data cannot tell, and of what they cannot tell apart something is there, at every step.
    Among,
    /// Nothing is named: of what is missing, or where the data are said to tell nothing.
    Refused,
    /// Something is named that is not there, but some data cannot tell it from what is: each has the other among its aliases.
    Alias,
    /// Something is named that is not there.
    Wrong,
    /// Nothing is missing, and something is said to be.
    FalseAlarm,
}

impl Judgement {
    /// Every one, in the order of a table.
    pub const ALL: [Judgement; 7] = [
        Judgement::Right,
        Judgement::Half,
        Judgement::Among,
        Judgement::Refused,
        Judgement::Alias,
        Judgement::Wrong,
        Judgement::FalseAlarm,
    ];

    /// The heading of its column.
    pub fn as_str(self) -> &'static str {
        match self {
            Judgement::Right => "right",
            Judgement::Half => "one of two",
            Judgement::Among => "among two",
            Judgement::Refused => "refused",
            Judgement::Alias => "an alias",
            Judgement::Wrong => "wrong name",
            Judgement::FalseAlarm => "false alarm",
        }
    }
}

/// A case judged.
pub struct Judged {
    pub number: usize,
    pub truth: Truth,
    pub verdict: String,
    /// Name and junction of what was named.
    pub named: Vec<(String, String)>,
    pub judgement: Judgement,
    /// Parameters of effects that are rightly named, which the truth tells, too.
    pub parameters: Vec<Parameter>,
    /// What is left of the data that were held back, rms over sigma.
    pub held_out: f64,
    pub seconds: f64,
    /// What was tried, for a reader.
    pub tried: String,
}

/// A fitted parameter beside the true one, in SI units.
pub struct Parameter {
    /// Of which effect,
    pub effect: String,
    /// and which of its parameters it is.
    pub name: String,
    pub wanted: f64,
    pub found: f64,
    /// In which it lies, as the search says, in 95 of 100 cases.
    pub interval: [f64; 2],
}

impl Judged {
    pub fn of(number: usize, hidden: &Hidden, library: &Library, threads: usize) -> Outcome<Judged> {
        let truth = hidden.truth(number)?;
        let began = Instant::now();
        let experiment = Experiment::read(&hidden.experiment(number)).map_err(|error| error.to_string())?;
        let problem = Problem::of(&experiment)?;
        let with = Means { library, threads, seed: 1 };
        let found =
            patchcord::ident::search::search(&problem, &experiment.patch, &experiment.fit, &with, |_| ())?;
        let seconds = began.elapsed().as_secs_f64();
        let Some(found) = found else { return Err(format!("case {number} cannot be run").into()) };
        let report = Report::new(&experiment, &problem, &found);
        let effects = report.json()["effects"].as_array().cloned().unwrap_or_default();
        let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let named: Vec<_> = effects.iter().map(|own| (text(&own["name"]), text(&own["junction"]))).collect();
        let steps = effects.chunk_by(|one, next| one["step"] == next["step"]);
        let steps: Vec<Vec<String>> =
            steps.map(|own| own.iter().map(|effect| text(&effect["name"])).collect()).collect();
        let judgement = judgement(&truth, found.verdict, &steps, library);
        Ok(Judged {
            verdict: found.verdict.as_str().to_owned(),
            judgement,
            parameters: parameters(&truth, &effects),
            held_out: found.told().test.over_noise(),
            tried: tried(&problem, &found),
            number,
            truth,
            named,
            seconds,
        })
    }

    /// Whether everything that is rightly named is named where it is; nothing where nothing is.
    pub fn is_in_place(&self) -> Option<bool> {
        let right = self.named.iter().filter_map(|(name, at)| {
            let effect = self.truth.effects.iter().find(|own| own.name == *name)?;
            Some(effect.junction == *at)
        });
        right.reduce(|all, own| all && own)
    }

    /// The case in a line.
    pub fn line(&self) -> String {
        let named: Vec<_> = self.named.iter().map(|(name, at)| format!("{name}@{at}")).collect();
        let most_off = self.parameters.iter().map(Parameter::off).fold(0.0, f64::max);
        format!(
            "{:04} {:<44} {:7.2}  {:<15} {:<44} {:?} held {:.3} off {:.3} {:.1} s",
            self.number,
            self.truth.what,
            self.truth.egnr,
            self.verdict,
            named.join("+"),
            self.judgement,
            self.held_out,
            most_off,
            self.seconds
        )
    }
}

fn parameters(truth: &Truth, effects: &[Value]) -> Vec<Parameter> {
    let pairs = truth.effects.iter().flat_map(|own| {
        let named = effects.iter().find(|effect| effect["name"] == own.name.as_str());
        let wanted = own.parameters.iter().filter(|(_, wanted)| **wanted != 0.0);
        wanted.filter_map(move |(name, wanted)| {
            Parameter::of(&own.name, name, *wanted, &named?["parameters"][name])
        })
    });
    pairs.collect()
}

impl Parameter {
    /// `told` as the report has it, the true value in SI.
    fn of(effect: &str, name: &str, wanted: f64, told: &Value) -> Option<Parameter> {
        let unit = Unit::parse(told["unit"].as_str()?).ok()?;
        let end = |place: usize| told["interval"][place].as_f64().map(|end| unit.to_si(end));
        Some(Parameter {
            effect: effect.to_owned(),
            name: name.to_owned(),
            wanted,
            found: in_si(told)?,
            interval: [end(0).unwrap_or(f64::NEG_INFINITY), end(1).unwrap_or(f64::INFINITY)],
        })
    }

    /// Of the difference, the share of the true value.
    pub fn off(&self) -> f64 {
        (self.found - self.wanted).abs() / self.wanted.abs()
    }

    /// Whether its interval holds the true value.
    pub fn is_covered(&self) -> bool {
        (self.interval[0]..=self.interval[1]).contains(&self.wanted)
    }
}

/// Whether some data cannot tell two effects apart.
fn are_alike(library: &Library, one: &str, other: &str) -> bool {
    let has = |name: &str, alias: &str| {
        library.iter().any(|effect| effect.name == name && effect.aliases.contains_key(alias))
    };
    has(one, other) || has(other, one)
}

/// What a verdict is worth that names one of these at every step.
fn judgement(truth: &Truth, verdict: Verdict, steps: &[Vec<String>], library: &Library) -> Judgement {
    let is_there = |name: &String| truth.effects.iter().any(|own| own.name == *name);
    let is_like =
        |name: &String| is_there(name) || truth.effects.iter().any(|own| are_alike(library, name, &own.name));
    let named = || steps.iter().flatten();
    let is_named = |own: &Effect| named().filter(|name| own.name == **name).count() == 1;
    let all_there = steps.iter().all(|names| names.iter().any(is_there));
    match verdict {
        Verdict::NothingMissing if truth.effects.is_empty() => Judgement::Right,
        Verdict::UnknownEffect | Verdict::Named | Verdict::Ambiguous if truth.effects.is_empty() => {
            Judgement::FalseAlarm
        }
        Verdict::UnknownEffect if truth.what.starts_with("unknown") => Judgement::Right,
        Verdict::NothingMissing | Verdict::UnknownEffect | Verdict::CannotJudge => Judgement::Refused,
        Verdict::Ambiguous if all_there => Judgement::Among,
        Verdict::Named if all_there && truth.effects.iter().all(is_named) => Judgement::Right,
        Verdict::Named if all_there && steps.len() < truth.effects.len() => Judgement::Half,
        _ if !all_there && named().all(is_like) => Judgement::Alias,
        _ => Judgement::Wrong,
    }
}

/// What was tried: the base, and the first trials of every round.
fn tried(problem: &Problem, found: &Found) -> String {
    let mut text = String::new();
    let base = &found.base;
    let _ = writeln!(
        text,
        "     base {:.3} colour {:.1} memory {:.1} knobs {:?} sigma {:?} steps {}",
        base.train.reduced(),
        base.colour,
        base.memory,
        base.train.point.knobs,
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
                train.reduced(),
                test.reduced(),
                trial.stage.colour,
                trial.stage.memory,
                trial.behind.sum,
                trial.behind.error,
                &train.point.knobs[round.before.train.point.knobs.len()..]
            );
        }
    }
    for own in &found.whereabouts {
        let curves = own
            .curves
            .iter()
            .map(|curve| format!("{} {:.3} held {:.3?}", curve.against, curve.explains, curve.held_out));
        let _ = writeln!(
            text,
            "     at {} explains {:.3} evidence {:.1} best {} ({})",
            own.junction,
            own.explains,
            own.evidence,
            own.best_against(),
            curves.collect::<Vec<_>>().join(", ")
        );
    }
    let _ = write!(text, "     left {:.3}", found.left);
    text
}
