//! The weakest effects that data would have shown.
//!
//! An effect of some strength is run beside the patch as it was fitted. What it changes in the outputs, less all that parameters,
//! initial voltages and offsets follow when they are fitted again (to first order), is what the search has to find it by: as
//! much as its score asks for in training, and as its confirmation asks for in the data that are held back. What would show so is
//! fitted in full: parameters may follow further than to first order.

pub(crate) mod cleared;
pub(crate) mod detection_limit;
pub(crate) mod ground;
pub(crate) mod half;
pub(crate) mod tried;

use crate::design::detectability::ground::Ground;
use crate::effects::Library;
use crate::effects::attach::Attached;
use crate::effects::candidate::Candidate;
use crate::fit::base_fit::fit_base;
use crate::fit::extended_model::attach_effect;
use crate::fit::extended_model::sites_of;
use crate::fit::extended_model::{LeftOut, Untried};
use crate::fit::fitted_model::{Stage, Version};
use crate::fit::model::ModelError;
use crate::fit::peaks::peaks_of;
use crate::fit::problem::Problem;
use crate::statistics::acceptance::Bar;
use patchcord_analysis::{pool, spare};
use patchcord_core::patch::Patch;

pub use detection_limit::{Limit, Visible, best_places};

/// What the data could show of the effects of a library beside a patch, once it is fitted; nothing where it can be run from none
/// of the points tried.
///
/// # Errors
/// When the patch cannot be run beside the records at all.
pub fn visible_effects(
    problem: &Problem,
    patch: &Patch,
    fit: &[String],
    library: &Library,
    threads: usize,
    seed: u64,
) -> Result<Option<Visible>, ModelError> {
    spare::with_threads(threads, || {
        let Some(base) = fit_base(problem, patch, fit, seed)? else { return Ok(None) };
        visible_beside(problem, &base, library, threads).map(Some)
    })
}

fn visible_beside(
    problem: &Problem,
    base: &Stage,
    library: &Library,
    threads: usize,
) -> Result<Visible, ModelError> {
    let (sites, peaks) = (sites_of(problem, base)?, peaks_of(problem, base)?);
    let (mut wired, mut left_out) = (Vec::new(), Vec::new());
    for attached in library.iter().flat_map(|effect| Attached::all(effect, &sites)) {
        match attach_effect(base, &attached, &peaks).and_then(|own| if_runs(problem, own)) {
            Ok(own) => wired.push(own),
            Err(why) => left_out.push(LeftOut::of(&attached, &why)),
        }
    }
    let wired: Vec<_> = wired.iter().map(|(candidate, version)| (candidate, version)).collect();
    let limits = detection_limits(problem, base, Bar::of_noise(wired.len()), &wired, threads)?;
    Ok(Visible { leaves: base.train.over_noise(), limits, left_out })
}

/// What is wired, if it can be run beside the records.
fn if_runs(problem: &Problem, own: (Candidate, Version)) -> Result<(Candidate, Version), Untried> {
    problem.model(&own.1, &problem.train, &problem.outputs)?;
    Ok(own)
}

/// The weakest effects that would have been seen of all that were tried beside a stage, those that show best first, worked out
/// on so many threads.
///
/// # Errors
/// When the patch cannot be run beside the records.
pub(crate) fn detection_limits(
    problem: &Problem,
    before: &Stage,
    bar: Bar,
    tried: &[(&Candidate, &Version)],
    threads: usize,
) -> Result<Vec<Limit>, ModelError> {
    let mut grounds: Vec<(u32, Ground<'_>)> = Vec::new();
    for (_, version) in tried {
        let steps = version.steps;
        if grounds.iter().all(|own| own.0 != steps) {
            grounds.extend(Ground::of(problem, before, bar, steps)?.map(|ground| (steps, ground)));
        }
    }
    let of = |(candidate, version): &(&Candidate, &Version)| {
        let ground = grounds.iter().find(|own| own.0 == version.steps);
        ground.map(|(_, ground)| ground.limit(candidate, version)).transpose()
    };
    let found = pool::each(tried, threads, of, |_| ());
    let found: Vec<Option<Limit>> = found.into_iter().collect::<Result<_, _>>()?;
    let mut limits: Vec<Limit> = Vec::new();
    for limit in found.into_iter().flatten() {
        match limits.iter_mut().find(|own| own.is_of(&limit)) {
            Some(own) if limit.share < own.share => *own = limit,
            Some(_) => (),
            None => limits.push(limit),
        }
    }
    limits.sort_by(|a, b| {
        a.share.total_cmp(&b.share).then_with(|| (&a.effect, &a.junction).cmp(&(&b.effect, &b.junction)))
    });
    Ok(limits)
}
