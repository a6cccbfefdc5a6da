//! Recognises a number with a unit, such as "8 s", where the document must have a number alone.
//!
//! The unit of a number in a document is given by the format, or by the key "unit" next to it. A unit in the number
//! itself is a common mistake, so it gets a hint of its own.

use super::typed_number::begins_unit;
use patchcord_expr::{Unit, leading_number, round_significant};

/// The keys outside elements whose numbers are times in seconds.
const TIME_KEYS: [&str; 5] = ["for", "step", "every", "operate", "hold"];

/// The number of digits of an advised number. More digits would show the rounding errors of a conversion.
const ADVISED_DIGITS: usize = 12;

/// A number with a unit, such as "8 s".
pub(super) struct Quantity<'a> {
    /// The text of the number.
    pub number: &'a str,
    /// The unit.
    pub unit: Unit,
}

impl<'a> Quantity<'a> {
    /// Reads a text. `None` if it is not a number with a unit.
    pub(super) fn parse(text: &'a str) -> Option<Self> {
        let (number, unit) = leading_number(text)?;
        let unit = Unit::parse(unit).ok().filter(|_| begins_unit(unit))?;
        Some(Quantity { number, unit })
    }

    /// The number to write instead if numbers are in the unit `expected`: "0.001" for "1 ms" if "s" is expected.
    /// `None` if the expected unit is in words, or if the number is another quantity.
    pub(super) fn number_in(&self, expected: &str) -> Option<String> {
        let expected = Unit::parse(expected.trim_start_matches("machine ")).ok()?;
        let conversion = self.unit.conversion_to(&expected).ok()?;
        if conversion.is_identity() {
            return Some(self.number.to_owned());
        }
        let converted = conversion.apply(self.number.parse().ok()?);
        converted.is_finite().then(|| round_significant(converted, ADVISED_DIGITS).to_string())
    }

    /// The hint for a formula. `expected` is the unit of a number alone; `None` if it is not known.
    pub(super) fn formula_hint(&self, expected: Option<&str>) -> String {
        let alone = expected.map_or_else(|| "the number alone, in that unit".to_owned(), number_with_unit);
        match expected.and_then(|expected| self.number_in(expected)) {
            Some(number) => format!("write {number}, {alone}"),
            None => format!("write {alone}"),
        }
    }
}

/// The product that a number with a unit can also mean, and the name in it: "2 * m" and "m" for "2 m". `None` if the
/// text is not a number with a unit, or if the unit cannot be a name.
pub(crate) fn possible_product(text: &str) -> Option<(String, String)> {
    let Quantity { number, unit } = Quantity::parse(text)?;
    let name = unit.text();
    let can_be_name = name.chars().all(|letter| letter.is_ascii_alphanumeric());
    can_be_name.then(|| (format!("{number} * {name}"), name.to_owned()))
}

/// A number in an expected unit, as hints describe it.
fn number_with_unit(unit: &str) -> String {
    match unit {
        "1" => "a number without a unit".to_owned(),
        "whole number" => "a whole number".to_owned(),
        _ if unit.starts_with("unit ") => format!("a number in the {unit}"),
        _ => format!("a number in {unit}"),
    }
}

/// The unit of every number under this key. `None` if it depends on the element or on another key.
pub(super) fn fixed_unit(key: &str) -> Option<&'static str> {
    TIME_KEYS.contains(&key).then_some("s")
}

/// States what gives the unit of a number under this key.
pub(super) fn unit_rule(key: &str) -> String {
    match key {
        "value" | "range" | "per_volt" | "maximum" | "default" | "sigma" | "interval" => {
            format!("the key \"unit\" gives the unit of \"{key}\"")
        }
        _ => format!("the unit of \"{key}\" is fixed"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(text: &str) -> Option<(&str, String)> {
        Quantity::parse(text).map(|quantity| (quantity.number, quantity.unit.text().to_owned()))
    }

    #[test]
    fn a_quantity_is_split_into_its_number_and_its_unit() {
        let quantities = [
            ("8 s", ("8", "s")),
            ("8s", ("8", "s")),
            ("-1.5e3  N s/m", ("-1.5e3", "N s/m")),
            (" .5 mm ", (".5", "mm")),
            ("20 V", ("20", "V")),
        ];
        for (text, (number, unit)) in quantities {
            assert_eq!(split(text), Some((number, unit.to_owned())), "{text}");
        }
    }

    #[test]
    fn other_texts_are_no_quantities() {
        for text in ["", "8", "s", "8 apples", "2 * k", "8 1", "inf s", "-", "8 ü", "1e999 s", "k s"] {
            assert_eq!(split(text), None, "{text}");
        }
    }

    #[test]
    fn a_number_is_advised_only_if_its_unit_is_known() {
        let advised = |text, unit| Quantity::parse(text).unwrap().number_in(unit);
        assert_eq!(advised("1 ms", "s").as_deref(), Some("0.001"));
        assert_eq!(advised("2 min", "s").as_deref(), Some("120"));
        assert_eq!(advised("5 ms", "machine s").as_deref(), Some("0.005"));
        assert_eq!(advised("20 V", "V").as_deref(), Some("20"));
        assert_eq!(advised("1e3 Hz", "Hz").as_deref(), Some("1e3"));
        assert_eq!(advised("120 rpm", "Hz").as_deref(), Some("2"));
        assert_eq!(advised("120 1/min", "rpm").as_deref(), Some("120"));
        assert_eq!(advised("120 1/min", "deg/s"), None);
        assert_eq!(advised("50 %", "1").as_deref(), Some("0.5"));
        assert_eq!(advised("3 kg", "s"), None);
        assert_eq!(advised("50 mm", "unit of the scale"), None);
        assert_eq!(["step", "value", "sigma", "initial"].map(fixed_unit), [Some("s"), None, None, None]);
    }

    #[test]
    fn the_hint_for_a_formula_names_the_expected_unit() {
        let hint = |text, unit| Quantity::parse(text).unwrap().formula_hint(unit);
        let cases = [
            ("1 Hz", Some("Hz"), "write 1, a number in Hz"),
            ("5 ms", Some("machine s"), "write 0.005, a number in machine s"),
            ("5 kg", Some("s"), "write a number in s"),
            ("0.5 kg", Some("1"), "write a number without a unit"),
            ("3 m", Some("whole number"), "write a whole number"),
            ("1 mm", Some("unit of the scale"), "write a number in the unit of the scale"),
            ("1 mm/s", Some("unit of the scale per s"), "write a number in the unit of the scale per s"),
            ("2 m", None, "write the number alone, in that unit"),
        ];
        for (text, unit, expected) in cases {
            assert_eq!(hint(text, unit), expected, "{text}");
        }
    }

    #[test]
    fn a_unit_of_one_word_can_be_a_name_in_a_product() {
        assert_eq!(possible_product("2.5 kN"), Some(("2.5 * kN".to_owned(), "kN".to_owned())));
        assert_eq!(possible_product("-3m"), Some(("-3 * m".to_owned(), "m".to_owned())));
        for text in ["1 mm/s", "1 N s", "5 %", "2 * m", "2", "m"] {
            assert_eq!(possible_product(text), None, "{text}");
        }
    }

    #[test]
    fn the_unit_of_a_value_is_under_another_key() {
        assert_eq!(unit_rule("value"), "the key \"unit\" gives the unit of \"value\"");
        assert_eq!(unit_rule("maximum"), "the key \"unit\" gives the unit of \"maximum\"");
        assert_eq!(unit_rule("for"), "the unit of \"for\" is fixed");
    }
}
