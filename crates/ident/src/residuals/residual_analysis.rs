//! Sources of coloured residuals other than a missing effect: noise of drives, drives between samples, sensor noise.
//!
//! The effect of drive noise is found by simulation: more noise of the same size is added to the drives, and the patch
//! is fitted to its own output. Slow sensor noise is found by the likelihood of a first-order autoregressive process
//! with white noise, which a Kalman filter computes.

use std::ops::RangeInclusive;

use crate::data::experiment::MeasuredDrive;
use crate::data::record::Record;
use crate::fit::coloured_residual::{ColouredResidual, ResidualSource};
use crate::fit::estimate::{FitResult, normalised_output_rms};
use crate::fit::fitted_model::FittedModel;
use crate::fit::levenberg_marquardt::FitProblem;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::residuals::intersample::refit_smoothly;
use crate::residuals::output_motion::normalised_motion;
use crate::statistics::descriptive::mean;
use crate::statistics::rng::standard_normal;
use patchcord_analysis::parallel;

/// The number of simulations of drive noise.
const DRIVE_NOISE_DRAWS: u64 = 32;
/// Mean squared residuals above those of sensor noise are due to drive noise if they are at most this many times the
/// mean of the simulations. One simulation in a hundred exceeds it if a force drives a mass, whose position drifts.
pub(crate) const DRIVE_NOISE_RATIO: f64 = 6.0;
/// The number of iterations of the fit to a simulation. They suffice because drive noise changes the fit only slightly.
const DRAW_ITERATIONS: usize = 2;

/// Correlation times of slow noise that are tested: powers of two, in samples of the record with the shortest interval.
const TIME_EXPONENTS: RangeInclusive<i32> = 1..=10;
/// Variances of slow noise that are tested: powers of two, relative to the white noise.
const VARIANCE_EXPONENTS: RangeInclusive<i32> = -4..=12;

/// Slow noise of a sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct SlowNoise {
    /// Name of the output.
    pub output: String,
    /// The correlation time of the noise, in seconds.
    pub correlation_time: f64,
}

/// Least difference of the log-likelihoods at which slow noise explains the residuals better than a force. The force is
/// searched at few points in time, so that its log-likelihood may be up to 45 too low if it is hardly visible.
const LOG_LIKELIHOOD_MARGIN: f64 = 60.0;

/// The source of coloured residuals that are no larger than noise can explain: noise of the outputs or the drives, or
/// the drives between samples.
///
/// `None` if the residuals are white or are larger. The fitted model keeps the result for later calls.
///
/// # Errors
/// If the patch cannot be run along the records.
pub(crate) fn coloured_residual(
    problem: &Problem,
    fitted: &FittedModel,
) -> Result<Option<ColouredResidual>, ModelError> {
    if !fitted.residuals_are_coloured() {
        return Ok(None);
    }
    if let Some(known) = fitted.coloured_residual.get() {
        return Ok(known.clone());
    }
    let finding = match find_intersample_source(problem, fitted)? {
        None => find_noise_source(problem, fitted)?,
        intersample => intersample,
    };
    Ok(fitted.coloured_residual.get_or_init(|| finding).clone())
}

/// The finding that linear interpolation of drives is the source. `None` if it is not.
fn find_intersample_source(
    problem: &Problem,
    fitted: &FittedModel,
) -> Result<Option<ColouredResidual>, ModelError> {
    let Some((smooth, drives)) = refit_smoothly(problem, fitted)? else { return Ok(None) };
    let finding = worst_output(problem, fitted).map(|output| ColouredResidual {
        output: problem.outputs[output].clone(),
        normalised_rms: normalised_output_rms(&fitted.train, output),
        source: ResidualSource::Intersample(drives, normalised_output_rms(&smooth.train, output)),
    });
    Ok(finding)
}

/// The finding that noise of outputs or drives is the source. `None` if the residuals of any output are larger.
fn find_noise_source(
    problem: &Problem,
    fitted: &FittedModel,
) -> Result<Option<ColouredResidual>, ModelError> {
    let output_rms = |output| normalised_output_rms(&fitted.train, output);
    let drive_noise = drive_noise_in_outputs(problem, fitted)?;
    let is_noise =
        |output: usize| output_rms(output).powi(2) <= 1.0 + DRIVE_NOISE_RATIO * drive_noise[output];
    let drives = || noisy_drives(problem).map(|drive| drive.drive.clone()).collect();
    let source = |output: usize| match output_rms(output) {
        rms if rms <= 1.0 => ResidualSource::OutputNoise,
        rms if rms > normalised_motion(problem, output) => ResidualSource::Divergence(drives()),
        _ => ResidualSource::DriveNoise(drives(), drive_noise[output].sqrt()),
    };
    let finding =
        worst_output(problem, fitted).filter(|_| (0..drive_noise.len()).all(is_noise)).map(|output| {
            ColouredResidual {
                output: problem.outputs[output].clone(),
                normalised_rms: output_rms(output),
                source: source(output),
            }
        });
    Ok(finding)
}

/// Index of the output with the largest rms residual. `None` if there are no outputs.
fn worst_output(problem: &Problem, fitted: &FittedModel) -> Option<usize> {
    let rms = |output: &usize| normalised_output_rms(&fitted.train, *output);
    (0..problem.outputs.len()).max_by(|a, b| rms(a).total_cmp(&rms(b)))
}

/// The drives whose columns have noise.
fn noisy_drives(problem: &Problem) -> impl Iterator<Item = &MeasuredDrive> {
    problem.drives.iter().zip(&problem.drive_sigma).filter(|(_, sigma)| **sigma > 0.0).map(|(drive, _)| drive)
}

/// The mean squared residual of every output that noise of the drives causes, in units of sigma squared. Zeros if no
/// drive has noise.
///
/// It is the mean over simulations: the patch is fitted to its own output with more noise on the drives.
fn drive_noise_in_outputs(problem: &Problem, fitted: &FittedModel) -> Result<Vec<f64>, ModelError> {
    if noisy_drives(problem).next().is_none() {
        return Ok(vec![0.0; problem.outputs.len()]);
    }
    let seeds: Vec<u64> = (0..DRIVE_NOISE_DRAWS).collect();
    let draws = parallel::map(&seeds, |seed| fit_with_drive_noise(problem, fitted, *seed), |_| ());
    let draws = draws.into_iter().filter_map(Result::transpose).collect::<Result<Vec<FitResult>, _>>()?;
    let mean_square = |output| {
        let squares = draws.iter().map(|draw| normalised_output_rms(draw, output).powi(2));
        mean(&squares.collect::<Vec<f64>>())
    };
    Ok((0..problem.outputs.len()).map(mean_square).collect())
}

/// One simulation of drive noise. `None` if the patch cannot be run with it.
fn fit_with_drive_noise(
    problem: &Problem,
    fitted: &FittedModel,
    seed: u64,
) -> Result<Option<FitResult>, ModelError> {
    let records = records_with_drive_noise(problem, fitted, seed);
    let model = problem.model(&fitted.variant, &records, &problem.outputs)?;
    let fit_problem =
        FitProblem { max_iterations: DRAW_ITERATIONS, ..problem.fit_problem(&model, &records, true) };
    Ok(fit_problem.fit(&fitted.train.estimate))
}

/// The training records with the model's outputs as data, and with more noise on the drives.
fn records_with_drive_noise(problem: &Problem, fitted: &FittedModel, seed: u64) -> Vec<Record> {
    let indices = 0..problem.train.len() as u64;
    let records = problem.train.iter().zip(&fitted.train.residuals).zip(indices);
    let with_noise = |((record, residuals), index): ((&Record, &Vec<Vec<f64>>), u64)| {
        let drives = record.drives.iter().zip(&problem.drive_sigma).zip(0..);
        let noisy_drive = |((drive, sigma), drive_index): ((&Vec<f64>, &f64), u64)| {
            let noise = standard_normal((seed << 40) + (index << 8) + drive_index, drive.len());
            drive.iter().zip(noise).map(|(value, noise)| value + sigma * noise).collect()
        };
        let outputs = (0..problem.outputs.len())
            .map(|output| problem.model_output(record, residuals, output))
            .collect();
        Record { drives: drives.map(noisy_drive).collect(), outputs, ..record.clone() }
    };
    records.map(with_noise).collect()
}

/// The slow noise of a sensor that explains the residuals better than an unknown force with this log-likelihood ratio.
/// `None` if there is none. Of several outputs it is the one with the likeliest noise.
pub(crate) fn slow_sensor_noise(problem: &Problem, fitted: &FittedModel, evidence: f64) -> Option<SlowNoise> {
    let intervals: Vec<f64> = problem.train.iter().map(|record| record.interval).collect();
    let each = problem.outputs.iter().enumerate().map(|(output, name)| {
        let (log_likelihood, correlation_time) =
            likeliest_slow_noise(&fitted.train.residuals, &intervals, output);
        (log_likelihood, SlowNoise { output: name.clone(), correlation_time })
    });
    let each: Vec<(f64, SlowNoise)> = each.collect();
    let sum: f64 = each.iter().map(|(log_likelihood, _)| log_likelihood.max(0.0)).sum();
    let likeliest = each.into_iter().max_by(|(a, _), (b, _)| a.total_cmp(b));
    likeliest.map(|(_, noise)| noise).filter(|_| sum > evidence + LOG_LIKELIHOOD_MARGIN)
}

/// The likeliest slow noise in the residuals of an output: its log-likelihood ratio to white noise, and its correlation
/// time in seconds. `intervals` contains the sampling interval of every record.
fn likeliest_slow_noise(residuals: &[Vec<Vec<f64>>], intervals: &[f64], output: usize) -> (f64, f64) {
    let tracks = residuals.iter().map(|record| record[output].as_slice());
    let shortest = intervals.iter().copied().fold(f64::INFINITY, f64::min);
    let tracks: Vec<_> = tracks.zip(intervals.iter().map(|interval| interval / shortest)).collect();
    let times = TIME_EXPONENTS.map(|exponent| 2f64.powi(exponent));
    let grid = times.flat_map(|time| VARIANCE_EXPONENTS.map(move |exponent| (time, 2f64.powi(exponent))));
    let candidates =
        grid.map(|(time, variance)| (log_likelihood_ratio(&tracks, time, variance), time * shortest));
    candidates.max_by(|(a, _), (b, _)| a.total_cmp(b)).unwrap_or((0.0, shortest))
}

/// The log-likelihood ratio of slow noise with white noise to white noise alone.
///
/// Each track comes with its sampling interval. `time` is the correlation time in the same unit. `variance` is that of
/// the slow noise relative to the white noise. The level of the noise is maximised out. The likelihood comes from a
/// Kalman filter with one state; missing samples only advance the state.
fn log_likelihood_ratio(tracks: &[(&[f64], f64)], time: f64, variance: f64) -> f64 {
    let (mut count, mut white_square, mut innovation_square, mut log_variance) = (0.0, 0.0, 0.0, 0.0_f64);
    for (track, interval) in tracks {
        let decay = libm::exp(-interval / time);
        let (mut state, mut state_variance) = (0.0, variance);
        for value in *track {
            if !value.is_nan() {
                let (innovation, innovation_variance) = (value - state, state_variance + 1.0);
                innovation_square += innovation * innovation / innovation_variance;
                log_variance += libm::log(innovation_variance);
                white_square += value * value;
                count += 1.0;
                state += state_variance / innovation_variance * innovation;
                state_variance /= innovation_variance;
            }
            state *= decay;
            state_variance = decay * decay * state_variance + (1.0 - decay * decay) * variance;
        }
    }
    if white_square > 0.0 {
        -0.5 * (count * libm::log(innovation_square / white_square) + log_variance)
    } else {
        0.0
    }
}

/// Whether the residuals are due to the drives: their noise or their values between samples. An effect must then not be
/// identified from them.
///
/// # Errors
/// If the patch cannot be run along the records.
pub(crate) fn is_drive_noise(problem: &Problem, fitted: &FittedModel) -> Result<bool, ModelError> {
    Ok(coloured_residual(problem, fitted)?.is_some_and(|finding| finding.is_from_drives()))
}

#[cfg(test)]
mod tests {
    use crate::fit::base_fit::fit_base;
    use std::path::Path;

    use serde_json::json;

    use super::*;
    use crate::Experiment;
    use patchcord_core::patch::Edit;

    /// 2000 samples of white noise of variance 1 with slow noise of a given decay per sample and variance.
    fn slow_and_white_noise(seed: u64, decay: f64, variance: f64) -> Vec<f64> {
        let white_noise = standard_normal(seed, 2000);
        let mut level = 0.0;
        let scale = (variance * (1.0 - decay * decay)).sqrt();
        let noise = standard_normal(seed + 1, 2000).into_iter().zip(white_noise).map(|(slow, white)| {
            level = decay * level + scale * slow;
            level + white
        });
        noise.collect()
    }

    #[test]
    fn slow_noise_is_likelier_than_white_noise_only_if_it_is_present() {
        let likeliest = |track: &[f64]| {
            let tracks = [&track[..1000], &track[1000..]];
            let residuals = tracks.map(|track| vec![track.to_vec()]).to_vec();
            likeliest_slow_noise(&residuals, &[0.01, 0.01], 0)
        };
        let (ratio, seconds) = likeliest(&slow_and_white_noise(3, (-1.0_f64 / 16.0).exp(), 4.0));
        assert!(ratio > 300.0 && (0.08..=0.32).contains(&seconds), "{ratio} {seconds}");
        let (ratio, _) = likeliest(&standard_normal(5, 2000));
        assert!(ratio < 3.0, "{ratio}");
    }

    #[test]
    #[ignore = "takes several seconds"]
    fn divergence_is_reported_as_the_source_if_drive_noise_grows() {
        let path = Path::new("tests/hidden/nothing/experiment.json");
        let mut experiment = Experiment::read(path).unwrap_or_else(|error| panic!("{error}"));
        let wrong_sign = [
            Edit::new("elements/BX", json!({"kind": "inverter", "in": "IX"})),
            Edit::new("elements/PK/in", json!("BX")),
        ];
        experiment.patch = experiment.patch.with_edits("turned.json", &wrong_sign).unwrap();
        for (record, seed) in experiment.train.iter_mut().chain(&mut experiment.validation).zip(0..) {
            record.drives.iter_mut().chain(&mut record.outputs).for_each(|column| column.truncate(400));
            let noise = standard_normal(seed, 400);
            record.drives[0].iter_mut().zip(noise).for_each(|(force, noise)| *force += 0.05 * noise);
        }
        let problem = Problem::of(&experiment).unwrap();
        let base = fit_base(&problem, &experiment.patch, &experiment.fit, 1).unwrap().unwrap();
        let finding = coloured_residual(&problem, &base).unwrap().unwrap();
        assert_eq!(finding.source, ResidualSource::Divergence(vec!["F".to_owned()]), "{finding:?}");
    }

    /// Two neighbouring samples have a bivariate normal distribution.
    #[test]
    fn kalman_filter_gives_the_likelihood_of_a_bivariate_normal_distribution() {
        let (time, variance, values) = (3.0_f64, 2.0_f64, [0.7, -1.1]);
        let (total_variance, covariance) = (variance + 1.0, variance * (-1.0 / time).exp());
        let determinant = total_variance * total_variance - covariance * covariance;
        let [a, b] = values;
        let square = (total_variance * (a * a + b * b) - 2.0 * covariance * a * b) / determinant;
        let expected = -0.5 * (2.0 * (square / (a * a + b * b)).ln() + determinant.ln());
        let ratio = log_likelihood_ratio(&[(&[f64::NAN, a, b], 1.0)], time, variance);
        assert!((ratio - expected).abs() < 1e-12, "{ratio} {expected}");
        let shorter_interval = log_likelihood_ratio(&[(&[a, b], 0.1)], 0.1 * time, variance);
        assert!((shorter_interval - expected).abs() < 1e-12, "{shorter_interval} {expected}");
    }
}
