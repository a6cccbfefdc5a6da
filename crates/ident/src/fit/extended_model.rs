//! A fitted model with one more effect: the trial of one effect at one site.
//!
//! [`fit_trial`] wires the effect into the patch and fits all parameters again. The starts combine the present fit with
//! several values of the effect's parameters, and with the values that have no effect.

use std::sync::Arc;

use crate::effects::attach::EffectPlacement;
use crate::effects::candidate::Candidate;
use crate::effects::sites::Sites;
use crate::fit::estimate::Estimate;
use crate::fit::estimation::{FitStart, fit_variant};
use crate::fit::fitted_model::{FittedModel, ModelVariant};
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::fit::schedule::{Effort, Starts};
use crate::fit::signal_extents::SignalExtents;

/// Why an effect was not tried at a site.
#[derive(Debug)]
#[non_exhaustive]
pub enum SkipReason {
    /// The ranges of its parameters cannot be computed: its input is always zero, or the residuals have no dominant
    /// frequency.
    NoScale,
    /// The patch cannot be run from any start.
    NotRunnable,
    /// The patch with the effect is invalid, or the records cannot feed it.
    Model(ModelError),
}

impl From<ModelError> for SkipReason {
    fn from(error: ModelError) -> Self {
        SkipReason::Model(error)
    }
}

/// How a trial is to be made.
#[derive(Debug, Clone, Copy)]
pub struct TrialRequest<'a> {
    /// The effort of the fit.
    pub effort: Effort,
    /// The fit is given up if it is not expected to bring the sum of squares below this value.
    pub target_chi2: f64,
    /// The result of the same trial with less effort, if there is one.
    pub previous: Option<&'a FittedModel>,
    /// Values of the effect's parameters from another source, in their units, as one more start.
    pub effect_values: Option<&'a [f64]>,
}

/// Wires one more effect into a fitted model. Returns the effect as a candidate, and the variant to be fitted.
///
/// # Errors
/// If the ranges of the effect's parameters cannot be computed or the effect does not suit the patch.
pub(crate) fn attach_effect(
    fitted: &FittedModel,
    placement: &EffectPlacement<'_>,
    extents: &SignalExtents,
) -> Result<(Candidate, ModelVariant), SkipReason> {
    let largest = extents.largest_at(&placement.site);
    let candidate =
        Candidate::new(placement, fitted.variant.patch(), &largest, &extents.residual_frequencies);
    let candidate = candidate.map_err(ModelError::from)?.ok_or(SkipReason::NoScale)?;
    let graft = &candidate.graft;
    let effect_parameters = graft.parameters.iter().map(|parameter| parameter.name.clone());
    let fit = fitted.variant.fit.iter().cloned().chain(effect_parameters).collect();
    let initial_states = fitted.variant.initial_states.iter().chain(&graft.initial_states).cloned().collect();
    let steps = fitted.variant.steps.max(candidate.steps_per_sample(extents.interval));
    let variant = ModelVariant::new(graft.patch.clone(), fit, initial_states, steps);
    Ok((candidate, variant))
}

/// Wires one more effect into a fitted model and fits all parameters, as `request` specifies.
///
/// # Errors
/// If the effect does not suit the patch, or the patch with it cannot be run along the records.
///
/// # Examples
///
/// ```no_run
/// use patchcord_ident::effects::attach::EffectPlacement;
/// use patchcord_ident::effects::sites::Sites;
/// use patchcord_ident::fit::extended_model::{TrialRequest, fit_trial};
/// use patchcord_ident::fit::schedule::Effort;
/// use patchcord_ident::fit::signal_extents::signal_extents;
/// use patchcord_ident::{Experiment, Library, Problem, fit_base};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let experiment = Experiment::read("../../examples/05_missing_effect/spring.experiment.json")?;
/// let (problem, library) = (Problem::of(&experiment)?, Library::shipped());
/// let base = fit_base(&problem, &experiment.patch, &experiment.fit, 1)?.ok_or("the patch cannot be run")?;
/// let sites = Sites::fed(&experiment.patch, &experiment.drives)?;
/// let friction = library.get("viscous-friction").ok_or("a shipped effect")?;
/// let placements = EffectPlacement::all(friction, &sites);
/// let request = TrialRequest {
///     effort: Effort::FULL,
///     target_chi2: f64::INFINITY,
///     previous: None,
///     effect_values: None,
/// };
/// let extents = signal_extents(&problem, &base)?;
/// let trial = fit_trial(&problem, &base, &placements[0], &extents, request);
/// let (_, fitted) = trial.map_err(|reason| format!("{reason:?}"))?;
/// assert!(fitted.train.chi2 < base.train.chi2);
/// # Ok(())
/// # }
/// ```
pub fn fit_trial(
    problem: &Problem,
    fitted: &FittedModel,
    placement: &EffectPlacement<'_>,
    extents: &SignalExtents,
    request: TrialRequest<'_>,
) -> Result<(Candidate, FittedModel), SkipReason> {
    let (candidate, variant) = attach_effect(fitted, placement, extents)?;
    let starts_from = |base: &Estimate, previous: Option<&Estimate>| {
        trial_starts(&candidate, request.effect_values, base, previous)
    };
    let start = FitStart {
        starts: starts_from(
            &fitted.train.estimate,
            request.previous.map(|previous| &previous.train.estimate),
        ),
        piece_starts: fitted.pieces_estimate.as_ref().map(|base| {
            starts_from(base, request.previous.and_then(|previous| previous.pieces_estimate.as_ref()))
        }),
        validation_initial: Some(&fitted.validation.estimate.initial),
        caches: request.previous.map(|previous| previous.start_caches.clone()).unwrap_or_default(),
        effort: request.effort,
    };
    let fitted = fit_variant(problem, variant, start, request.target_chi2)?.ok_or(SkipReason::NotRunnable)?;
    Ok((candidate, fitted))
}

/// The starts of a trial from the present fit `base`, and from the fit `previous` of the same trial if there is one.
/// `effect_values` are values of the effect's parameters from another source.
fn trial_starts(
    candidate: &Candidate,
    effect_values: Option<&[f64]>,
    base: &Estimate,
    previous: Option<&Estimate>,
) -> Starts {
    let new_state_count = candidate.graft.initial_states.len();
    let with_values = |effect_values: &Vec<f64>| Estimate {
        parameters: [base.parameters.as_slice(), effect_values].concat(),
        initial: base
            .initial
            .iter()
            .map(|voltages| [voltages.as_slice(), &vec![0.0; new_state_count]].concat())
            .collect(),
        offsets: base.offsets.clone(),
    };
    let neighbours = previous.into_iter().flat_map(|previous| {
        let (others, effect_values) = previous.parameters.split_at(base.parameters.len());
        let moved = candidate.neighbours(effect_values).into_iter();
        moved.map(move |values| Estimate { parameters: [others, &values].concat(), ..previous.clone() })
    });
    let requested = effect_values.map(|values| with_values(&candidate.clamped(values)));
    Starts {
        required: candidate.null_starts.iter().map(with_values).collect(),
        previous: previous.cloned().or(requested),
        optional: candidate.starts.iter().map(with_values).chain(neighbours).collect(),
    }
}

/// The sites in the patch of a fitted model at which effects can be wired in.
///
/// # Errors
/// If the patch cannot be compiled to a circuit.
pub(crate) fn find_sites(problem: &Problem, fitted: &FittedModel) -> Result<Sites, ModelError> {
    Ok(Sites::fed(fitted.variant.patch(), &problem.drives)?)
}

/// An effect that was not tried at a site.
#[derive(Debug, Clone)]
pub struct SkippedTrial {
    /// Name of the effect.
    pub effect: String,
    /// Name of the element at which it would act.
    pub site: String,
    /// Why it was not tried.
    pub reason: Arc<SkipReason>,
}

impl SkippedTrial {
    /// The trial of an effect at a site, skipped for this reason.
    pub(crate) fn new(placement: &EffectPlacement<'_>, reason: SkipReason) -> SkippedTrial {
        let effect = placement.effect.name.clone();
        SkippedTrial { effect, site: placement.site_name().to_owned(), reason: Arc::new(reason) }
    }
}
