//! Formats a product of unit symbols.

/// An exponent whose absolute value is at most this is rounding, and its symbol is omitted.
const EXPONENT_ROUNDING: f64 = 1e-9;

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
    let whole = power.round();
    if (power - whole).abs() > EXPONENT_ROUNDING {
        let decimals = format!("{power:.6}");
        format!("^{}", decimals.trim_end_matches('0'))
    } else if whole == 1.0 {
        String::new()
    } else {
        whole.to_string()
    }
}
