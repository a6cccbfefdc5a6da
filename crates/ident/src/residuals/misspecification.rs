//! What an experiment may tell wrongly: the sign of an output, its unit, the unit of time. A patch that explains the data once that
//! is told otherwise lacks no effect.

use crate::data::record::Record;
use crate::fit::base_fit::fit_base;
use crate::fit::estimation::glance;
use crate::fit::fitted_model::Stage;
use crate::fit::model::ModelError;
use crate::fit::problem::{Problem, in_pieces};
use crate::fit::step_size::steps_per_sample;
use crate::residuals::output_motion::is_hardly_explained;
use patchcord_core::patch::Patch;

/// Something is told wrongly where told otherwise it leaves no more than such a share of the gap, in rms.
const FAR_LESS: f64 = 0.2;

/// Times a thousand times as long are looked at where the solver takes no more steps from sample to sample: more take long, and lead to
/// nothing.
const FEW_STEPS: u32 = 4;
/// What prefixes of units differ by.
const THOUSAND: f64 = 1e3;

/// What may be told otherwise.
#[derive(Debug, Clone, PartialEq)]
pub enum Otherwise {
    /// These outputs are the opposite.
    Turned(Vec<String>),
    /// These outputs are a thousandth of what is told.
    Thousandth(Vec<String>),
    /// These outputs are a thousand times what is told.
    Thousandfold(Vec<String>),
    /// All times are a thousandth of what is told: milliseconds that are taken for seconds.
    ThousandthOfTimes,
    /// All times are a thousand times what is told.
    ThousandfoldTimes,
}

/// What a patch explains that does not explain what is told.
#[derive(Debug, Clone, PartialEq)]
pub struct Mistold {
    /// What is told otherwise then.
    pub otherwise: Otherwise,
    /// What the patch leaves of all outputs as they are told and otherwise, rms over the noise.
    pub leaves: [f64; 2],
}

/// What is told wrongly, where a patch far from the data explains them told otherwise: one output turned round, or all, as where a
/// drive is the wrong way round; and where it hardly explains what moves, those in other units, or all times.
///
/// # Errors
/// When the patch cannot be run beside the records.
pub(crate) fn misspecification_of(
    problem: &Problem,
    base: &Stage,
    patch: &Patch,
    fit: &[String],
    seed: u64,
) -> Result<Option<Mistold>, ModelError> {
    if !base.is_far() {
        return Ok(None);
    }
    let mut all = each_and_all(problem, Otherwise::Turned);
    if is_hardly_explained(problem, base) {
        // The quickest first: all others take many steps where times are told a thousand times too long.
        all.insert(0, Otherwise::ThousandthOfTimes);
        all.extend(each_and_all(problem, Otherwise::Thousandth));
        all.extend(each_and_all(problem, Otherwise::Thousandfold));
        all.push(Otherwise::ThousandfoldTimes);
    }
    let few = of_few_records(problem);
    let mut best: Option<Mistold> = None;
    for otherwise in all {
        let told = respecified(&few, &otherwise, patch, fit)?;
        if otherwise == Otherwise::ThousandfoldTimes && told.steps > FEW_STEPS {
            continue;
        }
        let Some(stage) = fit_base(&told, patch, fit, seed)? else { continue };
        let leaves = [base, &stage].map(|own| own.train.over_noise());
        // What grows beyond all bounds leaves far less in a thousandth of the time, and explains nothing.
        let explains = stage.gap() < FAR_LESS * base.gap() && !is_hardly_explained(&told, &stage);
        if explains && best.as_ref().is_none_or(|best| leaves[1] < best.leaves[1]) {
            best = Some(Mistold { otherwise, leaves });
            if !stage.is_far() {
                break;
            }
        }
    }
    Ok(best)
}

/// The same with no more than a few of many records.
fn of_few_records(problem: &Problem) -> Problem {
    let few = |records: &[Record]| -> Vec<Record> {
        glance(records).into_iter().map(|place| records[place].clone()).collect()
    };
    let (train, test) = (few(&problem.train), few(&problem.test));
    Problem { pieces: in_pieces(&train, problem.cuts), train, test, ..problem.clone() }
}

/// Every output told otherwise, and all together.
fn each_and_all(problem: &Problem, otherwise: fn(Vec<String>) -> Otherwise) -> Vec<Otherwise> {
    let alone = problem.outputs.iter().map(|own| vec![own.clone()]);
    let together = (problem.outputs.len() > 1).then(|| problem.outputs.clone());
    alone.chain(together).map(otherwise).collect()
}

fn respecified(
    problem: &Problem,
    otherwise: &Otherwise,
    patch: &Patch,
    fit: &[String],
) -> Result<Problem, ModelError> {
    let mut own = match otherwise {
        // What the solver errs by has no sign.
        Otherwise::Turned(names) => return Ok(with_outputs_scaled(problem, names, -1.0)),
        Otherwise::Thousandth(names) => with_outputs_scaled(problem, names, THOUSAND.recip()),
        Otherwise::Thousandfold(names) => with_outputs_scaled(problem, names, THOUSAND),
        Otherwise::ThousandthOfTimes => with_times_scaled(problem, THOUSAND.recip()),
        Otherwise::ThousandfoldTimes => with_times_scaled(problem, THOUSAND),
    };
    own.steps = steps_per_sample(&own, patch, fit)?;
    Ok(own)
}

/// The same with so many times all times.
fn with_times_scaled(problem: &Problem, factor: f64) -> Problem {
    with_records(problem, |record| {
        for time in [&mut record.begin, &mut record.since, &mut record.interval] {
            *time *= factor;
        }
    })
}

/// The same with so many times some outputs, and their noise.
fn with_outputs_scaled(problem: &Problem, names: &[String], factor: f64) -> Problem {
    let factors = problem.outputs.iter().map(|own| if names.contains(own) { factor } else { 1.0 });
    let factors: Vec<f64> = factors.collect();
    let with = with_records(problem, |record| {
        for (output, factor) in record.outputs.iter_mut().zip(&factors) {
            output.iter_mut().for_each(|value| *value *= factor);
        }
    });
    let sigma = problem.sigma.iter().zip(&factors).map(|(own, factor)| own * factor.abs());
    Problem { sigma: sigma.collect(), ..with }
}

/// The same with every record changed.
fn with_records(problem: &Problem, change: impl Fn(&mut Record)) -> Problem {
    let mut own = problem.clone();
    own.train.iter_mut().chain(&mut own.pieces).chain(&mut own.test).for_each(change);
    own
}
