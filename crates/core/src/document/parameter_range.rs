//! The range check of a parameter: the only place that decides whether a parameter may have a value.
//!
//! Circuits, phases, machines and sweeps all use [`parameter_in_si`], so one value gives one verdict and one message.

use std::fmt;

use super::code::Code;
use super::diagnostic::{Diagnostic, Span};
use super::wording::{format_distinct, format_number, format_outside, unit_suffix};

/// A value that is outside the range of its parameter, or not a finite number in SI units.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::parameter_in_si;
///
/// let violation = parameter_in_si("x", 6.0, ("mm", 1e-3), Some((1.0, 5.0))).unwrap_err();
/// assert_eq!((violation.name.as_str(), violation.range), ("x", Some((1.0, 5.0))));
/// assert_eq!(violation.to_string(), "x = 6 mm is outside its range 1 ... 5 mm");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterRangeError {
    /// Name of the parameter.
    pub name: String,
    /// The value in the declared unit.
    pub value: f64,
    /// Least and largest value allowed, in the declared unit; `None` if the value is not finite in SI units.
    pub range: Option<(f64, f64)>,
    /// Text of the declared unit.
    pub unit: String,
}

impl fmt::Display for ParameterRangeError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, unit) = (&self.name, unit_suffix(&self.unit));
        match self.range {
            Some((low, high)) => {
                let value = format_outside(self.value, (low, high));
                let [low, high] = [low, high].map(|bound| format_distinct(bound, self.value));
                write!(formatter, "{name} = {value}{unit} is outside its range {low} ... {high}{unit}")
            }
            None => {
                let value = format_number(self.value);
                write!(formatter, "{name} = {value}{unit} is not a finite number in SI units")
            }
        }
    }
}

impl std::error::Error for ParameterRangeError {}

impl ParameterRangeError {
    /// The diagnostic for a report. `span` is the position of the value, or `None` if the value is not in the document.
    pub(crate) fn diagnostic(&self, span: Option<Span>) -> Diagnostic {
        let (code, hint) = match self.range {
            Some(_) => (Code::OUTSIDE_RANGE, "widen the range in the patch if the circuit can take it"),
            None => (Code::NOT_FINITE, "every number of a patch must be finite"),
        };
        Diagnostic { code, span, message: self.to_string(), hint: Some(hint.to_owned()) }
    }
}

/// The value of a parameter in SI units, if the parameter may have it.
///
/// `value` and `range` are in the declared unit; `unit` is the text of that unit and its size in SI units. Both ends of
/// the range are allowed. Without a range, every value that is finite in SI units is allowed.
///
/// # Errors
/// If the value is not finite in SI units, or is outside the range.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::parameter_in_si;
///
/// assert_eq!(parameter_in_si("x", 1.0, ("mm", 1e-3), Some((1.0, 5.0))), Ok(1e-3));
/// assert_eq!(parameter_in_si("x", -4.0, ("km", 1e3), None), Ok(-4e3));
/// assert!(parameter_in_si("x", f64::NAN, ("km", 1e3), None).is_err());
/// ```
pub fn parameter_in_si(
    name: &str,
    value: f64,
    (unit, per_unit): (&str, f64),
    range: Option<(f64, f64)>,
) -> Result<f64, ParameterRangeError> {
    let violation =
        |range| ParameterRangeError { name: name.to_owned(), value, range, unit: unit.to_owned() };
    let in_si = value * per_unit;
    if !in_si.is_finite() {
        return Err(violation(None));
    }
    match range {
        Some((low, high)) if !(low <= value && value <= high) => Err(violation(range)),
        _ => Ok(in_si),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_of_a_range_are_allowed() {
        let millimetres = |value| parameter_in_si("x", value, ("mm", 1e-3), Some((1.0, 5.0)));
        assert_eq!(millimetres(1.0), Ok(1e-3));
        assert_eq!(millimetres(5.0), Ok(5.0 * 1e-3));
        let violation = millimetres(6.0).unwrap_err();
        assert_eq!(violation.to_string(), "x = 6 mm is outside its range 1 ... 5 mm");
        assert_eq!(violation.diagnostic(None).code, Code::OUTSIDE_RANGE);
        let violation = millimetres(5.000_000_1).unwrap_err();
        assert_eq!(violation.to_string(), "x = 5.0000001 mm is outside its range 1 ... 5 mm");
    }

    #[test]
    fn a_value_that_is_not_finite_in_si_units_is_refused() {
        let kilometres = |value, range| parameter_in_si("x", value, ("km", 1e3), range);
        assert_eq!(kilometres(1e306, None).unwrap_err().range, None);
        let violation = kilometres(f64::NAN, Some((0.0, 1.0))).unwrap_err();
        assert_eq!(violation.to_string(), "x = NaN km is not a finite number in SI units");
        assert_eq!(violation.diagnostic(None).code, Code::NOT_FINITE);
        assert_eq!(kilometres(-1e300, None), Ok(-1e300 * 1e3));
    }
}
