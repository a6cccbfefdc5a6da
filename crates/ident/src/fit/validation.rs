//! The records that are held back: only the voltages with which integrators begin are found there, and declared offsets.

use crate::data::record::Record;
use crate::fit::estimate::{Fitted, Point, squares};
use crate::fit::fitted_model::{Stage, Version};
use crate::fit::levenberg_marquardt::{MOST_ROUNDS, Task};
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::fit::schedule::{Effort, Starts};
use crate::fit::start_cache::Begun;
use crate::statistics::descriptive::mean;

/// So often the derivatives are worked out in a first look at what was held back.
pub(crate) const FIRST_HELD: usize = 2;

/// A patch that leaves so much more of what was held back than of what it was fitted to may have begun there in the wrong place, as
/// may one that leaves noise there, and more than that of what was held back.
const LOST: f64 = 1.5;
/// Voltages from which each state may begin.
const VOLTS: [f64; 10] = [-80.0, -30.0, -10.0, -3.0, -1.0, 1.0, 3.0, 10.0, 30.0, 80.0];

/// The same knobs on the records that are held back: only initial voltages and declared offsets are found there, from where the
/// patch stands and from where another fit came to.
pub(crate) fn validate(
    problem: &Problem,
    version: &Version,
    at: &Point,
    from: Option<&[Vec<f64>]>,
    effort: Effort,
) -> Result<Option<Fitted>, ModelError> {
    let model = problem.model(version, &problem.test, &problem.outputs)?;
    let first = Point::of(&model, problem.outputs.len());
    let first = Point { knobs: at.knobs.clone(), offsets: at.offsets.clone(), ..first };
    let before = from.map(|initial| Point { initial: filled(initial, &first.initial), ..first.clone() });
    let most_rounds = if effort.is_thorough { MOST_ROUNDS } else { FIRST_HELD };
    // Pieces begin as was measured: from there one fit is enough.
    let starts = if effort.is_thorough && !problem.is_cut { 2 } else { 1 };
    let task = Task { most_rounds, ..problem.task(&model, &problem.test, false) };
    let starts = before.into_iter().chain([first]).take(starts);
    Ok(Fitted::best_of(starts.filter_map(|point| task.told(&task.settled(&point)?))))
}

/// A stage that may have begun there in the wrong place, begun from many; nothing where that is not better.
///
/// # Errors
/// When the patch cannot be run beside the records.
pub(crate) fn revalidate(problem: &Problem, stage: &Stage) -> Result<Option<Stage>, ModelError> {
    // Pieces begin as was measured, and do not last.
    if problem.is_cut || !may_be_lost(problem, stage) {
        return Ok(None);
    }
    let begins = problem.test.iter().zip(&stage.test.point.initial);
    let begins = begins.map(|(record, initial)| initial_voltages(problem, stage, record, initial));
    let initial = begins.collect::<Result<Vec<_>, _>>()?;
    let again = validate(problem, &stage.version, &stage.train.point, Some(&initial), Effort::FULL)?;
    let better = again.filter(|again| again.chi2 < stage.test.chi2);
    Ok(better.map(|test| Stage { test, ..stage.clone() }))
}

/// Whether a stage may have begun in the wrong place in the records that are held back.
fn may_be_lost(problem: &Problem, stage: &Stage) -> bool {
    let is_explained = !stage.leaves_structure();
    let leaves_more = stage.test.over_noise() >= LOST * stage.train.over_noise().max(1.0);
    leaves_more || is_explained && any_has_changed(problem, stage)
}

/// The voltages with which a record begins, by its beginning first; those known before where no others are better.
fn initial_voltages(
    problem: &Problem,
    stage: &Stage,
    record: &Record,
    known: &[f64],
) -> Result<Vec<f64>, ModelError> {
    let record = std::slice::from_ref(record);
    let model = problem.model(&stage.version, record, &problem.outputs)?;
    let task = problem.task(&model, record, false);
    let at = |initial: Vec<f64>| Point { initial: vec![initial], ..stage.train.point.clone() };
    let moved = |state: usize| {
        let [low, high] = model.initial[state].range;
        let allowed = VOLTS.into_iter().filter(move |volts| (low..=high).contains(volts));
        allowed.map(move |volts| {
            let mut initial = known.to_vec();
            initial[state] = volts;
            initial
        })
    };
    let starts = Starts {
        sure: vec![at(known.to_vec())],
        others: (0..known.len()).flat_map(moved).map(at).collect(),
        ..Starts::default()
    };
    let best = Effort::FROM_ANYWHERE.best(&task, &starts, &mut Begun::default());
    Ok(best.map_or_else(|| known.to_vec(), |best| best.initial[0].clone()))
}

/// Initial voltages of fewer states, with those of the rest behind them.
fn filled(some: &[Vec<f64>], all: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let pairs = some.iter().zip(all);
    pairs.map(|(some, all)| some.iter().chain(&all[some.len()..]).copied().collect()).collect()
}

/// By chance data held back leave less than so many times what training leaves, or than the noise.
const CHANGED: f64 = 2.0;
/// What is left of them lies less than so many standard deviations above that of training by chance.
const BY_CHANCE: f64 = 5.0;

/// Whether what explains an output in training does not explain it in what was held back.
pub(crate) fn has_changed(stage: &Stage, output: usize) -> bool {
    let [was, is] = [&stage.train, &stage.test].map(|fitted| squares(&fitted.residuals, output));
    is_more(&was, &is, stage.memory)
}

/// Whether squares that remember for so many samples are more than others, or than the noise, by so much that it is no chance.
pub(crate) fn is_more(before: &[f64], after: &[f64], memory: f64) -> bool {
    let (was, is) = (mean(before).max(1.0), mean(after));
    // The mean of the squares of m normal numbers is off by sqrt(2 / m) of itself.
    let [learnt, held] = [before, after].map(|own| 2.0 * memory / own.len().max(1) as f64);
    let by_chance = BY_CHANCE * (learnt * was * was + held * is * is).sqrt();
    is > CHANGED * CHANGED * was || is - was > by_chance
}

/// Whether what explains training does not explain what was held back, of any output.
pub(crate) fn any_has_changed(problem: &Problem, stage: &Stage) -> bool {
    (0..problem.outputs.len()).any(|output| has_changed(stage, output))
}
