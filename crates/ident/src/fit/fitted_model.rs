//! Fitted models: a variant of the patch, its fit to the training records, and its validation.
//!
//! A [`ModelVariant`] is a patch with the names of its fitted parameters. A [`FittedModel`] is a variant with the
//! results of its fit. The search compares fitted models of variants with different effects.

use std::sync::{Arc, OnceLock};

use crate::data::experiment::MeasuredDrive;
use crate::effects::candidate::Candidate;
use crate::effects::graft::AddedParameter;
use crate::fit::coloured_residual::ColouredResidual;
use crate::fit::estimate::{Estimate, FitResult};
use crate::fit::model::{FitProgram, ModelError, range_fraction};
use crate::fit::parameter_values::ParameterValues;
use crate::fit::start_cache::StartCaches;
use crate::fit::uncertainty::Uncertainty;
use crate::statistics::whiteness::{integrated_autocorrelation_time, ljung_box_z};
use patchcord_core::patch::{EditError, Patch};

/// A patch and the choice of what is fitted in it.
#[derive(Debug, Clone)]
pub struct ModelVariant {
    patch: Arc<Patch>,
    /// The patch compiled for fitting, after the first use. Copies of the variant share it.
    program: Arc<OnceLock<Arc<FitProgram>>>,
    /// Names of the fitted parameters.
    pub fit: Vec<String>,
    /// Names of the parameters that are initial voltages. They are fitted for each record separately.
    pub initial_states: Vec<String>,
    /// Solver steps per sample.
    pub steps: u32,
}

impl ModelVariant {
    /// A variant in which the parameters `fit` are fitted. The parameters `initial_states` are initial voltages and are
    /// fitted for each record. The solver makes `steps` steps per sample.
    pub fn new(
        patch: impl Into<Arc<Patch>>,
        fit: Vec<String>,
        initial_states: Vec<String>,
        steps: u32,
    ) -> ModelVariant {
        ModelVariant { patch: patch.into(), program: Arc::default(), fit, initial_states, steps }
    }

    /// The patch, with parameter values from before the fit.
    pub fn patch(&self) -> &Patch {
        &self.patch
    }

    /// The same variant with another number of solver steps per sample.
    pub fn with_steps(&self, steps: u32) -> ModelVariant {
        ModelVariant { steps, ..self.clone() }
    }

    /// The same choice of what is fitted, in another patch.
    pub fn with_patch(&self, patch: impl Into<Arc<Patch>>) -> ModelVariant {
        ModelVariant::new(patch, self.fit.clone(), self.initial_states.clone(), self.steps)
    }

    /// The patch compiled for records that feed these drives.
    ///
    /// The variant keeps the program for the first drives. For other drives, or other interpolation, the patch is
    /// compiled at every call.
    ///
    /// # Errors
    /// If the patch cannot be compiled for these drives.
    pub(crate) fn fit_program(&self, drives: &[MeasuredDrive]) -> Result<Arc<FitProgram>, ModelError> {
        if let Some(cached) = self.program.get().filter(|cached| cached.has_drives(drives)) {
            return Ok(Arc::clone(cached));
        }
        let compiled = Arc::new(FitProgram::new(&self.patch, drives)?);
        // Another thread may have stored its program in the meantime.
        let cached = self.program.get_or_init(|| Arc::clone(&compiled));
        Ok(if cached.has_drives(drives) { Arc::clone(cached) } else { compiled })
    }

    /// A measure of the time of one iteration: the number of runs for a Jacobian times the steps per sample. It is only
    /// meaningful relative to that of other variants.
    pub(crate) fn cost(&self) -> usize {
        (self.fit.len() + self.initial_states.len() + 1) * self.steps as usize
    }

    /// The ranges of the fitted parameters, in order. `None` if a parameter has no range.
    pub(crate) fn ranges(&self) -> impl Iterator<Item = Option<(f64, f64)>> + '_ {
        self.fit.iter().map(|name| self.patch.parameters.get(name)?.range)
    }

    /// The patch with these values of the fitted parameters. `file` is the name for its diagnostics.
    ///
    /// # Errors
    /// If a value is not finite.
    pub fn patch_with_values(&self, file: &str, parameters: &[f64]) -> Result<Patch, EditError> {
        let mut editor = self.patch.edit();
        for (name, value) in self.fit.iter().zip(parameters) {
            editor.set_parameter(name, *value)?;
        }
        editor.finish(file)
    }
}

/// A variant of the patch with its fit and validation.
#[derive(Debug, Clone)]
pub struct FittedModel {
    /// The variant that was fitted.
    pub variant: ModelVariant,
    /// The best fit to the training records.
    pub train: FitResult,
    /// The result for the validation records: the same parameters, but fitted initial voltages and offsets.
    pub validation: FitResult,
    /// The Ljung-Box statistic of the training residuals, in standard deviations from white noise ([`ljung_box_z`]).
    pub ljung_box_z: f64,
    /// The integrated autocorrelation time of the training residuals, in samples ([`integrated_autocorrelation_time`]).
    pub autocorrelation_time: f64,
    /// The fit to the pieces of the records. `None` if a fit to pieces was not necessary.
    pub pieces_estimate: Option<Estimate>,
    /// Results from the starts of this fit, which a fit with more effort can use again.
    pub(crate) start_caches: StartCaches,
    /// Whether the fit was complete, and not only a quick look.
    pub is_thorough: bool,
    /// The uncertainty of each fitted parameter. Empty until
    /// [`with_standard_errors`](crate::fit::intervals::with_standard_errors) computes it.
    pub uncertainties: Vec<Uncertainty>,
    /// The result of `residuals::residual_analysis::coloured_residual`, after its first call.
    pub(crate) coloured_residual: OnceLock<Option<ColouredResidual>>,
}

impl FittedModel {
    /// A fitted model from the results for the training and the validation records, in this order.
    pub(crate) fn new(
        variant: ModelVariant,
        [train, validation]: [FitResult; 2],
        pieces_estimate: Option<Estimate>,
        start_caches: StartCaches,
        is_thorough: bool,
    ) -> FittedModel {
        let (ljung_box_z, autocorrelation_time) =
            (ljung_box_z(&train.residuals), integrated_autocorrelation_time(&train.residuals));
        let (uncertainties, coloured_residual) = (Vec::new(), OnceLock::new());
        FittedModel {
            variant,
            train,
            validation,
            ljung_box_z,
            autocorrelation_time,
            pieces_estimate,
            start_caches,
            is_thorough,
            uncertainties,
            coloured_residual,
        }
    }

    /// The rms of the training residuals that noise does not explain, in units of sigma: the root of the excess of
    /// reduced chi-squared.
    pub fn excess_rms(&self) -> f64 {
        self.train.excess_reduced_chi2().sqrt()
    }

    /// Whether the training residuals are not white noise.
    pub fn residuals_are_coloured(&self) -> bool {
        self.ljung_box_z > WHITENESS_Z
    }

    /// The fraction of the excess of reduced chi-squared of `without` that this model explains. 1 if it explains all,
    /// negative if it explains less than `without`.
    pub fn explained_fraction(&self, without: &FittedModel) -> f64 {
        1.0 - self.train.excess_reduced_chi2() / without.train.excess_reduced_chi2()
    }

    /// Indices of the fitted parameters whose values are at an end of their ranges.
    pub(crate) fn indices_at_range_end(&self) -> impl Iterator<Item = usize> + '_ {
        self.indices_where(self.variant.ranges(), |[below, above]| {
            below.abs().min(above.abs()) <= RANGE_END_TOLERANCE
        })
    }

    /// Indices of the fitted parameters whose values are outside these ranges.
    pub(crate) fn indices_outside<'s>(
        &'s self,
        ranges: &'s [Option<(f64, f64)>],
    ) -> impl Iterator<Item = usize> + 's {
        self.indices_where(ranges.iter().copied(), |[below, above]| below.min(above) < -RANGE_END_TOLERANCE)
    }

    /// Indices of the fitted parameters for which a condition is true. The condition receives the distances of the
    /// value from the lower and the upper end, as fractions of the range. They are negative outside the range.
    fn indices_where<'s>(
        &'s self,
        ranges: impl Iterator<Item = Option<(f64, f64)>> + 's,
        condition: impl Fn([f64; 2]) -> bool + 's,
    ) -> impl Iterator<Item = usize> + 's {
        let fitted = ranges.zip(&self.train.estimate.parameters).enumerate();
        fitted.filter_map(move |(index, (range, value))| {
            let (low, high) = range?;
            let fraction = range_fraction([low, high], *value);
            condition([fraction, 1.0 - fraction]).then_some(index)
        })
    }

    /// Indices of the parameters of `before` that are at an end of their ranges here but were not there.
    pub(crate) fn indices_newly_at_range_end<'s>(
        &'s self,
        before: &'s FittedModel,
    ) -> impl Iterator<Item = usize> + 's {
        let common = self.indices_at_range_end().filter(|index| *index < before.variant.fit.len());
        common.filter(|index| before.indices_at_range_end().all(|other| other != *index))
    }

    /// Whether the first parameter of an effect, its strength, is at an end of its range, except at the value without
    /// effect.
    pub(crate) fn is_at_max_strength(&self, effect: &Candidate) -> bool {
        let strength = effect.graft.parameters.first();
        let is_strength_at_limit = |index: usize| {
            strength.is_some_and(|parameter| parameter.name == self.variant.fit[index])
                && Some(self.train.estimate.parameters[index]) != effect.null_value
        };
        self.indices_at_range_end().any(is_strength_at_limit)
    }

    /// Whether the training residuals are so large that the fit may be in a wrong minimum.
    pub fn is_poor(&self) -> bool {
        self.train.normalised_rms() >= POOR_FIT_RMS
    }

    /// The parameters of an effect, each with its fitted value and the uncertainty of the value.
    pub(crate) fn effect_parameters<'s>(
        &'s self,
        effect: &'s Candidate,
    ) -> impl Iterator<Item = (&'s AddedParameter, f64, Uncertainty)> {
        effect.graft.parameters.iter().filter_map(|parameter| {
            let index = self.variant.fit.iter().position(|name| *name == parameter.name)?;
            Some((parameter, self.train.estimate.parameters[index], self.uncertainty(index)))
        })
    }

    /// The uncertainty of the fitted parameter with this index. Undetermined if it was not computed.
    pub fn uncertainty(&self, index: usize) -> Uncertainty {
        self.uncertainties.get(index).copied().unwrap_or(Uncertainty::UNDETERMINED)
    }
}

/// A value is at the end of its range if it is nearer than this fraction of the range.
const RANGE_END_TOLERANCE: f64 = 1e-6;
/// Residuals with a Ljung-Box statistic above this value, in standard deviations, are not white noise.
pub(crate) const WHITENESS_Z: f64 = 4.0;
/// Rms residual, in units of sigma, from which a fit is poor. Below it, fits converge without cutting the records.
const POOR_FIT_RMS: f64 = 5.0;

impl FittedModel {
    /// The unit of the fitted parameter with this index. "1" if the patch has no such parameter.
    pub fn unit(&self, index: usize) -> &str {
        let parameter = self.variant.patch.parameters.get(&self.variant.fit[index]);
        parameter.map_or("1", |parameter| parameter.unit.text())
    }

    /// The fitted parameters with their values in an estimate.
    pub(crate) fn parameter_values(&self, estimate: &Estimate) -> ParameterValues {
        let each = self.variant.fit.iter().zip(&estimate.parameters).enumerate();
        let each = each.map(|(index, (name, value))| (name.clone(), *value, self.unit(index).to_owned()));
        ParameterValues(each.collect())
    }
}
