//! Derivatives of signals by parameters: what they are called, and their units.

/// The name of the derivative of a signal by a parameter: `d v_o / d M`.
pub fn derivative_name(signal: &str, parameter: &str) -> String {
    format!("d {signal} / d {parameter}")
}

/// The signal and the parameter that such a name tells of.
pub fn derivative_of(name: &str) -> Option<(&str, &str)> {
    name.strip_prefix("d ")?.split_once(" / d ")
}

/// Text of one unit divided by another, which can be read as a unit again.
pub fn derivative_unit(of: &str, by: &str) -> String {
    let bracketed = |unit: &str, marks: &[char]| match unit.contains(marks) {
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
    fn names_tell_what_they_are_derivatives_of() {
        assert_eq!(derivative_of(&derivative_name("L1.v", "M")), Some(("L1.v", "M")));
        assert!(["d v / dM", "v / d M", "d v"].iter().all(|name| derivative_of(name).is_none()));
    }

    #[test]
    fn units_of_derivatives_can_be_read() {
        for (of, by, wanted) in [
            ("m/s", "kg", "(m/s)/kg"),
            ("m/s", "N s/m", "(m/s)/(N s/m)"),
            ("V", "1", "V"),
            ("1", "m", "1/m"),
            ("", "m", "1/m"),
            ("m/s", "", "m/s"),
        ] {
            assert_eq!(derivative_unit(of, by), wanted);
            assert!(Unit::parse(wanted).is_ok(), "{wanted}");
        }
    }
}
