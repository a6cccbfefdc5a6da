//! The result of a search as a JSON document for programs.
//!
//! The document is a tree of structs. Their fields are the keys of the JSON text, in the same order. A number that is
//! not finite becomes null. Residuals are rms values over the noise if nothing else is said.
//!
//! The top level is a [`SearchDocument`]. The command line adds the keys `experiment`, an [`ExperimentDocument`], and
//! `doubts`, a list of sentences. `sentence` and `why` are for readers; programs decide by `verdict`.

use indexmap::IndexMap;
use serde::Serialize;

use crate::data::experiment::{Experiment, MeasuredDrive, MeasuredOutput};
use crate::data::record::Record;
use crate::effects::candidate::Candidate;
use crate::fit::estimate::{FitResult, normalised_output_rms};
use crate::fit::fitted_model::FittedModel;
use crate::fit::problem::Problem;
use crate::fit::uncertainty::Uncertainty;
use crate::report::detection_limits::DetectionLimitDocument;
use crate::report::discriminating_experiment::DiscriminatingExperimentDocument;
use crate::report::fit_quality::{StartsDocument, StepsDocument};
use crate::report::localisation::LocalisationDocument;
use crate::report::ranges::RangeExtensionDocument;
use crate::report::reasons::inconclusive_sentence;
use crate::report::rounds::SkippedTrialDocument;
use crate::report::search_log::SearchLogDocument;
use crate::report::sentence::verdict_sentence;
use crate::residuals::correlation::{Correlation, LaggedCorrelation};
use crate::search::outcome::Outcome;
use crate::search::round::{Round, Trial};
use crate::statistics::block_comparison::Advantage;

/// The complete result of a search.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SearchDocument {
    /// The verdict: "named", "ambiguous", "nothing-missing", "unknown-effect" or "cannot-judge".
    pub verdict: &'static str,
    /// The verdict as a sentence.
    pub sentence: String,
    /// The named effects. A step has two if the data cannot distinguish them.
    pub effects: Vec<EffectDocument>,
    /// Every trial of every round.
    pub rivals: Vec<RivalDocument>,
    /// Effects that could not be tried at a place.
    pub left_out: Vec<SkippedTrialDocument>,
    /// The effects for which the patch has no place.
    pub nowhere: Vec<String>,
    /// The residuals of the patch without and with the named effects.
    pub gap: GapDocument,
    /// The correlations of the residuals of the original patch with drives and signals.
    pub correlations: Vec<CorrelationDocument>,
    /// The rounds of the search.
    pub rounds: Vec<RoundDocument>,
    /// Why the data are inconclusive; null if they are not.
    pub why: Option<String>,
    /// The steps of the solver and their error.
    pub solver: StepsDocument,
    /// Fits of the original patch from other starts.
    pub other_starts: StartsDocument,
    /// The fitted parameters, by name.
    pub parameters: IndexMap<String, EstimateDocument>,
    /// The experiment that distinguishes two effects; null if the verdict needs none or none was found.
    pub separate: Option<DiscriminatingExperimentDocument>,
    /// The log of the search.
    pub way: Vec<SearchLogDocument>,
    /// The smallest detectable effects.
    pub limits: Vec<DetectionLimitDocument>,
    /// The fit with wider ranges; null unless the original fit is at the end of a range.
    pub beyond: Option<RangeExtensionDocument>,
    /// The missing force at every junction, the most likely junction first.
    #[serde(rename = "where")]
    pub localisation: Vec<LocalisationDocument>,
}

impl SearchDocument {
    /// The document of an outcome.
    ///
    /// Effects, trials and skipped trials are listed round by round. `effects` is empty unless the verdict names
    /// effects. A round with a rival gives two entries with the same `step`.
    pub fn of(problem: &Problem, outcome: &Outcome) -> Self {
        let taken = outcome.effects.iter().zip(&outcome.rounds).filter(|_| outcome.verdict.has_names());
        let effects = taken.enumerate().flat_map(|(index, (effect, round))| {
            let rival =
                round.rival().map(|trial| EffectDocument::of(index + 1, &trial.candidate, &trial.model));
            [EffectDocument::of(index + 1, effect, &outcome.final_model)].into_iter().chain(rival)
        });
        let rounds = || outcome.rounds.iter().enumerate().map(|(index, round)| (index + 1, round));
        let rivals = rounds().flat_map(|(number, round)| {
            round.trials.iter().map(move |trial| RivalDocument::of(number, round, trial))
        });
        let left_out = rounds().flat_map(|(number, round)| {
            round.skipped.iter().map(move |skipped| SkippedTrialDocument::of(skipped, Some(number)))
        });
        let extension = outcome.range_extension.as_ref();
        let why = outcome.inconclusive.as_ref().map(|reason| inconclusive_sentence(reason, extension));
        SearchDocument {
            verdict: outcome.verdict.as_str(),
            sentence: verdict_sentence(outcome),
            effects: effects.collect(),
            rivals: rivals.collect(),
            left_out: left_out.collect(),
            nowhere: outcome.places.inapplicable_effects().into_iter().map(str::to_owned).collect(),
            gap: GapDocument {
                before: ResidualDocument::of(problem, &outcome.base),
                after: ResidualDocument::of(problem, outcome.reported_model()),
                left: outcome.remaining_fraction,
            },
            correlations: outcome.correlations.iter().map(CorrelationDocument::from).collect(),
            rounds: rounds().map(|(number, round)| RoundDocument::of(number, round)).collect(),
            why,
            solver: StepsDocument::from(&outcome.step_refinement),
            other_starts: StartsDocument::from(&outcome.agreement),
            parameters: parameters(outcome.reported_model()),
            separate: outcome.discriminating_experiment.as_ref().map(DiscriminatingExperimentDocument::from),
            way: outcome.search_log.iter().map(SearchLogDocument::from).collect(),
            limits: outcome.detection_limits.iter().map(DetectionLimitDocument::from).collect(),
            beyond: extension.map(RangeExtensionDocument::from),
            localisation: outcome.localisations.iter().map(LocalisationDocument::from).collect(),
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
    /// The validation records.
    pub test: Vec<RecordDocument>,
    /// The length of the pieces into which the experiment divides its records, in seconds; null if it does not.
    pub pieces: Option<f64>,
    /// The seed of all random numbers.
    pub seed: u64,
}

impl ExperimentDocument {
    /// The document of an experiment that is searched with a seed.
    ///
    /// Noise is that of the problem, which is specified or estimated. `seed` is that of the command line.
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
            pieces: experiment.piece_duration,
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
    /// The interpolation between samples: "linear", "previous" or "smooth".
    pub hold: &'static str,
    /// Standard deviation of its noise, in its unit.
    pub sigma: f64,
    /// Whether the experiment specifies `sigma`; if not, it is estimated.
    #[serde(rename = "sigma_told")]
    pub is_sigma_specified: bool,
}

impl DriveDocument {
    /// Makes the document of a drive with the standard deviation of its noise, which is 0 for a drive without noise.
    fn of(feed: &MeasuredDrive, sigma: f64) -> Self {
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
    /// Whether the column may have a constant offset.
    pub offset: bool,
}

impl OutputDocument {
    /// Makes the document of an output with the standard deviation of its noise.
    fn of(output: &MeasuredOutput, sigma: f64) -> Self {
        OutputDocument {
            column: output.column.clone(),
            unit: output.unit.text().to_owned(),
            sigma,
            is_sigma_specified: output.sigma.is_some(),
            offset: output.has_offset,
        }
    }
}

/// A record.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordDocument {
    /// Its file.
    pub data: String,
    /// Time of the first sample by its clock, in seconds.
    pub from: f64,
    /// Time of the last sample, in seconds.
    pub to: f64,
    /// Number of samples.
    pub samples: usize,
    /// Number of missing values.
    pub missing: usize,
}

impl From<&Record> for RecordDocument {
    /// Times are those of the clock of the file, so `from` need not be 0.
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

/// An effect in the patch of a fitted model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectDocument {
    /// The round that took it, counted from 1. The data cannot distinguish two effects of the same round.
    pub step: usize,
    /// Its name.
    pub name: String,
    /// The form of the effect, as text; empty if there is only one.
    pub form: String,
    /// The element that it acts on.
    pub junction: String,
    /// The signals that it reads, if there is a choice.
    pub reads: Vec<String>,
    /// Its parameters, by their names in the library.
    pub parameters: IndexMap<String, EstimateDocument>,
}

impl EffectDocument {
    /// Takes the parameters of the candidate from the model, which may contain further effects. `step` counts from 1.
    fn of(step: usize, candidate: &Candidate, model: &FittedModel) -> Self {
        let parameters = model.effect_parameters(candidate).map(|(parameter, value, known)| {
            (parameter.name_in_effect.clone(), EstimateDocument::of(value, known, &parameter.unit))
        });
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
    /// Copies the ends of the interval. An infinite end becomes null in the text.
    fn of(value: f64, known: Uncertainty, unit: &str) -> Self {
        EstimateDocument { value, unit: unit.to_owned(), interval: known.interval }
    }
}

/// The fitted parameters of a model, by name.
fn parameters(model: &FittedModel) -> IndexMap<String, EstimateDocument> {
    let parameters = model.variant.fit.iter().enumerate().map(|(index, name)| {
        let value = model.train.estimate.parameters[index];
        (name.clone(), EstimateDocument::of(value, model.uncertainty(index), model.unit(index)))
    });
    parameters.collect()
}

/// A round of the search.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RoundDocument {
    /// Its number, counted from 1.
    pub step: usize,
    /// Number of trials.
    pub tried: usize,
    /// The effect of the best trial; null if there is none.
    pub best: Option<String>,
    /// The score that the best trial needs, as a decrease of BIC.
    pub needed: f64,
    /// Whether the best trial was taken.
    pub taken: bool,
    /// Number of trials that the data cannot distinguish from the best, which is counted too.
    pub tied: usize,
    /// The fraction of the gap that the best trial explains, in squares.
    pub closes: f64,
    /// By how much the best trial lowers the chi-squared of the validation data.
    pub confirmed: ConfirmationDocument,
    /// Distance of the best trial's residual from white noise, in standard deviations.
    pub from_white: Option<f64>,
    /// The effects that were in the patch already.
    pub beside: Vec<String>,
    /// The residual of the patch without and with the best trial.
    pub gap: RoundGapDocument,
}

impl RoundDocument {
    /// A round without trials has null as `best` and `from_white`. `confirmed` is a comparison on the validation data
    /// only.
    fn of(number: usize, round: &Round) -> Self {
        let Advantage { sum, standard_error, .. } = round.validation_advantage;
        let best = round.trials.first();
        RoundDocument {
            step: number,
            tried: round.trials.len(),
            best: best.map(|best| best.candidate.effect.clone()),
            needed: round.required_delta_bic,
            taken: round.taken,
            tied: round.tied,
            closes: round.explained_fraction(),
            confirmed: ConfirmationDocument {
                by: sum,
                error: standard_error,
                interval: round.validation_advantage.confidence_interval(),
            },
            from_white: best.map(|best| best.model.ljung_box_z),
            beside: round.other_effects.clone(),
            gap: RoundGapDocument {
                before: round.before.train.normalised_rms(),
                best: best.map(|best| best.model.train.normalised_rms()),
            },
        }
    }
}

/// By how much a trial lowers the chi-squared of the validation data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConfirmationDocument {
    /// The difference.
    pub by: f64,
    /// Its standard error.
    pub error: f64,
    /// Its 95 % interval.
    pub interval: [f64; 2],
}

/// The residual in the training data without and with the best trial of a round, rms over the noise.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RoundGapDocument {
    /// Without it.
    pub before: f64,
    /// With it; null if there is no trial.
    pub best: Option<f64>,
}

/// A trial of a round.
///
/// A trial is one effect in one form at one place, with one choice of the signals that it reads.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RivalDocument {
    /// The round, counted from 1.
    pub step: usize,
    /// The effect.
    pub name: String,
    /// The form of the effect, as text; empty if there is only one.
    pub form: String,
    /// The element that it acts on.
    pub junction: String,
    /// The signals that it reads, if there is a choice.
    pub reads: Vec<String>,
    /// The score: the decrease of BIC by the effect.
    pub score: f64,
    /// The score that the best trial of the round needs.
    pub needed: f64,
    /// The residual in the training data, rms over the noise.
    pub gap: f64,
    /// The residual in the validation data, rms over the noise.
    pub held_out_gap: f64,
    /// By how much the best trial has a smaller chi-squared.
    pub behind: BehindDocument,
    /// Whether the data cannot distinguish it from the best trial.
    pub tied: bool,
    /// Whether it was fitted completely, or only quickly.
    pub gone_through: bool,
}

impl RivalDocument {
    /// `behind` compares the residuals of the trial with those of the best trial of the round, sample by sample.
    fn of(number: usize, round: &Round, trial: &Trial) -> Self {
        RivalDocument {
            step: number,
            name: trial.candidate.effect.clone(),
            form: trial.candidate.note.clone(),
            junction: trial.candidate.junction.clone(),
            reads: trial.candidate.reads.clone(),
            score: trial.delta_bic,
            needed: round.required_delta_bic,
            gap: trial.model.train.normalised_rms(),
            held_out_gap: trial.model.test.normalised_rms(),
            behind: BehindDocument {
                by: trial.best_advantage.sum,
                error: trial.best_advantage.standard_error,
            },
            tied: round.is_tied(trial),
            gone_through: trial.model.is_thorough,
        }
    }
}

/// By how much the best trial of a round has a smaller chi-squared than another, in the compared records.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BehindDocument {
    /// The difference.
    pub by: f64,
    /// Its standard error.
    pub error: f64,
}

/// The residuals of the patch without and with the named effects.
///
/// `left` is the excess rms after by that before: 0 if the effects explain everything, 1 if they explain nothing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GapDocument {
    /// Without it.
    pub before: ResidualDocument,
    /// With it.
    pub after: ResidualDocument,
    /// The remaining fraction of the gap, in rms.
    pub left: f64,
}

/// The residual of a fitted model by output.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResidualDocument {
    /// In training, by output.
    pub train: IndexMap<String, OutputResidualDocument>,
    /// In the validation data, by output.
    pub test: IndexMap<String, OutputResidualDocument>,
    /// Distance of the residual in training from white noise, in standard deviations.
    pub from_white: f64,
}

impl ResidualDocument {
    /// Outputs keep the order of the problem. `rms` is the normalised rms times the noise of the output.
    fn of(problem: &Problem, model: &FittedModel) -> Self {
        let by_output = |fitted: &FitResult| -> IndexMap<String, OutputResidualDocument> {
            let outputs = problem.outputs.iter().zip(&problem.sigma).enumerate();
            let residuals = outputs.map(|(output, (name, sigma))| {
                let over = normalised_output_rms(fitted, output);
                (name.clone(), OutputResidualDocument { rms: over * sigma, over_sigma: over })
            });
            residuals.collect()
        };
        let (train, test) = (by_output(&model.train), by_output(&model.test));
        ResidualDocument { train, test, from_white: model.ljung_box_z }
    }
}

/// The residual of an output.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutputResidualDocument {
    /// The rms, in the unit of the output.
    pub rms: f64,
    /// The same over the noise.
    pub over_sigma: f64,
}

/// The correlation of a residual with a signal or drive.
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
    /// The correlation that chance exceeds in 5 of 100 cases, over all lags.
    pub chance: f64,
}

impl From<&Correlation> for CorrelationDocument {
    /// `itself` uses the signal with its sign, `size` its magnitude. A residual that depends on the magnitude of a
    /// velocity appears only in the second.
    fn from(correlation: &Correlation) -> Self {
        CorrelationDocument {
            output: correlation.output.clone(),
            with: correlation.quantity.clone(),
            itself: LaggedDocument::from(correlation.signed),
            size: LaggedDocument::from(correlation.magnitude),
            chance: correlation.chance_limit,
        }
    }
}

/// A correlation with a signal at an earlier time.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LaggedDocument {
    /// The correlation, -1 ... 1.
    pub correlation: f64,
    /// The time difference in seconds, not negative.
    pub lag: f64,
}

impl From<LaggedCorrelation> for LaggedDocument {
    /// The residual follows the signal by `lag`.
    fn from(lagged: LaggedCorrelation) -> Self {
        LaggedDocument { correlation: lagged.value, lag: lagged.lag }
    }
}
