//! Points scattered over the ranges of what is fitted, from which fits begin, and whether they lead to the same.

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng as _, SeedableRng as _};

use crate::fit::estimate::Point;
use crate::fit::fitted_model::Stage;
use crate::fit::model::{Model, ModelError};
use crate::fit::parameter_values::ParameterValues;
use crate::fit::problem::Problem;

/// So many points are scattered over the ranges.
const SCATTERED: usize = 4;
/// Two fits came to the same where their sums of squares differ by less than this,
const SAME: f64 = 1.0;
/// or by less than this share.
const SAME_SHARE: f64 = 1e-3;

/// A point for each of several draws by chance: knobs over their ranges, all else where the patch stands.
pub(crate) fn scattered(model: &Model, first: &Point, seed: u64) -> Vec<Point> {
    let mut dice = ChaCha8Rng::seed_from_u64(seed);
    let mut draw = || f64::from(dice.next_u32()) / f64::from(u32::MAX);
    let mut knobs = || model.knobs.iter().map(|knob| knob.at(0.1 + 0.8 * draw())).collect();
    (0..SCATTERED).map(|_| Point { knobs: knobs(), ..first.clone() }).collect()
}

/// Whether fits of the patch from elsewhere come to the same: if not, there may be a better one that none has come to.
#[derive(Debug, Clone, PartialEq)]
pub struct Agreement {
    /// From so many other points fits were gone through with, until one came to the same.
    pub tried: usize,
    /// What the best of them left, rms over the noise; infinite where none could be run.
    pub left: f64,
    /// Whether that is the same.
    pub is_same: bool,
    /// Whether it is less.
    pub is_better: bool,
    /// Where it is less: what is fitted, each with its value and its unit.
    pub values: ParameterValues,
    /// Whether runs begin anew in each of them, as where the patch itself was fitted so first.
    pub in_pieces: bool,
}

/// Fits the patch of a stage from other points than those of its own seed, until one comes to the same, or to less, or there are no more.
///
/// # Errors
/// When the patch cannot be run beside the records.
pub(crate) fn agreement_of_starts(
    problem: &Problem,
    stage: &Stage,
    seed: u64,
) -> Result<Agreement, ModelError> {
    let in_pieces = chi2_of_pieces(problem, stage)?;
    let (records, best) = match in_pieces {
        Some(chi2) => (&problem.pieces, chi2),
        None => (&problem.train, stage.train.chi2),
    };
    let model = problem.model(&stage.version, records, &problem.outputs)?;
    let first = Point::of(&model, problem.outputs.len());
    let task = problem.task(&model, records, true);
    let mut agreement = Agreement {
        tried: 0,
        left: f64::INFINITY,
        is_same: false,
        is_better: false,
        values: ParameterValues::default(),
        in_pieces: in_pieces.is_some(),
    };
    for point in scattered(&model, &first, seed.wrapping_add(1)) {
        agreement.tried += 1;
        let Some(fitted) = task.settled(&point).and_then(|point| task.fit(&point)) else { continue };
        agreement.left = agreement.left.min(fitted.over_noise());
        let lower = best - fitted.chi2;
        agreement.is_same = lower.abs() < SAME.max(SAME_SHARE * best);
        agreement.is_better = lower > 0.0 && !agreement.is_same;
        if agreement.is_better {
            agreement.values = stage.values_at(&fitted.point);
        }
        if agreement.is_same || agreement.is_better {
            break;
        }
    }
    Ok(agreement)
}

/// The sum of squares that a stage left of the pieces, where it was fitted to these first.
fn chi2_of_pieces(problem: &Problem, stage: &Stage) -> Result<Option<f64>, ModelError> {
    let Some(point) = &stage.in_pieces else { return Ok(None) };
    let model = problem.model(&stage.version, &problem.pieces, &problem.outputs)?;
    Ok(problem.task(&model, &problem.pieces, true).told(point).map(|fitted| fitted.chi2))
}

#[cfg(test)]
mod tests {
    use super::agreement_of_starts;
    use crate::fit::base_fit::fit_base;
    use crate::fit::step_size::tests::decay;

    #[test]
    fn where_a_better_fit_begins_is_told() {
        let (patch, fit, problem) = decay(1e-3, 32);
        let mut stage = fit_base(&problem, &patch, &fit, 1).unwrap().unwrap();
        let same = agreement_of_starts(&problem, &stage, 1).unwrap();
        assert!(same.is_same && same.values.0.is_empty());
        // As of a fit that stayed where it began.
        stage.train.chi2 = 1e9;
        let better = agreement_of_starts(&problem, &stage, 1).unwrap();
        let [(name, rate, unit)] = better.values.0.as_slice() else { panic!("{better:?}") };
        assert!(better.is_better && (name.as_str(), unit.as_str()) == ("rate", "1"), "{better:?}");
        assert!((rate - 2.0).abs() < 1e-3, "{rate}");
    }
}
