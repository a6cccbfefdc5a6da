//! Numbers as they are given on the command line.

/// A number above 0.
pub(super) fn above_zero(text: &str) -> Result<f64, String> {
    let number: f64 =
        text.trim().parse().map_err(|_| format!("\"{text}\" is not a number: leave out its unit"))?;
    if number > 0.0 && number.is_finite() { Ok(number) } else { Err("a number above 0 is wanted".to_owned()) }
}

/// More threads than this only get in each other's way.
const MOST_THREADS: usize = 1024;

/// How many threads work at the same time.
pub(super) fn threads(text: &str) -> Result<usize, String> {
    let number = text.trim().parse().ok().filter(|number| (1..=MOST_THREADS).contains(number));
    number.ok_or_else(|| format!("a whole number from 1 to {MOST_THREADS} is wanted"))
}

/// A number that draws begin with.
pub(super) fn seed(text: &str) -> Result<u64, String> {
    text.trim().parse().map_err(|_| format!("a whole number from 0 to {} is wanted", u64::MAX))
}
