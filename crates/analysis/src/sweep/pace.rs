//! How many runs are made side by side: so many that rows keep coming, and that a sweep that is killed loses little.

use std::time::{Duration, Instant};

/// Runs that take no longer together are always made side by side.
const SHORT: Duration = Duration::from_secs(2);
/// Others may take this share of the time that the sweep has taken.
const SHARE: f64 = 0.25;
/// A run among as many as can be takes about this part of what it takes among few (docs/performance.md).
const IN_COMPANY: f64 = 0.5;

/// The pace of one thread. It decides when rows come, and nothing of what stands in them.
#[derive(Debug)]
pub(super) struct Pace {
    begun: Instant,
    /// So many are made side by side at most.
    most: u64,
    /// What a run takes among so many, going by those made last; nothing before the first.
    each: Option<Duration>,
}

impl Pace {
    pub fn new(most: u64) -> Self {
        Pace { begun: Instant::now(), most, each: None }
    }

    /// How many runs come next: one as long as nobody knows what it takes.
    pub fn runs(&self) -> u64 {
        self.each.map_or(1, |each| fitting(each, self.begun.elapsed()).clamp(1, self.most))
    }

    /// Makes so many runs.
    pub fn make<T>(&mut self, runs: u64, make: impl FnOnce() -> T) -> T {
        let begin = Instant::now();
        let made = make();
        let share = if runs < self.most { IN_COMPANY } else { 1.0 };
        self.each = Some(begin.elapsed().mul_f64(share / runs.max(1) as f64));
        made
    }
}

/// How many runs that take this time each may be lost after a time.
fn fitting(each: Duration, elapsed: Duration) -> u64 {
    let time = SHORT.max(elapsed.mul_f64(SHARE));
    (time.as_secs_f64() / each.as_secs_f64()) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_short_beside_the_sweep() {
        let fits = |each, elapsed| fitting(Duration::from_millis(each), Duration::from_secs(elapsed));
        assert_eq!([fits(1, 0), fits(500, 1), fits(5000, 1)], [2000, 4, 0]);
        assert_eq!([fits(500, 60), fits(5000, 600), fits(0, 0)], [30, 30, u64::MAX]);
    }

    #[test]
    fn the_first_run_is_made_alone() {
        let mut pace = Pace::new(16);
        assert_eq!(pace.runs(), 1);
        assert_eq!(pace.make(1, || "a row"), "a row");
        assert_eq!(pace.runs(), 16);
        pace.each = Some(Duration::from_secs(3600));
        assert_eq!(pace.runs(), 1);
    }
}
