//! Numbers as people type them: alone or with a unit, also with a comma by mistake.
//!
//! Options of the command line and axes of sweeps read numbers with [`TypedNumber::parse`]. A unit after the number is
//! converted to the expected unit. A comma is never guessed: the error says what to write instead.

use patchcord_expr::{ConversionError, Unit, UnitError, leading_number, round_significant};

/// A number with the unit that was typed after it.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::TypedNumber;
/// use patchcord_expr::Unit;
///
/// let metres_per_second = Unit::parse("m/s")?;
/// assert_eq!(TypedNumber::parse("2.54 mm/s")?.in_unit(&metres_per_second), Ok(0.00254));
/// assert_eq!(TypedNumber::parse("0.5")?.in_unit(&metres_per_second), Ok(0.5));
/// let error = TypedNumber::parse("3 kg")?.in_unit(&metres_per_second).unwrap_err();
/// assert_eq!(error.to_string(), "\"3 kg\" is in kg, but m/s is expected");
/// let error = TypedNumber::parse("2,54").unwrap_err();
/// assert_eq!(error.to_string(), "\"2,54\" is not a number: write 2.54");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct TypedNumber {
    /// The number, in the typed unit.
    pub number: f64,
    /// The typed unit. `None` if the number was typed alone.
    pub unit: Option<Unit>,
    /// The typed text, for messages.
    text: String,
}

/// Why a text is not a number in the expected unit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TypedNumberError {
    /// The text does not begin with a number. The field is the text.
    #[error("\"{0}\" is not a number")]
    NotANumber(String),
    /// The number is NaN, infinite or too large. The field is the text.
    #[error("{0} is not a finite number")]
    NotFinite(String),
    /// The number has a comma, or other signs between its digits.
    #[error("\"{text}\" is not a number: write {advised}")]
    Separators {
        /// The typed text.
        text: String,
        /// The text with a decimal point, or without the signs between the digits.
        advised: String,
    },
    /// A number precedes a text that is not a unit.
    #[error("\"{text}\" is not a number with a unit: {}", unit_reason(.reason))]
    NotAUnit {
        /// The typed text.
        text: String,
        /// Why the text after the number is not a unit.
        reason: UnitError,
    },
    /// The unit has another dimension than the expected one.
    #[error("\"{text}\" is in {found}, but {expected} is expected")]
    WrongUnit {
        /// The typed text.
        text: String,
        /// The typed unit.
        found: String,
        /// The expected unit, in words.
        expected: String,
    },
    /// The number cannot be converted, because one of the units may count several things.
    #[error("\"{text}\": {reason}: {hint}")]
    UnclearUnit {
        /// The typed text.
        text: String,
        /// Why the number cannot be converted.
        reason: String,
        /// What to write.
        hint: String,
    },
}

/// Digits of a converted number. A conversion to other units then shows no rounding error: 2.54 mm/s is 0.00254 m/s.
const CONVERTED_DIGITS: usize = 15;

impl TypedNumber {
    /// Parses a finite number, or a number with a unit such as "2.54 mm/s" or "3s".
    ///
    /// # Errors
    /// If the text is not a finite number, or the text after the number is not a unit.
    pub fn parse(text: &str) -> Result<TypedNumber, TypedNumberError> {
        let text = text.trim();
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(TypedNumber { number, unit: None, text: text.to_owned() }),
            Ok(_) => Err(TypedNumberError::NotFinite(text.to_owned())),
            Err(_) => Self::parse_with_unit(text),
        }
    }

    /// Parses a number with a unit.
    fn parse_with_unit(text: &str) -> Result<TypedNumber, TypedNumberError> {
        let text = text.to_owned();
        if let Some(advised) = without_separators(&text) {
            return Err(TypedNumberError::Separators { text, advised });
        }
        let Some((number, unit)) = leading_number(&text) else {
            return Err(TypedNumberError::NotANumber(text));
        };
        let Ok(number) = number.parse::<f64>() else { return Err(TypedNumberError::NotANumber(text)) };
        if !begins_unit(unit) {
            return Err(TypedNumberError::NotANumber(text));
        }
        match Unit::parse(unit) {
            Ok(unit) => Ok(TypedNumber { number, unit: Some(unit), text }),
            Err(reason) => Err(TypedNumberError::NotAUnit { text, reason }),
        }
    }

    /// The number in this unit. A number that was typed alone is in this unit already.
    ///
    /// # Errors
    /// If the typed unit cannot be converted, or the converted number is too large.
    pub fn in_unit(&self, expected: &Unit) -> Result<f64, TypedNumberError> {
        let Some(unit) = &self.unit else { return Ok(self.number) };
        let conversion = unit.conversion_to(expected).map_err(|error| self.unit_error(expected, &error))?;
        if conversion.is_identity() {
            return Ok(self.number);
        }
        let converted = conversion.apply(self.number);
        match converted.is_finite() {
            true => Ok(round_significant(converted, CONVERTED_DIGITS)),
            false => Err(TypedNumberError::NotFinite(self.text.clone())),
        }
    }

    /// The error for a unit that cannot be converted to the expected one.
    fn unit_error(&self, expected: &Unit, error: &ConversionError) -> TypedNumberError {
        let text = self.text.clone();
        match error {
            ConversionError::Dimension { from, .. } => {
                TypedNumberError::WrongUnit { text, found: from.clone(), expected: expected_unit(expected) }
            }
            ConversionError::Angle { hint, .. } => {
                TypedNumberError::UnclearUnit { text, reason: error.to_string(), hint: hint.clone() }
            }
        }
    }
}

/// The message and the hint about a text that is not a unit.
fn unit_reason(reason: &UnitError) -> String {
    match &reason.hint {
        Some(hint) => format!("{}; {hint}", reason.message),
        None => reason.message.clone(),
    }
}

/// The expected unit for messages.
fn expected_unit(unit: &Unit) -> String {
    let is_number = ["", "1"].contains(&unit.text());
    if is_number { "a pure number".to_owned() } else { unit.text().to_owned() }
}

/// Whether a text after a number can be a unit. A unit begins with a letter, "%", "°" or "1/".
pub(super) fn begins_unit(text: &str) -> bool {
    text.starts_with("1/") || text.starts_with(|first: char| first.is_alphabetic() || "%°".contains(first))
}

/// Signs that may stand between the digits of a number that people type. Points are separators only if there are
/// several, or if a comma follows. The last four signs are an apostrophe and blanks of typeset numbers.
const SEPARATORS: &str = ",_' \u{2019}\u{a0}\u{202f}\u{2009}";

/// What to write instead of a number with a comma or other signs between its digits: "3.5" for "3,5", and "45000000"
/// for "45,000,000" and for "45.000.000". `None` if the text does not begin with such a number.
///
/// If a single comma precedes three digits, both meanings are given.
pub(super) fn without_separators(text: &str) -> Option<String> {
    let is_part =
        |letter: char| letter.is_ascii_digit() || "+-.".contains(letter) || SEPARATORS.contains(letter);
    let end = text.find(|letter: char| !is_part(letter)).unwrap_or(text.len());
    let number = text[..end].trim_end();
    let rest = &text[number.len()..];
    let unsigned = number.trim_start_matches(['+', '-']);
    let sign = &number[..number.len() - unsigned.len()];
    let (whole, fraction) = split_fraction(unsigned);
    let separator = whole.chars().find(|letter| *letter == '.' || SEPARATORS.contains(*letter))?;
    let groups: Vec<&str> = whole.split(separator).collect();
    let is_digits = |group: &&str| !group.is_empty() && group.bytes().all(|byte| byte.is_ascii_digit());
    if !groups.iter().chain(fraction.iter()).all(is_digits) {
        return None;
    }
    let fraction_text = fraction.map_or_else(String::new, |fraction| format!(".{fraction}"));
    let joined = format!("{sign}{}{fraction_text}{rest}", groups.concat());
    let with_point = format!("{sign}{}{rest}", groups.join("."));
    let can_be_decimal = separator == ',' && groups.len() == 2 && fraction.is_none();
    match (are_thousands(&groups), can_be_decimal) {
        (true, true) => Some(format!("{joined} or {with_point}")),
        (true, false) => Some(joined),
        (false, true) => Some(with_point),
        (false, false) => None,
    }
}

/// The parts of a number before and after its decimal sign. The sign is a point, or a comma if the points are between
/// thousands: there are several, or one precedes the comma.
fn split_fraction(number: &str) -> (&str, Option<&str>) {
    let (point, comma) = (number.find('.'), number.find(','));
    let has_points_between = number.matches('.').count() > 1 || (point.is_some() && point < comma);
    match number.split_once(if has_points_between { ',' } else { '.' }) {
        Some((whole, fraction)) => (whole, Some(fraction)),
        None => (number, None),
    }
}

/// Whether groups of digits are thousands: all groups after the first have three digits.
fn are_thousands(groups: &[&str]) -> bool {
    let [first, others @ ..] = groups else { return false };
    first.len() <= 3 && !first.starts_with('0') && others.iter().all(|group| group.len() == 3)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn in_unit(text: &str, unit: &str) -> Result<f64, String> {
        let typed = TypedNumber::parse(text).map_err(|error| error.to_string())?;
        typed.in_unit(&Unit::parse(unit).unwrap()).map_err(|error| error.to_string())
    }

    #[test]
    fn a_unit_is_converted_to_the_expected_unit() {
        let cases = [
            ("3", "s", 3.0),
            ("-1e-3", "s", -1e-3),
            ("3s", "s", 3.0),
            (" 2.54mm/s ", "m/s", 2.54e-3),
            ("2.5 min", "s", 150.0),
            ("5 %", "1", 0.05),
            ("20 1/s", "Hz", 20.0),
            ("150 1/min", "rpm", 150.0),
            ("2.5 1/s", "rpm", 150.0),
            ("150 rpm", "1/s", 2.5),
            ("150 rpm", "1/min", 150.0),
            ("3 rad/s", "1/s", 3.0),
            ("30 rpm", "deg/s", 180.0),
            ("3um", "µm", 3.0),
        ];
        for (text, unit, expected) in cases {
            assert_eq!(in_unit(text, unit), Ok(expected), "{text}");
        }
    }

    #[test]
    fn other_texts_and_units_are_refused() {
        let cases = [
            ("3 kg", "s", "\"3 kg\" is in kg, but s is expected"),
            ("3 kg", "1", "\"3 kg\" is in kg, but a pure number is expected"),
            ("fast", "s", "\"fast\" is not a number"),
            ("8 1", "s", "\"8 1\" is not a number"),
            ("", "s", "\"\" is not a number"),
            ("inf", "s", "inf is not a finite number"),
            (
                "90 deg/s",
                "1/min",
                "\"90 deg/s\": deg/s cannot be converted to 1/min, because 1/min may count radians, degrees or \
                 revolutions: write the value in 1/min, or declare 1/min with its angle, as in \"rad/s\", \"deg/s\" \
                 or \"rpm\"",
            ),
            (
                "5 1/s",
                "deg/s",
                "\"5 1/s\": 1/s cannot be converted to deg/s, because 1/s may count radians, degrees or revolutions: \
                 write the unit with its angle, as in \"rad/s\", \"deg/s\" or \"rpm\"",
            ),
            ("1e308km", "nm", "1e308km is not a finite number"),
            ("3,5", "s", "\"3,5\" is not a number: write 3.5"),
            ("45,000,000", "s", "\"45,000,000\" is not a number: write 45000000"),
            ("45.000.000", "s", "\"45.000.000\" is not a number: write 45000000"),
        ];
        for (text, unit, expected) in cases {
            assert_eq!(in_unit(text, unit), Err(expected.to_owned()), "{text}");
        }
        let unknown = in_unit("3 furlong", "m").unwrap_err();
        assert!(unknown.starts_with("\"3 furlong\" is not a number with a unit: "), "{unknown}");
    }

    #[test]
    fn separators_are_removed_or_replaced_by_a_point() {
        let cases = [
            ("3,5", "3.5"),
            ("-0,05", "-0.05"),
            ("0,005", "0.005"),
            ("3,5mm/s", "3.5mm/s"),
            ("1,5e3", "1.5e3"),
            ("1,500", "1500 or 1.500"),
            ("1,500.25", "1500.25"),
            ("1,234,567", "1234567"),
            ("45 000 000", "45000000"),
            ("45_000 m", "45000 m"),
            ("1'000", "1000"),
            ("45\u{2019}000\u{2019}000", "45000000"),
            ("45\u{a0}000\u{a0}000 N", "45000000 N"),
            ("45_000_000", "45000000"),
            ("45.000.000", "45000000"),
            ("-45.000.000 N/m", "-45000000 N/m"),
            ("45.000.000,5", "45000000.5"),
            ("1.500,25", "1500.25"),
        ];
        for (text, expected) in cases {
            assert_eq!(without_separators(text).as_deref(), Some(expected), "{text}");
        }
        for text in [
            "3.5",
            "3,",
            ",5",
            "1,2,3",
            "8 1",
            "a,b",
            "3 kg",
            "",
            "-",
            "1,5.2",
            "1.2.3",
            "1.5,2",
            "2024.01.15",
        ] {
            assert_eq!(without_separators(text), None, "{text}");
        }
    }
}
