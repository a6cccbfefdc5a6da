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
use crate::design::drive_proposal::{DriveLimits, DriveProposal, has_both_signs};
use crate::effects::PlacedEffect;
use crate::effects::candidate::Candidate;
use crate::fit::estimate::Estimate;
use crate::fit::fitted_model::FittedModel;
use crate::fit::levenberg_marquardt::{FitProblem, stacked_column};
use crate::fit::model::{Model, ModelError, OutputTrajectory, RunValues};
use crate::fit::problem::Problem;
use crate::statistics::acceptance::RIVAL_Z;
use crate::statistics::block_comparison::expected_advantage;
use crate::statistics::projection::{dot, orthonormal, remove_projections};

pub use crate::design::drive_proposal::Shape;

/// Number of drives, those with the largest differences, for which the linearised fit is computed.
const LINEARISED_DRIVES: usize = 16;
/// Number of drives, the best ones of the linearised fits, for which the complete fit is computed.
const REFITTED_DRIVES: usize = 4;
/// Expected difference of a decisive experiment, as a multiple of the one that makes a trial no rival. It leaves room
/// for chance.
const DECISIVE_FACTOR: f64 = 1.5;

/// A drive signal that distinguishes two effects, and the predictions of both patches.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct DiscriminatingExperiment {
    /// The two effects.
    pub effects: [PlacedEffect; 2],
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
    pub(crate) drives: Vec<MeasuredDrive>,
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
    /// The effect.
    pub candidate: &'a Candidate,
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
        (0..problem.drives.len()).map(|drive| DriveLimits::of(problem, drive, can_reverse)).collect();
    let proposals: Vec<DriveProposal> =
        limits.iter().enumerate().flat_map(|(drive, limits)| limits.proposals(drive, longest)).collect();
    let records: Vec<Record> = proposals.iter().map(|proposal| proposal.record(longest, &limits)).collect();
    let comparison = Comparison { problem, rivals, records: &records, noise };
    let best = comparison.best(most_different_runs(problem, rivals, &records)?)?;
    Ok(best.map(|(difference, ProposalRun { proposal, predictions })| {
        let DriveProposal { drive, shape, amplitude, period } = proposals[proposal];
        DiscriminatingExperiment {
            effects: rivals.map(|rival| rival.candidate.placed_effect()),
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
            drives: problem.drives.clone(),
            record: records[proposal].clone(),
            predictions,
        }
    }))
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
        let fit_problem = self.problem.fit_problem(&model, &records, true);
        let start = estimate_at_rest(rival, &model);
        let fit = if is_complete { fit_problem.fit(&start) } else { None };
        let residual = fit.map_or_else(
            || linearised_residual(&fit_problem, &start, &run.predictions[fitted]),
            |fit| fit.residuals.into_iter().flatten().flatten().collect(),
        );
        let tracks: Vec<&[f64]> = residual.chunks(records[0].len()).collect();
        let rms = |track: &&[f64]| (dot(track, track) / track.len() as f64).sqrt();
        let rms = tracks.iter().map(rms).collect();
        Ok(PredictionDifference { rms, standard_errors: expected_advantage(&[tracks], self.noise).z_score() })
    }
}

/// The residual of a trajectory after a linearised fit of everything that is free.
fn linearised_residual(
    fit_problem: &FitProblem<'_>,
    start: &Estimate,
    trajectory: &OutputTrajectory,
) -> Vec<f64> {
    let coordinates = fit_problem.coordinates(start);
    let mut residual: Vec<f64> = (0..trajectory.len())
        .flat_map(|output| fit_problem.residuals(&coordinates, 0, output, trajectory))
        .collect();
    let responses = fit_problem.jacobian(&coordinates, 0, trajectory);
    let free = (0..coordinates.len()).filter(|index| fit_problem.is_free(*index));
    let columns = free.map(|index| stacked_column(&responses, index, fit_problem.records[0].len()));
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
