//! The outcome of a search.
//!
//! It has everything that reports need. Reports only select and format it.

use crate::design::detectability::detection_limit::DetectionLimit;
use crate::design::discriminating_experiment::DiscriminatingExperiment;
use crate::effects::candidate::Candidate;
use crate::effects::effect_sites::EffectSites;
use crate::fit::fitted_model::FittedModel;
use crate::fit::overload::RecordOverload;
use crate::fit::starts::StartAgreement;
use crate::fit::step_size::StepRefinement;
use crate::localise::localisation::Localisation;
use crate::residuals::correlation::Correlation;
use crate::search::inconclusive::Inconclusive;
use crate::search::range_extension::RangeExtension;
use crate::search::round::Round;
use crate::search::search_log::LogEntry;
use crate::search::verdict::Verdict;

/// Fraction of the excess rms above which named effects may explain only part of an unknown effect.
const SUBSTANTIAL_FRACTION: f64 = 0.1;

/// The outcome of a search.
///
/// # Examples
///
/// A search takes some seconds, so this example is only compiled:
///
/// ```no_run
/// use patchcord_ident::{Experiment, Library, Problem, SearchSettings, search};
///
/// let experiment = Experiment::read("../../examples/05_missing_effect/spring.experiment.json")?;
/// let (problem, library) = (Problem::of(&experiment)?, Library::shipped());
/// let outcome = search(&experiment, &problem, &SearchSettings::new(&library), |_| ())?;
/// let outcome = outcome.ok_or("the patch cannot be run from any start")?;
///
/// assert_eq!(outcome.verdict.as_str(), "named");
/// assert_eq!(outcome.effects[0].effect, "viscous-friction");
/// let model = outcome.reported_model();
/// assert!(model.train.normalised_rms() < outcome.base.train.normalised_rms());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Outcome {
    /// The verdict.
    pub verdict: Verdict,
    /// Whether the residual of `base` is below the declared noise. No effect was tried then, and the verdict is that
    /// nothing is missing.
    pub agrees_within_noise: bool,
    /// The seed of the search.
    pub seed: u64,
    /// The patch as it was, fitted.
    pub base: FittedModel,
    /// Whether fits of the patch from other starts reproduce its fit.
    pub agreement: StartAgreement,
    /// The rounds. The last one may have added no effect.
    pub rounds: Vec<Round>,
    /// The effects that were added. Entry i was added by round i.
    pub effects: Vec<Candidate>,
    /// The first overload in a record, of the reported model. None if no amplifier is overloaded.
    pub overload: Option<RecordOverload>,
    /// All actions of the search, in order.
    pub search_log: Vec<LogEntry>,
    /// The patch with all effects that were added, fitted.
    pub final_model: FittedModel,
    /// Excess rms of `final_model` over the excess rms of `base`: 0 if the effects explain everything, 1 if nothing.
    pub remaining_fraction: f64,
    /// Correlations of the residual of `base` with drives and signals.
    pub correlations: Vec<Correlation>,
    /// The missing force at every junction, the most likely junction first. Empty if nothing is missing.
    pub localisations: Vec<Localisation>,
    /// The smallest effects that the first round would have found. Empty if an effect was added.
    pub detection_limits: Vec<DetectionLimit>,
    /// The fit of the patch with wider ranges. None unless `base` is at an end of a range and its residual is
    /// coloured.
    pub range_extension: Option<RangeExtension>,
    /// Why the data are inconclusive. None if they are not.
    pub inconclusive: Option<Inconclusive>,
    /// The experiment that distinguishes two tied effects. None if there are none, or if no such experiment can be
    /// run.
    pub discriminating_experiment: Option<DiscriminatingExperiment>,
    /// The sites of the patch at which effects can be attached. Empty if no effect was tried.
    pub effect_sites: EffectSites,
    /// The number of solver steps of the reported model, and the solver's error.
    pub step_refinement: StepRefinement,
}

impl Outcome {
    /// The model that the report describes: `final_model` if effects are named, `base` otherwise.
    pub fn reported_model(&self) -> &FittedModel {
        if self.verdict.has_names() { &self.final_model } else { &self.base }
    }

    /// The force that explains the excess residual best, if the verdict is an unknown effect.
    pub(crate) fn unknown_force(&self) -> Option<&Localisation> {
        self.localisations.first().filter(|_| self.verdict == Verdict::UnknownEffect)
    }

    /// Whether the residual of `final_model` is coloured and larger than an inexact law usually causes.
    pub fn has_substantial_residual(&self) -> bool {
        is_residual_substantial(&self.final_model, self.remaining_fraction)
    }

    /// Whether the log has more than the fit of the patch and one change, so that the rounds alone do not describe
    /// the search.
    pub fn has_detailed_log(&self) -> bool {
        self.search_log.len() > 2
    }
}

/// The rounds whose best effect was taken.
pub(crate) fn taken_rounds(rounds: &[Round]) -> impl Iterator<Item = &Round> + Clone {
    rounds.iter().filter(|round| round.taken)
}

/// Whether the residual of a model is coloured, and `remaining_fraction` exceeds 10 % of the excess rms of the patch
/// as it was.
pub(crate) fn is_residual_substantial(model: &FittedModel, remaining_fraction: f64) -> bool {
    model.residuals_are_coloured() && remaining_fraction > SUBSTANTIAL_FRACTION
}
