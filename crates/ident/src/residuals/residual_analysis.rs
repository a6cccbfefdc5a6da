//! What is left of data although nothing is missing, and is not white: what noise of the fed drives brings, and slow noise of a
//! sensor.

use std::ops::RangeInclusive;

use crate::data::experiment::Feed;
use crate::data::record::Record;
use crate::fit::coloured_residual::{Cause, NotWhite};
use crate::fit::estimate::{Fitted, over_sigma};
use crate::fit::fitted_model::Stage;
use crate::fit::levenberg_marquardt::Task;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::residuals::intersample::refit_smoothly;
use crate::residuals::output_motion::motion_over_noise;
use crate::statistics::descriptive::mean;
use crate::statistics::rng::normal;
use patchcord_analysis::pool;

/// So often noise of the drives is drawn.
const DRAWN: u64 = 32;
/// What is left beside noise of the sensors is that of the drives up to so many times what draws of it bring in the mean, in squares:
/// one in a hundred draws brings more where force drives a mass, whose place wanders off.
pub(crate) const BROUGHT: f64 = 6.0;
/// So often the derivatives are worked out for a draw: it moves the patch but a little.
const ROUNDS: usize = 2;

/// Slow noise remembers for so many samples,
const TIMES: RangeInclusive<i32> = 1..=10;
/// and has so many times the variance of the white noise beside it, in powers of two.
const VARIANCES: RangeInclusive<i32> = -4..=12;

/// Slow noise of an output.
#[derive(Debug, Clone, PartialEq)]
pub struct SlowNoise {
    /// The output.
    pub output: String,
    /// Over how many seconds it remembers.
    pub seconds: f64,
}

/// Slow noise is taken for what is left where its likelihood lies so far above that of the likeliest force, as a logarithm: the
/// force is sought at few times, and those lie up to 45 apart where there is a force that is hardly seen.
const LIKELIER: f64 = 60.0;

/// That a stage leaves structure, but no more of any output than noise brings, its own and that of the drives, or what these do
/// between samples; nothing where it leaves more, or no structure.
///
/// # Errors
/// When the patch cannot be run beside the records.
pub(crate) fn coloured_residual(
    problem: &Problem,
    stage: &Stage,
    threads: usize,
) -> Result<Option<NotWhite>, ModelError> {
    if !stage.leaves_structure() {
        return Ok(None);
    }
    if let Some(known) = stage.not_white.get() {
        return Ok(known.clone());
    }
    let found = match source_in_intersample(problem, stage)? {
        None => source_in_noise(problem, stage, threads)?,
        between => between,
    };
    Ok(stage.not_white.get_or_init(|| found).clone())
}

/// That of drives that go on smoothly between samples.
fn source_in_intersample(problem: &Problem, stage: &Stage) -> Result<Option<NotWhite>, ModelError> {
    let Some((smooth, drives)) = refit_smoothly(problem, stage)? else { return Ok(None) };
    let own = loudest_output(problem, stage).map(|output| NotWhite {
        output: problem.outputs[output].clone(),
        left: over_sigma(&stage.train, output),
        cause: Cause::Between(drives, over_sigma(&smooth.train, output)),
    });
    Ok(own)
}

/// That of noise, found by draws.
fn source_in_noise(problem: &Problem, stage: &Stage, threads: usize) -> Result<Option<NotWhite>, ModelError> {
    let left = |output| over_sigma(&stage.train, output);
    let brought = brought_by_drives(problem, stage, threads)?;
    let is_noise = |output: usize| left(output).powi(2) <= 1.0 + BROUGHT * brought[output];
    let drives = || noisy_drives(problem).map(|feed| feed.drive.clone()).collect();
    let cause = |output: usize| match left(output) {
        left if left <= 1.0 => Cause::Own,
        left if left > motion_over_noise(problem, output) => Cause::Runaway(drives()),
        _ => Cause::Drives(drives(), brought[output].sqrt()),
    };
    let own = loudest_output(problem, stage).filter(|_| (0..brought.len()).all(is_noise)).map(|output| {
        NotWhite { output: problem.outputs[output].clone(), left: left(output), cause: cause(output) }
    });
    Ok(own)
}

/// The output of which most is left.
fn loudest_output(problem: &Problem, stage: &Stage) -> Option<usize> {
    let left = |output: &usize| over_sigma(&stage.train, *output);
    (0..problem.outputs.len()).max_by(|a, b| left(a).total_cmp(&left(b)))
}

/// The drives whose columns have noise.
fn noisy_drives(problem: &Problem) -> impl Iterator<Item = &Feed> {
    problem.drives.iter().zip(&problem.drive_sigma).filter(|(_, sigma)| **sigma > 0.0).map(|(feed, _)| feed)
}

/// What noise of the drives brings to every output, mean square over its noise: what the patch, fitted again, leaves of what it
/// gives itself where its drives are fed with more such noise.
fn brought_by_drives(problem: &Problem, stage: &Stage, threads: usize) -> Result<Vec<f64>, ModelError> {
    if noisy_drives(problem).next().is_none() {
        return Ok(vec![0.0; problem.outputs.len()]);
    }
    let seeds: Vec<u64> = (0..DRAWN).collect();
    let drawn = pool::each(&seeds, threads, |seed| brought_by_draw(problem, stage, *seed), |_| ());
    let drawn = drawn.into_iter().filter_map(Result::transpose).collect::<Result<Vec<Fitted>, _>>()?;
    let brought = |output| {
        let each = drawn.iter().map(|own| over_sigma(own, output).powi(2));
        mean(&each.collect::<Vec<f64>>())
    };
    Ok((0..problem.outputs.len()).map(brought).collect())
}

/// The same of one draw; nothing where the patch cannot be run with it.
fn brought_by_draw(problem: &Problem, stage: &Stage, seed: u64) -> Result<Option<Fitted>, ModelError> {
    let records = fed_with_noise(problem, stage, seed);
    let model = problem.model(&stage.version, &records, &problem.outputs)?;
    let task = Task { most_rounds: ROUNDS, ..problem.task(&model, &records, true) };
    Ok(task.fit(&stage.train.point))
}

/// The training records with what a stage gives as data, and more noise on their drives.
fn fed_with_noise(problem: &Problem, stage: &Stage, seed: u64) -> Vec<Record> {
    let places = 0..problem.train.len() as u64;
    let records = problem.train.iter().zip(&stage.train.residuals).zip(places);
    let with = |((record, left), place): ((&Record, &Vec<Vec<f64>>), u64)| {
        let drives = record.drives.iter().zip(&problem.drive_sigma).zip(0..);
        let noisy = |((drive, sigma), number): ((&Vec<f64>, &f64), u64)| {
            let noise = normal((seed << 40) + (place << 8) + number, drive.len());
            drive.iter().zip(noise).map(|(value, noise)| value + sigma * noise).collect()
        };
        let outputs = (0..problem.outputs.len()).map(|output| problem.made(record, left, output)).collect();
        Record { drives: drives.map(noisy).collect(), outputs, ..record.clone() }
    };
    records.map(with).collect()
}

/// Slow noise of an output that explains what is left better than a force of this evidence.
pub(crate) fn slow_sensor_noise(problem: &Problem, stage: &Stage, evidence: f64) -> Option<SlowNoise> {
    let intervals: Vec<f64> = problem.train.iter().map(|record| record.interval).collect();
    let each = problem.outputs.iter().enumerate().map(|(output, name)| {
        let (likely, seconds) = slowness(&stage.train.residuals, &intervals, output);
        (likely, SlowNoise { output: name.clone(), seconds })
    });
    let each: Vec<(f64, SlowNoise)> = each.collect();
    let all: f64 = each.iter().map(|(likely, _)| likely.max(0.0)).sum();
    let most = each.into_iter().max_by(|(a, _), (b, _)| a.total_cmp(b));
    most.map(|(_, own)| own).filter(|_| all > evidence + LIKELIER)
}

/// How likely it is that what is left of an output is slow noise beside white noise, as the logarithm over that of white noise alone,
/// and how long it remembers; records are sampled at these intervals.
fn slowness(residuals: &[Vec<Vec<f64>>], intervals: &[f64], output: usize) -> (f64, f64) {
    let tracks = residuals.iter().map(|record| record[output].as_slice());
    let shortest = intervals.iter().copied().fold(f64::INFINITY, f64::min);
    let tracks: Vec<_> = tracks.zip(intervals.iter().map(|own| own / shortest)).collect();
    let times = TIMES.map(|power| 2f64.powi(power));
    let each = times.flat_map(|time| VARIANCES.map(move |power| (time, 2f64.powi(power))));
    let likely = each.map(|(time, variance)| (likelihood(&tracks, time, variance), time * shortest));
    likely.max_by(|(a, _), (b, _)| a.total_cmp(b)).unwrap_or((0.0, shortest))
}

/// Logarithm of the likelihood of tracks, each with the time from sample to sample, as white noise and noise that remembers for
/// such a time and has so many times its variance, over that as white noise alone; how large both are together is free. Kalman's
/// filter of one state.
fn likelihood(tracks: &[(&[f64], f64)], time: f64, variance: f64) -> f64 {
    let (mut count, mut alone, mut misfit, mut spread) = (0.0, 0.0, 0.0, 0.0_f64);
    for (track, interval) in tracks {
        let keeps = libm::exp(-interval / time);
        let (mut expected, mut unsure) = (0.0, variance);
        for value in *track {
            if !value.is_nan() {
                let (off, all) = (value - expected, unsure + 1.0);
                misfit += off * off / all;
                spread += libm::log(all);
                alone += value * value;
                count += 1.0;
                expected += unsure / all * off;
                unsure /= all;
            }
            expected *= keeps;
            unsure = keeps * keeps * unsure + (1.0 - keeps * keeps) * variance;
        }
    }
    if alone > 0.0 { -0.5 * (count * libm::log(misfit / alone) + spread) } else { 0.0 }
}

/// Whether what a stage leaves is what noise of the drives brings: nothing that an effect might be named after.
pub(crate) fn is_drive_noise(problem: &Problem, stage: &Stage, threads: usize) -> Result<bool, ModelError> {
    Ok(coloured_residual(problem, stage, threads)?.is_some_and(|own| own.is_of_drives()))
}

#[cfg(test)]
mod tests {
    use crate::fit::base_fit::fit_base;
    use std::path::Path;

    use serde_json::json;

    use super::*;
    use crate::Experiment;
    use patchcord_core::patch::Edit;

    fn slow(seed: u64, keeps: f64, variance: f64) -> Vec<f64> {
        let drawn = normal(seed, 2000);
        let mut level = 0.0;
        let size = (variance * (1.0 - keeps * keeps)).sqrt();
        let own = normal(seed + 1, 2000).into_iter().zip(drawn).map(|(slow, white)| {
            level = keeps * level + size * slow;
            level + white
        });
        own.collect()
    }

    #[test]
    fn slow_noise_is_likelier_than_white_noise_where_it_is() {
        let best = |track: &[f64]| {
            let tracks = [&track[..1000], &track[1000..]];
            let residuals = tracks.map(|own| vec![own.to_vec()]).to_vec();
            slowness(&residuals, &[0.01, 0.01], 0)
        };
        let (likely, seconds) = best(&slow(3, (-1.0_f64 / 16.0).exp(), 4.0));
        assert!(likely > 300.0 && (0.08..=0.32).contains(&seconds), "{likely} {seconds}");
        let (likely, _) = best(&normal(5, 2000));
        assert!(likely < 3.0, "{likely}");
    }

    #[test]
    #[ignore = "takes several seconds"]
    fn a_patch_that_runs_away_is_told_as_that() {
        let path = Path::new("tests/hidden/nothing/experiment.json");
        let mut experiment = Experiment::read(path).unwrap_or_else(|error| panic!("{error}"));
        let turned = [
            Edit::new("elements/BX", json!({"kind": "inverter", "in": "IX"})),
            Edit::new("elements/PK/in", json!("BX")),
        ];
        experiment.patch = experiment.patch.edited("turned.json", &turned).unwrap();
        for (record, place) in experiment.train.iter_mut().chain(&mut experiment.test).zip(0..) {
            record.drives.iter_mut().chain(&mut record.outputs).for_each(|column| column.truncate(400));
            let noise = normal(place, 400);
            record.drives[0].iter_mut().zip(noise).for_each(|(force, noise)| *force += 0.05 * noise);
        }
        let problem = Problem::of(&experiment).unwrap();
        let base = fit_base(&problem, &experiment.patch, &experiment.fit, 1).unwrap().unwrap();
        let own = coloured_residual(&problem, &base, 2).unwrap().unwrap();
        assert_eq!(own.cause, Cause::Runaway(vec!["F".to_owned()]), "{own:?}");
    }

    /// Of two neighbours the likelihood is that of a plane of normal numbers.
    #[test]
    fn the_filter_gives_the_likelihood_of_its_definition() {
        let (time, variance, values) = (3.0_f64, 2.0_f64, [0.7, -1.1]);
        let (all, both) = (variance + 1.0, variance * (-1.0 / time).exp());
        let determinant = all * all - both * both;
        let [a, b] = values;
        let misfit = (all * (a * a + b * b) - 2.0 * both * a * b) / determinant;
        let expected = -0.5 * (2.0 * (misfit / (a * a + b * b)).ln() + determinant.ln());
        let found = likelihood(&[(&[f64::NAN, a, b], 1.0)], time, variance);
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        let further_apart = likelihood(&[(&[a, b], 0.1)], 0.1 * time, variance);
        assert!((further_apart - expected).abs() < 1e-12, "{further_apart} {expected}");
    }
}
