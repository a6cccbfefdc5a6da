//! The fit of the patch as it is, and fits made again from better points.

use crate::fit::estimate::Point;
use crate::fit::estimation::Beginning;
use crate::fit::estimation::fit_variant;
use crate::fit::estimation::refit;
use crate::fit::fitted_model::{Stage, Version};
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::fit::schedule::Starts;
use crate::fit::starts::scattered;
use crate::fit::step_size::refine_steps;
use crate::fit::validation::revalidate;
use patchcord_core::patch::Patch;

/// A fit whose sum of squares is below this share of another's has found what that did not.
const BETTER: f64 = 0.99;

/// The first stage: a patch as it is, fitted from where it stands and from points scattered over the ranges of what is fitted.
///
/// # Errors
/// When the patch cannot be run beside the records at all.
pub fn fit_base(
    problem: &Problem,
    patch: &Patch,
    fit: &[String],
    seed: u64,
) -> Result<Option<Stage>, ModelError> {
    let version = Version::new(patch.clone(), fit.to_vec(), Vec::new(), problem.steps);
    let model = problem.model(&version, &problem.train, &problem.outputs)?;
    let first = Point::of(&model, problem.outputs.len());
    let task = problem.task(&model, &problem.train, true);
    let points = [first.clone()].into_iter().chain(scattered(&model, &first, seed));
    let settled = points.filter_map(|point| task.settled(&point));
    let starts: Vec<Point> = settled.chain([first.clone()]).collect();
    let from = Beginning::points(starts);
    let Some(mut stage) = fit_variant(problem, version, from, f64::INFINITY)? else { return Ok(None) };
    if !problem.is_cut && stage.is_far() {
        stage = refit_over_pieces(problem, stage)?;
    }
    let finished = finish(problem, &stage)?;
    Ok(Some(finished.unwrap_or(stage)))
}

/// A stage with steps that are fine enough where it came to, and begun in the right place where it is held back; nothing where
/// it has and is.
///
/// # Errors
/// When the patch cannot be run beside the records.
pub(crate) fn finish(problem: &Problem, stage: &Stage) -> Result<Option<Stage>, ModelError> {
    let refined = refine_steps(problem, stage)?;
    let again = revalidate(problem, refined.as_ref().unwrap_or(stage))?;
    Ok(again.or(refined))
}

/// A stage whose gap is large, fitted from its pieces on, too.
fn refit_over_pieces(problem: &Problem, stage: Stage) -> Result<Stage, ModelError> {
    let model = problem.model(&stage.version, &problem.pieces, &problem.outputs)?;
    let first = Point { knobs: stage.train.point.knobs.clone(), ..Point::of(&model, problem.outputs.len()) };
    let Some(settled) = problem.task(&model, &problem.pieces, true).settled(&first) else { return Ok(stage) };
    let from = Beginning {
        in_pieces: Some(Starts { sure: vec![settled], ..Starts::default() }),
        held: Some(&stage.test.point.initial),
        ..Beginning::points(vec![stage.train.point.clone()])
    };
    let again = fit_variant(problem, stage.version.clone(), from, f64::INFINITY)?;
    Ok(again.filter(|again| again.train.chi2 < stage.train.chi2).unwrap_or(stage))
}

/// The same patch fitted from where a trial with one more effect came to, if that is better.
///
/// # Errors
/// When the patch cannot be run beside the records at all.
pub fn refit_from_trial(
    problem: &Problem,
    stage: &Stage,
    trial: &Stage,
) -> Result<Option<Stage>, ModelError> {
    let (own, other) = (&stage.train.point, &trial.train.point);
    let start = Point {
        knobs: other.knobs[..own.knobs.len()].to_vec(),
        initial: own
            .initial
            .iter()
            .zip(&other.initial)
            .map(|(own, other)| other[..own.len()].to_vec())
            .collect(),
        offsets: other.offsets.clone(),
    };
    let again = refit(problem, stage, stage.version.clone(), start)?;
    Ok(again.filter(|again| again.train.chi2 < BETTER * stage.train.chi2))
}
