//! Roots of what rises or falls steadily.

/// Where a condition that holds at `low` and not at `high` stops to hold, halved down to rounding.
pub(super) fn halved(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return high;
        }
        if holds(middle) { low = middle } else { high = middle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_is_found_to_rounding() {
        assert!((halved(0.0, 2.0, |x| x * x < 2.0) - 2f64.sqrt()).abs() < 1e-15);
        assert_eq!(halved(0.5, 1.0, |_| true), 1.0);
        assert!(halved(0.5, 1.0, |_| false) < 0.5 + 1e-15);
    }
}
