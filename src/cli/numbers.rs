//! Numbers as they are given on the command line.

/// A number above 0.
pub(super) fn above_zero(text: &str) -> Result<f64, String> {
    let number: f64 =
        text.trim().parse().map_err(|_| format!("\"{text}\" is not a number: leave out its unit"))?;
    if number > 0.0 && number.is_finite() { Ok(number) } else { Err("a number above 0 is wanted".to_owned()) }
}

/// A number that draws begin with.
pub(super) fn seed(text: &str) -> Result<u64, String> {
    text.trim().parse().map_err(|_| format!("a whole number from 0 to {} is wanted", u64::MAX))
}
