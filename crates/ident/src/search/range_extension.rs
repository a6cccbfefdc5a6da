//! Fits with wider parameter ranges.
//!
//! If the best fit of a patch is at an end of a parameter's range, a value outside the range may explain the data
//! without any missing effect. The patch is fitted again with that range ten times wider.

use crate::fit::estimate::FitResult;
use crate::fit::estimation::refit;
use crate::fit::fitted_model::FittedModel;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::search::verdict::Verdict;
use crate::statistics::acceptance::RIVAL_Z;
use crate::statistics::block_comparison::advantage;

/// Factor by which the end of a range moves: away from zero, or towards zero if the end is the one nearer to zero.
const RANGE_FACTOR: f64 = 10.0;

/// A fit of a patch with wider ranges for the parameters that were at an end of their range.
#[derive(Debug, Clone)]
pub struct RangeExtension {
    /// The fit.
    pub model: FittedModel,
    /// The parameters outside their original ranges, as indices into the fitted parameters.
    pub(crate) outside: Vec<usize>,
    /// Whether the data cannot distinguish this fit from the patch with the named effects.
    pub is_rival: bool,
}

impl RangeExtension {
    /// The verdict if the extension is considered as well. A named effect becomes ambiguous if the extension is as
    /// good. An unknown effect becomes inconclusive if the extension leaves only noise.
    pub(crate) fn adjust_verdict(&self, verdict: Verdict) -> Verdict {
        match verdict {
            Verdict::Named if self.is_rival => Verdict::Ambiguous,
            Verdict::UnknownEffect if self.has_white_residual() => Verdict::CannotJudge,
            verdict => verdict,
        }
    }

    /// Whether the fit leaves only noise.
    pub(crate) fn has_white_residual(&self) -> bool {
        !self.model.residuals_are_coloured()
    }
}

/// Fits a patch with wider ranges for the parameters at an end of their range. `final_model` is the patch with the
/// effects that were added.
///
/// Returns None if no parameter is at an end, if the residual of `base` is white, or if all values stay in their
/// ranges.
///
/// # Errors
/// If the patch cannot be simulated with the drives of the records.
pub(crate) fn extend_ranges(
    problem: &Problem,
    base: &FittedModel,
    final_model: &FittedModel,
) -> Result<Option<RangeExtension>, ModelError> {
    let original: Vec<Option<(f64, f64)>> = base.variant.ranges().collect();
    let widened = base.indices_at_range_end().filter_map(|parameter| {
        let (low, high) = widen(original[parameter]?, base.train.estimate.parameters[parameter]);
        (original[parameter] != Some((low, high))).then(|| (&base.variant.fit[parameter], [low, high]))
    });
    let widened: Vec<(&String, [f64; 2])> = widened.collect();
    if widened.is_empty() || !base.residuals_are_coloured() {
        return Ok(None);
    }
    let mut editor = base.variant.patch().edit();
    for (name, range) in widened {
        editor.set_range(name, range)?;
    }
    let patch = editor.finish(base.variant.patch().file())?;
    let variant = base.variant.with_patch(patch);
    let Some(model) = refit(problem, base, variant, base.train.estimate.clone())? else { return Ok(None) };
    let outside: Vec<usize> = model.indices_outside(&original).collect();
    let compare = |fit_of: fn(&FittedModel) -> &FitResult| {
        advantage(&fit_of(&model).residuals, &fit_of(final_model).residuals)
    };
    let final_advantage = compare(|model| &model.train).combined(compare(|model| &model.validation));
    let is_rival = final_advantage.z_score() < RIVAL_Z;
    Ok((!outside.is_empty()).then_some(RangeExtension { model, outside, is_rival }))
}

/// A range that is wider at the end nearer to `value`. It does not cross zero, since the sign of a parameter is
/// known.
fn widen((low, high): (f64, f64), value: f64) -> (f64, f64) {
    let moved = |end: f64, is_outward: bool| if is_outward { end * RANGE_FACTOR } else { end / RANGE_FACTOR };
    match value - low < high - value {
        true => (moved(low, low < 0.0), high),
        false => (low, moved(high, high > 0.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_near_the_value_is_widened_without_crossing_zero() {
        assert_eq!(widen((1.0, 8.0), 8.0), (1.0, 80.0));
        assert_eq!(widen((1.0, 8.0), 1.0), (0.1, 8.0));
        assert_eq!(widen((-3.0, -2.0), -3.0), (-30.0, -2.0));
        assert_eq!(widen((-3.0, -2.0), -2.0), (-3.0, -0.2));
        assert_eq!(widen((0.0, 5.0), 0.0), (0.0, 5.0));
    }
}
