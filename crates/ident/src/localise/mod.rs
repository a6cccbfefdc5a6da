//! Localisation: at which junction, when, and on what an unknown input must depend to explain the residuals.
//!
//! At each junction an input over time is estimated, jointly with everything that the patch leaves free
//! (`unknown_input`, with the regularised least squares of `evidence`). The junctions are compared by the marginal
//! likelihood of the data. Then the input is tested as a curve over signals of the patch (`regressor`,
//! `candidate_curve`). The best curve is wired in as a function generator and validated (`wired_curve`, `recovered`).

pub(crate) mod candidate_curve;
pub(crate) mod diagonal_problem;
pub(crate) mod evidence;
pub(crate) mod input_basis;
pub(crate) mod junction;
pub(crate) mod localisation;
pub(crate) mod recovered;
pub(crate) mod regressor;
pub(crate) mod unknown_input;
pub(crate) mod wired_curve;

use crate::effects::sites::Junction;
use crate::fit::extended_model::find_sites;
use crate::fit::fitted_model::FittedModel;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use patchcord_analysis::parallel;

pub use evidence::SmoothnessPrior;
pub use localisation::{EstimatedInput, InputCurve, Localisation, indistinguishable_junctions};

/// Estimates an unknown input at every junction of a fitted model. The results are in order of
/// evidence, the largest first. Junctions at which no input can be wired in, or none is better than no input, are left
/// out.
///
/// # Errors
/// If the patch cannot be run along the records.
pub fn localise(problem: &Problem, fitted: &FittedModel) -> Result<Vec<Localisation>, ModelError> {
    let sites = find_sites(problem, fitted)?;
    let localise_at = |junction: &Junction| {
        let analysis = junction::JunctionAnalysis { problem, fitted, sites: &sites, junction };
        match analysis.localise() {
            Err(ModelError::Edit(_) | ModelError::Patch(_)) => Ok(None),
            result => result,
        }
    };
    let results = parallel::map(&sites.junctions, localise_at, |_| ());
    let results = results.into_iter().filter_map(Result::transpose);
    let mut localisations = results.collect::<Result<Vec<Localisation>, ModelError>>()?;
    localisations.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    Ok(localisations)
}
