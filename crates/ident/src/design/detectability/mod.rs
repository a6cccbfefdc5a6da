//! The smallest effects that would be detected in given data.
//!
//! 1. The effect is simulated with some strength in the fitted patch. The change of the outputs is its signal.
//! 2. The part of the signal that parameters, initial voltages and offsets can follow is removed, to first order.
//! 3. The rest is compared with what a search needs: the required `delta_bic` in training, and a confirmation in
//!    validation.
//! 4. If the effect would be detected, the patch is fitted completely to the changed outputs, since parameters may
//!    follow further than to first order. Then the comparison is repeated.

pub(crate) mod detection_limit;
pub(crate) mod detection_test;
pub(crate) mod fit_directions;
pub(crate) mod record_group;
pub(crate) mod strength_scan;

use crate::data::experiment::Experiment;
use crate::design::detectability::detection_test::DetectionTest;
use crate::effects::Library;
use crate::effects::attach::EffectPlacement;
use crate::effects::candidate::Candidate;
use crate::fit::base_fit::fit_base;
use crate::fit::extended_model::attach_effect;
use crate::fit::extended_model::find_sites;
use crate::fit::extended_model::{SkipReason, SkippedTrial};
use crate::fit::fitted_model::{FittedModel, ModelVariant};
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::fit::signal_extents::signal_extents;
use crate::fit::step_size::step_refinement;
use crate::statistics::acceptance::AcceptanceCriterion;
use patchcord_analysis::parallel;

pub use detection_limit::{Detectability, DetectionLimit, best_sites};

/// Fits the patch of an experiment and computes the detection limits of all effects of a library. `problem` is that of
/// the experiment. The limits do not depend on the number of threads. `seed` selects the random starts of the fit.
/// Returns None if the patch can be run from none of the starts.
///
/// # Errors
/// If the patch cannot be simulated with the drives of the records.
///
/// # Examples
///
/// ```no_run
/// use patchcord_ident::report::detection_limits::limit_sentence;
/// use patchcord_ident::{Experiment, Library, Problem, detectable_effects};
///
/// let experiment = Experiment::read("../../examples/05_missing_effect/spring.experiment.json")?;
/// let problem = Problem::of(&experiment)?;
/// let found = detectable_effects(&experiment, &problem, &Library::shipped(), 2, 1)?;
/// let detectability = found.ok_or("the patch cannot be run from any start")?;
/// for sentence in detectability.limits.iter().filter_map(limit_sentence) {
///     println!("{sentence}");
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn detectable_effects(
    experiment: &Experiment,
    problem: &Problem,
    library: &Library,
    threads: usize,
    seed: u64,
) -> Result<Option<Detectability>, ModelError> {
    parallel::with_threads(threads, || {
        let Some(base) = fit_base(problem, &experiment.patch, &experiment.fit, seed)? else {
            return Ok(None);
        };
        detectability_of(problem, &base, library).map(Some)
    })
}

/// The detection limits of all effects in a fitted patch, as if its residual were white noise.
fn detectability_of(
    problem: &Problem,
    base: &FittedModel,
    library: &Library,
) -> Result<Detectability, ModelError> {
    let (sites, peaks) = (find_sites(problem, base)?, signal_extents(problem, base)?);
    let (mut variants, mut skipped) = (Vec::new(), Vec::new());
    for placement in library.iter().flat_map(|effect| EffectPlacement::all(effect, &sites)) {
        match attach_effect(base, &placement, &peaks).and_then(|variant| check_runs(problem, variant)) {
            Ok(variant) => variants.push(variant),
            Err(reason) => skipped.push(SkippedTrial::new(&placement, reason)),
        }
    }
    let variants: Vec<_> = variants.iter().map(|(candidate, variant)| (candidate, variant)).collect();
    let criterion = AcceptanceCriterion::white_noise(variants.len());
    let limits = detection_limits(problem, base, criterion, &variants)?;
    let (residual_rms, step_refinement) = (base.train.normalised_rms(), step_refinement(problem, base)?);
    Ok(Detectability { residual_rms, step_refinement, limits, skipped })
}

/// Returns the variant if it can be simulated with the training records.
fn check_runs(
    problem: &Problem,
    variant: (Candidate, ModelVariant),
) -> Result<(Candidate, ModelVariant), SkipReason> {
    problem.model(&variant.1, &problem.train, &problem.outputs)?;
    Ok(variant)
}

/// The detection limits of effects in the fitted patch `before`. There is one entry per effect, site and parameter:
/// that of the most detectable form. The entries are sorted by `range_fraction`.
///
/// # Errors
/// If the patch cannot be simulated with the drives of the records.
pub(crate) fn detection_limits(
    problem: &Problem,
    before: &FittedModel,
    criterion: AcceptanceCriterion,
    variants: &[(&Candidate, &ModelVariant)],
) -> Result<Vec<DetectionLimit>, ModelError> {
    // Variants with the same number of solver steps share a test.
    let mut tests: Vec<(u32, DetectionTest<'_>)> = Vec::new();
    for (_, variant) in variants {
        let steps = variant.steps;
        if tests.iter().all(|test| test.0 != steps) {
            tests.extend(DetectionTest::new(problem, before, criterion, steps)?.map(|test| (steps, test)));
        }
    }
    let limit_of = |(candidate, variant): &(&Candidate, &ModelVariant)| {
        let test = tests.iter().find(|test| test.0 == variant.steps);
        test.map(|(_, test)| test.limit(candidate, variant)).transpose()
    };
    let results = parallel::map(variants, limit_of, |_| ());
    let results: Vec<Option<DetectionLimit>> = results.into_iter().collect::<Result<_, _>>()?;
    let mut limits: Vec<DetectionLimit> = Vec::new();
    for limit in results.into_iter().flatten() {
        match limits.iter_mut().find(|other| other.is_same_case(&limit)) {
            Some(other) if limit.range_fraction < other.range_fraction => *other = limit,
            Some(_) => (),
            None => limits.push(limit),
        }
    }
    limits.sort_by(|a, b| {
        a.range_fraction
            .total_cmp(&b.range_fraction)
            .then_with(|| (&a.effect, &a.site).cmp(&(&b.effect, &b.site)))
    });
    Ok(limits)
}
