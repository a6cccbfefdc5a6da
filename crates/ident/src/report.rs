//! What a search found, for readers and programs: a JSON document, and the patch with what was missing.

use std::collections::HashSet;

use serde_json::{Map, Value, json};

use super::beyond::Beyond;
use super::blind::{Blind, LOUD, has_changed, over_sigma};
use super::candidate::Candidate;
use super::correlation::Correlation;
use super::experiment::{Experiment, Output};
use super::fit::{Fitted, Point};
use super::intervals::Known;
use super::limits::Limit;
use super::measured::plural;
use super::parameter_values::ParameterValues;
use super::problem::Problem;
use super::record::Record;
use super::round::{LeftOut, Round, Trial};
use super::score::Advantage;
use super::search::{Outcome, Verdict};
use super::separate::Separating;
use super::settled::may_be_none;
use super::stage::Stage;
use super::way::Change;
use super::whereabouts::Whereabouts;
use patchcord_analysis::instruments::number;
use patchcord_core::document::behind;

impl Stage {
    /// The unit of what is fitted at a place.
    pub fn unit(&self, place: usize) -> &str {
        let parameter = self.version.patch.parameters.get(&self.version.fit[place]);
        parameter.map_or("1", |own| own.unit.text())
    }

    /// The value of what is fitted at a place, with as many digits as its interval asks for.
    pub fn number_told(&self, place: usize) -> String {
        self.known(place).number(self.train.point.knobs[place])
    }

    /// What is fitted at a place, and its value, in words.
    pub fn value_told(&self, place: usize) -> String {
        format!("{} = {}{}", self.version.fit[place], self.number_told(place), behind(self.unit(place)))
    }

    /// What is fitted, with the values that it has at a point.
    pub(super) fn values_at(&self, point: &Point) -> ParameterValues {
        let each = self.version.fit.iter().zip(&point.knobs).enumerate();
        let each = each.map(|(place, (name, value))| (name.clone(), *value, self.unit(place).to_owned()));
        ParameterValues(each.collect())
    }

    /// The standard error of what is fitted at a place, in words.
    pub fn error_told(&self, place: usize) -> String {
        let error = self.known(place).error;
        if error.is_finite() { number(error) } else { "not told".to_owned() }
    }

    /// Between which values what is fitted at a place lies in 95 of 100 cases, as it is told.
    pub fn interval_told(&self, place: usize) -> String {
        self.known(place).interval_told()
    }

    /// What the data do not tell of what is fitted, in a sentence; nothing where they tell of all.
    pub fn untold(&self) -> Option<String> {
        let untold =
            self.version.fit.iter().enumerate().filter(|(place, _)| !self.known(*place).error.is_finite());
        let names: Vec<&str> = untold.map(|(_, name)| name.as_str()).collect();
        let why = match names.as_slice() {
            [] => return None,
            [_] => "its value changes nothing, or what it changes others can make up for",
            _ => "their values change nothing, or can be changed together and leave the same",
        };
        Some(format!("These data do not tell {}: {why}.", names.join(", ")))
    }
}

/// What is left is as large as the noise, unless that is told too large: by so much less it is not by chance.
const FAR_LESS: f64 = 0.5;

impl Outcome {
    /// What the reader should doubt, in sentences: ranges at whose end the patch stands, more noise than there can be, a solver that
    /// errs by more than it should, what is left that only looks like noise, integrators without a signal,
    /// and what the experiment was warned of.
    pub fn doubts(&self, experiment: &Experiment) -> Vec<String> {
        let warnings = experiment.warnings.findings.iter();
        let warned =
            warnings.map(|own| format!("Of the experiment ({}): {}.", own.code.as_str(), own.message));
        let coarse = (!self.fineness.is_enough()).then(|| self.fineness.sentence());
        let noises = self.noises(experiment).into_iter().chain(self.louder(experiment));
        let nameless = self.places.nameless_told();
        self.at_ends()
            .into_iter()
            .chain(self.overload.iter().cloned())
            .chain(self.more_is_left())
            .chain(self.uncertain())
            .chain(noises)
            .chain(nameless)
            .chain(coarse)
            .chain(warned)
            .collect()
    }

    /// Which parameters of the patch stand at an end of their ranges: as it was, or beside what is named.
    fn at_ends(&self) -> Vec<String> {
        let told = |stage: &Stage, place: usize| {
            let (name, value) = (&stage.version.fit[place], stage.number_told(place));
            format!("{name} at the end of its range, {value}{}", behind(stage.unit(place)))
        };
        let is_missing = self.verdict.has_names() || self.verdict == Verdict::UnknownEffect;
        let beyond = self.beyond.iter().flat_map(|own| &own.places).copied().collect::<Vec<_>>();
        // What is none stands in for nothing.
        let doubted =
            self.base.at_end().filter(|place| is_missing || self.base.train.point.knobs[*place] != 0.0);
        let doubted = doubted.filter(|place| !beyond.contains(place));
        let before = doubted.map(|place| {
            let at = told(&self.base, place);
            match (is_missing, self.base.train.point.knobs[place] == 0.0) {
                (false, _) => format!(
                    "The patch is fitted best with {at}: that value may stand in for something that is missing."
                ),
                (true, false) => format!("The patch as it was is fitted best with {at}: what seems to be missing may be a value beyond it."),
                (true, true) => format!("The patch as it was is fitted best with {at}: what seems to be missing may be the sign that it is wired in with, if that is wrong."),
            }
        });
        let beside = self.last.newly_at_end(&self.base).filter(|_| self.verdict.has_names()).map(|place| {
            let at = told(&self.last, place);
            format!("Beside what is named the patch is fitted best with {at}: nature's law may be another.")
        });
        let named = self.effects.iter().filter(|_| self.verdict.has_names());
        let own = named.flat_map(|effect| self.own_at_ends(effect));
        let further = self.beyond.as_ref().filter(|own| !self.says(own)).map(Beyond::sentence);
        before.chain(further).chain(beside).chain(own).collect()
    }

    /// Which effects the data may have none of, as far as their intervals tell.
    fn uncertain(&self) -> impl Iterator<Item = String> + '_ {
        let named = self.effects.iter().filter(|_| self.verdict.has_names());
        // What is not told at all has a line of its own.
        let is_told = |effect: &&Candidate| {
            self.last.brought(effect).next().is_some_and(|(_, _, known)| known.error.is_finite())
        };
        named.filter(is_told).filter(|effect| may_be_none(effect, &self.last)).map(|effect| {
            format!(
                "{} may have no strength at all, by its interval: it is named for what the data are explained better with it.",
                effect.named()
            )
        })
    }

    /// What is left beside what is named, where that is more than noise and the verdict does not say so.
    fn more_is_left(&self) -> Option<String> {
        let is_told = !self.verdict.has_names() || self.leaves_much();
        let is_more = self.last.leaves_structure() && self.last.train.over_noise() > 1.0;
        if is_told || !is_more {
            return None;
        }
        // What is noise of the drives, or lies between their samples, is nothing that is missing.
        let of_drives = self.last.not_white.get().and_then(Option::as_ref).filter(|own| own.is_of_drives());
        if let Some(own) = of_drives {
            return Some(format!("Beside what is named {}.", own.sentence()));
        }
        let [train, test] = [&self.last.train, &self.last.test].map(|fitted| number(fitted.over_noise()));
        Some(format!(
            "What is left, {train} times the noise in training and {test} on the data held back, is no noise: something smaller is missing beside what is named, or its law is another."
        ))
    }

    /// Whether what lies beyond ranges stands in the verdict.
    fn says(&self, beyond: &Beyond) -> bool {
        match self.verdict {
            Verdict::Ambiguous => beyond.is_rival,
            Verdict::CannotJudge => beyond.leaves_noise(),
            _ => false,
        }
    }

    /// The same of what an effect brought; nature knows no less than 0 of a time or a friction.
    fn own_at_ends(&self, effect: &Candidate) -> Vec<String> {
        let Stage { version, train, .. } = &self.last;
        let at_end = self.last.at_end().filter(|place| train.point.knobs[*place] != 0.0);
        let names: Vec<&str> = at_end.map(|place| version.fit[place].as_str()).collect();
        let brought = effect.graft.parameters.iter().filter(|own| names.contains(&own.name.as_str()));
        let doubt = brought.map(|own| {
            format!(
                "The {} of {} is found at the end of its range: these data may ask for a value beyond it.",
                own.name, effect.effect
            )
        });
        doubt.collect()
    }

    /// Of which outputs the experiment tells more noise than there can be.
    fn noises(&self, experiment: &Experiment) -> Vec<String> {
        let told = experiment.outputs.iter().enumerate().filter(|(_, output)| output.sigma.is_some());
        let left = told.map(|(place, output)| (&output.signal, over_sigma(&self.told().train, place)));
        let far_less = left.filter(|(_, left)| *left < FAR_LESS);
        let doubt = far_less.map(|(signal, left)| {
            format!(
                "What is left of {signal} is {} times the noise that the experiment tells: with a \"sigma\" as small as the noise these data would show more.",
                number(left)
            )
        });
        doubt.collect()
    }

    /// Of which outputs more is left than noise, although it looks like that, or although it does not in training.
    fn louder(&self, experiment: &Experiment) -> Vec<String> {
        let stage = self.told();
        let is_settled = self.verdict.has_names() || self.verdict == Verdict::NothingMissing;
        if !is_settled || stage.leaves_structure() {
            return Vec::new();
        }
        let of = |(place, output): (usize, &Output)| {
            let [train, test] = [&stage.train, &stage.test].map(|fitted| over_sigma(fitted, place));
            let loud = (train > LOUD).then(|| {
                format!(
                    "What is left of {} is {} times its noise, although it looks like noise: there is more noise in these data than that, or something too fast for them.",
                    output.signal,
                    number(train)
                )
            });
            // Where nothing is missing the patch explains both, fitted to both.
            let why = match self.verdict {
                Verdict::NothingMissing => {
                    "fitted to both, the patch explains both: what training leaves open led it astray"
                }
                _ => {
                    "something has changed by then or shows there alone, or a law is another than it seems in training"
                }
            };
            let held = has_changed(stage, place).then(|| {
                format!(
                    "Of {} {} times its noise is left of the data held back, and {} in training: {why}.",
                    output.signal,
                    number(test),
                    number(train)
                )
            });
            loud.into_iter().chain(held)
        };
        experiment.outputs.iter().enumerate().flat_map(of).collect()
    }

    /// What a round came to, in words, which effects that stood beside it were dropped later, and why what it took has no name.
    pub fn round_told(&self, round: &Round) -> String {
        let is_kept = |own: &str| self.effects.iter().any(|effect| effect.named() == own);
        let dropped = round.beside.iter().filter(|own| !is_kept(own));
        let dropped: String = dropped.map(|own| format!(" Later {own} was dropped.")).collect();
        let is_nameless = round.taken && !self.verdict.has_names();
        let nameless =
            if is_nameless { " It is not named: what is left in the end is too much." } else { "" };
        round.sentence() + &dropped + nameless
    }

    /// What a fitted parameter belongs to: the effect that brought it and where that acts, or the patch.
    pub fn owner(&self, parameter: &str) -> String {
        let brings = |own: &&Candidate| own.graft.parameters.iter().any(|brought| brought.name == parameter);
        self.effects.iter().find(brings).map_or_else(|| "the patch".to_owned(), Candidate::named)
    }

    /// The report as a JSON document.
    pub fn document(&self, problem: &Problem) -> Value {
        let taken = self.effects.iter().zip(&self.rounds).filter(|_| self.verdict.has_names());
        let effects = taken.enumerate().flat_map(|(place, (own, round))| {
            let rival = round.rival().map(|trial| effect(place + 1, &trial.candidate, &trial.stage));
            [effect(place + 1, own, &self.last)].into_iter().chain(rival)
        });
        let rivals = self.rounds.iter().enumerate().flat_map(|(number, round)| {
            round.trials.iter().map(move |trial| rival(number + 1, round, trial))
        });
        let left_out = self
            .rounds
            .iter()
            .enumerate()
            .flat_map(|(number, round)| round.left_out.iter().map(move |own| left_out(number + 1, own)));
        json!({
            "verdict": self.verdict.as_str(),
            "sentence": self.sentence(),
            "effects": effects.collect::<Vec<_>>(),
            "rivals": rivals.collect::<Vec<_>>(),
            "left_out": left_out.collect::<Vec<_>>(),
            "nowhere": self.places.nowhere(),
            "gap": {
                "before": gaps(problem, &self.base),
                "after": gaps(problem, self.told()),
                "left": self.left,
            },
            "correlations": self.correlations.iter().map(Correlation::document).collect::<Vec<_>>(),
            "rounds": self.rounds.iter().enumerate().map(|(place, round)| round_document(place + 1, round)).collect::<Vec<_>>(),
            "why": self.blind.as_ref().map(Blind::sentence),
            "solver": {"steps": self.fineness.steps, "error": self.fineness.error, "wanted": self.fineness.wanted},
            "other_starts": self.agreement.document(),
            "parameters": parameters(self.told()),
            "separate": self.separating.as_ref().map(Separating::document),
            "way": self.way.iter().map(Change::document).collect::<Vec<_>>(),
            "limits": self.limits.iter().map(Limit::document).collect::<Vec<_>>(),
            "beyond": self.beyond.as_ref().map(Beyond::document),
            "where": self.whereabouts.iter().map(Whereabouts::document).collect::<Vec<_>>(),
        })
    }
}

/// What was asked for, and by which seed, as a JSON document.
pub fn asked(experiment: &Experiment, problem: &Problem, seed: u64) -> Value {
    let records = |records: &[Record]| -> Vec<Value> {
        let record = |own: &Record| {
            let to = own.begin + own.duration();
            json!({"data": own.name, "from": own.begin, "to": to, "samples": own.len(), "missing": own.missing()})
        };
        records.iter().map(record).collect()
    };
    let drives = experiment.drives.iter().zip(&problem.drive_sigma).map(|(feed, sigma)| {
        let (unit, is_told) = (feed.unit.text(), feed.sigma.is_some());
        let told = json!({
            "column": feed.column, "unit": unit, "hold": feed.hold.as_str(), "sigma": sigma, "sigma_told": is_told,
        });
        (feed.drive.clone(), told)
    });
    let outputs = experiment.outputs.iter().zip(&problem.sigma).map(|(output, sigma)| {
        let (unit, is_told) = (output.unit.text(), output.sigma.is_some());
        let told = json!({
            "column": output.column, "unit": unit, "sigma": sigma, "sigma_told": is_told, "offset": output.offset,
        });
        (output.signal.clone(), told)
    });
    json!({
        "file": experiment.file,
        "title": experiment.title,
        "patch": experiment.patch.file(),
        "drives": drives.collect::<Map<_, _>>(),
        "outputs": outputs.collect::<Map<_, _>>(),
        "fit": experiment.fit,
        "train": records(&experiment.train),
        "test": records(&experiment.test),
        "pieces": experiment.pieces,
        "seed": seed,
    })
}

impl Round {
    /// How many effects were tried, and in how many ways: places, forms, and what they read there.
    pub fn tried_told(&self) -> String {
        let effects: HashSet<&str> =
            self.trials.iter().map(|trial| trial.candidate.effect.as_str()).collect();
        let [effects, ways] =
            [(effects.len(), "effect"), (self.trials.len(), "way")].map(|(n, noun)| plural(n, noun));
        format!("{effects} tried in {ways}")
    }

    /// What it came to, in words.
    pub fn sentence(&self) -> String {
        let Some(best) = self.trials.first() else { return "nothing fits".to_owned() };
        let held = format!(
            "on the data held back it lowers the sum of squares by {} times that of the noise (95 %: {})",
            number(self.confirmed.sum),
            self.confirmed.interval().map(number).join(" ... ")
        );
        let beside = match self.beside.is_empty() {
            true => String::new(),
            false => format!("Beside {}, ", self.beside.join(" and ")),
        };
        let score = format!("{beside}{} is the best, with a score of {}", best.named(), number(best.score));
        match (self.taken, self.tied) {
            (true, 1) => format!("{score}; {held}. It is taken."),
            (true, 2) => {
                format!("{score}; {held}. It is taken, although the data cannot tell it from another.")
            }
            (true, tied) => format!(
                "{score}; {held}. It is taken, although the data cannot tell it from {} others.",
                tied - 1
            ),
            (false, _) if best.score <= self.needed => {
                format!(
                    "{score}, which is less than the {} that so many trials ask for. None is taken.",
                    number(self.needed)
                )
            }
            (false, _) if !self.closes_enough() => format!(
                "{score}; but it closes only {} % of what is left, and what it leaves is no noise. None is taken.",
                number(100.0 * self.closed())
            ),
            (false, _) => format!("{score}; but {held}, which is no evidence. None is taken."),
        }
    }
}

impl Trial {
    /// The effect and where it acts.
    pub fn named(&self) -> String {
        self.candidate.named()
    }
}

/// An effect as it stands in the patch of a stage; two of one step are those that the data cannot tell apart.
fn effect(step: usize, candidate: &Candidate, stage: &Stage) -> Value {
    let parameters = stage.brought(candidate);
    let parameters =
        parameters.map(|(own, value, error)| (own.of.clone(), measured(value, error, &own.unit)));
    json!({
        "step": step,
        "name": candidate.effect,
        "form": candidate.note,
        "junction": candidate.junction,
        "reads": candidate.reads,
        "parameters": parameters.collect::<Map<_, _>>(),
    })
}

fn measured(value: f64, known: Known, unit: &str) -> Value {
    json!({"value": value, "unit": unit, "interval": known.interval.map(|end| if end.is_finite() { json!(end) } else { Value::Null })})
}

fn parameters(stage: &Stage) -> Value {
    let fit = stage.version.fit.iter().enumerate().map(|(place, name)| {
        (name.clone(), measured(stage.train.point.knobs[place], stage.known(place), stage.unit(place)))
    });
    fit.collect::<Map<_, _>>().into()
}

/// What came of a round.
fn round_document(number: usize, round: &Round) -> Value {
    let Advantage { sum, error, .. } = round.confirmed;
    json!({
        "step": number,
        "tried": round.trials.len(),
        "best": round.trials.first().map(|best| &best.candidate.effect),
        "needed": round.needed,
        "taken": round.taken,
        "tied": round.tied,
        "closes": round.closed(),
        "confirmed": {"by": sum, "error": error, "interval": round.confirmed.interval()},
        "from_white": round.trials.first().map(|best| best.stage.colour),
        "beside": round.beside,
        "gap": {"before": round.before.train.over_noise(), "best": round.trials.first().map(|best| best.stage.train.over_noise())},
    })
}

fn rival(number: usize, round: &Round, trial: &Trial) -> Value {
    json!({
        "step": number,
        "name": trial.candidate.effect,
        "form": trial.candidate.note,
        "junction": trial.candidate.junction,
        "reads": trial.candidate.reads,
        "score": trial.score,
        "needed": round.needed,
        "gap": trial.stage.train.over_noise(),
        "held_out_gap": trial.stage.test.over_noise(),
        "behind": {"by": trial.behind.sum, "error": trial.behind.error},
        "tied": round.is_tied(trial),
        "gone_through": trial.stage.gone_through,
    })
}

fn left_out(number: usize, own: &LeftOut) -> Value {
    let mut document = own.document();
    document.insert("step".to_owned(), number.into());
    document.into()
}

fn gaps(problem: &Problem, stage: &Stage) -> Value {
    let told = |fitted: &Fitted| {
        let outputs =
            problem.outputs.iter().zip(&problem.sigma).enumerate().map(|(output, (name, sigma))| {
                let over = over_sigma(fitted, output);
                (name.clone(), json!({"rms": over * sigma, "over_sigma": over}))
            });
        Value::Object(outputs.collect::<Map<_, _>>())
    };
    json!({"train": told(&stage.train), "test": told(&stage.test), "from_white": stage.colour})
}
