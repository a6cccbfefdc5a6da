//! Distinguishes frequencies in cycles per second from angular frequencies, such as those in rad/s or rpm.

use std::f64::consts::TAU;

use super::Quantities;
use crate::document::{Code, Diagnostic, Placed, formula_diagnostic};
use patchcord_expr::Formula;

impl Quantities {
    /// Whether the value of a formula is an angular frequency. False if its terms do not agree in this.
    pub fn is_angular(&self, formula: &Formula) -> bool {
        formula.is_angular(self).unwrap_or(false)
    }

    /// The frequency in Hz for the value of a formula. An angular frequency is divided by 2 pi.
    pub fn in_hertz(&self, formula: &Formula, value: f64) -> f64 {
        if self.is_angular(formula) { value / TAU } else { value }
    }

    /// The frequency in Hz for the value of a formula. `None` if only some of its terms are angular, which is reported.
    pub(in crate::circuit) fn checked_hertz(
        &self,
        placed: &Placed<Formula>,
        value: f64,
        findings: &mut Vec<Diagnostic>,
    ) -> Option<f64> {
        let fault = placed.value.is_angular(self).err();
        let fault = fault.map(|error| formula_diagnostic(Code::UNIT_MISMATCH, placed, error));
        let is_right = fault.is_none();
        findings.extend(fault);
        is_right.then(|| self.in_hertz(&placed.value, value))
    }
}
