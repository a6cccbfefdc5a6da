//! The experiment that distinguishes two effects.
//!
//! 1. Many drive signals are proposed: four shapes with several amplitudes and periods, for each drive of the patch.
//! 2. Both patches are simulated from rest with their fitted parameters. The drives with the largest differences are
//!    kept.
//! 3. One patch is fitted to the prediction of the other, first linearised, then completely for the best drives. Only
//!    the remaining difference counts.
//! 4. Of the two ways to fit, the one with the smaller difference counts. If one patch has fewer parameters, that
//!    patch is fitted.

use std::cmp::Ordering;

use crate::data::experiment::MeasuredDrive;
use crate::data::record::Record;
use crate::fit::estimate::Estimate;
use crate::fit::fitted_model::FittedModel;
use crate::fit::levenberg_marquardt::{FitProblem, stacked_column};
use crate::fit::model::{Model, ModelError, OutputTrajectory, RunValues};
use crate::fit::problem::Problem;
use crate::statistics::acceptance::RIVAL_Z;
use crate::statistics::block_comparison::expected_advantage;
use crate::statistics::descriptive::extremes;
use crate::statistics::projection::{dot, orthonormal, remove_projections};
use patchcord_core::machines::REFERENCE;

/// Amplitudes that are tried, as multiples of the largest excursion of the drive in the training records.
const AMPLITUDES: [f64; 4] = [0.25, 0.5, 1.0, 2.0];
/// Number of periods that are tried. They form a geometric sequence from the length of the record down.
const PERIOD_COUNT: i32 = 8;
/// Shortest period that is tried, in samples.
const SHORTEST_PERIOD: f64 = 10.0;
/// Time of a step, as a fraction of the record.
const STEP_TIME_FRACTION: f64 = 0.1;
/// Number of drives, those with the largest differences, for which the linearised fit is computed.
const LINEARISED_DRIVES: usize = 16;
/// Number of drives, the best ones of the linearised fits, for which the complete fit is computed.
const REFITTED_DRIVES: usize = 4;
/// Expected difference of a decisive experiment, as a multiple of the one that makes a trial no rival. It leaves room
/// for chance.
const DECISIVE_FACTOR: f64 = 1.5;

/// The shape of a drive signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// It jumps to the amplitude after a tenth of the record, and stays there.
    Step,
    /// It rises and falls at a constant rate.
    Ramps,
    /// A sine.
    Sine,
    /// A quarter of the period at the positive amplitude, a quarter at rest, a quarter at the negative amplitude, a
    /// quarter at rest.
    Reversals,
}

impl Shape {
    /// The shapes with a period.
    const PERIODIC: [Shape; 3] = [Shape::Ramps, Shape::Sine, Shape::Reversals];

    /// The name of the shape in reports and documents.
    pub fn as_str(self) -> &'static str {
        match self {
            Shape::Step => "step",
            Shape::Ramps => "ramps",
            Shape::Sine => "sine",
            Shape::Reversals => "reversals",
        }
    }

    /// The value, from -1 to 1, at this time in periods. The period of a step is the time before it.
    fn at(self, periods: f64) -> f64 {
        let part = periods.fract();
        match self {
            Shape::Step => f64::from(u8::from(periods >= 1.0)),
            Shape::Sine => libm::sin(std::f64::consts::TAU * part),
            Shape::Ramps if part < 0.25 => 4.0 * part,
            Shape::Ramps if part < 0.75 => 2.0 - 4.0 * part,
            Shape::Ramps => 4.0 * part - 4.0,
            Shape::Reversals => [1.0, 0.0, -1.0, 0.0][(4.0 * part) as usize % 4],
        }
    }
}

/// A drive signal that distinguishes two effects, and the predictions of both patches.
#[derive(Debug, Clone)]
pub struct DiscriminatingExperiment {
    /// The two effects, each with its place.
    pub effects: [String; 2],
    /// The drive.
    pub drive: String,
    /// Unit of the drive.
    pub unit: String,
    /// Shape of the signal.
    pub shape: Shape,
    /// Amplitude to either side of `rest`, in the unit of the drive. A step goes to the positive side only.
    pub amplitude: f64,
    /// Value at rest, in the unit of the drive.
    pub rest: f64,
    /// Period in seconds. For a step, it is the time before the step.
    pub period: f64,
    /// Whether the signal has a sign that the drive never has in the records.
    pub reverses_sign: bool,
    /// Remaining difference of the predictions for every output: rms over the noise.
    pub difference_rms: Vec<f64>,
    /// The expected difference in standard errors of the comparison.
    pub standard_errors: f64,
    /// The outputs, in the order of `difference_rms` and of the predictions.
    pub(crate) outputs: Vec<String>,
    /// The drives that the data feed, in the order of the record.
    pub(crate) feeds: Vec<MeasuredDrive>,
    /// The record of the experiment: its drives and times. Its outputs are not meaningful.
    pub(crate) record: Record,
    /// The predictions of both patches for every output, in the order of `effects`.
    pub(crate) predictions: [OutputTrajectory; 2],
}

impl DiscriminatingExperiment {
    /// Whether the experiment is expected to distinguish the two effects.
    pub fn is_decisive(&self) -> bool {
        self.standard_errors > DECISIVE_FACTOR * RIVAL_Z
    }
}

/// A proposed drive signal.
#[derive(Debug, Clone, Copy)]
struct DriveProposal {
    /// Index of the drive among those that the data feed.
    drive: usize,
    shape: Shape,
    /// In the unit of the drive.
    amplitude: f64,
    /// In seconds.
    period: f64,
}

/// The rest value of a drive and its limits, in the unit of the drive.
#[derive(Debug, Clone, Copy)]
struct DriveLimits {
    rest: f64,
    /// Largest excursion from the rest value in the training records.
    excursion: f64,
    /// Least and largest value that the machine unit and the sign of the drive permit.
    allowed: [f64; 2],
}

/// The difference of two predictions after the fit of one patch to the other.
struct PredictionDifference {
    /// Rms over the noise, by output.
    rms: Vec<f64>,
    standard_errors: f64,
}

/// The predictions of both patches for a proposed drive. `proposal` is its index.
struct ProposalRun {
    proposal: usize,
    predictions: [OutputTrajectory; 2],
}

/// One of two effects that the data cannot distinguish.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rival<'a> {
    /// The effect and its place, for example "leak at I2".
    pub name: &'a str,
    /// The patch with the effect, fitted.
    pub model: &'a FittedModel,
}

/// The drive that distinguishes two effects best. Returns None if no proposed drive can be run. `noise` is the
/// variance of the noise times its autocorrelation time in samples.
///
/// Drives keep the sign that they have in the records. Only if no such drive is decisive, drives of both signs are
/// tried.
///
/// # Errors
/// If a patch cannot be simulated with the proposed drives.
pub(crate) fn discriminating_experiment(
    problem: &Problem,
    rivals: [Rival<'_>; 2],
    noise: f64,
) -> Result<Option<DiscriminatingExperiment>, ModelError> {
    let same_sign = best_drive(problem, rivals, noise, false)?;
    if same_sign.as_ref().is_some_and(DiscriminatingExperiment::is_decisive)
        || (0..problem.drives.len()).all(|drive| has_both_signs(problem, drive))
    {
        return Ok(same_sign);
    }
    let both_signs = best_drive(problem, rivals, noise, true)?.filter(DiscriminatingExperiment::is_decisive);
    Ok(both_signs.or(same_sign))
}

/// The best drive among those that keep their sign or, with `can_reverse`, may have both signs.
fn best_drive(
    problem: &Problem,
    rivals: [Rival<'_>; 2],
    noise: f64,
    can_reverse: bool,
) -> Result<Option<DiscriminatingExperiment>, ModelError> {
    let Some(longest) = problem.train.iter().max_by_key(|record| record.len()) else { return Ok(None) };
    let limits: Vec<DriveLimits> =
        (0..problem.drives.len()).map(|drive| limits_of(problem, drive, can_reverse)).collect();
    let proposals: Vec<DriveProposal> =
        limits.iter().enumerate().flat_map(|(drive, limits)| limits.proposals(drive, longest)).collect();
    let records: Vec<Record> = proposals.iter().map(|proposal| proposal.record(longest, &limits)).collect();
    let comparison = Comparison { problem, rivals, records: &records, noise };
    let best = comparison.best(most_different_runs(problem, rivals, &records)?)?;
    Ok(best.map(|(difference, ProposalRun { proposal, predictions })| {
        let DriveProposal { drive, shape, amplitude, period } = proposals[proposal];
        DiscriminatingExperiment {
            effects: rivals.map(|rival| rival.name.to_owned()),
            drive: problem.drives[drive].drive.clone(),
            unit: problem.drives[drive].unit.text().to_owned(),
            shape,
            amplitude,
            rest: limits[drive].rest,
            period,
            reverses_sign: can_reverse && !has_both_signs(problem, drive),
            difference_rms: difference.rms,
            standard_errors: difference.standard_errors,
            outputs: problem.outputs.clone(),
            feeds: problem.drives.clone(),
            record: records[proposal].clone(),
            predictions,
        }
    }))
}

/// All samples of a drive in the training records.
fn drive_values(problem: &Problem, drive: usize) -> impl Iterator<Item = f64> + '_ {
    problem.train.iter().flat_map(move |record| &record.drives[drive]).copied()
}

/// Whether a drive has both signs in the training records.
fn has_both_signs(problem: &Problem, drive: usize) -> bool {
    let [least, most] = extremes(drive_values(problem, drive));
    least < 0.0 && most > 0.0
}

/// The limits of a drive. With both signs it rests at zero and may use the full machine unit. With one sign it rests
/// at its mean and keeps the sign.
fn limits_of(problem: &Problem, drive: usize, can_reverse: bool) -> DriveLimits {
    let [least, most] = extremes(drive_values(problem, drive));
    let full = REFERENCE * problem.drives[drive].per_volt.abs();
    let (rest, allowed) = if can_reverse || has_both_signs(problem, drive) {
        (0.0, [-full, full])
    } else {
        let mean = drive_values(problem, drive).sum::<f64>() / drive_values(problem, drive).count() as f64;
        (mean, if least < 0.0 { [-full, 0.0] } else { [0.0, full] })
    };
    DriveLimits { rest, excursion: (most - rest).max(rest - least), allowed }
}

/// The runs of the drives with the largest differences between both patches. Drives with which a patch cannot be run
/// are left out.
fn most_different_runs(
    problem: &Problem,
    rivals: [Rival<'_>; 2],
    records: &[Record],
) -> Result<Vec<ProposalRun>, ModelError> {
    let [one, other] =
        [predictions_of(problem, rivals[0], records)?, predictions_of(problem, rivals[1], records)?];
    let both = one.into_iter().zip(other).enumerate();
    let mut runs: Vec<(f64, ProposalRun)> = both
        .filter_map(|(proposal, (one, other))| {
            let predictions = [one?, other?];
            Some((squared_difference(problem, &predictions), ProposalRun { proposal, predictions }))
        })
        .collect();
    runs.sort_by(|a, b| b.0.total_cmp(&a.0));
    Ok(runs.into_iter().take(LINEARISED_DRIVES).map(|(_, run)| run).collect())
}

/// The predictions of a rival from rest, for every record. None for a record that cannot be run or overloads an
/// amplifier.
fn predictions_of(
    problem: &Problem,
    rival: Rival<'_>,
    records: &[Record],
) -> Result<Vec<Option<OutputTrajectory>>, ModelError> {
    let model = problem.model(&rival.model.variant, records, &problem.outputs)?;
    let estimate = estimate_at_rest(rival, &model);
    let initial = model.initial.iter().map(|parameter| parameter.value).collect();
    let choices = [RunValues { parameters: estimate.parameters, initial }];
    Ok((0..records.len())
        .map(|record| model.run_without_overload(record, &choices).pop().flatten())
        .collect())
}

/// Sum of the squared differences over the noise.
fn squared_difference(problem: &Problem, [one, other]: &[OutputTrajectory; 2]) -> f64 {
    let tracks = one.iter().zip(other).zip(&problem.sigma);
    tracks
        .map(|((one, other), sigma)| {
            one.iter().zip(other).map(|(a, b)| ((a - b) / sigma).powi(2)).sum::<f64>()
        })
        .sum()
}

/// Compares two rivals for many drives.
struct Comparison<'a> {
    problem: &'a Problem,
    rivals: [Rival<'a>; 2],
    /// One record per proposed drive.
    records: &'a [Record],
    /// Variance of the noise times its autocorrelation time in samples.
    noise: f64,
}

impl Comparison<'_> {
    /// The run with the largest remaining difference. None without runs.
    fn best(
        &self,
        runs: Vec<ProposalRun>,
    ) -> Result<Option<(PredictionDifference, ProposalRun)>, ModelError> {
        type Compared = Vec<(PredictionDifference, ProposalRun)>;
        let compare =
            |run: ProposalRun, is_complete: bool| Ok((self.smaller_difference(&run, is_complete)?, run));
        let sort = |runs: &mut Compared| {
            runs.sort_by(|a, b| b.0.standard_errors.total_cmp(&a.0.standard_errors));
        };
        let mut linearised: Compared =
            runs.into_iter().map(|run| compare(run, false)).collect::<Result<_, ModelError>>()?;
        sort(&mut linearised);
        let refitted = linearised.into_iter().take(REFITTED_DRIVES).map(|(_, run)| compare(run, true));
        let mut refitted: Compared = refitted.collect::<Result<_, ModelError>>()?;
        sort(&mut refitted);
        Ok(refitted.into_iter().next())
    }

    /// The smaller difference of the two ways to fit. If one patch has fewer parameters, only that patch is fitted:
    /// the other may contain it as a special case, and must then be worth its parameters.
    fn smaller_difference(
        &self,
        run: &ProposalRun,
        is_complete: bool,
    ) -> Result<PredictionDifference, ModelError> {
        let parameters = self.rivals.map(|rival| rival.model.variant.fit.len());
        match parameters[0].cmp(&parameters[1]) {
            Ordering::Less => self.difference(run, 0, is_complete),
            Ordering::Greater => self.difference(run, 1, is_complete),
            Ordering::Equal => {
                let [one, other] =
                    [self.difference(run, 0, is_complete)?, self.difference(run, 1, is_complete)?];
                Ok(if one.standard_errors < other.standard_errors { one } else { other })
            }
        }
    }

    /// The residual of a rival fitted to the prediction of the other one. The fit is linearised, or complete.
    fn difference(
        &self,
        run: &ProposalRun,
        fitted: usize,
        is_complete: bool,
    ) -> Result<PredictionDifference, ModelError> {
        let (rival, outputs) = (self.rivals[fitted], run.predictions[1 - fitted].clone());
        let records = [Record { outputs, ..self.records[run.proposal].clone() }];
        let model = self.problem.model(&rival.model.variant, &records, &self.problem.outputs)?;
        let task = self.problem.fit_problem(&model, &records, true);
        let start = estimate_at_rest(rival, &model);
        let fit = if is_complete { task.fit(&start) } else { None };
        let residual = fit.map_or_else(
            || linearised_residual(&task, &start, &run.predictions[fitted]),
            |fit| fit.residuals.into_iter().flatten().flatten().collect(),
        );
        let tracks: Vec<&[f64]> = residual.chunks(records[0].len()).collect();
        let rms = |track: &&[f64]| (dot(track, track) / track.len() as f64).sqrt();
        let rms = tracks.iter().map(rms).collect();
        Ok(PredictionDifference { rms, standard_errors: expected_advantage(&[tracks], self.noise).z_score() })
    }
}

/// The residual of a trajectory after a linearised fit of everything that is free.
fn linearised_residual(task: &FitProblem<'_>, start: &Estimate, trajectory: &OutputTrajectory) -> Vec<f64> {
    let at = task.coordinates(start);
    let mut residual: Vec<f64> =
        (0..trajectory.len()).flat_map(|output| task.residuals(&at, 0, output, trajectory)).collect();
    let responses = task.jacobian(&at, 0, trajectory);
    let free = (0..at.len()).filter(|index| task.is_free(*index));
    let columns = free.map(|index| stacked_column(&responses, index, task.records[0].len()));
    remove_projections(&orthonormal(columns), &mut residual);
    residual
}

/// The fitted parameters of a rival with the initial voltages of its patch.
fn estimate_at_rest(rival: Rival<'_>, model: &Model) -> Estimate {
    Estimate {
        parameters: rival.model.train.estimate.parameters.clone(),
        ..Estimate::nominal(model, rival.model.train.estimate.offsets.len())
    }
}

impl DriveLimits {
    /// Signals of every shape, amplitude and period that stay in the allowed range. `longest` is the longest training
    /// record.
    fn proposals(self, drive: usize, longest: &Record) -> Vec<DriveProposal> {
        let length = longest.duration();
        let shortest = (SHORTEST_PERIOD * longest.interval).min(length);
        let period = |index: i32| {
            length * libm::pow(shortest / length, f64::from(index) / f64::from(PERIOD_COUNT - 1))
        };
        let periodic = Shape::PERIODIC
            .into_iter()
            .flat_map(|shape| (0..PERIOD_COUNT).map(move |index| (shape, period(index))));
        let shapes: Vec<(Shape, f64)> =
            [(Shape::Step, STEP_TIME_FRACTION * length)].into_iter().chain(periodic).collect();
        let proposals = AMPLITUDES.into_iter().flat_map(|multiple| {
            let amplitude = multiple * self.excursion;
            shapes.iter().map(move |(shape, period)| DriveProposal {
                drive,
                shape: *shape,
                amplitude,
                period: *period,
            })
        });
        let is_allowed = |proposal: &DriveProposal| {
            let below = if proposal.shape == Shape::Step { 0.0 } else { proposal.amplitude };
            self.rest - below >= self.allowed[0] && self.rest + proposal.amplitude <= self.allowed[1]
        };
        proposals.filter(is_allowed).collect()
    }
}

impl DriveProposal {
    /// A record with this signal and all other drives at rest, with the length and the sampling interval of `like`.
    fn record(self, like: &Record, limits: &[DriveLimits]) -> Record {
        let value = |drive: usize, sample: usize| {
            let time = sample as f64 * like.interval;
            let excursion =
                if drive == self.drive { self.amplitude * self.shape.at(time / self.period) } else { 0.0 };
            limits[drive].rest + excursion
        };
        let drive = |drive: usize| (0..like.len()).map(|sample| value(drive, sample)).collect();
        Record {
            name: String::new(),
            begin: 0.0,
            start_in_file: 0.0,
            jitter: 0.0,
            drives: (0..limits.len()).map(drive).collect(),
            ..like.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn periodic_shapes_reach_both_ends_and_have_zero_mean() {
        for shape in Shape::PERIODIC {
            let values: Vec<f64> = (0..100).map(|index| shape.at(0.005 + 0.03 * f64::from(index))).collect();
            let ends = values
                .iter()
                .fold([0.0_f64; 2], |[least, most], value| [least.min(*value), most.max(*value)]);
            assert!(ends[0] < -0.95 && ends[1] > 0.95, "{shape:?} {ends:?}");
            assert!(values.iter().sum::<f64>().abs() < 4.0, "{shape:?}");
        }
        assert_eq!([0.5, 1.0, 7.3].map(|periods| Shape::Step.at(periods)), [0.0, 1.0, 1.0]);
    }

    #[test]
    fn a_drive_of_one_sign_keeps_its_sign() {
        let record = Record {
            name: String::new(),
            begin: 0.0,
            start_in_file: 0.0,
            interval: 0.1,
            jitter: 0.0,
            drives: vec![vec![0.0; 200]],
            outputs: vec![vec![0.0; 200]],
        };
        let pump = DriveLimits { rest: 4.0, excursion: 3.0, allowed: [0.0, 10.0] };
        let proposals = pump.proposals(0, &record);
        assert!(proposals.iter().any(|proposal| proposal.shape == Shape::Step && proposal.amplitude == 6.0));
        for proposal in &proposals {
            let drive = proposal.record(&record, &[pump]).drives.remove(0);
            assert_eq!(drive.len(), 200);
            assert!(drive.iter().all(|value| (0.0..=10.0).contains(value)), "{proposal:?}");
        }
        let sines = proposals.iter().filter(|proposal| proposal.shape == Shape::Sine);
        let periods: Vec<f64> = sines.map(|proposal| proposal.period).collect();
        let [longest, shortest] = [periods[0], periods[7]];
        assert!((longest - 19.9).abs() < 1e-9 && (shortest - 1.0).abs() < 1e-9, "{periods:?}");
    }
}
