//! What a search found, for readers and programs: a JSON document, and the patch with what was missing.

use serde_json::{Map, Value, json};

use crate::data::experiment::Experiment;
use crate::data::record::Record;
use crate::design::detectability::detection_limit::Limit;
use crate::design::discriminating_experiment::Separating;
use crate::effects::candidate::Candidate;
use crate::fit::estimate::{Fitted, over_sigma};
use crate::fit::extended_model::LeftOut;
use crate::fit::fitted_model::Stage;
use crate::fit::problem::Problem;
use crate::fit::uncertainty::Known;
use crate::localise::force::Whereabouts;
use crate::residuals::correlation::Correlation;
use crate::search::outcome::Outcome;
use crate::search::range_extension::Beyond;
use crate::search::round::{Round, Trial};
use crate::search::search_log::Change;
use crate::statistics::block_comparison::Advantage;

impl Outcome {
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
            "why": self.blind.as_ref().map(|own| own.sentence(self.beyond.as_ref())),
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
