//! Formats a product of unit symbols.

use crate::number_text::format_decimals;

/// The number of decimals of an exponent in a text.
const EXPONENT_DECIMALS: usize = 6;

/// An exponent whose absolute value is at most this is rounding, and its symbol is omitted. It is half of
/// the last decimal in a text, so no exponent is formatted as 0.
const EXPONENT_ROUNDING: f64 = 0.5e-6;

/// Formats symbols and their powers as a unit text: `kg m/s2`, `A/(m K)`, `1/s`; `1` if there are none.
pub(super) fn format_product<S: AsRef<str>>(factors: impl IntoIterator<Item = (S, f64)>) -> String {
    let (positive, negative): (Vec<_>, Vec<_>) = factors
        .into_iter()
        .filter(|(_, power)| power.abs() > EXPONENT_ROUNDING)
        .partition(|(_, power)| *power > 0.0);
    let numerator = if positive.is_empty() { "1".to_owned() } else { product(&positive) };
    match negative.len() {
        0 => numerator,
        1 => format!("{numerator}/{}", product(&negative)),
        _ => format!("{numerator}/({})", product(&negative)),
    }
}

/// Joins symbols with the absolute values of their powers: `m s2`.
fn product<S: AsRef<str>>(factors: &[(S, f64)]) -> String {
    let texts: Vec<String> =
        factors.iter().map(|(name, power)| format!("{}{}", name.as_ref(), power_text(power.abs()))).collect();
    texts.join(" ")
}

/// Formats a power after its symbol: nothing for 1, `2`, or `^0.5` with at most six decimals.
fn power_text(power: f64) -> String {
    let text = format_decimals(power, EXPONENT_DECIMALS);
    if text == "1" {
        String::new()
    } else if text.contains('.') {
        format!("^{text}")
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_near_whole_numbers_are_whole() {
        let powers = [(1.0, ""), (2.0, "2"), (0.5, "^0.5"), (1.0 / 3.0, "^0.333333"), (1e6, "1000000")];
        for (power, text) in powers {
            assert_eq!(power_text(power), text);
        }
        assert_eq!([2.000_000_1, 1.999_999_9, 1.000_000_1].map(power_text), ["2", "2", ""]);
    }

    #[test]
    fn symbols_with_a_power_of_0_are_omitted() {
        assert_eq!(format_product([("m", 1.0), ("s", -1e-8)]), "m");
        assert_eq!(format_product([("m", 1e-8)]), "1");
    }
}
