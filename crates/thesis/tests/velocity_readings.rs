//! Readings of an output velocity, and the formats in which pages print them.

/// Rows at which the velocity rises through the command, which is where a table slips. `command` is the command of a
/// row, in the unit of the velocity.
pub(crate) fn slips(velocity: &[f64], command: impl Fn(usize) -> f64) -> Vec<usize> {
    let exceeds_command = |row: usize| velocity[row] >= command(row);
    (1..velocity.len()).filter(|row| !exceeds_command(row - 1) && exceeds_command(*row)).collect()
}

/// Mean number of slips per second, from the first slip to the last. `every` is the interval of the rows in s.
pub(crate) fn slips_per_second(slips: &[usize], every: f64) -> f64 {
    (slips.len() - 1) as f64 / ((slips[slips.len() - 1] - slips[0]) as f64 * every)
}

/// The minimum.
pub(crate) fn min(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::MAX, f64::min)
}

/// The maximum.
pub(crate) fn max(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::MIN, f64::max)
}

/// A number with a number of decimals. Zero has no sign and no decimals.
pub(crate) fn format_fixed(number: f64, decimals: usize) -> String {
    let text = format!("{number:.decimals$}");
    if text.trim_start_matches('-').bytes().all(|byte| b"0.".contains(&byte)) { "0".to_owned() } else { text }
}
