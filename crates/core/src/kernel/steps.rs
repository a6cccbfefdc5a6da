//! Consecutive steps of equal length, as indices in a grid.
//!
//! The end of a step is calculated from its index, never by adding lengths, so rounding does not add up.

use crate::grid::{Grid, SAME_INSTANT};

/// Consecutive steps of a grid.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Steps {
    /// The time at which the grid begins, in problem seconds.
    pub begin: f64,
    /// The grid, whose instants are times after `begin`.
    pub grid: Grid,
    /// Index of the instant at which the first step ends.
    pub first: u64,
    /// Number of steps.
    pub count: u64,
}

impl Steps {
    /// The time at which a step ends, in problem seconds: begin + time of instant (first + step). Steps count from 0.
    #[inline(always)]
    pub(crate) fn end_of(&self, step: u64) -> f64 {
        self.begin + self.grid.time(self.first + step)
    }

    /// The steps after the first `taken` ones.
    pub(crate) fn after(self, taken: u64) -> Steps {
        Steps { first: self.first + taken, count: self.count - taken, ..self }
    }

    /// The number of steps up to the next instant whose index is a multiple of a number.
    pub(crate) fn up_to_multiple_of(&self, number: u64) -> u64 {
        number - (self.first - 1) % number
    }

    /// The number of steps that end at a time or before it.
    pub(crate) fn until(&self, time: f64) -> u64 {
        if time == f64::INFINITY {
            return self.count;
        }
        // A time that is far away has the largest index, so it has no successor.
        let whole = self.grid.steps_in((time - self.begin).max(0.0)).saturating_add(1);
        let some = whole.saturating_sub(self.first).min(self.count);
        // The grid tolerates more rounding than the comparison of instants.
        if some > 0 && self.end_of(some - 1) * (1.0 - SAME_INSTANT) > time { some - 1 } else { some }
    }

    /// The number of steps that end before a time by more than a tolerance.
    pub(crate) fn before(&self, time: f64, tolerance: f64) -> u64 {
        let some = self.until(time);
        if some > 0 && self.end_of(some - 1) >= time - tolerance { some - 1 } else { some }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_steps_end_before_a_time_that_is_far_away() {
        let steps = Steps { begin: 0.0, grid: Grid::new(1e-3), first: 1, count: 1000 };
        for time in [1.0, 1e6, 1.9e16, 1e19, f64::MAX, f64::INFINITY] {
            assert_eq!(steps.until(time), 1000, "{time}");
            assert_eq!(steps.after(400).until(time), 600, "{time}");
        }
        assert_eq!([-1e19, 0.0, 0.5e-3, 1e-3, 0.25].map(|time| steps.until(time)), [0, 0, 0, 1, 250]);
    }
}
