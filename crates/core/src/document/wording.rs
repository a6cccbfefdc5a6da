//! Numbers, counts, units and suggestions as messages print them.

use std::fmt::Display;

use patchcord_expr::{format_significant, nearest};

/// A number for messages, rounded to six significant digits: 1/3 gives "0.333333" and 45e6 gives "4.5e7".
///
/// Numbers below 1e-4 and from 1e7 on have an exponent. -0 is printed as 0. Data files need every digit and use
/// another function.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::format_number;
///
/// assert_eq!(format_number(1.0 / 3.0), "0.333333");
/// assert_eq!(format_number(45e6), "4.5e7");
/// assert_eq!(format_number(-0.0), "0");
/// ```
pub fn format_number(value: f64) -> String {
    format_significant(value, MESSAGE_DIGITS)
}

/// Number of significant digits of a number in a message.
const MESSAGE_DIGITS: usize = 6;

/// Number of significant digits with which two numbers always differ.
const MAX_DIGITS: usize = 17;

/// A number for messages that compare it with another one. Like [`format_number`], but with as many digits as the two
/// numbers need to differ.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::format_distinct;
///
/// assert_eq!([format_distinct(3e8, 2e8), format_distinct(2e8, 3e8)], ["3e8", "2e8"]);
/// assert_eq!([format_distinct(2e8 + 1.0, 2e8), format_distinct(2e8, 2e8 + 1.0)], ["2.00000001e8", "2e8"]);
/// assert_eq!(format_distinct(1.0 / 3.0, 1.0 / 3.0), "0.333333");
/// ```
pub fn format_distinct(value: f64, other: f64) -> String {
    let differ = |digits: &usize| format_significant(value, *digits) != format_significant(other, *digits);
    let digits = (MESSAGE_DIGITS..=MAX_DIGITS).find(differ).unwrap_or(MESSAGE_DIGITS);
    format_significant(value, digits)
}

/// A number outside a range for messages, with as many digits as it needs to differ from the bound.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::format_outside;
///
/// assert_eq!(format_outside(1.0000001, (0.0, 1.0)), "1.0000001");
/// assert_eq!(format_outside(-2.0, (0.0, 1.0)), "-2");
/// ```
pub fn format_outside(value: f64, (low, high): (f64, f64)) -> String {
    format_distinct(value, if value < low { low } else { high })
}

/// A count with its noun: "1 step", "2 steps".
///
/// # Examples
///
/// ```
/// use patchcord_core::document::plural;
///
/// assert_eq!([plural(1, "step"), plural(0, "step")], ["1 step", "0 steps"]);
/// ```
pub fn plural<N: Display + PartialEq + From<u8>>(count: N, noun: &str) -> String {
    let ending = if count == N::from(1) { "" } else { "s" };
    format!("{count} {noun}{ending}")
}

/// A unit as it follows a number: a space and the unit, such as " m/s". Empty for a pure number ("" or "1").
///
/// # Examples
///
/// ```
/// use patchcord_core::document::unit_suffix;
///
/// assert_eq!(unit_suffix("m/s"), " m/s");
/// assert_eq!(unit_suffix("1"), "");
/// ```
pub fn unit_suffix(unit: &str) -> String {
    if unit.is_empty() || unit == "1" { String::new() } else { format!(" {unit}") }
}

/// The part of a message that follows a value outside its range, such as "outside 0 ... 1 V".
///
/// If the upper bound is `f64::MAX`, only the lower bound is named: "below 0 V". Bounds below 1000 are rounded to 1e-9,
/// because they may include a margin for rounding errors.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::range_violation;
///
/// assert_eq!(range_violation(2.0, (0.0, 1.0), "V"), "outside 0 ... 1 V");
/// assert_eq!(range_violation(-2.0, (0.0, f64::MAX), "1"), "below 0");
/// ```
pub fn range_violation(value: f64, (low, high): (f64, f64), unit: &str) -> String {
    let unit = unit_suffix(unit);
    let without_margin = |bound: f64| {
        let bound = if bound.abs() < 1e3 { (bound * 1e9).round() / 1e9 } else { bound };
        format_distinct(bound, value)
    };
    match high {
        _ if !value.is_finite() => "and must be a finite number".to_owned(),
        f64::MAX => format!("below {}{unit}", without_margin(low)),
        _ => format!("outside {} ... {}{unit}", without_margin(low), without_margin(high)),
    }
}

/// Number of diagnostics from which on unknown names get no suggestion. A suggestion compares a name with all known
/// names, which takes too long if thousands of names are wrong.
pub(crate) const MAX_SUGGESTIONS: usize = 50;

/// Number of known names that a hint lists at most, so that it stays on one or two lines.
const MAX_NAMES_LISTED: usize = 10;

/// A hint for an unknown name: "did you mean ...?" if a known name is similar, otherwise a list of the known names.
///
/// The list contains at most ten names. `None` if there are no known names.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::suggestion;
///
/// assert_eq!(suggestion("sumer", &["summer", "pot"]).as_deref(), Some("did you mean \"summer\"?"));
/// assert_eq!(suggestion("relay", &["summer", "pot"]).as_deref(), Some("known here: summer, pot"));
/// assert_eq!(suggestion("relay", &[]), None);
/// ```
pub fn suggestion(name: &str, known: &[&str]) -> Option<String> {
    if let Some(near) = nearest(name, known.iter().copied()) {
        return Some(format!("did you mean \"{near}\"?"));
    }
    let listed = known.iter().take(MAX_NAMES_LISTED).copied();
    let more = (known.len() > MAX_NAMES_LISTED).then_some("...");
    let listed: Vec<_> = listed.chain(more).collect();
    (!known.is_empty()).then(|| format!("known here: {}", listed.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_at_most_six_significant_digits() {
        let numbers = [(1.2, "1.2"), (-0.0, "0"), (1.0 / 3.0, "0.333333"), (45e6, "4.5e7"), (1e-9, "1e-9")];
        for (value, expected) in numbers {
            assert_eq!(format_number(value), expected);
        }
    }

    #[test]
    fn compared_numbers_have_as_many_digits_as_they_need() {
        let pairs = [
            ((2e8 + 2.0, 2e8), ["2.00000002e8", "2e8"]),
            ((1.0 + f64::EPSILON, 1.0), ["1.0000000000000002", "1"]),
            ((0.500_000_1, 0.5), ["0.5000001", "0.5"]),
            ((1.0 / 3.0, 1.0 / 3.0), ["0.333333", "0.333333"]),
            ((f64::NAN, 1.0), ["NaN", "1"]),
        ];
        for ((value, other), expected) in pairs {
            assert_eq!([format_distinct(value, other), format_distinct(other, value)], expected);
        }
        // A bound that is rounded for the message must not exceed the value outside.
        let (value, bounds) = (2.0 / 3.0 + 1e-7, (0.0, 2.0 / 3.0));
        assert_eq!(format_outside(value, bounds), "0.6666668");
        assert_eq!(range_violation(value, bounds, "V"), "outside 0 ... 0.6666667 V");
    }

    #[test]
    fn a_hint_names_the_similar_name_or_at_most_ten_known_names() {
        assert_eq!(suggestion("sumer", &["summer", "pot"]).unwrap(), "did you mean \"summer\"?");
        assert_eq!(suggestion("relay", &["summer", "pot"]).unwrap(), "known here: summer, pot");
        let many = ["a"; 11];
        assert!(suggestion("relay", &many[..10]).unwrap().ends_with("a, a"));
        assert!(suggestion("relay", &many).unwrap().ends_with("a, a, ..."));
    }
}
