//! Where and when something is missing: at each junction the force that would close the gap, when it acts, and what it goes with.
//!
//! The force is a table over time, found by regularised least squares on what each of its numbers does to the outputs, beside
//! everything that the patch itself leaves free. Junctions are compared by the likelihood of the data with such a force.

pub(crate) mod against;
pub(crate) mod evidence;
pub(crate) mod force;
pub(crate) mod junction;
pub(crate) mod recovered;
pub(crate) mod unknown_input;

use crate::effects::sites::Junction;
use crate::fit::extended_model::sites_of;
use crate::fit::fitted_model::Stage;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use patchcord_analysis::pool;

pub use evidence::Likeness;
pub use force::{Curve, Force, Whereabouts, nearest};

/// What a force would explain at every junction of a stage, the most likely first, worked out on so many threads.
///
/// # Errors
/// When the patch cannot be run beside the records.
pub fn localise(problem: &Problem, stage: &Stage, threads: usize) -> Result<Vec<Whereabouts>, ModelError> {
    let sites = sites_of(problem, stage)?;
    let at = |junction: &Junction| {
        let at = junction::At { problem, stage, sites: &sites, junction };
        match at.whereabouts() {
            // Where a force cannot be wired in, none is told of.
            Err(ModelError::Edit(_) | ModelError::Patch(_)) => Ok(None),
            told => told,
        }
    };
    let found = pool::each(&sites.junctions, threads, at, |_| ());
    let found = found.into_iter().filter_map(Result::transpose);
    let mut found = found.collect::<Result<Vec<Whereabouts>, ModelError>>()?;
    found.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    Ok(found)
}
