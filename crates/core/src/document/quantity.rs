//! Recognises a number with a unit, such as "8 s", where the document must have a number alone.
//!
//! The unit of every number in a document is fixed: by the format, or by the key "unit" next to the number. A unit in
//! the number itself is a common mistake, so it gets a hint of its own.

use patchcord_expr::Unit;

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

/// States what gives the unit of a number under this key.
pub(super) fn unit_rule(key: &str) -> String {
    match key {
        "value" | "range" | "per_volt" | "default" => format!("the key \"unit\" gives the unit of \"{key}\""),
        _ => format!("the unit of \"{key}\" is fixed"),
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
    fn the_unit_of_a_value_is_under_another_key() {
        assert_eq!(unit_rule("value"), "the key \"unit\" gives the unit of \"value\"");
        assert_eq!(unit_rule("for"), "the unit of \"for\" is fixed");
    }
}
