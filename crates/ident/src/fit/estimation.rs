//! Fits one variant of the patch to the training records and validates it.
//!
//! If starts for pieces are given, the pieces are fitted first, and their result is one more start for the whole
//! records. If there are many records, a subsample is fitted first, and all records are fitted from its survivors.

use crate::data::record::Record;
use crate::fit::estimate::Estimate;
use crate::fit::fitted_model::{FittedModel, ModelVariant};
use crate::fit::levenberg_marquardt::{DampingSchedule, FitProblem};
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::fit::schedule::{Effort, Starts};
use crate::fit::start_cache::{StartCache, StartCaches};
use crate::fit::validation::validate;

/// The starts of a fit and the effort that is made from them.
#[derive(Debug, Clone)]
pub(crate) struct FitStart<'a> {
    /// Starts for the whole records.
    pub(crate) starts: Starts,
    /// Starts for the pieces of the records. `None` if the pieces are not fitted first.
    pub(crate) piece_starts: Option<Starts>,
    /// For every validation record the initial voltages from an earlier fit, in V. They may lack the last states.
    pub(crate) validation_initial: Option<&'a [Vec<f64>]>,
    /// Results from the same starts in an earlier fit.
    pub(crate) caches: StartCaches,
    /// The effort of the fit.
    pub(crate) effort: Effort,
}

impl FitStart<'_> {
    /// A full fit from the best of these estimates.
    pub(crate) fn from_estimates(optional: Vec<Estimate>) -> Self {
        let starts = Starts { optional, ..Starts::default() };
        FitStart {
            starts,
            piece_starts: None,
            validation_initial: None,
            caches: StartCaches::default(),
            effort: Effort::FULL,
        }
    }
}

/// The number of samples that a subsample of the records has at most, unless a single record is longer.
const SUBSAMPLE_SAMPLES: usize = 4000;
/// The number of iterations for the initial voltages of all records after a fit to a subsample.
const INITIAL_ITERATIONS: usize = 4;

/// Fits a variant and validates it. `None` if the patch can be run from none of the starts.
///
/// A fit that is not expected to reach the sum of squares `target_chi2` is given up early. Its result is then returned
/// as it is.
///
/// # Errors
/// If the patch cannot be run along the records at all.
pub(crate) fn fit_variant(
    problem: &Problem,
    variant: ModelVariant,
    start: FitStart<'_>,
    target_chi2: f64,
) -> Result<Option<FittedModel>, ModelError> {
    let mut caches = start.caches;
    let piece_fit = start
        .piece_starts
        .map(|piece_starts| fit_pieces(problem, &variant, &piece_starts, start.effort, &mut caches.pieces));
    let pieces_estimate = piece_fit.transpose()?.flatten();
    let model = problem.model(&variant, &problem.train, &problem.outputs)?;
    let fit_problem = FitProblem { target_chi2, ..problem.fit_problem(&model, &problem.train, true) };
    let mut starts = start.starts;
    let joined = pieces_estimate.as_ref().map(|estimate| problem.join_pieces(estimate));
    let from_subsample =
        fit_subsample_first(problem, &variant, &fit_problem, &starts, start.effort, &mut caches)?;
    let best = from_subsample.and_then(|(effort, estimates)| {
        let required = estimates.into_iter().chain(joined.clone()).collect();
        effort.best(&fit_problem, &Starts { required, ..Starts::default() }, &mut caches.whole)
    });
    let best = best.or_else(|| {
        starts.required.extend(joined);
        start.effort.best(&fit_problem, &starts, &mut caches.whole)
    });
    let Some(train) = best.and_then(|estimate| fit_problem.evaluate(&estimate)) else { return Ok(None) };
    let validation = validate(problem, &variant, &train.estimate, start.validation_initial, start.effort)?;
    Ok(validation.map(|validation| {
        FittedModel::new(variant, [train, validation], pieces_estimate, caches, start.effort.is_thorough)
    }))
}

/// Fits a variant to the pieces of the training records. Returns the best fit, or `None` if no start can be run.
fn fit_pieces(
    problem: &Problem,
    variant: &ModelVariant,
    starts: &Starts,
    effort: Effort,
    cache: &mut StartCache,
) -> Result<Option<Estimate>, ModelError> {
    let model = problem.model(variant, &problem.pieces, &problem.outputs)?;
    let fit_problem = problem.fit_problem(&model, &problem.pieces, true);
    Ok(effort.best(&fit_problem, starts, cache))
}

/// Fits a subsample of many records first. Returns the effort and the starts for the fit to all records.
///
/// These starts are the survivors of the subsample and one start that does not depend on it, because the subsample may
/// mislead. `None` if the records are few or there is only one start.
fn fit_subsample_first(
    problem: &Problem,
    variant: &ModelVariant,
    whole_problem: &FitProblem<'_>,
    starts: &Starts,
    effort: Effort,
    caches: &mut StartCaches,
) -> Result<Option<(Effort, Vec<Estimate>)>, ModelError> {
    let indices = subsample_indices(&problem.train);
    let has_choice = starts.required.iter().chain(&starts.previous).chain(&starts.optional).count() > 1;
    let split = effort.split().filter(|_| has_choice && indices.len() < problem.train.len());
    let Some([subsample_effort, rest]) = split else { return Ok(None) };
    let short_fit = FitProblem {
        max_iterations: INITIAL_ITERATIONS,
        damping_schedule: DampingSchedule::SEQUENTIAL,
        ..*whole_problem
    };
    let survivors =
        fit_subsample(problem, variant, &indices, starts, subsample_effort, &mut caches.subsample)?;
    let mut whole_starts: Vec<Estimate> =
        survivors.iter().filter_map(|estimate| short_fit.fit_initial(estimate)).collect();
    match effort.is_thorough {
        true => whole_starts.extend(
            whole_problem.nearest_starts(&starts.optional, &starts.required, 1, &mut caches.whole).cloned(),
        ),
        false => whole_starts.extend(starts.required.first().cloned()),
    }
    whole_starts.extend(starts.previous.clone());
    Ok(Some((rest, whole_starts)))
}

/// Fits a variant to the records with these indices. Returns the survivors as estimates for all records, the best
/// first. The other records keep the initial voltages of the first start.
fn fit_subsample(
    problem: &Problem,
    variant: &ModelVariant,
    indices: &[usize],
    starts: &Starts,
    effort: Effort,
    cache: &mut StartCache,
) -> Result<Vec<Estimate>, ModelError> {
    let records: Vec<Record> = indices.iter().map(|index| problem.train[*index].clone()).collect();
    let model = problem.model(variant, &records, &problem.outputs)?;
    let reduce = |estimate: &Estimate| {
        let initial = indices.iter().map(|index| estimate.initial[*index].clone());
        Estimate { initial: initial.collect(), ..estimate.clone() }
    };
    let reduce_all = |estimates: &[Estimate]| estimates.iter().map(reduce).collect();
    let reduced_starts = Starts {
        required: reduce_all(&starts.required),
        previous: starts.previous.as_ref().map(reduce),
        optional: reduce_all(&starts.optional),
    };
    let mut all_starts = starts.required.iter().chain(&starts.previous).chain(&starts.optional);
    let Some(first) = all_starts.next() else { return Ok(Vec::new()) };
    let survivors =
        effort.survivors(&problem.fit_problem(&model, &records, true), &reduced_starts, cache).into_iter();
    let expanded = survivors.map(|survivor| {
        let mut initial = first.initial.clone();
        indices.iter().zip(survivor.initial).for_each(|(index, voltages)| initial[*index] = voltages);
        Estimate { initial, ..survivor }
    });
    Ok(expanded.collect())
}

/// Fits another variant from one start, with full effort. It keeps the estimate for pieces of the earlier model.
///
/// # Errors
/// If the patch cannot be run along the records at all.
pub(crate) fn refit(
    problem: &Problem,
    fitted: &FittedModel,
    variant: ModelVariant,
    start: Estimate,
) -> Result<Option<FittedModel>, ModelError> {
    let start = FitStart {
        validation_initial: Some(&fitted.validation.estimate.initial),
        ..FitStart::from_estimates(vec![start])
    };
    let repeated = fit_variant(problem, variant, start, f64::INFINITY)?;
    Ok(repeated.map(|repeated| FittedModel { pieces_estimate: fitted.pieces_estimate.clone(), ..repeated }))
}

/// Indices of the records in the subsample, evenly distributed. All records if they have at most
/// [`SUBSAMPLE_SAMPLES`] samples together.
pub(crate) fn subsample_indices(records: &[Record]) -> Vec<usize> {
    let (count, samples) = (records.len(), records.iter().map(Record::len).sum::<usize>());
    let chosen_count = (SUBSAMPLE_SAMPLES * count / samples.max(1)).max(1).min(count);
    (0..chosen_count).map(|number| number * count / chosen_count).collect()
}
