//! Bisection for monotonic conditions.

/// The point between `low` and `high` at which a condition ceases to hold, to rounding.
///
/// The condition must hold from `low` up to this point and not above it. The result is the upper end of the last
/// interval, so it is `high` if the condition holds everywhere.
pub(super) fn bisect(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
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
    fn point_is_found_to_rounding() {
        assert!((bisect(0.0, 2.0, |x| x * x < 2.0) - 2f64.sqrt()).abs() < 1e-15);
        assert_eq!(bisect(0.5, 1.0, |_| true), 1.0);
        assert!(bisect(0.5, 1.0, |_| false) < 0.5 + 1e-15);
    }
}
