//! The result of localisation: for a junction, the unknown input that would explain the residuals, and what it depends
//! on.

use crate::localise::evidence::SmoothnessPrior;
use patchcord_core::patch::Patch;

/// The unknown input that would explain the residuals if it acted at one junction.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Localisation {
    /// The name of the integrator.
    pub junction: String,
    /// The unit of the input: that of the sum which drives the integrator.
    pub unit: String,
    /// The fraction of the excess of reduced chi-squared that the input explains; 1 if only noise remains.
    pub explained_fraction: f64,
    /// Logarithm of the marginal likelihood, relative to that without an input. Junctions are compared by it.
    pub evidence: f64,
    /// The effective number of parameters of the input.
    pub effective_parameters: f64,
    /// Whether the input is smooth or may jump.
    pub prior: SmoothnessPrior,
    /// The input over time, for every record.
    pub inputs: Vec<EstimatedInput>,
    /// The input as a curve over each regressor: first the junction's own output, then positions, drives and the other
    /// junctions' outputs, last the time at rest.
    pub curves: Vec<InputCurve>,
    /// The index of the curve that describes the input. `None` if the input only depends on time.
    pub best_curve: Option<usize>,
    /// The patch with the input as a function generator or as a table over time. All parameters have their fitted
    /// values.
    pub recovered: Patch,
}

/// An input over time in one record.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct EstimatedInput {
    /// The file of the record.
    pub data: String,
    /// Rows of: time in seconds on the time axis of the file, input, its standard error, and its standard error if all
    /// other parameters were known.
    pub points: Vec<[f64; 4]>,
    /// Intervals of time, in seconds, in which the input differs from zero significantly.
    pub windows: Vec<[f64; 2]>,
}

/// An input as a curve over a regressor.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct InputCurve {
    /// The name of the regressor.
    pub regressor: String,
    /// The unit of the regressor.
    pub unit: String,
    /// Rows of: regressor, input, standard error of the input.
    pub points: Vec<[f64; 3]>,
    /// Separate curves for rising and for falling values of the regressor. `None` unless the data support a difference.
    pub by_direction: Option<[Vec<[f64; 3]>; 2]>,
    /// The fraction of the excess of reduced chi-squared that the curve explains in the training records.
    pub explained_fraction: f64,
    /// The same fraction in the validation records, with the curve wired in as a function generator. `None` if it was
    /// not wired in.
    pub validation_fraction: Option<f64>,
    /// Logarithm of the marginal likelihood, relative to that without an input.
    pub evidence: f64,
    /// Pairs of regressor and input at the knots of the input over time.
    pub scatter: Vec<[f64; 2]>,
}

/// Least difference of evidence at which two junctions can be distinguished, and by which a later regressor, more knots
/// of a curve, or a curve for each direction is preferred. A difference of 10 is a likelihood ratio of 2e4, which is
/// decisive on the usual scales (H. Jeffreys, Theory of Probability, 1961).
pub(super) const DECISIVE_EVIDENCE: f64 = 10.0;

/// The evidence of the most likely junction, at least 0. `localisations` are in order of evidence, the largest first.
pub(crate) fn largest_evidence(localisations: &[Localisation]) -> f64 {
    localisations.first().map_or(0.0, |best| best.evidence.max(0.0))
}

/// The most likely junctions, as far as the data cannot distinguish them. Empty if no input is clearly better than
/// none. `localisations` are in order of evidence, the largest first.
pub fn indistinguishable_junctions(localisations: &[Localisation]) -> Vec<&str> {
    let best = localisations.first().filter(|best| best.evidence > DECISIVE_EVIDENCE);
    let Some(best) = best else { return Vec::new() };
    let is_close = |other: &&Localisation| best.evidence - other.evidence < DECISIVE_EVIDENCE;
    localisations.iter().filter(is_close).map(|localisation| localisation.junction.as_str()).collect()
}

impl Localisation {
    /// The name of the regressor that describes the input best: a signal or drive, "time at rest", or "time".
    pub fn best_regressor(&self) -> &str {
        self.best_curve.map_or("time", |best| &self.curves[best].regressor)
    }

    /// The curve of the function generator in `recovered`. `None` if `recovered` has a table over time, because no
    /// curve describes the input or no voltage of the patch carries its regressor.
    pub fn wired_curve(&self) -> Option<&InputCurve> {
        self.best_curve.map(|best| &self.curves[best]).filter(|curve| curve.validation_fraction.is_some())
    }

    /// The intervals of time, in seconds, in which the input acts, over all records.
    pub fn windows(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.inputs.iter().flat_map(|input| input.windows.iter().copied())
    }
}
