//! What the formulas of a run can name: parameters, scales, the time scale and signals.
//!
//! A run plan can set a parameter to a formula. The solver evaluates such a formula at the instant of the change, from
//! the values in a [`RunScope`].

use super::{Program, SignalInfo};
use crate::document::TIME_SCALE;
use patchcord_expr::{Dimension, Formula, FormulaError, Scope};

/// A scale that formulas of a run can name: the value of one volt.
#[derive(Debug, Clone)]
pub(crate) struct ScaleFactor {
    /// Name of the scale.
    pub name: String,
    /// Index of the coefficient with the value of one volt, in SI.
    pub per_volt: u32,
    /// Dimension of the value of one volt.
    pub dimension: Dimension,
}

/// The values that formulas of a run read at one instant.
pub(crate) struct RunScope<'a> {
    /// The program, for names and dimensions.
    pub program: &'a Program,
    /// Parameters in SI.
    pub parameters: &'a [f64],
    /// Coefficients that follow from the parameters.
    pub coefficients: &'a [f64],
    /// Every register of the body; `None` before anything has run. Signals then have no value.
    pub registers: Option<&'a [f64]>,
}

impl RunScope<'_> {
    /// The value of a formula in the declared unit of a parameter. A formula without names is already in that unit.
    ///
    /// # Errors
    /// If the formula has no finite value.
    pub(crate) fn value_for(&self, parameter: usize, formula: &Formula) -> Result<f64, FormulaError> {
        let value = formula.evaluate(self)?;
        let is_plain = formula.names().is_empty();
        Ok(if is_plain { value } else { value / self.program.parameters[parameter].declared.per_unit })
    }

    /// The value of a signal in SI; `None` before anything has run.
    fn signal_value(&self, signal: &SignalInfo) -> Option<f64> {
        let per_volt = signal.per_volt.map_or(1.0, |index| self.coefficients[index as usize]);
        Some(self.registers?[signal.register.index()] * per_volt)
    }
}

impl Scope for RunScope<'_> {
    fn value(&self, name: &str) -> Option<f64> {
        if name == TIME_SCALE {
            return Some(self.program.lowered.time_scale);
        }
        if let Some(parameter) = self.program.parameter(name) {
            return Some(self.parameters[parameter]);
        }
        match self.program.scale(name) {
            Some(scale) => Some(self.coefficients[scale.per_volt as usize]),
            None => self.signal_value(self.program.signal(name)?),
        }
    }

    fn dimension(&self, name: &str) -> Option<Dimension> {
        if name == TIME_SCALE {
            return Some(Dimension::NONE);
        }
        let parameter =
            self.program.parameter(name).map(|index| self.program.parameters[index].declared.dimension);
        let scale = || self.program.scale(name).map(|scale| scale.dimension);
        parameter.or_else(scale).or_else(|| self.program.signal(name).map(|signal| signal.dimension))
    }

    fn names(&self) -> Vec<&str> {
        let parameters = self.program.parameters.iter().map(|parameter| parameter.declared.name.as_str());
        let scales = self.program.lowered.scales.iter().map(|scale| scale.name.as_str());
        let signals = self.program.lowered.signals.iter().filter(|signal| signal.is_named);
        let signals = signals.map(|signal| signal.name.as_str());
        parameters.chain(scales).chain([TIME_SCALE]).chain(signals).collect()
    }
}
