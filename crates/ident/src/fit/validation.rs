//! Validation: the fitted parameters are applied to the records that were held back.
//!
//! Only the initial voltages and declared offsets are fitted there. If the result is doubtful, the initial voltages are
//! searched from many starts. [`is_validation_worse`] then decides whether the model predicts the validation records as
//! well as it explains the training records.

use crate::data::record::Record;
use crate::fit::estimate::{Estimate, FitResult, squared_residuals};
use crate::fit::fitted_model::{FittedModel, ModelVariant};
use crate::fit::levenberg_marquardt::{FitProblem, MAX_ITERATIONS};
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::fit::schedule::{Effort, Starts};
use crate::fit::start_cache::StartCache;
use crate::statistics::descriptive::mean;

/// The number of iterations of a validation in a quick look.
pub(crate) const QUICK_VALIDATION_ITERATIONS: usize = 2;

/// Ratio of the rms residuals of validation and training from which the initial voltages of the validation records are
/// doubtful. The rms of training counts as at least 1.
const DOUBTFUL_RATIO: f64 = 1.5;
/// The voltages at which the search for the initial voltage of a state begins, in V.
const START_VOLTAGES: [f64; 10] = [-80.0, -30.0, -10.0, -3.0, -1.0, 1.0, 3.0, 10.0, 30.0, 80.0];

/// Applies the parameters of an estimate to the validation records. Only initial voltages and offsets are fitted.
///
/// The fit starts from `initial`, the initial voltages of an earlier fit, and from the declared voltages. `None` if the
/// patch can be run from neither.
///
/// # Errors
/// If the patch cannot be run along the records at all.
pub(crate) fn validate(
    problem: &Problem,
    variant: &ModelVariant,
    estimate: &Estimate,
    initial: Option<&[Vec<f64>]>,
    effort: Effort,
) -> Result<Option<FitResult>, ModelError> {
    let model = problem.model(variant, &problem.validation, &problem.outputs)?;
    let nominal = Estimate::nominal(&model, problem.outputs.len());
    let nominal =
        Estimate { parameters: estimate.parameters.clone(), offsets: estimate.offsets.clone(), ..nominal };
    let previous = initial
        .map(|initial| Estimate { initial: complete_initial(initial, &nominal.initial), ..nominal.clone() });
    let max_iterations = if effort.is_thorough { MAX_ITERATIONS } else { QUICK_VALIDATION_ITERATIONS };
    // Pieces begin with measured values, so that one start is sufficient.
    let start_count = if effort.is_thorough && !problem.is_cut { 2 } else { 1 };
    let fit_problem =
        FitProblem { max_iterations, ..problem.fit_problem(&model, &problem.validation, false) };
    let starts = previous.into_iter().chain([nominal]).take(start_count);
    Ok(FitResult::best_of(starts.filter_map(|start| fit_problem.evaluate(&fit_problem.fit_initial(&start)?))))
}

/// Repeats a doubtful validation from many initial voltages. `None` if the validation is not doubtful or does not
/// improve.
///
/// # Errors
/// If the patch cannot be run along the records.
pub(crate) fn revalidate(problem: &Problem, fitted: &FittedModel) -> Result<Option<FittedModel>, ModelError> {
    // Pieces begin with measured values and are short, so that their initial voltages are never doubtful.
    if problem.is_cut || !has_doubtful_initial(problem, fitted) {
        return Ok(None);
    }
    let records = problem.validation.iter().zip(&fitted.validation.estimate.initial);
    let searched = records.map(|(record, initial)| search_initial(problem, fitted, record, initial));
    let initial = searched.collect::<Result<Vec<_>, _>>()?;
    let repeated = validate(problem, &fitted.variant, &fitted.train.estimate, Some(&initial), Effort::FULL)?;
    let better = repeated.filter(|repeated| repeated.chi2 < fitted.validation.chi2);
    Ok(better.map(|validation| FittedModel { validation, ..fitted.clone() }))
}

/// Whether the initial voltages of the validation records may be wrong: the validation is much worse than the training,
/// or it is significantly worse although the training residuals are white.
fn has_doubtful_initial(problem: &Problem, fitted: &FittedModel) -> bool {
    let is_explained = !fitted.residuals_are_coloured();
    let is_much_worse =
        fitted.validation.normalised_rms() >= DOUBTFUL_RATIO * fitted.train.normalised_rms().max(1.0);
    is_much_worse || is_explained && is_any_validation_worse(problem, fitted)
}

/// Searches the initial voltages of a record, with growing fractions of the record. Starts change one state of `known`
/// at a time. Returns `known` if no start can be run.
fn search_initial(
    problem: &Problem,
    fitted: &FittedModel,
    record: &Record,
    known: &[f64],
) -> Result<Vec<f64>, ModelError> {
    let record = std::slice::from_ref(record);
    let model = problem.model(&fitted.variant, record, &problem.outputs)?;
    let fit_problem = problem.fit_problem(&model, record, false);
    let with_initial =
        |initial: Vec<f64>| Estimate { initial: vec![initial], ..fitted.train.estimate.clone() };
    let variations = |state: usize| {
        let [low, high] = model.initial[state].range;
        let allowed = START_VOLTAGES.into_iter().filter(move |volts| (low..=high).contains(volts));
        allowed.map(move |volts| {
            let mut initial = known.to_vec();
            initial[state] = volts;
            initial
        })
    };
    let starts = Starts {
        required: vec![with_initial(known.to_vec())],
        optional: (0..known.len()).flat_map(variations).map(with_initial).collect(),
        ..Starts::default()
    };
    let best = Effort::UNKNOWN_INITIAL.best(&fit_problem, &starts, &mut StartCache::default());
    Ok(best.map_or_else(|| known.to_vec(), |best| best.initial[0].clone()))
}

/// Completes the initial voltages of the first states of every record with those of the other states in `all`.
fn complete_initial(first: &[Vec<f64>], all: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let pairs = first.iter().zip(all);
    pairs.map(|(first, all)| first.iter().chain(&all[first.len()..]).copied().collect()).collect()
}

/// Ratio of rms residuals, validation to training, from which the validation is worse whatever its standard error.
const WORSE_RATIO: f64 = 2.0;
/// Difference of mean squared residuals, in standard errors, from which the validation is worse.
const WORSE_Z: f64 = 5.0;

/// Whether the residuals of an output are significantly larger in validation than in training.
pub(crate) fn is_validation_worse(fitted: &FittedModel, output: usize) -> bool {
    let [training, validation] =
        [&fitted.train, &fitted.validation].map(|result| squared_residuals(&result.residuals, output));
    is_significantly_larger(&training, &validation, fitted.autocorrelation_time)
}

/// Whether the mean of squared residuals `after` is significantly larger than that of `before`, or than 1 if that is
/// larger. `autocorrelation_time` is in samples.
pub(crate) fn is_significantly_larger(before: &[f64], after: &[f64], autocorrelation_time: f64) -> bool {
    let (mean_before, mean_after) = (mean(before).max(1.0), mean(after));
    // The mean of the squares of m independent normal numbers has the relative standard error sqrt(2 / m).
    let [variance_before, variance_after] =
        [before, after].map(|squares| 2.0 * autocorrelation_time / squares.len().max(1) as f64);
    let limit = WORSE_Z
        * (variance_before * mean_before * mean_before + variance_after * mean_after * mean_after).sqrt();
    mean_after > WORSE_RATIO * WORSE_RATIO * mean_before || mean_after - mean_before > limit
}

/// Whether the validation is worse than the training for any output.
pub(crate) fn is_any_validation_worse(problem: &Problem, fitted: &FittedModel) -> bool {
    (0..problem.outputs.len()).any(|output| is_validation_worse(fitted, output))
}
