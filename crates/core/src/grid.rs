//! Equal steps of time without accumulated rounding.

/// Times that differ by less than this share of themselves are the same instant.
pub(crate) const SAME: f64 = 1e-12;

/// The instants 0, step, 2 step, ...
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Grid {
    step: f64,
    /// Steps per second, where that is a whole number: k / 1000 is nearer to the truth than k x 0.001.
    per_second: Option<f64>,
}

impl Grid {
    pub fn new(step: f64) -> Self {
        let rate = 1.0 / step;
        let whole = rate.round();
        let exact = (1.0..1e15).contains(&whole) && (rate - whole).abs() <= 1e-9 * whole;
        Grid { step, per_second: exact.then_some(whole) }
    }

    /// The time of an instant.
    pub fn time(&self, index: u64) -> f64 {
        match self.per_second {
            Some(rate) => index as f64 / rate,
            None => index as f64 * self.step,
        }
    }

    /// The instant nearest to a time.
    pub fn nearest(&self, time: f64) -> u64 {
        (time / self.step).round() as u64
    }

    /// What an index is multiplied by, and then divided by, to give its time.
    #[cfg(feature = "native")]
    pub fn numbers(&self) -> (f64, f64) {
        match self.per_second {
            Some(rate) => (1.0, rate),
            None => (self.step, 1.0),
        }
    }

    /// How many whole steps fit into a length of time, rounding forgiven.
    pub fn steps_in(&self, length: f64) -> u64 {
        ((length / self.step) * (1.0 + SAME) + 1e-9) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_steps_give_decimal_times() {
        let grid = Grid::new(0.001);
        assert_eq!(
            (0..4000).filter(|k| grid.time(*k) != format!("{}e-3", k).parse::<f64>().unwrap()).count(),
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
