//! Names of parameters with values and units.

/// Names of parameters, each with its value and its unit.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ParameterValues(pub(crate) Vec<(String, f64, String)>);
