//! Reasons why data are inconclusive. If such a reason applies, a white residual does not prove that nothing is
//! missing.

use crate::data::experiment::Experiment;
use crate::data::record::Record;
use crate::design::detectability::detection_limit::DetectionLimit;
use crate::fit::coloured_residual::ColouredResidual;
use crate::fit::estimate::{Estimate, normalised_output_rms, squared_residuals};
use crate::fit::fitted_model::{FittedModel, WHITENESS_Z};
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::fit::step_size::StepRefinement;
use crate::fit::validation::is_any_validation_worse;
use crate::fit::validation::is_significantly_larger;
use crate::residuals::divergence::Divergence;
use crate::residuals::misspecification::Misspecification;
use crate::residuals::output_motion::normalised_motion;
use crate::residuals::residual_analysis::SlowNoise;
use crate::search::round::Round;
use crate::statistics::descriptive::{about_mean, mean};
use crate::statistics::whiteness::ljung_box_z;

/// Why data are inconclusive.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Inconclusive {
    /// There are at most as many samples as fitted numbers.
    TooFewSamples,
    /// A constant explains the data as well as the patch does, or the data are noise about a constant.
    NoMotion,
    /// The residual of this output looks like noise, but its rms is this multiple of the stated noise.
    LoudResidual(String, f64),
    /// The residual does not exceed the noise of drives and outputs, but is not white.
    ColouredResidual(ColouredResidual),
    /// The residual is best explained by slow noise of a sensor.
    SlowSensorNoise(SlowNoise),
    /// The fit to the training records does not explain the validation records, where the rms residual is this
    /// multiple of the noise.
    ValidationMismatch(f64),
    /// The patch has no site for any effect.
    NoSites,
    /// None of the effects would be detected in these data, at any strength in its range.
    NothingDetectable,
    /// The patch explains the data with parameter values outside their ranges.
    RangeExtension,
    /// The patch explains the data if a sign, a unit or the time unit is changed.
    Misspecification(Misspecification),
    /// The fit diverges.
    Divergence(Divergence),
    /// The residual is below the declared noise, but the outputs do not move beyond that noise.
    NoiseAboveMotion,
    /// The solver error of the fitted patch exceeds the noise.
    SolverError(StepRefinement),
}

/// Number of samples of every output from which [`is_noise_only`] decides. Fewer samples often look like noise by
/// chance.
const MIN_NOISE_SAMPLES: usize = 100;
/// Standard deviations by which the mean square of a white residual must be below that of the declared noise, so that it
/// counts as below the noise. White noise of that size is so low in one of 700 cases.
const BELOW_NOISE_Z: f64 = 3.0;
/// Maximum rms of a residual over the stated noise. A larger residual is not only noise, even if it is white.
pub(crate) const MAX_NOISE_RATIO: f64 = 2.0;

/// The reason why data are inconclusive for a patch whose residual looks like noise. None if they are conclusive.
///
/// # Errors
/// If the patch cannot be simulated with the drives of the records.
pub(crate) fn why_inconclusive(
    problem: &Problem,
    base: &FittedModel,
    rounds: &[Round],
    limits: &[DetectionLimit],
) -> Result<Option<Inconclusive>, ModelError> {
    if base.train.data_count <= base.train.fitted_count {
        return Ok(Some(Inconclusive::TooFewSamples));
    }
    let needed = rounds.first().map_or(0.0, |round| round.required_delta_bic);
    if explained_motion(problem, base) < needed * base.autocorrelation_time {
        return Ok(Some(Inconclusive::NoMotion));
    }
    let rms = problem
        .outputs
        .iter()
        .enumerate()
        .map(|(index, name)| (name, normalised_output_rms(&base.train, index)));
    if let Some((output, rms)) =
        rms.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, rms)| *rms > MAX_NOISE_RATIO)
    {
        return Ok(Some(Inconclusive::LoudResidual(output.clone(), rms)));
    }
    if is_any_validation_worse(problem, base) && !is_joint_fit_sufficient(problem, base)? {
        return Ok(Some(Inconclusive::ValidationMismatch(base.validation.normalised_rms())));
    }
    if rounds.iter().all(|round| round.trials.is_empty()) {
        return Ok(Some(Inconclusive::NoSites));
    }
    let is_any_detectable = limits.iter().any(DetectionLimit::is_detectable);
    Ok((!is_any_detectable).then_some(Inconclusive::NothingDetectable))
}

/// Whether every output of the training records is white noise about a constant, with at most twice the stated rms.
/// False if an output has fewer than 100 samples.
pub(crate) fn is_noise_only(problem: &Problem) -> bool {
    let over_noise = |(track, sigma): (&Vec<f64>, &f64)| {
        about_mean(track).into_iter().map(|volts| volts / sigma).collect::<Vec<f64>>()
    };
    let outputs = |record: &Record| record.outputs.iter().zip(&problem.sigma).map(over_noise).collect();
    let all: Vec<Vec<Vec<f64>>> = problem.train.iter().map(outputs).collect();
    let is_enough = all.iter().flatten().all(|track| track.len() >= MIN_NOISE_SAMPLES);
    let is_quiet = |output: usize| mean(&squared_residuals(&all, output)) < MAX_NOISE_RATIO * MAX_NOISE_RATIO;
    is_enough && (0..problem.outputs.len()).all(is_quiet) && ljung_box_z(&all) < WHITENESS_Z
}

/// Whether the residual of every output is below the noise that the experiment declares for it, in the training and
/// the validation records. A white residual must be so low in training that noise of the declared size is unlikely.
pub(crate) fn agrees_within_noise(experiment: &Experiment, base: &FittedModel) -> bool {
    let z = if base.residuals_are_coloured() { 0.0 } else { BELOW_NOISE_Z };
    experiment.outputs.iter().enumerate().all(|(index, output)| {
        let squares = squared_residuals(&base.train.residuals, index);
        let limit = 1.0 - z * (2.0 / squares.len() as f64).sqrt();
        output.sigma.is_some()
            && mean(&squares) < limit
            && normalised_output_rms(&base.validation, index) < 1.0
    })
}

/// Whether at least one output moves by more than the noise, rms about its mean.
pub(crate) fn has_motion_above_noise(problem: &Problem) -> bool {
    (0..problem.outputs.len()).any(|output| normalised_motion(problem, output) > 1.0)
}

/// Whether the patch explains all records if it is fitted to all of them. The training records may leave a parameter
/// open that the validation records depend on, for example if motion sticks in training.
fn is_joint_fit_sufficient(problem: &Problem, base: &FittedModel) -> Result<bool, ModelError> {
    let records = [problem.train.as_slice(), &problem.validation].concat();
    let initial = [base.train.estimate.initial.as_slice(), &base.validation.estimate.initial].concat();
    let model = problem.model(&base.variant, &records, &problem.outputs)?;
    let start = Estimate { initial, ..base.train.estimate.clone() };
    let Some(fitted) = problem.fit_problem(&model, &records, true).fit(&start) else { return Ok(false) };
    let (train, validation) = fitted.residuals.split_at(problem.train.len());
    let is_explained = |output: usize| {
        let before = squared_residuals(&base.train.residuals, output);
        let parts = [train, validation].map(|part| squared_residuals(part, output));
        parts.iter().all(|after| !is_significantly_larger(&before, after, base.autocorrelation_time))
    };
    Ok((0..problem.outputs.len()).all(is_explained))
}

/// The sum of squares of the fitted outputs about their means, over the noise: the motion in training that the patch
/// explains.
fn explained_motion(problem: &Problem, base: &FittedModel) -> f64 {
    let tracks = problem.train.iter().zip(&base.train.residuals).flat_map(|(record, residuals)| {
        record.outputs.iter().zip(residuals).zip(&problem.sigma).map(|((data, residual), sigma)| {
            let simulated = data.iter().zip(residual).map(|(datum, residual)| datum / sigma - residual);
            simulated.filter(|value| !value.is_nan()).collect::<Vec<f64>>()
        })
    });
    let squares_about_mean = |track: Vec<f64>| {
        let mean = mean(&track);
        track.iter().map(|value| (value - mean).powi(2)).sum::<f64>()
    };
    tracks.map(squares_about_mean).sum()
}
