/// Exponents nearer to zero than this are left out of a written unit.
const SMALLEST_EXPONENT: f64 = 1e-9;

/// The unit text of factors and their powers: `kg m/s2`, `A/(m K)`, `1/s`, or `1` for none.
pub(super) fn written<S: AsRef<str>>(factors: impl IntoIterator<Item = (S, f64)>) -> String {
    let (above, below): (Vec<_>, Vec<_>) = factors
        .into_iter()
        .filter(|(_, power)| power.abs() > SMALLEST_EXPONENT)
        .partition(|(_, power)| *power > 0.0);
    let numerator = if above.is_empty() { "1".to_owned() } else { product(&above) };
    match below.len() {
        0 => numerator,
        1 => format!("{numerator}/{}", product(&below)),
        _ => format!("{numerator}/({})", product(&below)),
    }
}

fn product<S: AsRef<str>>(factors: &[(S, f64)]) -> String {
    let texts: Vec<String> =
        factors.iter().map(|(name, power)| format!("{}{}", name.as_ref(), power_text(power.abs()))).collect();
    texts.join(" ")
}

fn power_text(power: f64) -> String {
    let whole = power.round();
    if (power - whole).abs() > SMALLEST_EXPONENT {
        let decimals = format!("{power:.6}");
        format!("^{}", decimals.trim_end_matches('0'))
    } else if whole == 1.0 {
        String::new()
    } else {
        whole.to_string()
    }
}
