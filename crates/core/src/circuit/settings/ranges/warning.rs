//! The warning of a pot setting that leaves its range.

use super::{Subject, ranges};
use crate::circuit::settings::SettingChecker;
use crate::document::{Code, Diagnostic, Placed, format_number};
use crate::elements::Setting;
use patchcord_expr::Formula;

impl SettingChecker<'_> {
    /// Warns of a pot setting that leaves its range for some values of its parameters within their ranges.
    ///
    /// The warning names the values of the parameters for which this happens.
    pub(in crate::circuit::settings) fn check_over_ranges(
        &self,
        row: &Setting,
        placed: &Placed<Formula>,
        findings: &mut Vec<Diagnostic>,
    ) {
        let subject = Subject { element: self.name, quantities: self.quantities, patch: self.patch };
        if let Some(fault) = subject.permitted(row, &placed.value).fault(&ranges(self.patch)) {
            let predicate = match fault.value {
                Some(value) => format!("would be {}", format_number(value)),
                None => "would have no value".to_owned(),
            };
            let values = describe(&fault.parameters);
            let message = format!("\"{}\" of {} {predicate} at {values}", row.name, self.name);
            let hint = "narrow the range of the parameter, or rescale";
            findings.push(Diagnostic::at(Code::SETTING_RANGE, placed.span, message).hint(hint));
        }
    }
}

/// The names and values of parameters for messages: "k = 3, m = 2".
///
/// Values are in the declared units, without the unit.
fn describe(parameters: &[(String, f64)]) -> String {
    let values = parameters.iter().map(|(name, value)| format!("{name} = {}", format_number(*value)));
    values.collect::<Vec<_>>().join(", ")
}
