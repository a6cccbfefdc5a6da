//! Misspecified experiments: a wrong sign of an output, a wrong unit of an output, or a wrong unit of time.
//!
//! Each candidate specification is applied to the data, and the patch is fitted again. If the patch then explains the
//! data, the specification is wrong and no effect is missing.

use crate::data::record::Record;
use crate::fit::base_fit::fit_base;
use crate::fit::estimation::subsample_indices;
use crate::fit::fitted_model::FittedModel;
use crate::fit::model::ModelError;
use crate::fit::problem::{Problem, cut_records};
use crate::fit::step_size::steps_per_sample;
use crate::residuals::output_motion::has_unexplained_output;
use patchcord_core::patch::Patch;

/// The experiment is misspecified only if another specification leaves less than this fraction of the excess rms.
const MAX_EXCESS_RATIO: f64 = 0.2;

/// Times that are a thousand times as long are tested only if the solver then needs at most this many steps per sample.
/// With more steps the fit takes long and never succeeds.
const MAX_STEPS_FOR_LONG_TIMES: u32 = 4;
/// The ratio of neighbouring SI prefixes such as m and 1.
const PREFIX_RATIO: f64 = 1e3;

/// Another specification of the same data.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Respecification {
    /// These outputs have the opposite sign.
    SignFlip(Vec<String>),
    /// These outputs are a thousandth of the specified values.
    UnitScaleDown(Vec<String>),
    /// These outputs are a thousand times the specified values.
    UnitScaleUp(Vec<String>),
    /// All times are a thousandth of the specified times, for example milliseconds that were read as seconds.
    TimeScaleDown,
    /// All times are a thousand times the specified times.
    TimeScaleUp,
}

/// A misspecified experiment: the patch explains the data only with another specification.
#[derive(Debug, Clone, PartialEq)]
pub struct Misspecification {
    /// The specification with which the patch explains the data.
    pub respecification: Respecification,
    /// The rms residuals of all outputs, in units of sigma: as specified, and with the other specification.
    pub normalised_rms: [f64; 2],
}

/// Detects a misspecified experiment as the cause of a poor fit. `None` if no other specification is much better.
///
/// The sign of each output is tested, and the sign of all together, as if a drive had the wrong sign. If the fit does
/// not explain an output at all, the units of outputs and of time are tested, too. `patch` and `fit` specify the base
/// fit; `seed` selects its random starts.
///
/// # Errors
/// If the patch cannot be run along the records.
pub(crate) fn find_misspecification(
    problem: &Problem,
    base: &FittedModel,
    patch: &Patch,
    fit: &[String],
    seed: u64,
) -> Result<Option<Misspecification>, ModelError> {
    let mut candidates = output_respecifications(problem, Respecification::SignFlip);
    if has_unexplained_output(problem, base) {
        // Shorter times are fastest to test. If times are a thousand times too long, all other fits take many steps.
        candidates.insert(0, Respecification::TimeScaleDown);
        candidates.extend(output_respecifications(problem, Respecification::UnitScaleDown));
        candidates.extend(output_respecifications(problem, Respecification::UnitScaleUp));
        candidates.push(Respecification::TimeScaleUp);
    }
    best_respecification(problem, base, candidates, patch, fit, seed)
}

/// Detects times that are specified a thousand times too long, such as milliseconds that are read as seconds. `None` if
/// shorter times are not much better. It takes less time than [`find_misspecification`].
///
/// # Errors
/// If the patch cannot be run along the records.
pub(crate) fn find_long_times(
    problem: &Problem,
    base: &FittedModel,
    patch: &Patch,
    fit: &[String],
    seed: u64,
) -> Result<Option<Misspecification>, ModelError> {
    best_respecification(problem, base, vec![Respecification::TimeScaleDown], patch, fit, seed)
}

/// The candidate that explains the data best. `None` if the fit `base` is good, or if no candidate is much better.
fn best_respecification(
    problem: &Problem,
    base: &FittedModel,
    candidates: Vec<Respecification>,
    patch: &Patch,
    fit: &[String],
    seed: u64,
) -> Result<Option<Misspecification>, ModelError> {
    if !base.is_poor() {
        return Ok(None);
    }
    let subsample = with_subsample(problem);
    let mut best: Option<Misspecification> = None;
    for respecification in candidates {
        let respecified = respecify(&subsample, &respecification, patch, fit)?;
        if respecification == Respecification::TimeScaleUp && respecified.steps > MAX_STEPS_FOR_LONG_TIMES {
            continue;
        }
        let Some(fitted) = fit_base(&respecified, patch, fit, seed)? else { continue };
        let normalised_rms = [base, &fitted].map(|fitted| fitted.train.normalised_rms());
        // Over a thousandth of the time an unstable model has small residuals, but it explains no output.
        let is_explained = fitted.excess_rms() < MAX_EXCESS_RATIO * base.excess_rms()
            && !has_unexplained_output(&respecified, &fitted);
        if is_explained && best.as_ref().is_none_or(|best| normalised_rms[1] < best.normalised_rms[1]) {
            best = Some(Misspecification { respecification, normalised_rms });
            if !fitted.is_poor() {
                break;
            }
        }
    }
    Ok(best)
}

/// The same problem with a subsample of the training and validation records.
fn with_subsample(problem: &Problem) -> Problem {
    let choose = |records: &[Record]| -> Vec<Record> {
        subsample_indices(records).into_iter().map(|index| records[index].clone()).collect()
    };
    let (train, validation) = (choose(&problem.train), choose(&problem.validation));
    Problem { pieces: cut_records(&train, problem.pieces_per_record), train, validation, ..problem.clone() }
}

/// A respecification for each output, and one for all outputs together if there are several.
fn output_respecifications(
    problem: &Problem,
    respecification: fn(Vec<String>) -> Respecification,
) -> Vec<Respecification> {
    let single = problem.outputs.iter().map(|output| vec![output.clone()]);
    let all = (problem.outputs.len() > 1).then(|| problem.outputs.clone());
    single.chain(all).map(respecification).collect()
}

/// The same problem with another specification of the data. If a scale changes, the solver steps are chosen again.
fn respecify(
    problem: &Problem,
    respecification: &Respecification,
    patch: &Patch,
    fit: &[String],
) -> Result<Problem, ModelError> {
    let mut respecified = match respecification {
        // The solver error does not depend on the sign of the data.
        Respecification::SignFlip(names) => return Ok(with_scaled_outputs(problem, names, -1.0)),
        Respecification::UnitScaleDown(names) => with_scaled_outputs(problem, names, PREFIX_RATIO.recip()),
        Respecification::UnitScaleUp(names) => with_scaled_outputs(problem, names, PREFIX_RATIO),
        Respecification::TimeScaleDown => with_scaled_times(problem, PREFIX_RATIO.recip()),
        Respecification::TimeScaleUp => with_scaled_times(problem, PREFIX_RATIO),
    };
    respecified.steps = steps_per_sample(&respecified, patch, fit)?;
    Ok(respecified)
}

/// The same problem with all times multiplied by a factor.
fn with_scaled_times(problem: &Problem, factor: f64) -> Problem {
    with_changed_records(problem, |record| {
        for time in [&mut record.begin, &mut record.start_in_file, &mut record.interval] {
            *time *= factor;
        }
    })
}

/// The same problem with the named outputs multiplied by a factor, and their noise by its magnitude.
fn with_scaled_outputs(problem: &Problem, names: &[String], factor: f64) -> Problem {
    let factors = problem.outputs.iter().map(|output| if names.contains(output) { factor } else { 1.0 });
    let factors: Vec<f64> = factors.collect();
    let scaled = with_changed_records(problem, |record| {
        for (output, factor) in record.outputs.iter_mut().zip(&factors) {
            output.iter_mut().for_each(|value| *value *= factor);
        }
    });
    let sigma = problem.sigma.iter().zip(&factors).map(|(sigma, factor)| sigma * factor.abs());
    Problem { sigma: sigma.collect(), ..scaled }
}

/// The same problem with every record changed by a function.
fn with_changed_records(problem: &Problem, change: impl Fn(&mut Record)) -> Problem {
    let mut changed = problem.clone();
    changed.train.iter_mut().chain(&mut changed.pieces).chain(&mut changed.validation).for_each(change);
    changed
}
