//! The result of a search as a JSON document for programs.
//!
//! The document is a tree of structs. Their fields are the keys of the JSON text, in the same order. A number that is
//! not finite becomes null. Residuals are rms values over the noise if nothing else is said.
//!
//! The top level is a [`SearchDocument`]. `sentence`, `why` and `doubts` are for readers; programs decide by `verdict`.
//! The command line adds the patches, or the paths of their files.

use indexmap::IndexMap;
use serde::Serialize;

use crate::data::experiment::Experiment;
use crate::effects::candidate::Candidate;
use crate::fit::estimate::{FitResult, normalised_output_rms};
use crate::fit::fitted_model::FittedModel;
use crate::fit::problem::Problem;
use crate::fit::uncertainty::Uncertainty;
use crate::report::detection_limits::DetectionLimitDocument;
use crate::report::discriminating_experiment::DiscriminatingExperimentDocument;
use crate::report::doubts::doubts;
use crate::report::experiment_summary::ExperimentSummary;
use crate::report::fit_quality::{StartsDocument, StepsDocument};
use crate::report::localisation::LocalisationDocument;
use crate::report::ranges::RangeExtensionDocument;
use crate::report::reasons::inconclusive_sentence;
use crate::report::rounds::{RivalDocument, RoundDocument, SkippedTrialDocument};
use crate::report::search_log::SearchLogDocument;
use crate::report::sentence::verdict_sentence;
use crate::residuals::correlation::{Correlation, LaggedCorrelation};
use crate::search::outcome::Outcome;

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
    /// Effects that could not be tried at a site.
    pub left_out: Vec<SkippedTrialDocument>,
    /// The effects for which the patch has no site.
    pub nowhere: Vec<String>,
    /// The residuals of the patch without and with the named effects.
    pub gap: ExcessResidualSummary,
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
    /// Doubts about the result, a sentence each.
    pub doubts: Vec<String>,
    /// The experiment that was searched, and the seed.
    pub experiment: ExperimentSummary,
}

impl SearchDocument {
    /// The document of the outcome of a search. `experiment` and `problem` are those of the search.
    ///
    /// Effects, trials and skipped trials are listed round by round. `effects` is empty unless the verdict names
    /// effects. A round with a rival gives two entries with the same `step`.
    pub fn of(experiment: &Experiment, problem: &Problem, outcome: &Outcome) -> Self {
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
            nowhere: outcome.effect_sites.inapplicable_effects().into_iter().map(str::to_owned).collect(),
            gap: ExcessResidualSummary {
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
            doubts: doubts(outcome, experiment),
            experiment: ExperimentSummary::of(experiment, problem, outcome.seed),
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
        let parameters = model.effect_parameters(candidate).map(|(parameter, value, uncertainty)| {
            (parameter.name_in_effect.clone(), EstimateDocument::of(value, uncertainty, &parameter.unit))
        });
        EffectDocument {
            step,
            name: candidate.effect.clone(),
            form: candidate.note.clone(),
            junction: candidate.site.clone(),
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
    fn of(value: f64, uncertainty: Uncertainty, unit: &str) -> Self {
        EstimateDocument { value, unit: unit.to_owned(), interval: uncertainty.interval }
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

/// The residuals of the patch without and with the named effects.
///
/// `left` is the excess rms after by that before: 0 if the effects explain everything, 1 if they explain nothing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExcessResidualSummary {
    /// Without the named effects.
    pub before: ResidualDocument,
    /// With the named effects.
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
    #[serde(rename = "test")]
    pub validation: IndexMap<String, OutputResidualDocument>,
    /// Distance of the residual in training from white noise, in standard deviations.
    pub from_white: f64,
}

impl ResidualDocument {
    /// Outputs keep the order of the problem. `rms` is the normalised rms times the noise of the output.
    fn of(problem: &Problem, model: &FittedModel) -> Self {
        let by_output = |fitted: &FitResult| -> IndexMap<String, OutputResidualDocument> {
            let outputs = problem.outputs.iter().zip(&problem.sigma).enumerate();
            let residuals = outputs.map(|(output, (name, sigma))| {
                let over_sigma = normalised_output_rms(fitted, output);
                (name.clone(), OutputResidualDocument { rms: over_sigma * sigma, over_sigma })
            });
            residuals.collect()
        };
        let (train, validation) = (by_output(&model.train), by_output(&model.validation));
        ResidualDocument { train, validation, from_white: model.ljung_box_z }
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
