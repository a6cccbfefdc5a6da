//! What is left of data although nothing is missing, and is not white: what noise of the fed drives brings, and slow noise of a
//! sensor.

use std::ops::RangeInclusive;

use super::blind::over_sigma;
use super::dice::normal;
use super::experiment::Feed;
use super::fit::{Fitted, Task};
use super::model::ModelError;
use super::problem::Problem;
use super::record::Record;
use super::runaway::ADVICE;
use super::score::rms_about_means;
use super::stage::Stage;
use super::statistics::mean;
use patchcord_analysis::instruments::number;
use patchcord_analysis::pool;

/// So often noise of the drives is drawn.
const DRAWN: u64 = 32;
/// What is left beside noise of the sensors is that of the drives up to so many times what draws of it bring in the mean, in squares:
/// one in a hundred draws brings more where force drives a mass, whose place wanders off.
const BROUGHT: f64 = 6.0;
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

impl SlowNoise {
    /// The same in words.
    pub fn sentence(&self) -> String {
        format!(
            "what is left of {} goes like slow noise of its sensor, which that remembers for about {} s, rather than like a force at any junction",
            self.output,
            number(self.seconds)
        )
    }
}

/// What is left although nothing is missing: of the output of which that is most.
#[derive(Debug, Clone, PartialEq)]
pub struct NotWhite {
    /// The output.
    pub output: String,
    /// What is left of it, rms over its noise.
    pub left: f64,
    /// What brings it.
    pub cause: Cause,
}

/// What brings residuals that are not white although nothing is missing.
#[derive(Debug, Clone, PartialEq)]
pub enum Cause {
    /// Noise of the output itself.
    Own,
    /// Noise of these drives, which brings so much on average, rms over the noise of the output.
    Drives(Vec<String>, f64),
    /// The patch runs away: noise of these drives grows to more than the output moves, as does what is left.
    Runaway(Vec<String>),
    /// Straight lines between the samples of these drives: where they go on smoothly so much is left, rms over the noise.
    Between(Vec<String>, f64),
}

impl NotWhite {
    /// Whether it is how drives were measured that brings it, or what the patch makes of that, rather than less than the noise of the output.
    pub fn is_of_drives(&self) -> bool {
        self.cause != Cause::Own
    }

    /// The same in words.
    pub fn sentence(&self) -> String {
        let (output, left) = (&self.output, number(self.left));
        match &self.cause {
            Cause::Drives(drives, brought) => format!(
                "what is left of {output}, {left} times its noise, is no more than noise of {} may bring, {} times: measure that better, or tell its \"sigma\", which is 0 of what is set and not measured",
                drives.join(", "),
                number((1.0 + BROUGHT * brought * brought).sqrt())
            ),
            Cause::Runaway(drives) => format!(
                "the patch runs away: what is left of {output}, {left} times its noise, is more than that moves, and noise of {} would grow as far: {ADVICE}",
                drives.join(", ")
            ),
            Cause::Between(drives, smooth) => format!(
                "what is left of {output}, {left} times its noise, is what straight lines between the samples of {} bring: going on smoothly it leaves {} times; write \"hold\": \"smooth\" if that is how it went, or take samples closer together",
                drives.join(", "),
                number(*smooth)
            ),
            Cause::Own => format!(
                "what is left of {output} is no more than its noise, {left} times, but not white: that noise is slow, or less than that, which its \"sigma\" would tell"
            ),
        }
    }
}

/// Slow noise is taken for what is left where its likelihood lies so far above that of the likeliest force, as a logarithm: the
/// force is sought at few times, and those lie up to 45 apart where there is a force that is hardly seen.
const LIKELIER: f64 = 60.0;

impl Problem {
    /// That a stage leaves structure, but no more of any output than noise brings, its own and that of the drives, or what these do
    /// between samples; nothing where it leaves more, or no structure.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records.
    pub(super) fn not_white(&self, stage: &Stage, threads: usize) -> Result<Option<NotWhite>, ModelError> {
        if !stage.leaves_structure() {
            return Ok(None);
        }
        if let Some(known) = stage.not_white.get() {
            return Ok(known.clone());
        }
        let found = match self.between(stage)? {
            None => self.drawn_against(stage, threads)?,
            between => between,
        };
        Ok(stage.not_white.get_or_init(|| found).clone())
    }

    /// That of drives that go on smoothly between samples.
    fn between(&self, stage: &Stage) -> Result<Option<NotWhite>, ModelError> {
        let Some((smooth, drives)) = self.smoothed(stage)? else { return Ok(None) };
        let own = self.loudest(stage).map(|output| NotWhite {
            output: self.outputs[output].clone(),
            left: over_sigma(&stage.train, output),
            cause: Cause::Between(drives, over_sigma(&smooth.train, output)),
        });
        Ok(own)
    }

    /// That of noise, found by draws.
    fn drawn_against(&self, stage: &Stage, threads: usize) -> Result<Option<NotWhite>, ModelError> {
        let left = |output| over_sigma(&stage.train, output);
        let brought = self.brought_by_drives(stage, threads)?;
        let is_noise = |output: usize| left(output).powi(2) <= 1.0 + BROUGHT * brought[output];
        let drives = || self.noisy_drives().map(|feed| feed.drive.clone()).collect();
        let cause = |output: usize| match left(output) {
            left if left <= 1.0 => Cause::Own,
            left if left > self.moves(output) => Cause::Runaway(drives()),
            _ => Cause::Drives(drives(), brought[output].sqrt()),
        };
        let own = self.loudest(stage).filter(|_| (0..brought.len()).all(is_noise)).map(|output| NotWhite {
            output: self.outputs[output].clone(),
            left: left(output),
            cause: cause(output),
        });
        Ok(own)
    }

    /// How far an output goes about its mean in the training records, rms over its noise.
    pub(super) fn moves(&self, output: usize) -> f64 {
        rms_about_means(self.train.iter().map(|record| record.outputs[output].as_slice()))
            / self.sigma[output]
    }

    /// The output of which most is left.
    fn loudest(&self, stage: &Stage) -> Option<usize> {
        let left = |output: &usize| over_sigma(&stage.train, *output);
        (0..self.outputs.len()).max_by(|a, b| left(a).total_cmp(&left(b)))
    }

    /// The drives whose columns have noise.
    fn noisy_drives(&self) -> impl Iterator<Item = &Feed> {
        self.drives.iter().zip(&self.drive_sigma).filter(|(_, sigma)| **sigma > 0.0).map(|(feed, _)| feed)
    }

    /// What noise of the drives brings to every output, mean square over its noise: what the patch, fitted again, leaves of what it
    /// gives itself where its drives are fed with more such noise.
    fn brought_by_drives(&self, stage: &Stage, threads: usize) -> Result<Vec<f64>, ModelError> {
        if self.noisy_drives().next().is_none() {
            return Ok(vec![0.0; self.outputs.len()]);
        }
        let seeds: Vec<u64> = (0..DRAWN).collect();
        let drawn = pool::each(&seeds, threads, |seed| self.brought_by(stage, *seed), |_| ());
        let drawn = drawn.into_iter().filter_map(Result::transpose).collect::<Result<Vec<Fitted>, _>>()?;
        let brought = |output| {
            let each = drawn.iter().map(|own| over_sigma(own, output).powi(2));
            mean(&each.collect::<Vec<f64>>())
        };
        Ok((0..self.outputs.len()).map(brought).collect())
    }

    /// The same of one draw; nothing where the patch cannot be run with it.
    fn brought_by(&self, stage: &Stage, seed: u64) -> Result<Option<Fitted>, ModelError> {
        let records = self.fed_with_noise(stage, seed);
        let model = self.model(&stage.version, &records, &self.outputs)?;
        let task = Task { most_rounds: ROUNDS, ..self.task(&model, &records, true) };
        Ok(task.fit(&stage.train.point))
    }

    /// The training records with what a stage gives as data, and more noise on their drives.
    fn fed_with_noise(&self, stage: &Stage, seed: u64) -> Vec<Record> {
        let places = 0..self.train.len() as u64;
        let records = self.train.iter().zip(&stage.train.residuals).zip(places);
        let with = |((record, left), place): ((&Record, &Vec<Vec<f64>>), u64)| {
            let drives = record.drives.iter().zip(&self.drive_sigma).zip(0..);
            let noisy = |((drive, sigma), number): ((&Vec<f64>, &f64), u64)| {
                let noise = normal((seed << 40) + (place << 8) + number, drive.len());
                drive.iter().zip(noise).map(|(value, noise)| value + sigma * noise).collect()
            };
            let outputs = (0..self.outputs.len()).map(|output| self.made(record, left, output)).collect();
            Record { drives: drives.map(noisy).collect(), outputs, ..record.clone() }
        };
        records.map(with).collect()
    }

    /// Slow noise of an output that explains what is left better than a force of this evidence.
    pub(super) fn slow_noise(&self, stage: &Stage, evidence: f64) -> Option<SlowNoise> {
        let intervals: Vec<f64> = self.train.iter().map(|record| record.interval).collect();
        let each = self.outputs.iter().enumerate().map(|(output, name)| {
            let (likely, seconds) = slowness(&stage.train, &intervals, output);
            (likely, SlowNoise { output: name.clone(), seconds })
        });
        let each: Vec<(f64, SlowNoise)> = each.collect();
        let all: f64 = each.iter().map(|(likely, _)| likely.max(0.0)).sum();
        let most = each.into_iter().max_by(|(a, _), (b, _)| a.total_cmp(b));
        most.map(|(_, own)| own).filter(|_| all > evidence + LIKELIER)
    }
}

/// How likely it is that what is left of an output is slow noise beside white noise, as the logarithm over that of white noise alone,
/// and how long it remembers; records are sampled at these intervals.
fn slowness(fitted: &Fitted, intervals: &[f64], output: usize) -> (f64, f64) {
    let tracks = fitted.residuals.iter().map(|record| record[output].as_slice());
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

#[cfg(test)]
mod tests {
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
            let fitted = crate::score::tests::fitted(residuals);
            slowness(&fitted, &[0.01, 0.01], 0)
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
        let base = problem.base(&experiment.patch, &experiment.fit, 1).unwrap().unwrap();
        let own = problem.not_white(&base, 2).unwrap().unwrap();
        assert_eq!(own.cause, Cause::Runaway(vec!["F".to_owned()]), "{}", own.sentence());
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
