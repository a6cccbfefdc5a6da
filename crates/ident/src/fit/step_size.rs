//! The number of solver steps per sample, chosen so that the solver error is small relative to the noise.
//!
//! The solver error is estimated by step doubling: it is the difference from a run with twice as many steps. The steps
//! are chosen before the first fit and checked after each fit, because the error depends on the parameters.

use crate::fit::estimate::Estimate;
use crate::fit::estimation::refit;
use crate::fit::fitted_model::{FittedModel, ModelVariant};
use crate::fit::model::{ModelError, OutputTrajectory};
use crate::fit::problem::Problem;
use patchcord_analysis::parallel;
use patchcord_core::patch::Patch;

/// The largest solver error, rms, relative to the noise or to the residuals if these are larger.
const ERROR_RATIO: f64 = 0.1;
/// The largest number of steps per sample.
const MAX_STEPS: u32 = 64;
/// The largest number of repetitions of a fit with more steps. The parameters of each repetition may need still more
/// steps.
const MAX_REFINEMENTS: usize = 4;

/// The solver steps of a fit and their error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepRefinement {
    /// Steps per sample.
    pub steps: u32,
    /// The rms difference from a run with twice as many steps, in units of sigma: the largest of all outputs and
    /// records. Infinite if a run fails.
    pub error: f64,
    /// The limit of the error: 0.1, or 0.1 times the rms residual if that is larger than 1. In units of sigma.
    pub limit: f64,
}

impl StepRefinement {
    /// Whether the solver error is below its limit.
    pub fn is_sufficient(&self) -> bool {
        self.error < self.limit
    }

    /// Whether the solver error is above its limit and larger than the noise. The residual may then be an error of the
    /// solver. False if the error is unknown.
    pub fn exceeds_noise(&self) -> bool {
        self.error.is_finite() && self.error > 1.0 && !self.is_sufficient()
    }
}

/// The solver steps of a fitted model and their error.
///
/// # Errors
/// If the patch cannot be run along the records.
pub(crate) fn step_refinement(problem: &Problem, fitted: &FittedModel) -> Result<StepRefinement, ModelError> {
    let (variant, estimate) = (&fitted.variant, &fitted.train.estimate);
    let [coarse, fine] =
        [1, 2].map(|factor| run_with_steps(problem, variant, estimate, factor * variant.steps));
    let error = largest_difference(problem, coarse?.as_deref(), fine?.as_deref());
    Ok(StepRefinement { steps: variant.steps, error, limit: error_limit(fitted.train.normalised_rms()) })
}

/// The number of solver steps that is sufficient for a patch with its declared values.
///
/// If none is sufficient relative to the noise, for example because the patch diverges, the number is sufficient
/// relative to the residuals. If none is sufficient at all, it is [`MAX_STEPS`].
///
/// # Errors
/// If the patch cannot be run along the records.
pub(crate) fn steps_per_sample(problem: &Problem, patch: &Patch, fit: &[String]) -> Result<u32, ModelError> {
    let variant = ModelVariant::new(patch.clone(), fit.to_vec(), Vec::new(), 1);
    let nominal =
        Estimate::nominal(&problem.model(&variant, &problem.train, &problem.outputs)?, problem.outputs.len());
    let errors = solver_errors(problem, &variant, &nominal, error_limit(1.0))?;
    if let Some(steps) = fewest_sufficient_steps(&errors, error_limit(1.0)) {
        return Ok(steps);
    }
    let finest = problem.model(&variant.with_steps(MAX_STEPS), &problem.train, &problem.outputs)?;
    let unfitted = problem.fit_problem(&finest, &problem.train, false).evaluate(&nominal);
    let steps =
        unfitted.and_then(|result| fewest_sufficient_steps(&errors, error_limit(result.normalised_rms())));
    Ok(steps.unwrap_or(MAX_STEPS))
}

/// Repeats a fit with more solver steps until the solver error at the result is below its limit.
///
/// `None` if the steps are sufficient already, or if [`MAX_STEPS`] is not sufficient.
///
/// # Errors
/// If the patch cannot be run along the records.
pub(crate) fn refine_steps(
    problem: &Problem,
    fitted: &FittedModel,
) -> Result<Option<FittedModel>, ModelError> {
    let mut refined: Option<FittedModel> = None;
    for _ in 0..MAX_REFINEMENTS {
        let latest = refined.as_ref().unwrap_or(fitted);
        let (variant, estimate) = (&latest.variant, &latest.train.estimate);
        let limit = error_limit(latest.train.normalised_rms());
        let steps = fewest_sufficient_steps(&solver_errors(problem, variant, estimate, limit)?, limit);
        let Some(steps) = steps.filter(|steps| *steps > variant.steps) else { break };
        let repeated = refit(problem, latest, variant.with_steps(steps), estimate.clone())?;
        let Some(repeated) = repeated else { break };
        refined = Some(repeated);
    }
    Ok(refined)
}

/// Pairs of steps per sample and their solver error, in units of sigma. The steps begin with those of the variant and
/// double until the error is below `limit` or [`MAX_STEPS`] is reached.
fn solver_errors(
    problem: &Problem,
    variant: &ModelVariant,
    estimate: &Estimate,
    limit: f64,
) -> Result<Vec<(u32, f64)>, ModelError> {
    let (mut steps, mut coarse) = (variant.steps, run_with_steps(problem, variant, estimate, variant.steps)?);
    let mut errors = Vec::new();
    while steps < MAX_STEPS && fewest_sufficient_steps(&errors, limit).is_none() {
        let fine = run_with_steps(problem, variant, estimate, 2 * steps)?;
        errors.push((steps, largest_difference(problem, coarse.as_deref(), fine.as_deref())));
        (steps, coarse) = (2 * steps, fine);
    }
    Ok(errors)
}

/// The outputs along every training record with this number of steps per sample. `None` if a record cannot be run.
fn run_with_steps(
    problem: &Problem,
    variant: &ModelVariant,
    estimate: &Estimate,
    steps: u32,
) -> Result<Option<Vec<OutputTrajectory>>, ModelError> {
    let model = problem.model(&variant.with_steps(steps), &problem.train, &problem.outputs)?;
    let trajectories = parallel::map_indices(estimate.initial.len(), |record| {
        model.run(record, &[estimate.run_values(record)]).pop().flatten()
    });
    Ok(trajectories.into_iter().collect())
}

/// The largest rms difference between the outputs of one fitted model in two problems, in units of sigma. The problems
/// may differ in the interpolation of drives.
pub(crate) fn difference_between(
    problem: &Problem,
    other: &Problem,
    fitted: &FittedModel,
) -> Result<f64, ModelError> {
    let (variant, estimate) = (&fitted.variant, &fitted.train.estimate);
    let [first, second] =
        [problem, other].map(|problem| run_with_steps(problem, variant, estimate, variant.steps));
    Ok(largest_difference(problem, first?.as_deref(), second?.as_deref()))
}

/// The rms difference between two runs, in units of sigma: the largest of all outputs and records. Infinite if a run is
/// missing.
fn largest_difference(
    problem: &Problem,
    coarse: Option<&[OutputTrajectory]>,
    fine: Option<&[OutputTrajectory]>,
) -> f64 {
    let Some((coarse, fine)) = coarse.zip(fine) else { return f64::INFINITY };
    let pairs =
        coarse.iter().zip(fine).flat_map(|(coarse, fine)| coarse.iter().zip(fine).zip(&problem.sigma));
    let differences = pairs.map(|((coarse, fine), sigma)| rms_difference(coarse, fine) / sigma);
    differences.fold(0.0, f64::max)
}

/// The fewest steps with an error below `limit`. `None` if there are none.
fn fewest_sufficient_steps(errors: &[(u32, f64)], limit: f64) -> Option<u32> {
    errors.iter().find(|(_, error)| *error < limit).map(|(steps, _)| *steps)
}

/// The limit of the solver error for residuals with this rms, both in units of sigma.
fn error_limit(normalised_rms: f64) -> f64 {
    ERROR_RATIO * normalised_rms.max(1.0)
}

/// The rms of the difference of two tracks.
fn rms_difference(left: &[f64], right: &[f64]) -> f64 {
    let sum: f64 = left.iter().zip(right).map(|(left, right)| (left - right).powi(2)).sum();
    (sum / left.len().max(1) as f64).sqrt()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::data::record::Record;
    use crate::fit::base_fit::fit_base;
    use crate::fit::cancellation::Cancellation;

    /// The rate of the decay, per sample.
    pub(crate) const RATE: f64 = 2.0;
    /// The amplitude of the decay, in V.
    pub(crate) const AMPLITUDE: f64 = 50.0;

    /// A patch of a decay, its fitted parameter, and 20 samples without noise. `sigma` is the declared noise in V. The
    /// rate ranges from 0 to 10 per sample.
    pub(crate) fn decay(sigma: f64, steps: u32) -> (Patch, Vec<String>, Problem) {
        let patch = r#"{
  "patchcord": 1,
  "parameters": {"rate": {"value": 1, "unit": "1", "range": [0, 10]}},
  "elements": {
    "P1": {"kind": "pot", "in": "A1", "setting": "rate / 10"},
    "A1": {"kind": "integrator", "in": {"x100": ["P1"]}, "initial": 30}
  }
}"#;
        let patch = Patch::parse("decay.json", patch).unwrap_or_else(|report| panic!("{report}"));
        let decayed = (0..20).map(|sample| AMPLITUDE * (-RATE * f64::from(sample)).exp());
        (patch, vec!["rate".to_owned()], measured("A1", decayed.collect(), sigma, steps))
    }

    /// The problem of one record: the output of an element, in V, every 0.1 s, with declared noise `sigma`.
    pub(crate) fn measured(element: &str, volts: Vec<f64>, sigma: f64, steps: u32) -> Problem {
        let record = Record {
            name: String::new(),
            begin: 0.0,
            start_in_file: 0.0,
            interval: 0.1,
            jitter: 0.0,
            drives: Vec::new(),
            outputs: vec![volts],
        };
        let records = vec![record];
        Problem {
            drives: Vec::new(),
            drive_sigma: Vec::new(),
            outputs: vec![element.to_owned()],
            sigma: vec![sigma],
            has_offset: vec![false],
            train: records.clone(),
            pieces: records.clone(),
            pieces_per_record: 1,
            validation: records,
            is_cut: false,
            steps,
            cancellation: Cancellation::default(),
        }
    }

    #[test]
    fn a_fit_with_too_few_steps_is_repeated_with_more() {
        let fitted = |sigma: f64| {
            let (patch, fit, problem) = decay(sigma, 1);
            let fitted = fit_base(&problem, &patch, &fit, 1).unwrap().unwrap();
            (fitted.variant.steps, fitted.train.estimate.parameters[0])
        };
        let (steps, rate) = fitted(1e-3);
        assert!(steps > 8 && (rate - RATE).abs() < 1e-4, "{steps} {rate}");
        // With more noise a larger solver error is permitted, so that fewer steps are sufficient.
        let (fewer_steps, _) = fitted(1.0);
        assert!((2..steps).contains(&fewer_steps), "{fewer_steps} {steps}");
    }

    #[test]
    fn an_insufficient_number_of_steps_is_reported() {
        let refinement = |sigma: f64| {
            let (patch, fit, problem) = decay(sigma, 1);
            let fitted = fit_base(&problem, &patch, &fit, 1).unwrap().unwrap();
            step_refinement(&problem, &fitted).unwrap()
        };
        let sufficient = refinement(1e-3);
        assert!(sufficient.is_sufficient() && sufficient.error < 0.1, "{sufficient:?}");
        // No permitted number of steps reaches such a small error.
        let insufficient = refinement(1e-12);
        assert!(!insufficient.is_sufficient() && insufficient.error.is_finite(), "{insufficient:?}");
        assert!(insufficient.exceeds_noise() && !sufficient.exceeds_noise(), "{insufficient:?}");
    }

    #[test]
    fn a_solver_error_is_compared_with_the_noise_and_with_its_limit() {
        let exceeds = |error, limit| StepRefinement { steps: 64, error, limit }.exceeds_noise();
        assert!(exceeds(50.0, 20.0));
        // A larger residual than that is no error of the solver, and a smaller error is only a doubt.
        assert!(!exceeds(50.0, 60.0) && !exceeds(0.5, 0.1) && !exceeds(f64::INFINITY, 0.1));
    }
}
