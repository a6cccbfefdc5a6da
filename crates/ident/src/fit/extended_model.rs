//! A fitted model with one more effect: the trial of one effect at one place.
//!
//! [`fit_trial`] wires the effect into the patch and fits all parameters again. The starts combine the present fit with
//! several values of the effect's parameters, and with the values that have no effect.

use crate::effects::attach::EffectPlacement;
use crate::effects::candidate::Candidate;
use crate::effects::sites::Sites;
use crate::fit::estimate::Estimate;
use crate::fit::estimation::FitStart;
use crate::fit::estimation::fit_variant;
use crate::fit::fitted_model::{FittedModel, ModelVariant};
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::fit::schedule::{Effort, Starts};
use crate::fit::signal_extents::SignalExtents;

/// Why an effect was not tried at a place.
#[derive(Debug, thiserror::Error)]
pub enum SkipReason {
    /// The ranges of its parameters cannot be computed.
    #[error(
        "its size cannot be estimated: its input is always zero, or the residuals have no dominant frequency"
    )]
    NoScale,
    /// The patch cannot be run from any start.
    #[error("the patch with this effect cannot be run from any start")]
    NotRunnable,
    /// The patch with the effect is invalid, or the records cannot feed it.
    #[error(transparent)]
    Model(#[from] ModelError),
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
    attached: &EffectPlacement<'_>,
    extents: &SignalExtents,
) -> Result<(Candidate, ModelVariant), SkipReason> {
    let largest = extents.largest_at(&attached.site);
    let candidate = Candidate::new(attached, fitted.variant.patch(), &largest, &extents.residual_frequencies);
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
pub fn fit_trial(
    problem: &Problem,
    fitted: &FittedModel,
    attached: &EffectPlacement<'_>,
    extents: &SignalExtents,
    request: TrialRequest<'_>,
) -> Result<(Candidate, FittedModel), SkipReason> {
    let (candidate, variant) = attach_effect(fitted, attached, extents)?;
    let new_state_count = candidate.graft.initial_states.len();
    let starts_from = |base: &Estimate, previous: Option<&Estimate>| {
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
        let requested = request.effect_values.map(|values| with_values(&candidate.clamped(values)));
        Starts {
            required: candidate.null_starts.iter().map(with_values).collect(),
            previous: previous.cloned().or(requested),
            optional: candidate.starts.iter().map(with_values).chain(neighbours).collect(),
        }
    };
    let start = FitStart {
        starts: starts_from(
            &fitted.train.estimate,
            request.previous.map(|previous| &previous.train.estimate),
        ),
        piece_starts: fitted.pieces_estimate.as_ref().map(|base| {
            starts_from(base, request.previous.and_then(|previous| previous.pieces_estimate.as_ref()))
        }),
        test_initial: Some(&fitted.test.estimate.initial),
        caches: request.previous.map(|previous| previous.start_caches.clone()).unwrap_or_default(),
        effort: request.effort,
    };
    let fitted = fit_variant(problem, variant, start, request.target_chi2)?.ok_or(SkipReason::NotRunnable)?;
    Ok((candidate, fitted))
}

/// The places in the patch of a fitted model at which effects can be wired in.
///
/// # Errors
/// If the patch cannot be compiled to a circuit.
pub(crate) fn find_sites(problem: &Problem, fitted: &FittedModel) -> Result<Sites, ModelError> {
    Ok(Sites::fed(fitted.variant.patch(), &problem.drives)?)
}

/// An effect that was not tried at a place.
#[derive(Debug, Clone)]
pub struct SkippedTrial {
    /// Name of the effect.
    pub effect: String,
    /// Name of the element on which it would act.
    pub junction: String,
    /// Why it was not tried: the text of the [`SkipReason`].
    pub reason: String,
}

impl SkippedTrial {
    /// The trial of an effect at a place, skipped for this reason.
    pub(crate) fn new(attached: &EffectPlacement<'_>, reason: &SkipReason) -> SkippedTrial {
        let effect = attached.effect.name.clone();
        SkippedTrial { effect, junction: attached.junction().to_owned(), reason: reason.to_string() }
    }
}
