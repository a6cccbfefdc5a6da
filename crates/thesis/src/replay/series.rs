//! Functions on series of numbers that several figures and checks use.

/// Returns the smallest and the largest number. They are infinity and -infinity if there are no numbers.
pub(super) fn min_max(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let start = (f64::INFINITY, f64::NEG_INFINITY);
    values.into_iter().fold(start, |(min, max), value| (min.min(value), max.max(value)))
}

/// Returns whether every number is larger than its predecessor. A single number counts as rising.
pub(super) fn is_rising(values: &[f64]) -> bool {
    values.is_sorted_by(|one, next| next > one)
}

/// Returns whether every number is smaller than its predecessor. A single number counts as falling.
pub(super) fn is_falling(values: &[f64]) -> bool {
    values.is_sorted_by(|one, next| next < one)
}

/// Whether a series has a trend.
pub(super) type Trend = fn(&[f64]) -> bool;

/// The names of both trends in the ledger, with the functions that detect them.
pub(super) const TRENDS: [(&str, Trend); 2] = [("rises", is_rising), ("falls", is_falling)];

/// Returns the largest absolute difference between numbers at the same index of two series.
pub(super) fn max_difference(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max)
}

/// Formats numbers with commas between them, and their unit after the last: "1.20, 3.40 mm/s".
pub(super) fn format_list(values: &[f64], decimals: usize, unit: &str) -> String {
    let texts: Vec<_> = values.iter().map(|value| format!("{value:.decimals$}")).collect();
    format!("{} {unit}", texts.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trends_are_strict() {
        assert!(is_rising(&[1.0, 2.0, 4.0]) && is_falling(&[4.0, 2.0]) && is_rising(&[1.0]));
        assert!(!is_rising(&[1.0, 1.0]) && !is_falling(&[1.0, 1.0]) && !is_rising(&[1.0, f64::NAN]));
    }

    #[test]
    fn extremes_and_differences_are_found() {
        assert_eq!(min_max([2.0, -1.0, 3.0]), (-1.0, 3.0));
        assert_eq!(max_difference(&[1.0, 5.0], &[2.0, 1.0]), 4.0);
        assert_eq!(format_list(&[1.2, 3.456], 2, "mm/s"), "1.20, 3.46 mm/s");
    }
}
