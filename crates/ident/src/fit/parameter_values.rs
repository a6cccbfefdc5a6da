//! Parameters with their values, as they are told.

use serde_json::{Map, Value, json};

use patchcord_analysis::instruments::number;
use patchcord_core::document::behind;

/// Names of parameters, each with its value and its unit.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ParameterValues(pub(crate) Vec<(String, f64, String)>);

impl ParameterValues {
    /// The same in words, with a comma between two.
    pub fn told(&self) -> String {
        let each =
            self.0.iter().map(|(name, value, unit)| format!("{name} = {}{}", number(*value), behind(unit)));
        each.collect::<Vec<_>>().join(", ")
    }

    /// The same as a JSON document.
    pub(crate) fn document(&self) -> Map<String, Value> {
        let each = self.0.iter();
        each.map(|(name, value, unit)| (name.clone(), json!({"value": value, "unit": unit}))).collect()
    }
}
