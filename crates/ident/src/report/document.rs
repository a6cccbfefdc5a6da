//! What a search found, as a JSON document for programs.
//!
//! The document is a tree of structs whose members have the order of the JSON text. A value that is not finite becomes null.

use indexmap::IndexMap;
use serde::Serialize;

use crate::data::experiment::{Experiment, Feed, Output};
use crate::data::record::Record;
use crate::effects::candidate::Candidate;
use crate::fit::estimate::{Fitted, over_sigma};
use crate::fit::fitted_model::Stage;
use crate::fit::problem::Problem;
use crate::fit::uncertainty::Known;
use crate::report::detection_limits::DetectionLimitDocument;
use crate::report::discriminating_experiment::DiscriminatingExperimentDocument;
use crate::report::fit_quality::{StartsDocument, StepsDocument};
use crate::report::localisation::LocalisationDocument;
use crate::report::ranges::RangeExtensionDocument;
use crate::report::reasons::inconclusive_sentence;
use crate::report::rounds::SkippedTrialDocument;
use crate::report::search_log::SearchLogDocument;
use crate::report::sentence::verdict_sentence;
use crate::residuals::correlation::{Correlation, Lagged};
use crate::search::outcome::Outcome;
use crate::search::round::{Round, Trial};
use crate::statistics::block_comparison::Advantage;

/// Everything that a search found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SearchDocument {
    /// The word for the verdict: "named", "ambiguous", "nothing-missing", "unknown-effect" or "cannot-judge".
    pub verdict: &'static str,
    /// The verdict in a sentence.
    pub sentence: String,
    /// The effects that are named; of one step two if the data cannot distinguish them.
    pub effects: Vec<EffectDocument>,
    /// Every trial of every round.
    pub rivals: Vec<RivalDocument>,
    /// What was not tried.
    pub left_out: Vec<SkippedTrialDocument>,
    /// The effects for which the patch has no place.
    pub nowhere: Vec<String>,
    /// What the patch leaves without and with what is named.
    pub gap: GapDocument,
    /// What the residuals of the patch as it was correlate with.
    pub correlations: Vec<CorrelationDocument>,
    /// The rounds of the search.
    pub rounds: Vec<RoundDocument>,
    /// Why the data are inconclusive; null if they are not.
    pub why: Option<String>,
    /// The steps of the solver and their error.
    pub solver: StepsDocument,
    /// Fits of the patch as it was from other points.
    pub other_starts: StartsDocument,
    /// The fitted parameters, by name.
    pub parameters: IndexMap<String, EstimateDocument>,
    /// The experiment that distinguishes two effects; null if the verdict needs none or none was found.
    pub separate: Option<DiscriminatingExperimentDocument>,
    /// The log of the search.
    pub way: Vec<SearchLogDocument>,
    /// The weakest effects that the data would have shown.
    pub limits: Vec<DetectionLimitDocument>,
    /// The patch with wider ranges; null unless it stands at the ends of its ranges.
    pub beyond: Option<RangeExtensionDocument>,
    /// At which junctions, and when, something is missing; the most likely junction first.
    #[serde(rename = "where")]
    pub localisation: Vec<LocalisationDocument>,
}

impl SearchDocument {
    /// The document of an outcome.
    pub fn of(problem: &Problem, outcome: &Outcome) -> Self {
        let taken = outcome.effects.iter().zip(&outcome.rounds).filter(|_| outcome.verdict.has_names());
        let effects = taken.enumerate().flat_map(|(place, (own, round))| {
            let rival =
                round.rival().map(|trial| EffectDocument::of(place + 1, &trial.candidate, &trial.stage));
            [EffectDocument::of(place + 1, own, &outcome.last)].into_iter().chain(rival)
        });
        let rounds = || outcome.rounds.iter().enumerate().map(|(place, round)| (place + 1, round));
        let rivals = rounds().flat_map(|(number, round)| {
            round.trials.iter().map(move |trial| RivalDocument::of(number, round, trial))
        });
        let left_out = rounds().flat_map(|(number, round)| {
            round.left_out.iter().map(move |own| SkippedTrialDocument::of(own, Some(number)))
        });
        let why = outcome.blind.as_ref().map(|own| inconclusive_sentence(own, outcome.beyond.as_ref()));
        SearchDocument {
            verdict: outcome.verdict.as_str(),
            sentence: verdict_sentence(outcome),
            effects: effects.collect(),
            rivals: rivals.collect(),
            left_out: left_out.collect(),
            nowhere: outcome.places.nowhere().into_iter().map(str::to_owned).collect(),
            gap: GapDocument {
                before: ResidualDocument::of(problem, &outcome.base),
                after: ResidualDocument::of(problem, outcome.told()),
                left: outcome.left,
            },
            correlations: outcome.correlations.iter().map(CorrelationDocument::from).collect(),
            rounds: rounds().map(|(number, round)| RoundDocument::of(number, round)).collect(),
            why,
            solver: StepsDocument::from(&outcome.fineness),
            other_starts: StartsDocument::from(&outcome.agreement),
            parameters: parameters(outcome.told()),
            separate: outcome.separating.as_ref().map(DiscriminatingExperimentDocument::from),
            way: outcome.way.iter().map(SearchLogDocument::from).collect(),
            limits: outcome.limits.iter().map(DetectionLimitDocument::from).collect(),
            beyond: outcome.beyond.as_ref().map(RangeExtensionDocument::from),
            localisation: outcome.whereabouts.iter().map(LocalisationDocument::from).collect(),
        }
    }
}

/// The experiment that was searched, and the seed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExperimentDocument {
    /// The file, as the reader wrote it.
    pub file: String,
    /// Its title; empty if it has none.
    pub title: String,
    /// The file of the patch.
    pub patch: String,
    /// The drives that the data feed, by name.
    pub drives: IndexMap<String, DriveDocument>,
    /// The measured signals, by name.
    pub outputs: IndexMap<String, OutputDocument>,
    /// The parameters that are fitted.
    pub fit: Vec<String>,
    /// The records that are fitted to.
    pub train: Vec<RecordDocument>,
    /// The records that are held back.
    pub test: Vec<RecordDocument>,
    /// The length of the pieces into which the experiment asks to cut its records, in seconds; null if it does not ask.
    pub pieces: Option<f64>,
    /// The seed of all random numbers.
    pub seed: u64,
}

impl ExperimentDocument {
    /// The document of an experiment that is searched with a seed.
    pub fn of(experiment: &Experiment, problem: &Problem, seed: u64) -> Self {
        let drives = experiment.drives.iter().zip(&problem.drive_sigma);
        let outputs = experiment.outputs.iter().zip(&problem.sigma);
        ExperimentDocument {
            file: experiment.file.clone(),
            title: experiment.title.clone(),
            patch: experiment.patch.file().to_owned(),
            drives: drives
                .map(|(feed, sigma)| (feed.drive.clone(), DriveDocument::of(feed, *sigma)))
                .collect(),
            outputs: outputs
                .map(|(output, sigma)| (output.signal.clone(), OutputDocument::of(output, *sigma)))
                .collect(),
            fit: experiment.fit.clone(),
            train: experiment.train.iter().map(RecordDocument::from).collect(),
            test: experiment.test.iter().map(RecordDocument::from).collect(),
            pieces: experiment.pieces,
            seed,
        }
    }
}

/// A drive that data feed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DriveDocument {
    /// The column that feeds it.
    pub column: String,
    /// Its unit.
    pub unit: String,
    /// What it does between samples: "linear", "previous" or "smooth".
    pub hold: &'static str,
    /// Standard deviation of its noise, in its unit.
    pub sigma: f64,
    /// Whether the experiment specifies `sigma`; if not, it is estimated.
    #[serde(rename = "sigma_told")]
    pub is_sigma_specified: bool,
}

impl DriveDocument {
    fn of(feed: &Feed, sigma: f64) -> Self {
        DriveDocument {
            column: feed.column.clone(),
            unit: feed.unit.text().to_owned(),
            hold: feed.hold.as_str(),
            sigma,
            is_sigma_specified: feed.sigma.is_some(),
        }
    }
}

/// A measured signal.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutputDocument {
    /// The column that measures it.
    pub column: String,
    /// Its unit.
    pub unit: String,
    /// Standard deviation of its noise, in its unit.
    pub sigma: f64,
    /// Whether the experiment specifies `sigma`; if not, it is estimated.
    #[serde(rename = "sigma_told")]
    pub is_sigma_specified: bool,
    /// Whether the column may be off by a constant.
    pub offset: bool,
}

impl OutputDocument {
    fn of(output: &Output, sigma: f64) -> Self {
        OutputDocument {
            column: output.column.clone(),
            unit: output.unit.text().to_owned(),
            sigma,
            is_sigma_specified: output.sigma.is_some(),
            offset: output.offset,
        }
    }
}

/// A record.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordDocument {
    /// Its file.
    pub data: String,
    /// When it begins, in seconds by its clock.
    pub from: f64,
    /// When it ends.
    pub to: f64,
    /// How many samples it has.
    pub samples: usize,
    /// How many values are missing.
    pub missing: usize,
}

impl From<&Record> for RecordDocument {
    fn from(record: &Record) -> Self {
        RecordDocument {
            data: record.name.clone(),
            from: record.begin,
            to: record.begin + record.duration(),
            samples: record.len(),
            missing: record.missing(),
        }
    }
}

/// An effect as it is in the patch of a fitted model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectDocument {
    /// The round that took it, counted from 1; two effects of one round are those that the data cannot distinguish.
    pub step: usize,
    /// Its name.
    pub name: String,
    /// Which of its forms it has, in words; empty if there is only one.
    pub form: String,
    /// The element that it acts on.
    pub junction: String,
    /// The signals that it reads, if there is a choice.
    pub reads: Vec<String>,
    /// Its parameters, by their names in the library.
    pub parameters: IndexMap<String, EstimateDocument>,
}

impl EffectDocument {
    fn of(step: usize, candidate: &Candidate, stage: &Stage) -> Self {
        let parameters = stage
            .brought(candidate)
            .map(|(own, value, known)| (own.of.clone(), EstimateDocument::of(value, known, &own.unit)));
        EffectDocument {
            step,
            name: candidate.effect.clone(),
            form: candidate.note.clone(),
            junction: candidate.junction.clone(),
            reads: candidate.reads.clone(),
            parameters: parameters.collect(),
        }
    }
}

/// A fitted parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EstimateDocument {
    /// Its value.
    pub value: f64,
    /// Its unit.
    pub unit: String,
    /// Its 95 % interval; an end is null if the data do not limit it.
    pub interval: [f64; 2],
}

impl EstimateDocument {
    fn of(value: f64, known: Known, unit: &str) -> Self {
        EstimateDocument { value, unit: unit.to_owned(), interval: known.interval }
    }
}

fn parameters(stage: &Stage) -> IndexMap<String, EstimateDocument> {
    let fit = stage.version.fit.iter().enumerate().map(|(place, name)| {
        let value = stage.train.point.knobs[place];
        (name.clone(), EstimateDocument::of(value, stage.known(place), stage.unit(place)))
    });
    fit.collect()
}

/// A round of the search.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RoundDocument {
    /// Its number, counted from 1.
    pub step: usize,
    /// How many trials were made.
    pub tried: usize,
    /// The effect of the best trial; null if there is none.
    pub best: Option<String>,
    /// The score that the best trial needs.
    pub needed: f64,
    /// Whether the best trial was taken.
    pub taken: bool,
    /// How many trials the data cannot distinguish, the best among them.
    pub tied: usize,
    /// The share of the gap that the best trial closes, in squares.
    pub closes: f64,
    /// By how much the best trial lowers the sum of squares of the data held back.
    pub confirmed: ConfirmationDocument,
    /// How far the residual of the best trial is from white, in standard deviations.
    pub from_white: Option<f64>,
    /// The effects that were in the patch already.
    pub beside: Vec<String>,
    /// What the patch leaves without and with the best trial.
    pub gap: RoundGapDocument,
}

impl RoundDocument {
    fn of(number: usize, round: &Round) -> Self {
        let Advantage { sum, error, .. } = round.confirmed;
        let best = round.trials.first();
        RoundDocument {
            step: number,
            tried: round.trials.len(),
            best: best.map(|best| best.candidate.effect.clone()),
            needed: round.needed,
            taken: round.taken,
            tied: round.tied,
            closes: round.closed(),
            confirmed: ConfirmationDocument { by: sum, error, interval: round.confirmed.interval() },
            from_white: best.map(|best| best.stage.colour),
            beside: round.beside.clone(),
            gap: RoundGapDocument {
                before: round.before.train.over_noise(),
                best: best.map(|best| best.stage.train.over_noise()),
            },
        }
    }
}

/// By how much a trial lowers the sum of squares of the data held back, over that of the noise.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConfirmationDocument {
    /// The difference.
    pub by: f64,
    /// Its standard error.
    pub error: f64,
    /// Its 95 % interval.
    pub interval: [f64; 2],
}

/// What the patch leaves in training without and with the best trial of a round, rms over the noise.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RoundGapDocument {
    /// Without it.
    pub before: f64,
    /// With it; null if there is no trial.
    pub best: Option<f64>,
}

/// A trial of a round.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RivalDocument {
    /// The round, counted from 1.
    pub step: usize,
    /// The effect.
    pub name: String,
    /// Which of its forms it has, in words; empty if there is only one.
    pub form: String,
    /// The element that it acts on.
    pub junction: String,
    /// The signals that it reads, if there is a choice.
    pub reads: Vec<String>,
    /// By how much the patch with it is better than without it, as a difference of BIC.
    pub score: f64,
    /// The score that the best trial of the round needs.
    pub needed: f64,
    /// What the patch with it leaves in training, rms over the noise.
    pub gap: f64,
    /// The same on the data held back.
    pub held_out_gap: f64,
    /// By how much the best trial leaves less.
    pub behind: BehindDocument,
    /// Whether the data cannot distinguish it from the best trial.
    pub tied: bool,
    /// Whether it was fitted completely, or only quickly.
    pub gone_through: bool,
}

impl RivalDocument {
    fn of(number: usize, round: &Round, trial: &Trial) -> Self {
        RivalDocument {
            step: number,
            name: trial.candidate.effect.clone(),
            form: trial.candidate.note.clone(),
            junction: trial.candidate.junction.clone(),
            reads: trial.candidate.reads.clone(),
            score: trial.score,
            needed: round.needed,
            gap: trial.stage.train.over_noise(),
            held_out_gap: trial.stage.test.over_noise(),
            behind: BehindDocument { by: trial.behind.sum, error: trial.behind.error },
            tied: round.is_tied(trial),
            gone_through: trial.stage.gone_through,
        }
    }
}

/// By how much the best trial of a round leaves less than another, in sums of squares.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BehindDocument {
    /// The difference.
    pub by: f64,
    /// Its standard error.
    pub error: f64,
}

/// What the patch leaves without and with what is named.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GapDocument {
    /// Without it.
    pub before: ResidualDocument,
    /// With it.
    pub after: ResidualDocument,
    /// The share of the gap that is left, in rms.
    pub left: f64,
}

/// What a fitted model leaves of every output.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResidualDocument {
    /// In training, by output.
    pub train: IndexMap<String, OutputResidualDocument>,
    /// On the data held back, by output.
    pub test: IndexMap<String, OutputResidualDocument>,
    /// How far the residual in training is from white, in standard deviations.
    pub from_white: f64,
}

impl ResidualDocument {
    fn of(problem: &Problem, stage: &Stage) -> Self {
        let each = |fitted: &Fitted| -> IndexMap<String, OutputResidualDocument> {
            let outputs = problem.outputs.iter().zip(&problem.sigma).enumerate();
            let left = outputs.map(|(output, (name, sigma))| {
                let over = over_sigma(fitted, output);
                (name.clone(), OutputResidualDocument { rms: over * sigma, over_sigma: over })
            });
            left.collect()
        };
        ResidualDocument { train: each(&stage.train), test: each(&stage.test), from_white: stage.colour }
    }
}

/// What a fitted model leaves of an output.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutputResidualDocument {
    /// The rms, in the unit of the output.
    pub rms: f64,
    /// The same over the noise.
    pub over_sigma: f64,
}

/// How a residual correlates with a signal or drive.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CorrelationDocument {
    /// The output whose residual it is.
    pub output: String,
    /// The signal or drive.
    pub with: String,
    /// The strongest correlation with the signal itself.
    pub itself: LaggedDocument,
    /// The strongest correlation with the size of the signal.
    pub size: LaggedDocument,
    /// What chance brings at most in 95 of 100 cases, at whichever lag.
    pub chance: f64,
}

impl From<&Correlation> for CorrelationDocument {
    fn from(found: &Correlation) -> Self {
        CorrelationDocument {
            output: found.output.clone(),
            with: found.with.clone(),
            itself: LaggedDocument::from(found.own),
            size: LaggedDocument::from(found.size),
            chance: found.chance,
        }
    }
}

/// A correlation with what was some time before.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LaggedDocument {
    /// The correlation, -1 ... 1.
    pub correlation: f64,
    /// The time, in seconds.
    pub lag: f64,
}

impl From<Lagged> for LaggedDocument {
    fn from(own: Lagged) -> Self {
        LaggedDocument { correlation: own.value, lag: own.lag }
    }
}
