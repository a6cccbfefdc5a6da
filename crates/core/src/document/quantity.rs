//! Recognises a number with a unit, such as "8 s", where the document must have a number alone.
//!
//! The unit of every number in a document is fixed: by the format, or by the key "unit" next to the number. A unit in
//! the number itself is a common mistake, so it gets a hint of its own.

use patchcord_expr::{Unit, round_significant};

/// Largest length of the number in front of a unit, in bytes. Longer texts are not searched for a number.
const MAX_NUMBER_BYTES: usize = 40;

/// Splits a text such as "8 s" into its number and its unit. `None` if it is anything else.
pub(super) fn split_quantity(text: &str) -> Option<(&str, &str)> {
    let text = text.trim();
    if !text.starts_with(|first: char| first.is_ascii_digit() || "+-.".contains(first)) {
        return None;
    }
    let splits = (1..text.len().min(MAX_NUMBER_BYTES)).rev().filter_map(|end| text.split_at_checked(end));
    let is_number = |number: &str| number.parse::<f64>().is_ok_and(f64::is_finite);
    let (number, unit) = splits
        .map(|(number, unit)| (number.trim_end(), unit.trim()))
        .find(|(number, _)| is_number(number))?;
    let is_unit = unit.starts_with(|first: char| first.is_alphabetic() || "%°".contains(first));
    (is_unit && Unit::parse(unit).is_ok()).then_some((number, unit))
}

/// Whether the key "unit" gives the unit of a number under this key. Otherwise the number is in an SI unit.
fn has_declared_unit(key: &str) -> bool {
    matches!(key, "value" | "range" | "per_volt" | "default")
}

/// States what gives the unit of a number under this key.
pub(super) fn unit_rule(key: &str) -> String {
    match has_declared_unit(key) {
        true => format!("the key \"unit\" gives the unit of \"{key}\""),
        false => format!("the unit of \"{key}\" is fixed"),
    }
}

/// The number of digits of an advised number. More digits would show the rounding errors of a conversion.
const ADVISED_DIGITS: usize = 12;

/// The number to write under a key instead of a number with a unit: "0.001" for "1 ms" under "step".
pub(super) fn advised_number(number: &str, unit: &str, key: &str) -> String {
    let factor = Unit::parse(unit).map_or(1.0, |unit| unit.factor());
    match number.parse::<f64>() {
        Ok(value) if factor != 1.0 && !has_declared_unit(key) => {
            round_significant(value * factor, ADVISED_DIGITS).to_string()
        }
        _ => number.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quantity_is_split_into_its_number_and_its_unit() {
        let quantities = [
            ("8 s", ("8", "s")),
            ("8s", ("8", "s")),
            ("-1.5e3  N s/m", ("-1.5e3", "N s/m")),
            (" .5 mm ", (".5", "mm")),
            ("20 V", ("20", "V")),
        ];
        for (text, expected) in quantities {
            assert_eq!(split_quantity(text), Some(expected), "{text}");
        }
    }

    #[test]
    fn other_texts_are_no_quantities() {
        for text in ["", "8", "s", "8 apples", "2 * k", "8 1", "inf s", "-", "8 ü", "1e999 s", "k s"] {
            assert_eq!(split_quantity(text), None, "{text}");
        }
    }

    #[test]
    fn the_advised_number_is_in_the_fixed_unit() {
        assert_eq!(advised_number("1", "ms", "step"), "0.001");
        assert_eq!(advised_number("8", "s", "for"), "8");
        assert_eq!(advised_number("50", "mm", "value"), "50");
    }

    #[test]
    fn the_unit_of_a_value_is_under_another_key() {
        assert_eq!(unit_rule("value"), "the key \"unit\" gives the unit of \"value\"");
        assert_eq!(unit_rule("for"), "the unit of \"for\" is fixed");
    }
}
