//! Distinguishes frequencies in cycles per second from angular frequencies, such as those in rad/s or rpm.

use std::f64::consts::TAU;

use super::Quantities;
use crate::document::{Code, Diagnostic, Placed, formula_diagnostic};
use patchcord_expr::{Formula, Scope, Unit};

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

/// Reports an angular frequency for a quantity whose unit counts cycles, such as Hz. `None` after a report.
///
/// Only frequencies of drives are converted. The names of the formula are in `scope`.
pub(in crate::circuit) fn check_cycles(
    placed: &Placed<Formula>,
    scope: &dyn Scope,
    unit: &Unit,
    findings: &mut Vec<Diagnostic>,
) -> Option<()> {
    if !unit.counts_cycles() || !placed.value.is_angular(scope).unwrap_or(false) {
        return Some(());
    }
    let message = format!("{} is an angular frequency, but {unit} is expected here", placed.value.text());
    let hint = "divide it by (2 * pi)";
    findings.push(Diagnostic::at(Code::UNIT_MISMATCH, placed.span, message).hint(hint));
    None
}
