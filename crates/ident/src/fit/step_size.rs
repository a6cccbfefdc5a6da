//! How many steps the solver takes from sample to sample, so that its own error stays well under the noise.

use crate::fit::estimate::Point;
use crate::fit::estimation::refit;
use crate::fit::fitted_model::{Stage, Version};
use crate::fit::model::{Course, ModelError};
use crate::fit::problem::Problem;
use patchcord_analysis::spare;
use patchcord_core::patch::Patch;

/// The solver may err by this share of the noise, rms.
const FINE: f64 = 0.1;
/// No sample takes more steps than this.
const MOST_STEPS: u32 = 64;
/// So often a fit is made again with finer steps: where it comes to, these may be too coarse again.
const MOST_REFINED: usize = 4;

/// How finely a patch was run, and what that is worth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fineness {
    /// Steps from sample to sample.
    pub steps: u32,
    /// By how much runs with twice as many differ at most in an output of a record, rms over the noise; infinite where they
    /// come to no end.
    pub error: f64,
    /// What it should keep below: a tenth of the noise, or of what is left where that is more.
    pub wanted: f64,
}

impl Fineness {
    /// Whether the solver's own error is well under the noise.
    pub fn is_enough(&self) -> bool {
        self.error < self.wanted
    }
}

/// How finely a stage was run.
///
/// # Errors
/// When the patch cannot be run beside the records.
pub(crate) fn fineness_of(problem: &Problem, stage: &Stage) -> Result<Fineness, ModelError> {
    let (version, point) = (&stage.version, &stage.train.point);
    let [coarse, fine] = [1, 2].map(|times| run_with_steps(problem, version, point, times * version.steps));
    let error = largest_difference(problem, coarse?.as_deref(), fine?.as_deref());
    Ok(Fineness { steps: version.steps, error, wanted: wanted(stage.train.over_noise()) })
}

/// Steps with which the solver errs little, for a patch as it stands. Where none do, as where it runs away, those with which it
/// errs little beside what is left; the most where none do.
///
/// # Errors
/// When the patch cannot be run beside the records.
pub(crate) fn steps_per_sample(problem: &Problem, patch: &Patch, fit: &[String]) -> Result<u32, ModelError> {
    let version = Version::new(patch.clone(), fit.to_vec(), Vec::new(), 1);
    let at = Point::of(&problem.model(&version, &problem.train, &problem.outputs)?, problem.outputs.len());
    let errors = solver_errors(problem, &version, &at, wanted(1.0))?;
    if let Some(steps) = fewest(&errors, wanted(1.0)) {
        return Ok(steps);
    }
    let finest = problem.model(&version.with_steps(MOST_STEPS), &problem.train, &problem.outputs)?;
    let stands = problem.task(&finest, &problem.train, false).told(&at);
    let beside = stands.and_then(|stands| fewest(&errors, wanted(stands.over_noise())));
    Ok(beside.unwrap_or(MOST_STEPS))
}

/// A stage fitted again with finer steps, where the solver errs by too much at the point that it came to; nothing where it
/// does not, or where no steps are fine enough.
///
/// # Errors
/// When the patch cannot be run beside the records.
pub(crate) fn refine_steps(problem: &Problem, stage: &Stage) -> Result<Option<Stage>, ModelError> {
    let mut refined: Option<Stage> = None;
    for _ in 0..MOST_REFINED {
        let own = refined.as_ref().unwrap_or(stage);
        let (version, point) = (&own.version, &own.train.point);
        let enough = wanted(own.train.over_noise());
        let steps = fewest(&solver_errors(problem, version, point, enough)?, enough);
        let Some(steps) = steps.filter(|steps| *steps > version.steps) else { break };
        let again = refit(problem, own, version.with_steps(steps), point.clone())?;
        let Some(again) = again else { break };
        refined = Some(again);
    }
    Ok(refined)
}

/// Steps, those of a version and twice, four times as many until the solver errs by little enough, each with what it errs by at
/// most in a record beside twice as many, rms over the noise.
fn solver_errors(
    problem: &Problem,
    version: &Version,
    at: &Point,
    enough: f64,
) -> Result<Vec<(u32, f64)>, ModelError> {
    let (mut steps, mut coarse) = (version.steps, run_with_steps(problem, version, at, version.steps)?);
    let mut errors = Vec::new();
    while steps < MOST_STEPS && fewest(&errors, enough).is_none() {
        let fine = run_with_steps(problem, version, at, 2 * steps)?;
        errors.push((steps, largest_difference(problem, coarse.as_deref(), fine.as_deref())));
        (steps, coarse) = (2 * steps, fine);
    }
    Ok(errors)
}

/// What a version gives at a point with so many steps; nothing where a record cannot be run.
fn run_with_steps(
    problem: &Problem,
    version: &Version,
    at: &Point,
    steps: u32,
) -> Result<Option<Vec<Course>>, ModelError> {
    let model = problem.model(&version.with_steps(steps), &problem.train, &problem.outputs)?;
    let courses =
        spare::each(at.initial.len(), |record| model.run(record, &[at.choice(record)]).pop().flatten());
    Ok(courses.into_iter().collect())
}

/// By how much a stage's training records differ at most as two problems run them, rms over the noise.
pub(crate) fn difference_of(problem: &Problem, other: &Problem, stage: &Stage) -> Result<f64, ModelError> {
    let (version, point) = (&stage.version, &stage.train.point);
    let [one, other] = [problem, other].map(|own| run_with_steps(own, version, point, version.steps));
    Ok(largest_difference(problem, one?.as_deref(), other?.as_deref()))
}

/// By how much two runs differ at most in an output of a record, rms over the noise; infinite where there is but one.
fn largest_difference(problem: &Problem, coarse: Option<&[Course]>, fine: Option<&[Course]>) -> f64 {
    let Some((coarse, fine)) = coarse.zip(fine) else { return f64::INFINITY };
    let pairs =
        coarse.iter().zip(fine).flat_map(|(coarse, fine)| coarse.iter().zip(fine).zip(&problem.sigma));
    let errs = pairs.map(|((coarse, fine), sigma)| rms_difference(coarse, fine) / sigma);
    errs.fold(0.0, f64::max)
}

/// The fewest steps with which the solver errs by little enough; nothing where none do.
fn fewest(errors: &[(u32, f64)], enough: f64) -> Option<u32> {
    errors.iter().find(|(_, error)| *error < enough).map(|(steps, _)| *steps)
}

/// What the solver may err by where so much is left, both rms over the noise.
fn wanted(left: f64) -> f64 {
    FINE * left.max(1.0)
}

fn rms_difference(left: &[f64], right: &[f64]) -> f64 {
    let sum: f64 = left.iter().zip(right).map(|(left, right)| (left - right).powi(2)).sum();
    (sum / left.len().max(1) as f64).sqrt()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::data::record::Record;
    use crate::fit::base_fit::fit_base;

    /// The rate, per sample, and the amplitude of a decay, in volts.
    pub const RATE: f64 = 2.0;
    pub const AMPLITUDE: f64 = 50.0;

    /// A decay of 20 samples with noise that is told, and none in it; the rate is sought from 0 to 10 per sample.
    pub fn decay(sigma: f64, steps: u32) -> (Patch, Vec<String>, Problem) {
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

    /// What was measured each 0.1 s at an element, in volts, with noise that is told.
    pub fn measured(at: &str, volts: Vec<f64>, sigma: f64, steps: u32) -> Problem {
        let record = Record {
            name: String::new(),
            begin: 0.0,
            since: 0.0,
            interval: 0.1,
            jitter: 0.0,
            drives: Vec::new(),
            outputs: vec![volts],
        };
        let records = vec![record];
        Problem {
            drives: Vec::new(),
            drive_sigma: Vec::new(),
            outputs: vec![at.to_owned()],
            sigma: vec![sigma],
            offset: vec![false],
            train: records.clone(),
            pieces: records.clone(),
            cuts: 1,
            test: records,
            is_cut: false,
            steps,
        }
    }

    #[test]
    fn a_fit_with_steps_that_are_too_coarse_is_made_again() {
        let fitted = |sigma: f64| {
            let (patch, fit, problem) = decay(sigma, 1);
            let stage = fit_base(&problem, &patch, &fit, 1).unwrap().unwrap();
            (stage.version.steps, stage.train.point.knobs[0])
        };
        let (steps, rate) = fitted(1e-3);
        assert!(steps > 8 && (rate - RATE).abs() < 1e-4, "{steps} {rate}");
        // Where the noise hides what the solver errs by, steps are as coarse as they may be.
        let (coarse, _) = fitted(1.0);
        assert!((2..steps).contains(&coarse), "{coarse} {steps}");
    }

    #[test]
    fn a_solver_that_errs_by_more_than_it_may_is_told() {
        let told = |sigma: f64| {
            let (patch, fit, problem) = decay(sigma, 1);
            let stage = fit_base(&problem, &patch, &fit, 1).unwrap().unwrap();
            fineness_of(&problem, &stage).unwrap()
        };
        let fine = told(1e-3);
        assert!(fine.is_enough() && fine.error < 0.1, "{fine:?}");
        // No steps come to noise as little as this.
        let coarse = told(1e-12);
        assert!(!coarse.is_enough() && coarse.error.is_finite(), "{coarse:?}");
    }
}
