//! Fitting a patch to the training records, in pieces and to a few of many records first, and validating it.

use crate::data::record::Record;
use crate::fit::estimate::Point;
use crate::fit::fitted_model::{Stage, Version};
use crate::fit::levenberg_marquardt::{Ladder, Task};
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::fit::schedule::{Effort, Starts};
use crate::fit::start_cache::{Begun, Seen};
use crate::fit::validation::validate;

/// From where a stage is fitted.
#[derive(Debug, Clone)]
pub(crate) struct Beginning<'a> {
    /// Points for the records whole.
    pub(crate) starts: Starts,
    /// Points for their pieces, where those are fitted first.
    pub(crate) in_pieces: Option<Starts>,
    /// The initial voltages of the records that are held back, as an earlier fit found them.
    pub(crate) held: Option<&'a [Vec<f64>]>,
    /// What is known of some of the points.
    pub(crate) seen: Seen,
    pub(crate) effort: Effort,
}

impl Beginning<'_> {
    pub(crate) fn points(others: Vec<Point>) -> Self {
        let starts = Starts { others, ..Starts::default() };
        Beginning { starts, in_pieces: None, held: None, seen: Seen::default(), effort: Effort::FULL }
    }
}

/// Looks at many records begin with so many samples of them,
const GLANCED_AT: usize = 4000;
/// and finds in so many rounds how all of them begin.
const NEARLY: usize = 4;

/// Fits a patch from several points on, so that the sum of squares comes below what is wanted; nothing where it can be run
/// from none of them.
///
/// # Errors
/// When the patch cannot be run beside the records at all.
pub(crate) fn fit_variant(
    problem: &Problem,
    version: Version,
    from: Beginning<'_>,
    wanted: f64,
) -> Result<Option<Stage>, ModelError> {
    let mut seen = from.seen;
    let pieces = from.in_pieces.map(|own| fit_pieces(problem, &version, &own, from.effort, &mut seen.pieces));
    let in_pieces = pieces.transpose()?.flatten();
    let model = problem.model(&version, &problem.train, &problem.outputs)?;
    let task = Task { wanted, ..problem.task(&model, &problem.train, true) };
    let mut starts = from.starts;
    let joined = in_pieces.as_ref().map(|point| problem.joined_up(point));
    let led = fit_subsample_first(problem, &version, &task, &starts, from.effort, &mut seen)?;
    let best = led.and_then(|(all, led)| {
        let sure = led.into_iter().chain(joined.clone()).collect();
        all.best(&task, &Starts { sure, ..Starts::default() }, &mut seen.whole)
    });
    let best = best.or_else(|| {
        starts.sure.extend(joined);
        from.effort.best(&task, &starts, &mut seen.whole)
    });
    let Some(train) = best.and_then(|point| task.told(&point)) else { return Ok(None) };
    let test = validate(problem, &version, &train.point, from.held, from.effort)?;
    Ok(test.map(|test| Stage::new(version, [train, test], in_pieces, seen, from.effort.is_thorough)))
}

/// Fits a patch to the pieces: where it comes to from the best of several points.
fn fit_pieces(
    problem: &Problem,
    version: &Version,
    starts: &Starts,
    effort: Effort,
    begun: &mut Begun,
) -> Result<Option<Point>, ModelError> {
    let model = problem.model(version, &problem.pieces, &problem.outputs)?;
    let task = problem.task(&model, &problem.pieces, true);
    Ok(effort.best(&task, starts, begun))
}

/// From where all of many records are gone on with, and how: from where a few of them lead, and from what these may lead
/// astray from. Nothing where the records are few, or there is nothing to choose between.
fn fit_subsample_first(
    problem: &Problem,
    version: &Version,
    all: &Task<'_>,
    starts: &Starts,
    effort: Effort,
    seen: &mut Seen,
) -> Result<Option<(Effort, Vec<Point>)>, ModelError> {
    let places = glance(&problem.train);
    let is_open = starts.sure.iter().chain(&starts.found).chain(&starts.others).count() > 1;
    let split = effort.split().filter(|_| is_open && places.len() < problem.train.len());
    let Some([few, rest]) = split else { return Ok(None) };
    let nearly = Task { most_rounds: NEARLY, dampings: Ladder::ONE, ..*all };
    let glanced = fit_subsample(problem, version, &places, starts, few, &mut seen.few)?;
    let mut led: Vec<Point> = glanced.iter().filter_map(|point| nearly.settled(point)).collect();
    match effort.is_thorough {
        true => led.extend(all.nearest(&starts.others, &starts.sure, 1, &mut seen.whole).cloned()),
        false => led.extend(starts.sure.first().cloned()),
    }
    led.extend(starts.found.clone());
    Ok(Some((rest, led)))
}

/// Where a patch fitted to a few of the records comes to, the best first; the others begin where they did before.
fn fit_subsample(
    problem: &Problem,
    version: &Version,
    places: &[usize],
    starts: &Starts,
    effort: Effort,
    begun: &mut Begun,
) -> Result<Vec<Point>, ModelError> {
    let records: Vec<Record> = places.iter().map(|place| problem.train[*place].clone()).collect();
    let model = problem.model(version, &records, &problem.outputs)?;
    let few = |point: &Point| {
        let initial = places.iter().map(|place| point.initial[*place].clone());
        Point { initial: initial.collect(), ..point.clone() }
    };
    let all = |points: &[Point]| points.iter().map(few).collect();
    let some = Starts {
        sure: all(&starts.sure),
        found: starts.found.as_ref().map(few),
        others: all(&starts.others),
    };
    let mut points = starts.sure.iter().chain(&starts.found).chain(&starts.others);
    let Some(first) = points.next() else { return Ok(Vec::new()) };
    let ahead = effort.ahead(&problem.task(&model, &records, true), &some, begun).into_iter();
    let whole = ahead.map(|own| {
        let mut initial = first.initial.clone();
        places.iter().zip(own.initial).for_each(|(place, begins)| initial[*place] = begins);
        Point { initial, ..own }
    });
    Ok(whole.collect())
}

/// A stage in another version, fitted from a point on.
///
/// # Errors
/// When the patch cannot be run beside the records at all.
pub(crate) fn refit(
    problem: &Problem,
    stage: &Stage,
    version: Version,
    start: Point,
) -> Result<Option<Stage>, ModelError> {
    let from = Beginning { held: Some(&stage.test.point.initial), ..Beginning::points(vec![start]) };
    let again = fit_variant(problem, version, from, f64::INFINITY)?;
    Ok(again.map(|again| Stage { in_pieces: stage.in_pieces.clone(), ..again }))
}

/// The places of records, all or a few of many, from which a first look takes its data.
pub(crate) fn glance(records: &[Record]) -> Vec<usize> {
    let (count, samples) = (records.len(), records.iter().map(Record::len).sum::<usize>());
    let few = (GLANCED_AT * count / samples.max(1)).max(1).min(count);
    (0..few).map(|place| place * count / few).collect()
}
