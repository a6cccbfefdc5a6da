//! The text of numbers in schematics and patch panels.
//!
//! Numbers have at most four significant digits and a proper minus sign instead of a hyphen.

use crate::plot::with_minus_sign;
use patchcord_analysis::format::format_quantity;
use patchcord_expr::{format_decimals, round_significant};

/// The maximum number of significant digits.
const DIGITS: usize = 4;

/// Formats a fraction such as the setting of a potentiometer.
///
/// The text has four decimals, or four significant digits if the value is below 0.01.
///
/// Examples: 0.25 gives `0.2500`, and 0.001 gives `0.0010`.
pub(super) fn format_fraction(value: f64) -> String {
    match value.abs() {
        small if small > 0.0 && small < 1e-4 => format_four_digits(value),
        small if small > 0.0 && small < 0.01 => format!("{:0<6}", format_four_digits(value)),
        _ => with_minus_sign(&format!("{value:.4}")),
    }
}

/// Formats a value with its unit. The prefix of the unit is chosen so that the text is short.
///
/// Example: -0.5 and "m/s" give `−500 mm/s`.
pub(super) fn format_with_unit(value: f64, unit: &str) -> String {
    with_minus_sign(&format_quantity(value, unit))
}

/// Formats a voltage with its unit; below 1 mV the unit has a prefix.
///
/// Examples: 12.5 gives `12.5 V`, and 2e-4 gives `200 µV`.
pub(super) fn format_volts(value: f64) -> String {
    match value.abs() {
        small if small > 0.0 && small < 1e-3 => format_with_unit(value, "V"),
        _ => format!("{} V", format_four_digits(value)),
    }
}

/// Formats a number with at most four significant digits: `12.35`, `2e5`, `1.235e−5`.
///
/// Numbers below 1e-4 and from 1e5 have an exponent.
pub(super) fn format_four_digits(value: f64) -> String {
    let magnitude = value.abs();
    if value != 0.0 && !(1e-4..1e5).contains(&magnitude) {
        return with_minus_sign(&format!("{:e}", round_significant(value, DIGITS)));
    }
    let last_digit = DIGITS as f64 - 1.0;
    let decimals = if value == 0.0 { 0.0 } else { last_digit - magnitude.log10().floor() };
    with_minus_sign(&format_decimals(value, decimals.max(0.0) as usize))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits_and_a_minus_sign() {
        let shown =
            [0.0, 0.25, 1.0, -50.0, 12.345_67, 99.996, 2e5, -0.1, 1234.5, -1e-5].map(format_four_digits);
        assert_eq!(shown, ["0", "0.25", "1", "−50", "12.35", "100", "2e5", "−0.1", "1234", "−1e−5"]);
    }

    #[test]
    fn fractions_have_four_decimals() {
        let shown = [0.0, 0.25, 0.004, 0.002_345_6, 1.0, 0.123_456, 4e-7, 1.234_56e-5].map(format_fraction);
        assert_eq!(shown, ["0.0000", "0.2500", "0.0040", "0.002346", "1.0000", "0.1235", "4e−7", "1.235e−5"]);
    }

    #[test]
    fn small_values_have_a_prefix() {
        assert_eq!(format_with_unit(-0.5, "m/s"), "−500 mm/s");
        let shown = [0.0, -50.0, 0.001, 1e-6, -2.5e-4].map(format_volts);
        assert_eq!(shown, ["0 V", "−50 V", "0.001 V", "1 µV", "−250 µV"]);
    }
}
