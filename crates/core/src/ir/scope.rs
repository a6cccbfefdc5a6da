//! What the formulas of a run may name, as it stands at an instant: parameters, scales, the time scale, signals.

use super::{Probe, Program};
use crate::document::TIME_SCALE;
use patchcord_expr::{Dimension, Formula, FormulaError, Scope};

/// A scale as the formulas of a run read it.
#[derive(Debug, Clone)]
pub(crate) struct ScaleSlot {
    pub name: String,
    /// Coefficient of one volt, in SI.
    pub per_volt: u32,
    pub dimension: Dimension,
}

/// The values of an instant.
pub(crate) struct Standing<'a> {
    pub program: &'a Program,
    /// In SI.
    pub parameters: &'a [f64],
    pub coefficients: &'a [f64],
    /// Every voltage; `None` where nothing has run yet.
    pub registers: Option<&'a [f64]>,
}

impl Standing<'_> {
    /// What a formula comes to in the unit of a parameter: bare numbers stand in that unit.
    ///
    /// # Errors
    /// When the formula has no finite value.
    pub fn value_for(&self, parameter: usize, formula: &Formula) -> Result<f64, FormulaError> {
        let value = formula.evaluate(self)?;
        let is_plain = formula.names().is_empty();
        Ok(if is_plain { value } else { value / self.program.parameters[parameter].per_unit })
    }

    /// A signal's value in SI.
    fn reading(&self, probe: &Probe) -> Option<f64> {
        let per_volt = probe.per_volt.map_or(1.0, |index| self.coefficients[index as usize]);
        Some(self.registers?[probe.register.index()] * per_volt)
    }
}

impl Scope for Standing<'_> {
    fn value(&self, name: &str) -> Option<f64> {
        if name == TIME_SCALE {
            return Some(self.program.time_scale);
        }
        if let Some(parameter) = self.program.parameter(name) {
            return Some(self.parameters[parameter]);
        }
        match self.program.scale(name) {
            Some(scale) => Some(self.coefficients[scale.per_volt as usize]),
            None => self.reading(self.program.signal(name)?),
        }
    }

    fn dimension(&self, name: &str) -> Option<Dimension> {
        if name == TIME_SCALE {
            return Some(Dimension::NONE);
        }
        let parameter = self.program.parameter(name).map(|index| self.program.parameters[index].dimension);
        let scale = || self.program.scale(name).map(|scale| scale.dimension);
        parameter.or_else(scale).or_else(|| self.program.signal(name).map(|probe| probe.dimension))
    }

    fn names(&self) -> Vec<&str> {
        let parameters = self.program.parameters.iter().map(|slot| slot.name.as_str());
        let scales = self.program.scales.iter().map(|slot| slot.name.as_str());
        let signals = self.program.signals.iter().filter(|probe| probe.is_named);
        let signals = signals.map(|probe| probe.name.as_str());
        parameters.chain(scales).chain([TIME_SCALE]).chain(signals).collect()
    }
}
