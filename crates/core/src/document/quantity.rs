//! Recognises a number with a unit, such as "8 s", where the document must have a number alone.
//!
//! The unit of a number in a document is given by the format, or by the key "unit" next to it. A unit in the number
//! itself is a common mistake, so it gets a hint of its own.

use super::typed_number::begins_unit;
use patchcord_expr::{Unit, leading_number, round_significant};

/// The keys whose numbers are times in seconds.
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

    /// The number to write under a key instead: "0.001" for "1 ms" under "step". `None` if the place may have a unit
    /// in which the number is another one.
    pub(super) fn advised_number(&self, key: &str) -> Option<String> {
        if TIME_KEYS.contains(&key) {
            let is_time = Unit::parse("s").is_ok_and(|second| second.dimension() == self.unit.dimension());
            let seconds = self.unit.to_si(self.number.parse().ok()?);
            return is_time.then(|| round_significant(seconds, ADVISED_DIGITS).to_string());
        }
        (self.unit.factor() == 1.0).then(|| self.number.to_owned())
    }
}

/// States what gives the unit of a number under this key.
pub(super) fn unit_rule(key: &str) -> String {
    match key {
        "value" | "range" | "per_volt" | "default" | "sigma" | "interval" => {
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
        let advised = |text, key| Quantity::parse(text).unwrap().advised_number(key);
        assert_eq!(advised("1 ms", "step").as_deref(), Some("0.001"));
        assert_eq!(advised("2 min", "for").as_deref(), Some("120"));
        assert_eq!(advised("20 V", "initial").as_deref(), Some("20"));
        assert_eq!(advised("3 kg", "step"), None);
        // The unit of the place may be mm, as that of a scale or of the key "unit".
        assert_eq!(["height", "value", "sigma"].map(|key| advised("50 mm", key)), [None, None, None]);
    }

    #[test]
    fn the_unit_of_a_value_is_under_another_key() {
        assert_eq!(unit_rule("value"), "the key \"unit\" gives the unit of \"value\"");
        assert_eq!(unit_rule("for"), "the unit of \"for\" is fixed");
    }
}
