//! The text of numbers for people: rounded to significant digits or to decimals.
//!
//! Reports, messages and drawings use these functions, so that a number has the same text
//! everywhere. Data files need every digit, so they do not use these functions.

/// Numbers from this absolute value up to [`MIN_LARGE`] are printed without an exponent.
const MIN_PLAIN: f64 = 1e-4;

/// Numbers from this absolute value have an exponent.
const MIN_LARGE: f64 = 1e7;

/// Rounds a number to `digits` significant digits.
///
/// The result is the number that is closest to the rounded decimal. Infinities and NaN are returned
/// unchanged. 0 digits round like 1 digit.
///
/// # Examples
///
/// ```
/// use patchcord_expr::round_significant;
///
/// assert_eq!(round_significant(1.0 / 3.0, 3), 0.333);
/// assert_eq!(round_significant(123_456.0, 2), 120_000.0);
/// assert_eq!(round_significant(0.1 + 0.2, 9), 0.3);
/// ```
pub fn round_significant(value: f64, digits: usize) -> f64 {
    let decimals = digits.saturating_sub(1);
    format!("{value:.decimals$e}").parse().unwrap_or(value)
}

/// Formats a number with at most `digits` significant digits, without trailing zeros.
///
/// Numbers below 1e-4 and from 1e7 have an exponent, and -0 is printed as 0. 0 digits format like
/// 1 digit.
///
/// # Examples
///
/// ```
/// use patchcord_expr::format_significant;
///
/// assert_eq!(format_significant(1.0 / 3.0, 6), "0.333333");
/// assert_eq!(format_significant(2.50, 6), "2.5");
/// assert_eq!(format_significant(45e6, 6), "4.5e7");
/// assert_eq!(format_significant(-0.0, 6), "0");
/// ```
pub fn format_significant(value: f64, digits: usize) -> String {
    let rounded = round_significant(value, digits);
    if rounded == 0.0 { "0".to_owned() } else { format_shortest(rounded) }
}

/// Formats a number with at most `decimals` decimals, without trailing zeros.
///
/// The text has no exponent. A negative number that is rounded to zero keeps its sign: `-0`.
///
/// # Examples
///
/// ```
/// use patchcord_expr::format_decimals;
///
/// assert_eq!(format_decimals(0.125, 4), "0.125");
/// assert_eq!(format_decimals(2.0, 4), "2");
/// assert_eq!(format_decimals(1200.0, 0), "1200");
/// ```
pub fn format_decimals(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Formats a number with the fewest digits from which the same number is read again.
///
/// Numbers other than 0 have an exponent below 1e-4 and from 1e7. -0 keeps its sign.
pub(crate) fn format_shortest(value: f64) -> String {
    let magnitude = value.abs();
    let is_plain = magnitude == 0.0 || (MIN_PLAIN..MIN_LARGE).contains(&magnitude);
    if is_plain { value.to_string() } else { format!("{value:e}") }
}

/// Largest length of a leading number, in bytes. Longer texts are not searched for one.
const MAX_LEADING_BYTES: usize = 40;

/// Splits a text such as "8 s" into the number at its start and the rest, without the blanks around them.
///
/// The rest is not empty. `None` if the text does not begin with a finite number.
///
/// # Examples
///
/// ```
/// use patchcord_expr::leading_number;
///
/// assert_eq!(leading_number("-1.5e3 N s/m"), Some(("-1.5e3", "N s/m")));
/// assert_eq!(leading_number("8"), None);
/// assert_eq!(leading_number("inf s"), None);
/// ```
pub fn leading_number(text: &str) -> Option<(&str, &str)> {
    let text = text.trim();
    let is_number = |number: &str| number.parse::<f64>().is_ok_and(f64::is_finite);
    (1..text.len().min(MAX_LEADING_BYTES))
        .rev()
        .filter_map(|end| text.split_at_checked(end))
        .map(|(number, rest)| (number.trim_end(), rest.trim_start()))
        .find(|(number, _)| is_number(number))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn significant_digits_are_rounded() {
        assert_eq!(round_significant(299_792_458.0, 3), 300_000_000.0);
        assert_eq!(round_significant(-0.001_234_56, 4), -0.001_235);
        assert_eq!(round_significant(9.99, 2), 10.0);
        assert_eq!(round_significant(7.6, 0), 8.0);
        assert_eq!(round_significant(f64::INFINITY, 6), f64::INFINITY);
        assert!(round_significant(f64::NAN, 6).is_nan());
    }

    #[test]
    fn significant_digits_have_no_trailing_zeros_and_an_exponent_only_if_needed() {
        let cases = [
            (0.0, "0"),
            (-0.0, "0"),
            (100.0, "100"),
            (1e-4, "0.0001"),
            (0.999_999_7e-4, "0.0001"),
            (9.87e-5, "9.87e-5"),
            (9_999_990.0, "9999990"),
            (9_999_999.0, "1e7"),
            (-4.5e7, "-4.5e7"),
            (0.010_499_999_999_999_999, "0.0105"),
            (f64::NEG_INFINITY, "-inf"),
            (f64::NAN, "NaN"),
        ];
        for (value, text) in cases {
            assert_eq!(format_significant(value, 6), text, "{value:e}");
        }
    }

    #[test]
    fn decimals_have_no_trailing_zeros() {
        let cases = [
            (0.5, 4, "0.5"),
            (0.000_04, 4, "0"),
            (-0.000_04, 4, "-0"),
            (1.0 / 3.0, 2, "0.33"),
            (10.0, 1, "10"),
        ];
        for (value, decimals, text) in cases {
            assert_eq!(format_decimals(value, decimals), text, "{value:e}");
        }
        assert_eq!(format_decimals(1e21, 0), "1000000000000000000000");
        assert_eq!(format_decimals(f64::NAN, 3), "NaN");
    }

    #[test]
    fn shortest_text_has_an_exponent_below_1e_4_and_from_1e7() {
        let cases = [(-0.0, "-0"), (0.1 + 0.2, "0.30000000000000004"), (1e7, "1e7"), (-2.5e-5, "-2.5e-5")];
        for (value, text) in cases {
            assert_eq!(format_shortest(value), text);
        }
    }

    proptest! {
        #[test]
        fn shortest_text_is_read_as_the_same_number(value in prop::num::f64::NORMAL) {
            prop_assert_eq!(format_shortest(value).parse::<f64>(), Ok(value));
        }

        #[test]
        fn rounding_twice_changes_nothing(value in prop::num::f64::NORMAL, digits in 1usize..15) {
            let rounded = round_significant(value, digits);
            prop_assert_eq!(round_significant(rounded, digits), rounded);
            prop_assert_eq!(format_significant(rounded, digits), format_significant(value, digits));
        }
    }
}
