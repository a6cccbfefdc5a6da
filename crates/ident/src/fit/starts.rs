//! Random starts of a fit, and whether fits from other starts reproduce its result.

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng as _, SeedableRng as _};

use crate::fit::estimate::Estimate;
use crate::fit::fitted_model::FittedModel;
use crate::fit::model::{Model, ModelError};
use crate::fit::parameter_values::ParameterValues;
use crate::fit::problem::Problem;

/// The number of random starts.
const RANDOM_STARTS: usize = 4;
/// Two fits agree if their sums of squares differ by less than this. At a
/// difference of 1 a parameter is one standard error away from its optimum.
const AGREEMENT_CHI2: f64 = 1.0;
/// Two fits also agree if their sums of squares differ by less than this fraction.
const AGREEMENT_RATIO: f64 = 1e-3;

/// Random starts. Parameters are uniformly distributed over the middle 80 % of their ranges; the rest equals `nominal`.
pub(crate) fn random_starts(model: &Model, nominal: &Estimate, seed: u64) -> Vec<Estimate> {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let mut draw = || f64::from(generator.next_u32()) / f64::from(u32::MAX);
    let mut parameters =
        || model.parameters.iter().map(|parameter| parameter.value_at(0.1 + 0.8 * draw())).collect();
    (0..RANDOM_STARTS).map(|_| Estimate { parameters: parameters(), ..nominal.clone() }).collect()
}

/// Whether fits from other starts reproduce a fit. If none does, there may be a better fit that was not found.
#[derive(Debug, Clone, PartialEq)]
pub struct StartAgreement {
    /// The number of other starts that were tried until one fit agreed or was better.
    pub tried: usize,
    /// The least rms residual of these fits, in units of sigma. Infinite if none could be run.
    pub normalised_rms: f64,
    /// Whether the last fit agrees.
    pub is_reproduced: bool,
    /// Whether the last fit is better.
    pub is_better: bool,
    /// The fitted parameters of the better fit. Empty if there is none.
    pub values: ParameterValues,
    /// Whether the fits are to pieces of the records, because the original fit was.
    pub uses_pieces: bool,
}

/// Fits from random starts of another seed until one fit agrees with the original, or is better, or no start is left.
///
/// # Errors
/// If the patch cannot be run along the records.
pub(crate) fn agreement_of_starts(
    problem: &Problem,
    fitted: &FittedModel,
    seed: u64,
) -> Result<StartAgreement, ModelError> {
    let pieces_chi2 = chi2_of_pieces(problem, fitted)?;
    let (records, original_chi2) = match pieces_chi2 {
        Some(chi2) => (&problem.pieces, chi2),
        None => (&problem.train, fitted.train.chi2),
    };
    let model = problem.model(&fitted.variant, records, &problem.outputs)?;
    let nominal = Estimate::nominal(&model, problem.outputs.len());
    let fit_problem = problem.fit_problem(&model, records, true);
    let mut agreement = StartAgreement {
        tried: 0,
        normalised_rms: f64::INFINITY,
        is_reproduced: false,
        is_better: false,
        values: ParameterValues::default(),
        uses_pieces: pieces_chi2.is_some(),
    };
    for start in random_starts(&model, &nominal, seed.wrapping_add(1)) {
        agreement.tried += 1;
        let Some(result) = fit_problem.fit_initial(&start).and_then(|start| fit_problem.fit(&start)) else {
            continue;
        };
        agreement.normalised_rms = agreement.normalised_rms.min(result.normalised_rms());
        let decrease = original_chi2 - result.chi2;
        agreement.is_reproduced = decrease.abs() < AGREEMENT_CHI2.max(AGREEMENT_RATIO * original_chi2);
        agreement.is_better = decrease > 0.0 && !agreement.is_reproduced;
        if agreement.is_better {
            agreement.values = fitted.parameter_values(&result.estimate);
        }
        if agreement.is_reproduced || agreement.is_better {
            break;
        }
    }
    Ok(agreement)
}

/// The sum of squares of the fit to pieces. `None` if the model was not fitted to pieces or cannot be run there.
fn chi2_of_pieces(problem: &Problem, fitted: &FittedModel) -> Result<Option<f64>, ModelError> {
    let Some(estimate) = &fitted.pieces_estimate else { return Ok(None) };
    let model = problem.model(&fitted.variant, &problem.pieces, &problem.outputs)?;
    Ok(problem.fit_problem(&model, &problem.pieces, true).evaluate(estimate).map(|result| result.chi2))
}

#[cfg(test)]
mod tests {
    use super::agreement_of_starts;
    use crate::fit::base_fit::fit_base;
    use crate::fit::step_size::tests::decay;

    #[test]
    fn a_better_fit_from_another_start_is_reported_with_its_values() {
        let (patch, fit, problem) = decay(1e-3, 32);
        let mut fitted = fit_base(&problem, &patch, &fit, 1).unwrap().unwrap();
        let reproduced = agreement_of_starts(&problem, &fitted, 1).unwrap();
        assert!(reproduced.is_reproduced && reproduced.values.0.is_empty());
        // The sum of squares of a fit that did not leave its start.
        fitted.train.chi2 = 1e9;
        let better = agreement_of_starts(&problem, &fitted, 1).unwrap();
        let [(name, rate, unit)] = better.values.0.as_slice() else { panic!("{better:?}") };
        assert!(better.is_better && (name.as_str(), unit.as_str()) == ("rate", "1"), "{better:?}");
        assert!((rate - 2.0).abs() < 1e-3, "{rate}");
    }
}
