//! The input of a junction as a curve over a regressor, from the normal equations of the input over time.
//!
//! No further runs are needed, so that every regressor is tried. A curve with more knots, or one for each direction of
//! the regressor, is used only if its evidence is decisively larger.

use crate::fit::estimate::Estimate;
use crate::localise::evidence::InputPosterior;
use crate::localise::input_basis::InputBasis;
use crate::localise::junction::JunctionAnalysis;
use crate::localise::localisation::{DECISIVE_EVIDENCE, InputCurve};
use crate::localise::regressor::Regressor;
use crate::localise::unknown_input::{InputEstimation, InputFit};

/// The number of knots of a curve. The second is used if its evidence is clearly larger.
const CURVE_KNOTS: [usize; 2] = [24, 72];

/// A curve over a regressor, with the nuisance parameters that belong to it.
pub(super) struct CandidateCurve {
    /// The curve.
    pub curve: InputCurve,
    /// Parameters, initial voltages and offsets.
    pub estimate: Estimate,
}

/// The posterior of a curve over a regressor, or of one for each direction.
struct CurvePosterior {
    /// The number of knots that was requested.
    knot_count: usize,
    /// The knots, including those about zero.
    knots: Vec<f64>,
    /// The posterior of the values at the knots: of one curve, or of the rising and then the falling one.
    posterior: InputPosterior,
}

impl CurvePosterior {
    /// Regressor, input and standard error at every knot. `first` is the index of the curve's first coefficient.
    fn points(&self, first: usize) -> Vec<[f64; 3]> {
        let point = |(index, knot): (usize, &f64)| {
            let variance = self.posterior.covariance[(first + index, first + index)];
            [*knot, self.posterior.coefficients[first + index], variance.max(0.0).sqrt()]
        };
        self.knots.iter().enumerate().map(point).collect()
    }
}

impl JunctionAnalysis<'_> {
    /// The input as a curve over a regressor. `None` if the regressor is constant.
    pub(super) fn candidate_curve(
        &self,
        input_estimation: &InputEstimation<'_>,
        regressor: &Regressor,
        fit: &InputFit,
        inputs: &[Vec<[f64; 2]>],
    ) -> Option<CandidateCurve> {
        let posterior = |knot_count, by_direction| {
            self.curve_posterior(input_estimation.basis, regressor, fit, knot_count, by_direction)
        };
        let is_decisive = |other: &CurvePosterior, simple: &CurvePosterior| {
            other.posterior.evidence > simple.posterior.evidence + DECISIVE_EVIDENCE
        };
        let [few, many] = CURVE_KNOTS;
        let coarse = posterior(few, false)?;
        let fine = posterior(many, false).filter(|fine| is_decisive(fine, &coarse));
        let single = fine.unwrap_or(coarse);
        let double = posterior(single.knot_count, true).filter(|double| is_decisive(double, &single));
        let curve = InputCurve {
            regressor: regressor.name.clone(),
            unit: regressor.unit.clone(),
            points: single.points(0),
            by_direction: double.map(|double| [double.points(0), double.points(double.knots.len())]),
            explained_fraction: self.explained_fraction(single.posterior.chi2),
            evidence: single.posterior.evidence,
            validation_fraction: None,
            scatter: self.scatter(regressor, inputs),
        };
        let estimate = input_estimation.nuisance_estimate(fit, &single.posterior);
        Some(CandidateCurve { curve, estimate })
    }

    /// The posterior of a curve with about `knot_count` knots, or of one for each direction of the regressor.
    fn curve_posterior(
        &self,
        basis: &InputBasis,
        regressor: &Regressor,
        fit: &InputFit,
        knot_count: usize,
        by_direction: bool,
    ) -> Option<CurvePosterior> {
        let knots = regressor.knots(knot_count)?;
        let weights = regressor.curve_weights(basis, &knots, by_direction, &self.intervals());
        let groups = vec![knots.len(); weights.ncols() / knots.len()];
        let posterior = fit.equations.in_basis(&weights, groups).solve()?;
        Some(CurvePosterior { knot_count, posterior, knots })
    }

    /// Pairs of regressor and input at the knots of the input over time.
    fn scatter(&self, regressor: &Regressor, inputs: &[Vec<[f64; 2]>]) -> Vec<[f64; 2]> {
        let records = inputs.iter().zip(self.intervals()).enumerate();
        let points = records.flat_map(|(record, (points, interval))| {
            points.iter().map(move |[time, input]| [regressor.value_at(record, *time, interval), *input])
        });
        points.collect()
    }
}
