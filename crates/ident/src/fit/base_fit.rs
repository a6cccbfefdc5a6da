//! The fit of the patch as it is, and repeated fits from better starts.
//!
//! [`fit_base`] fits the patch from its declared values and from random starts. If the fit is poor, it is repeated from
//! a fit to pieces of the records. `finish` then refines the solver steps and the validation.

use crate::fit::estimate::Estimate;
use crate::fit::estimation::{FitStart, fit_variant, refit};
use crate::fit::fitted_model::{FittedModel, ModelVariant};
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::fit::schedule::Starts;
use crate::fit::starts::random_starts;
use crate::fit::step_size::refine_steps;
use crate::fit::validation::revalidate;
use patchcord_core::patch::Patch;

/// A fit is better than another only if its sum of squares is below this fraction of the other.
const BETTER_CHI2_RATIO: f64 = 0.99;

/// Fits the patch as it is, from its declared values and from random starts in the ranges of `fit`.
///
/// `fit` names the fitted parameters; `seed` selects the random starts. The result is `None` if the patch can be run
/// from none of the starts.
///
/// # Errors
/// If the patch cannot be run along the records at all, or the fit is cancelled.
///
/// # Examples
///
/// ```
/// use patchcord_ident::{Experiment, Problem, fit_base};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let experiment = Experiment::read("../../examples/05_missing_effect/spring.experiment.json")?;
/// let problem = Problem::of(&experiment)?;
/// let fitted = fit_base(&problem, &experiment.patch, &experiment.fit, 1)?;
/// let fitted = fitted.ok_or("the patch cannot be run from any start")?;
///
/// // The patch lacks the damping of the spring, so the residual is larger than the noise.
/// assert_eq!(fitted.variant.fit, ["k"]);
/// assert!(fitted.train.normalised_rms() > 1.0 && fitted.residuals_are_coloured());
/// # Ok(())
/// # }
/// ```
pub fn fit_base(
    problem: &Problem,
    patch: &Patch,
    fit: &[String],
    seed: u64,
) -> Result<Option<FittedModel>, ModelError> {
    let variant = ModelVariant::new(patch.clone(), fit.to_vec(), Vec::new(), problem.steps);
    let model = problem.model(&variant, &problem.train, &problem.outputs)?;
    let nominal = Estimate::nominal(&model, problem.outputs.len());
    let fit_problem = problem.fit_problem(&model, &problem.train, true);
    let starts = [nominal.clone()].into_iter().chain(random_starts(&model, &nominal, seed));
    let with_fitted_initial = starts.filter_map(|start| fit_problem.fit_initial(&start));
    let starts: Vec<Estimate> = with_fitted_initial.chain([nominal.clone()]).collect();
    let start = FitStart::from_estimates(starts);
    let fitted = fit_variant(problem, variant, start, f64::INFINITY)?;
    let fitted = match fitted {
        Some(fitted) if !problem.is_cut && fitted.is_poor() => Some(refit_over_pieces(problem, fitted)?),
        fitted => fitted,
    };
    let finished = fitted.as_ref().map(|fitted| finish(problem, fitted)).transpose()?.flatten();
    // A run that was left out counts as failed.
    problem.cancellation.check()?;
    Ok(finished.or(fitted))
}

/// Refines the solver steps and, if necessary, the initial voltages of the validation records. `None` if neither
/// changes the fitted model.
///
/// # Errors
/// If the patch cannot be run along the records.
pub(crate) fn finish(problem: &Problem, fitted: &FittedModel) -> Result<Option<FittedModel>, ModelError> {
    let refined = refine_steps(problem, fitted)?;
    let revalidated = revalidate(problem, refined.as_ref().unwrap_or(fitted))?;
    Ok(revalidated.or(refined))
}

/// Repeats a poor fit from a fit to the pieces of the records. Returns the better of the old and the new fit.
fn refit_over_pieces(problem: &Problem, fitted: FittedModel) -> Result<FittedModel, ModelError> {
    let model = problem.model(&fitted.variant, &problem.pieces, &problem.outputs)?;
    let start = Estimate {
        parameters: fitted.train.estimate.parameters.clone(),
        ..Estimate::nominal(&model, problem.outputs.len())
    };
    let Some(with_fitted_initial) = problem.fit_problem(&model, &problem.pieces, true).fit_initial(&start)
    else {
        return Ok(fitted);
    };
    let start = FitStart {
        piece_starts: Some(Starts { required: vec![with_fitted_initial], ..Starts::default() }),
        validation_initial: Some(&fitted.validation.estimate.initial),
        ..FitStart::from_estimates(vec![fitted.train.estimate.clone()])
    };
    let repeated = fit_variant(problem, fitted.variant.clone(), start, f64::INFINITY)?;
    Ok(repeated.filter(|repeated| repeated.train.chi2 < fitted.train.chi2).unwrap_or(fitted))
}

/// Repeats a fit from the result of a trial with one more effect, without the values of that effect.
///
/// Returns `None` unless the sum of squares decreases by more than 1 %.
///
/// # Errors
/// If the patch cannot be run along the records at all.
///
/// # Examples
///
/// ```no_run
/// use patchcord_ident::fit::base_fit::refit_from_trial;
/// use patchcord_ident::fit::fitted_model::FittedModel;
/// use patchcord_ident::fit::model::ModelError;
/// use patchcord_ident::Problem;
///
/// /// The better of two fits of the same patch: the present one, and one from the values of a trial.
/// fn improved(problem: &Problem, fitted: FittedModel, trial: &FittedModel) -> Result<FittedModel, ModelError> {
///     Ok(refit_from_trial(problem, &fitted, trial)?.unwrap_or(fitted))
/// }
/// ```
pub fn refit_from_trial(
    problem: &Problem,
    fitted: &FittedModel,
    trial: &FittedModel,
) -> Result<Option<FittedModel>, ModelError> {
    let (estimate, trial_estimate) = (&fitted.train.estimate, &trial.train.estimate);
    let start = Estimate {
        parameters: trial_estimate.parameters[..estimate.parameters.len()].to_vec(),
        initial: estimate
            .initial
            .iter()
            .zip(&trial_estimate.initial)
            .map(|(voltages, trial_voltages)| trial_voltages[..voltages.len()].to_vec())
            .collect(),
        offsets: trial_estimate.offsets.clone(),
    };
    let repeated = refit(problem, fitted, fitted.variant.clone(), start)?;
    Ok(repeated.filter(|repeated| repeated.train.chi2 < BETTER_CHI2_RATIO * fitted.train.chi2))
}
