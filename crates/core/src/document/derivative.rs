//! Derivatives of signals with respect to parameters: their names and their units.

/// The name of the derivative of a signal with respect to a parameter, such as `d v_o / d M`.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::{derivative_name, derivative_of};
///
/// let name = derivative_name("v_o", "M");
/// assert_eq!(name, "d v_o / d M");
/// assert_eq!(derivative_of(&name), Some(("v_o", "M")));
/// assert_eq!(derivative_of("v_o"), None);
/// ```
pub fn derivative_name(signal: &str, parameter: &str) -> String {
    format!("d {signal} / d {parameter}")
}

/// The signal and the parameter of a name that [`derivative_name`] made. `None` for other names.
pub fn derivative_of(name: &str) -> Option<(&str, &str)> {
    name.strip_prefix("d ")?.split_once(" / d ")
}

/// The text of the unit `of` divided by the unit `by`. It can be parsed as a unit again.
///
/// "m/s" by "kg" gives "(m/s)/kg". The empty text and "1" are the unit of a pure number.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::derivative_unit;
///
/// assert_eq!(derivative_unit("m/s", "kg"), "(m/s)/kg");
/// assert_eq!(derivative_unit("V", "1"), "V");
/// assert_eq!(derivative_unit("1", "m"), "1/m");
/// ```
pub fn derivative_unit(of: &str, by: &str) -> String {
    let bracketed = |unit: &str, operators: &[char]| match unit.contains(operators) {
        true => format!("({unit})"),
        false => unit.to_owned(),
    };
    match (of.trim(), by.trim()) {
        (of, "" | "1") => of.to_owned(),
        ("", by) => derivative_unit("1", by),
        (of, by) => format!("{}/{}", bracketed(of, &['/']), bracketed(by, &['/', ' ', '*', '·'])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use patchcord_expr::Unit;

    #[test]
    fn a_derivative_name_contains_its_signal_and_parameter() {
        assert_eq!(derivative_of(&derivative_name("L1.v", "M")), Some(("L1.v", "M")));
        assert!(["d v / dM", "v / d M", "d v"].iter().all(|name| derivative_of(name).is_none()));
    }

    #[test]
    fn units_of_derivatives_can_be_parsed() {
        for (of, by, expected) in [
            ("m/s", "kg", "(m/s)/kg"),
            ("m/s", "N s/m", "(m/s)/(N s/m)"),
            ("V", "1", "V"),
            ("1", "m", "1/m"),
            ("", "m", "1/m"),
            ("m/s", "", "m/s"),
        ] {
            assert_eq!(derivative_unit(of, by), expected);
            assert!(Unit::parse(expected).is_ok(), "{expected}");
        }
    }
}
