//! Values of parameters with their units, ready to be reported.

/// Parameters, each as its name, its value and the unit of the value, in the order of the fit.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ParameterValues(pub(crate) Vec<(String, f64, String)>);
