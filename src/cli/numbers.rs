//! Parsers for numbers on the command line.

/// Parses a positive number.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    let number: f64 =
        text.trim().parse().map_err(|_| format!("\"{text}\" is not a number: leave out its unit"))?;
    if number > 0.0 && number.is_finite() { Ok(number) } else { Err("must be a positive number".to_owned()) }
}

/// The largest number of threads. More only slow each other down.
const MAX_THREADS: usize = 1024;

/// Parses a number of threads.
pub(super) fn threads(text: &str) -> Result<usize, String> {
    let number = text.trim().parse().ok().filter(|number| (1..=MAX_THREADS).contains(number));
    number.ok_or_else(|| format!("must be an integer from 1 to {MAX_THREADS}"))
}

/// Parses the seed of a random number generator.
pub(super) fn seed(text: &str) -> Result<u64, String> {
    text.trim().parse().map_err(|_| format!("must be an integer from 0 to {}", u64::MAX))
}
