//! Curves that are wired in as function generators and fitted again, with their feedback.
//!
//! A curve changes its own regressor, so that its fit needs runs of the model. The most likely curves are wired in, and
//! the first that explains the validation records describes the input.

use crate::effects::sites::ScaledSignal;
use crate::fit::estimate::{Estimate, FitResult};
use crate::fit::model::{ModelError, ReplacedTable};
use crate::fit::schedule::Effort;
use crate::fit::validation::validate;
use crate::localise::candidate_curve::CandidateCurve;
use crate::localise::input_basis::interpolated;
use crate::localise::junction::{JunctionAnalysis, explained_fraction};
use crate::localise::localisation::{DECISIVE_EVIDENCE, InputCurve};
use crate::localise::recovered::{function_basis, with_function};
use crate::localise::regressor::Regressor;
use crate::localise::unknown_input::{InputEstimation, InputFit, InputStart};
use patchcord_core::patch::Patch;

/// Fraction that a wired curve must explain of the validation records' excess. Otherwise its evidence must exceed that
/// of the input over time.
const MIN_VALIDATION_FRACTION: f64 = 0.7;
/// Fraction that a curve must explain of the training records' excess.
const MIN_EXPLAINED: f64 = 0.5;
/// If a wired curve leaves more than this multiple of the excess that it left without feedback, its fit starts again
/// from a coarse curve.
const RESTART_RATIO: f64 = 1.1;
/// If it still leaves more than this multiple, and explains less than [`PHASE_LOCKED_FRACTION`], it counts as diverged.
const DIVERGED_RATIO: f64 = 2.0;
/// Fraction that a curve explains if the model moves in phase with the data.
const PHASE_LOCKED_FRACTION: f64 = 0.8;
/// Fractions of the records from which a diverged curve is fitted in turn.
const RECORD_FRACTIONS: [f64; 6] = [0.1, 0.2, 0.35, 0.55, 0.75, 1.0];
/// Largest number of curves that are wired in. Each takes as long as the input over time.
const MAX_WIRED_CURVES: usize = 2;

/// A curve that was wired in as a function generator and fitted.
pub(super) struct WiredCurve {
    /// The patch with the function generator.
    pub patch: Patch,
    /// The fit to the training records, with feedback.
    pub fit: InputFit,
    /// The fit of initial voltages and offsets to the validation records.
    validation: FitResult,
}

impl JunctionAnalysis<'_> {
    /// The curve that describes the input: its index, and the wired curve if it could be wired in.
    ///
    /// The most likely curves are wired in. The first that explains the validation records wins. A curve that cannot be
    /// wired in wins if it is more likely than the input over time.
    pub(super) fn best_curve(
        &self,
        candidates: &mut [CandidateCurve],
        regressors: &[Regressor],
        over_time: &InputFit,
    ) -> Option<(usize, Option<WiredCurve>)> {
        let is_explaining = |index: &usize| candidates[*index].curve.explained_fraction > MIN_EXPLAINED;
        let mut open: Vec<usize> = (0..candidates.len()).filter(is_explaining).collect();
        for _ in 0..MAX_WIRED_CURVES {
            let more_likely = |best: usize, other: usize| {
                let [best_evidence, evidence] = [best, other].map(|index| candidates[index].curve.evidence);
                if evidence > best_evidence + DECISIVE_EVIDENCE { other } else { best }
            };
            let Some(index) = open.iter().copied().reduce(more_likely) else { break };
            open.retain(|other| *other != index);
            let CandidateCurve { curve, estimate } = &mut candidates[index];
            let regressor = regressors.iter().find(|regressor| regressor.name == curve.regressor);
            let signal = regressor.and_then(|regressor| regressor.signal.as_ref());
            // A curve beyond the range of the machine cannot be wired in.
            let wired = signal.and_then(|signal| self.wired_curve(signal, curve, estimate).ok().flatten());
            let Some(wired) = wired else {
                if curve.evidence > over_time.evidence {
                    return Some((index, None));
                }
                continue;
            };
            let validation_fraction = explained_fraction(&self.fitted.validation, wired.validation.chi2);
            curve.validation_fraction = Some(validation_fraction);
            if validation_fraction > MIN_VALIDATION_FRACTION
                || (validation_fraction > 0.0 && curve.evidence > over_time.evidence)
            {
                // The curves by direction remain those of the input over time.
                curve.explained_fraction = self.explained_fraction(wired.fit.chi2);
                let values = wired.fit.coefficients.iter().zip(&wired.fit.errors);
                let points = curve.points.iter_mut().zip(values);
                points.for_each(|(point, (value, error))| *point = [point[0], *value, *error]);
                return Some((index, Some(wired)));
            }
        }
        None
    }

    /// Whether a wired curve leaves more than `ratio` times the excess that it left without feedback.
    fn leaves_more(&self, wired: &InputFit, curve: &InputCurve, ratio: f64) -> bool {
        let leaves_excess = wired.chi2 > self.noise_chi2();
        leaves_excess && 1.0 - self.explained_fraction(wired.chi2) > ratio * (1.0 - curve.explained_fraction)
    }

    /// Whether the model with a wired curve is out of phase with the data: it leaves far more than expected, and much.
    fn is_diverged(&self, wired: &InputFit, curve: &InputCurve) -> bool {
        self.leaves_more(wired, curve, DIVERGED_RATIO)
            && self.explained_fraction(wired.chi2) < PHASE_LOCKED_FRACTION
    }

    /// Wires a curve in as a function generator of a signal, and fits it again with its feedback. `None` if no fit
    /// succeeds or the validation records cannot be run.
    ///
    /// The fit starts from the curve. If that leaves too much, it also starts from a coarse curve, and then from
    /// growing beginnings of the records. The least sum of squares wins.
    fn wired_curve(
        &self,
        signal: &ScaledSignal,
        curve: &InputCurve,
        estimate: &Estimate,
    ) -> Result<Option<WiredCurve>, ModelError> {
        let column = |index: usize| curve.points.iter().map(|point| point[index]).collect::<Vec<f64>>();
        let (knots, values) = (column(0), column(1));
        let basis = function_basis(&knots, self.junction, signal, self.problem.train.len());
        let wire = |values: &[f64]| {
            let points = basis.points(0, values);
            with_function(self.fitted.variant.patch(), self.junction, signal, &points)
        };
        let (patch, element) = wire(&values)?;
        let variant = self.variant(patch);
        let model = self.problem.model(&variant, &self.problem.train, &self.problem.outputs)?;
        let fit_problem = self.problem.fit_problem(&model, &self.problem.train, true);
        let input_estimation = self.input_estimation(fit_problem, ReplacedTable::Curve(&element), &basis);
        let from_curve = InputStart { estimate, coefficients: Some(&values) };
        let from_zero = InputStart { estimate: &self.fitted.train.estimate, coefficients: None };
        let mut fit = input_estimation.solve(&from_curve);
        let by_chi2 = |a: &InputFit, b: &InputFit| a.chi2.total_cmp(&b.chi2);
        if fit.as_ref().is_none_or(|fit| self.leaves_more(fit, curve, RESTART_RATIO)) {
            let restarted = solve_from_coarse_curve(&input_estimation, &knots, from_zero);
            fit = fit.into_iter().chain(restarted).min_by(by_chi2);
        }
        if fit.as_ref().is_none_or(|fit| self.is_diverged(fit, curve)) {
            let progressive = input_estimation.solve_progressively(&RECORD_FRACTIONS);
            fit = fit.into_iter().chain(progressive).min_by(by_chi2);
        }
        let Some(fit) = fit else { return Ok(None) };
        let (patch, _) = wire(&fit.coefficients)?;
        let variant = self.variant(patch);
        let validation = validate(
            self.problem,
            &variant,
            &fit.estimate,
            Some(&self.fitted.validation.estimate.initial),
            Effort::FULL,
        )?;
        Ok(validation.map(|validation| WiredCurve { patch: variant.patch().clone(), fit, validation }))
    }
}

/// Fits a curve from a coarse one. The coarse curve is fitted first, from `from_zero`. If that fails, the curve itself
/// is fitted from `from_zero`.
fn solve_from_coarse_curve(
    input_estimation: &InputEstimation<'_>,
    knots: &[f64],
    from_zero: InputStart<'_>,
) -> Option<InputFit> {
    let coarse_knots = coarse_knot_indices(knots);
    let coarse_basis = input_estimation.basis.coarsened(&coarse_knots);
    let coarse = InputEstimation { basis: &coarse_basis, ..*input_estimation }.solve(&from_zero);
    let coarse =
        coarse.map(|fit| (interpolated(&coarse_knots, &fit.coefficients, knots.len()), fit.estimate));
    let start = coarse
        .as_ref()
        .map(|(coefficients, estimate)| InputStart { estimate, coefficients: Some(coefficients) });
    input_estimation.solve(&start.unwrap_or(from_zero))
}

/// Indices of the knots of a coarse curve: the ends, those about zero, and one between each of these.
fn coarse_knot_indices(knots: &[f64]) -> Vec<usize> {
    let last = knots.len() - 1;
    let zero = knots.partition_point(|knot| *knot < 0.0).clamp(1, last);
    let mut indices = vec![0, (zero - 1) / 2, zero - 1, zero, (zero + last) / 2, last];
    indices.dedup();
    indices
}
