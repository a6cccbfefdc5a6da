//! Units in the names of columns, as people and other programs write them.
//!
//! Unit texts in patches are strict, and a wrong one gets a hint. The names of columns are often given by another
//! program. So names in full (`sec`), the degree sign and usual products without a blank (`kNm`) are understood there.
//! A text that is probably a unit, but not clearly, is recognised, so that the reader of the file can warn.

use super::dimension::Dimension;
use super::parse::{MAX_TEXT_LENGTH, begins_with_power, is_name_letter};
use super::symbols::{from_name, in_other_case, prefixed_full_name, unspaced_product};
use super::synonyms::{advice, is_clear_full_name, symbol_of};
use super::unit::Unit;

/// Texts that are understood as a whole, and their units.
const WHOLE_TEXTS: [(&str, &str); 6] = [
    ("rev/min", "rpm"),
    ("r/min", "rpm"),
    ("U/min", "rpm"),
    ("rev/s", "Hz"),
    ("dimensionless", "1"),
    ("unitless", "1"),
];

/// Products that are usual without a blank in front of a power, such as `kgm2`, and their units.
const PRODUCTS_WITH_POWER: [(&str, &str); 1] = [("kgm", "kg m")];

/// Signs for degrees, and what they are read as. A letter of a temperature scale may follow.
const DEGREE_SIGNS: [(&str, &str); 5] = [("º", "°"), ("˚", "°"), ("℃", "degC"), ("℉", "degF"), ("°", "deg")];

/// The name of degrees, of an angle or of a temperature.
const DEGREE: &str = "deg";

/// The letters of the temperature scales.
const TEMPERATURE_SCALES: [char; 3] = ['C', 'F', 'K'];

/// What a text means as the unit of a column.
///
/// # Examples
///
/// ```
/// use patchcord_expr::{Unit, UnitLabel};
///
/// assert_eq!(UnitLabel::read("kNm"), UnitLabel::Unit(Unit::parse("kN m")?));
/// assert_eq!(UnitLabel::read("seconds"), UnitLabel::Unit(Unit::parse("s")?));
/// assert_eq!(UnitLabel::read("mVolts"), UnitLabel::Similar(Unit::parse("mV")?));
/// assert!(matches!(UnitLabel::read("°C"), UnitLabel::Unknown { .. }));
/// assert_eq!(UnitLabel::read("filtered"), UnitLabel::Text);
/// # Ok::<(), patchcord_expr::UnitError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum UnitLabel {
    /// A unit.
    Unit(Unit),
    /// A text that probably means this unit.
    Similar(Unit),
    /// A text that means a unit that is not known, or that is not clear.
    Unknown {
        /// What to write instead.
        advice: String,
        /// The dimension of the unit. `None` if it is not clear.
        dimension: Option<Dimension>,
    },
    /// A text that is no unit.
    Text,
}

impl UnitLabel {
    /// Reads a text. An empty text is the pure number. A text that is too long for a unit is none.
    pub fn read(text: &str) -> Self {
        if text.len() > MAX_TEXT_LENGTH {
            return UnitLabel::Text;
        }
        let signs = DEGREE_SIGNS.into_iter();
        let without_signs = signs.fold(text.trim().to_owned(), |text, (sign, name)| text.replace(sign, name));
        let with_scales = with_temperature_scales(&without_signs);
        // "deg C" is a temperature, and not the product of an angle and a charge.
        let has_temperature = with_scales != without_signs;
        if let Some(unit) = Unit::parse(text).ok().filter(|_| !has_temperature) {
            return UnitLabel::Unit(unit);
        }
        let text = with_scales;
        // "20 °C" is a condition and not a unit.
        if text.starts_with(|first: char| first.is_ascii_digit()) && !text.starts_with("1/") {
            return UnitLabel::Text;
        }
        let whole = WHOLE_TEXTS.iter().find(|(whole, _)| *whole == text);
        match whole.and_then(|(_, unit)| Unit::parse(unit).ok()) {
            Some(unit) => UnitLabel::Unit(unit),
            None => StrictText::of(&text).map_or(UnitLabel::Text, StrictText::label),
        }
    }
}

/// Replaces degrees and the letter of a temperature scale after blanks by one name: `degC` for `deg C`.
fn with_temperature_scales(text: &str) -> String {
    let mut joined = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(DEGREE) {
        let (before, after) = rest.split_at(at + DEGREE.len());
        joined += before;
        let name = after.trim_start();
        let is_scale = name.strip_prefix(TEMPERATURE_SCALES).is_some_and(|end| {
            // "deg C2" is a product, and "deg Cal" begins with another name.
            !end.starts_with(is_name_letter) && !begins_with_power(end)
        });
        rest = if is_scale { name } else { after };
    }
    joined + rest
}

/// The meaning of one name.
enum Meaning {
    /// This unit text.
    Unit(String),
    /// Probably this unit text.
    Similar(String),
    /// A unit that is not known, with what to write and with its dimension.
    Unknown(String, Option<Dimension>),
    /// No unit.
    Text,
}

impl Meaning {
    /// The meaning of a name. `has_power`: a power follows. `is_first`: nothing precedes it.
    fn of(name: &str, has_power: bool, is_first: bool) -> Self {
        if from_name(name).is_some() {
            return Meaning::Unit(name.to_owned());
        }
        match symbol_of(name) {
            // "sec2" is the second section, but "m/sec2" is a unit.
            Some(symbol) if is_clear_full_name(name) && !(has_power && is_first) => Meaning::Unit(symbol),
            Some(symbol) if !has_power => Meaning::Similar(symbol),
            None if !has_power => Self::of_other(name),
            None => {
                let product = PRODUCTS_WITH_POWER.iter().find(|(known, _)| *known == name);
                product.map_or(Meaning::Text, |(_, product)| Meaning::Unit((*product).to_owned()))
            }
            Some(_) => Meaning::Text,
        }
    }

    /// The meaning of a name without a power that is neither a symbol nor a full name.
    fn of_other(name: &str) -> Self {
        if let Some(product) = unspaced_product(name) {
            return Meaning::Unit(format!("({product})"));
        }
        if let Some((advice, dimension)) = advice(name) {
            return Meaning::Unknown(advice.to_owned(), dimension);
        }
        if let Some(symbol) = prefixed_full_name(name) {
            return Meaning::Similar(symbol);
        }
        // A single letter is rarely a unit in the wrong case.
        let names = if name.chars().count() > 1 { in_other_case(name) } else { Vec::new() };
        match names.as_slice() {
            [] => Meaning::Text,
            [only] => Meaning::Similar(only.clone()),
            [first, others @ ..] => {
                let dimension = |name: &String| from_name(name).map(|(_, symbol)| symbol.dimension);
                let is_same = others.iter().all(|other| dimension(other) == dimension(first));
                let advice = format!("a unit has upper-case and lower-case letters: {}", names.join(" or "));
                Meaning::Unknown(advice, dimension(first).filter(|_| is_same))
            }
        }
    }
}

/// A text in which every name is a symbol.
#[derive(Default)]
struct StrictText {
    /// The text.
    text: String,
    /// Whether a name is only similar to a unit.
    is_similar: bool,
    /// The first unit that is not known, with what to write and with its dimension.
    unknown: Option<(String, Option<Dimension>)>,
}

impl StrictText {
    /// Replaces every name in a text by its symbol. `None` if a name is no unit.
    fn of(text: &str) -> Option<Self> {
        let mut strict = StrictText::default();
        let mut rest = text;
        while let Some(first) = rest.chars().next() {
            let name_length = rest.find(|letter: char| !is_name_letter(letter)).unwrap_or(rest.len());
            let (part, after) = rest.split_at(name_length.max(first.len_utf8()));
            rest = after;
            if name_length == 0 {
                strict.text += part;
                continue;
            }
            match Meaning::of(part, begins_with_power(after), strict.text.is_empty()) {
                Meaning::Unit(symbol) => strict.text += &symbol,
                Meaning::Similar(symbol) => {
                    strict.is_similar = true;
                    strict.text += &symbol;
                }
                Meaning::Unknown(advice, dimension) => {
                    // The dimension of a product or a quotient is another one.
                    let dimension = dimension.filter(|_| part == text);
                    strict.unknown.get_or_insert((advice, dimension));
                }
                Meaning::Text => return None,
            }
        }
        Some(strict)
    }

    /// The meaning of the whole text.
    fn label(self) -> UnitLabel {
        if let Some((advice, dimension)) = self.unknown {
            return UnitLabel::Unknown { advice, dimension };
        }
        match Unit::parse(&self.text) {
            Ok(unit) => {
                // The text of the product has no needless parentheses.
                let unit = Unit::of_product([(&unit, 1.0)]);
                if self.is_similar { UnitLabel::Similar(unit) } else { UnitLabel::Unit(unit) }
            }
            Err(error) if self.text.contains('/') => {
                let advice = match &error.hint {
                    Some(hint) => format!("{error}: {hint}"),
                    None => error.to_string(),
                };
                UnitLabel::Unknown { advice, dimension: None }
            }
            Err(_) => UnitLabel::Text,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The text of the unit that a label has. `None` if it is another label.
    fn unit(label: &str) -> Option<String> {
        match UnitLabel::read(label) {
            UnitLabel::Unit(unit) => Some(unit.text().to_owned()),
            _ => None,
        }
    }

    /// The text of the unit to which a label is similar. `None` if it is another label.
    fn similar(label: &str) -> Option<String> {
        match UnitLabel::read(label) {
            UnitLabel::Similar(unit) => Some(unit.text().to_owned()),
            _ => None,
        }
    }

    #[test]
    fn units_are_understood() {
        let cases = [
            ("ms", "ms"),
            ("N/(m s)", "N/(m s)"),
            ("kNm", "kN m"),
            ("Nm/rad", "N m/rad"),
            ("rad/Nm", "rad/(N m)"),
            ("kgm2", "kg m2"),
            ("micron", "µm"),
            ("microns/sec", "µm/s"),
            ("m/sec2", "m/s2"),
            ("°", "deg"),
            ("°/s", "deg/s"),
            ("deg", "deg"),
            ("N m/deg", "N m/deg"),
            ("kg m/deg", "kg m/deg"),
            ("deg C2", "deg C2"),
            ("º", "deg"),
            ("sec", "s"),
            ("secs", "s"),
            ("seconds", "s"),
            ("usec", "us"),
            ("milliseconds", "ms"),
            ("hrs", "h"),
            ("hours", "h"),
            ("mins", "min"),
            ("minutes", "min"),
            ("Volt", "V"),
            ("rev/min", "rpm"),
            ("U/min", "rpm"),
            ("rev/s", "Hz"),
            ("dimensionless", "1"),
            ("1/sec", "1/s"),
        ];
        for (label, expected) in cases {
            assert_eq!(unit(label).as_deref(), Some(expected), "{label}");
        }
    }

    #[test]
    fn similar_texts_are_recognised() {
        let cases = [
            ("mVolts", "mV"),
            ("kNewton", "kN"),
            ("second", "s"),
            ("Sec", "s"),
            ("MIN", "min"),
            ("foot", "ft"),
            ("KN", "kN"),
            ("KN/m", "kN/m"),
        ];
        for (label, expected) in cases {
            assert_eq!(similar(label).as_deref(), Some(expected), "{label}");
        }
    }

    #[test]
    fn units_that_are_not_known_have_an_advice() {
        let cases = [
            ("°C", "temperatures are in K, and 0 °C is 273.15 K", Some(Dimension::TEMPERATURE)),
            ("° F", "temperatures are in K, and 0 °C is 273.15 K", Some(Dimension::TEMPERATURE)),
            ("°  C", "temperatures are in K, and 0 °C is 273.15 K", Some(Dimension::TEMPERATURE)),
            ("℃", "temperatures are in K, and 0 °C is 273.15 K", Some(Dimension::TEMPERATURE)),
            ("deg C", "temperatures are in K, and 0 °C is 273.15 K", Some(Dimension::TEMPERATURE)),
            ("deg F", "temperatures are in K, and 0 °C is 273.15 K", Some(Dimension::TEMPERATURE)),
            ("deg  K", "temperatures are in K, and 0 °C is 273.15 K", Some(Dimension::TEMPERATURE)),
            ("W/(m2 deg C)", "temperatures are in K, and 0 °C is 273.15 K", None),
            ("days", "a day is 24 h", Some(Dimension::TIME)),
            ("kcal/h", "1 cal is 4.184 J", None),
            ("MPA", "a unit has upper-case and lower-case letters: MPa or mPa", Some(Dimension::PRESSURE)),
            (
                "kg/m s2",
                "it is not clear whether the / also divides by s2: write /(m s2) if it does, else put s2 before the /",
                None,
            ),
        ];
        for (label, expected, expected_dimension) in cases {
            let found = UnitLabel::read(label);
            let UnitLabel::Unknown { advice, dimension } = found else { panic!("{label}: {found:?}") };
            assert_eq!((advice.as_str(), dimension), (expected, expected_dimension), "{label}");
        }
    }

    #[test]
    fn other_texts_are_no_units() {
        let texts =
            ["filtered", "left side", "20 °C", "Ch1", "S1", "M1", "rev2", "Sec2", "A/B", "n", "day 1b"];
        for text in texts {
            assert_eq!(UnitLabel::read(text), UnitLabel::Text, "{text}");
        }
        assert_eq!(UnitLabel::read(&"KN ".repeat(100)), UnitLabel::Text);
    }

    proptest! {
        #[test]
        fn reading_never_panics(text in "\\PC*") {
            let _ = UnitLabel::read(&text);
        }

        #[test]
        fn reading_unit_like_text_never_panics(text in "[mNskgSec1%²⁻µ°º() */^.2-]{0,40}") {
            let _ = UnitLabel::read(&text);
        }
    }
}
