//! A grid of equal time steps without accumulated rounding.
//!
//! Instant k is computed from k alone, never by adding steps. If the step is one nth of a second, the time is k / n:
//! this is the double that the decimal notation of the time also gives, so recorded times print as short decimals.

/// Two times count as the same instant if they differ by less than this share of themselves.
pub(crate) const SAME_INSTANT: f64 = 1e-12;

/// A number of steps per second counts as whole if it differs from a whole number by at most this share. So an instant
/// of a grid may be earlier or later than a multiple of the step by this share of its time.
pub(crate) const RATE_TOLERANCE: f64 = 1e-9;

/// The instants 0, step, 2 step and so on, in seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Grid {
    /// Length of a step in seconds.
    step: f64,
    /// Steps per second, if that is a whole number to within [`RATE_TOLERANCE`]: k / 1000 is rounded once, k x 0.001
    /// twice.
    per_second: Option<f64>,
}

impl Grid {
    /// The grid of a step length in seconds.
    pub(crate) fn new(step: f64) -> Self {
        let rate = 1.0 / step;
        let whole = rate.round();
        let exact = (1.0..1e15).contains(&whole) && (rate - whole).abs() <= RATE_TOLERANCE * whole;
        Grid { step, per_second: exact.then_some(whole) }
    }

    /// The time of the instant with this index, in seconds.
    pub(crate) fn time(&self, index: u64) -> f64 {
        match self.per_second {
            Some(rate) => index as f64 / rate,
            None => index as f64 * self.step,
        }
    }

    /// Index of the instant nearest to a time; 0 for negative times.
    pub(crate) fn nearest(&self, time: f64) -> u64 {
        (time / self.step).round() as u64
    }

    /// The pair (a, b) for which `time(k)` is k x a / b. Native code computes times from it.
    #[cfg(feature = "native")]
    pub(crate) fn factors(&self) -> (f64, f64) {
        match self.per_second {
            Some(rate) => (1.0, rate),
            None => (self.step, 1.0),
        }
    }

    /// How many whole steps fit into a length of time in seconds. A length that rounding leaves just short of a whole
    /// number of steps counts as that number.
    pub(crate) fn steps_in(&self, length: f64) -> u64 {
        ((length / self.step) * (1.0 + SAME_INSTANT) + 1e-9) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_steps_give_decimal_times() {
        let grid = Grid::new(0.001);
        assert_eq!(
            (0..4000).filter(|k| grid.time(*k) != format!("{k}e-3").parse::<f64>().unwrap()).count(),
            0
        );
    }

    #[test]
    fn whole_steps_are_counted() {
        assert_eq!(Grid::new(2e-5).steps_in(8.4667), 423_335);
        assert_eq!(Grid::new(0.1).steps_in(0.3), 3);
        assert_eq!(Grid::new(0.1).steps_in(0.29), 2);
    }
}
