//! Checks pot settings over the ranges of their parameters.

use super::SettingChecker;
use crate::document::{Code, Diagnostic, Placed, format_number};
use crate::elements::Setting;
use patchcord_expr::Formula;

/// Number of parameters of one formula that are varied at most. Three values of each give 3^6 = 729 combinations.
const MAX_VARIED_PARAMETERS: usize = 6;

impl SettingChecker<'_> {
    /// Warns of a pot setting that leaves its range for some values of its parameters within their ranges.
    ///
    /// The warning names the first combination of values for which this happens.
    ///
    /// A setting without an error at the present values can still be wrong elsewhere in the ranges, which the user
    /// would notice only in a sweep. Bounds and middles find every fault of a formula that is monotonic in each of its
    /// parameters, if these are at most six.
    pub(super) fn check_over_ranges(
        &self,
        row: &Setting,
        placed: &Placed<Formula>,
        findings: &mut Vec<Diagnostic>,
    ) {
        let dependencies = self.quantities.dependencies(&placed.value);
        let violation = self.combinations(&dependencies.parameters).into_iter().find_map(|combination| {
            let quantities = self.quantities.varied(&combination, &dependencies.derived);
            let predicate = match placed.value.evaluate(&quantities) {
                Ok(value) if row.is_allowed(value) => return None,
                Ok(value) => format!("would be {}", format_number(value)),
                Err(_) => "would have no value".to_owned(),
            };
            Some((predicate, self.describe_combination(&combination)))
        });
        if let Some((predicate, values)) = violation {
            let message = format!("\"{}\" of {} {predicate} at {values}", row.name, self.name);
            let hint = "narrow the range of the parameter, or rescale";
            findings.push(Diagnostic::at(Code::SETTING_RANGE, placed.span, message).hint(hint));
        }
    }

    /// All combinations of the lower bounds, middles and upper bounds of these parameters' ranges.
    ///
    /// Each combination has indices of parameters with values in their declared units. Parameters without a range keep
    /// their value, and so do those after the first [`MAX_VARIED_PARAMETERS`].
    fn combinations(&self, parameters: &[usize]) -> Vec<Vec<(usize, f64)>> {
        let ranged =
            parameters.iter().filter_map(|index| Some((*index, self.patch.parameters[*index].range?)));
        let mut combinations = vec![Vec::new()];
        for (index, (low, high)) in ranged.take(MAX_VARIED_PARAMETERS) {
            let values = [low, (low + high) / 2.0, high];
            combinations = combinations
                .iter()
                .flat_map(|shorter| values.map(|value| [shorter.as_slice(), &[(index, value)]].concat()))
                .collect();
        }
        combinations
    }

    /// The names and values of a combination for messages: "k = 3, m = 2".
    ///
    /// Values are in the declared units, without the unit.
    fn describe_combination(&self, combination: &[(usize, f64)]) -> String {
        let values = combination.iter().filter_map(|(index, value)| {
            let (name, _) = self.patch.parameters.get_index(*index)?;
            Some(format!("{name} = {}", format_number(*value)))
        });
        values.collect::<Vec<_>>().join(", ")
    }
}
