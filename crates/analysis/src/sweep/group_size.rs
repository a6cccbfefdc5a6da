//! Chooses how many runs a thread computes together: enough for speed, few enough that an interrupted sweep loses
//! little.
//!
//! Rows are written only when a group of runs is complete. The first run is computed alone and timed. Later groups are
//! as large as fits in two seconds or in a quarter of the elapsed time.

use std::time::{Duration, Instant};

/// A group of runs may always take this long.
const MIN_GROUP_TIME: Duration = Duration::from_secs(2);
/// A group of runs may take this fraction of the time since the sweep started.
const ELAPSED_FRACTION: f64 = 0.25;
/// The time per run in a full group as a fraction of the time per run in a small one, measured in docs/performance.md.
const FULL_GROUP_SPEEDUP: f64 = 0.5;

/// The group size of one thread. It affects when rows are written, not their content.
#[derive(Debug)]
pub(super) struct GroupSizer {
    /// When the sweep started.
    started: Instant,
    /// Largest group.
    max: u64,
    /// Expected time per run in a full group, from the last group. None before the first run.
    time_per_run: Option<Duration>,
}

impl GroupSizer {
    /// A sizer for groups of at most `max` runs, with its clock started.
    pub(super) fn new(max: u64) -> Self {
        GroupSizer { started: Instant::now(), max, time_per_run: None }
    }

    /// The number of runs in the next group; 1 for the first.
    pub(super) fn size(&self) -> u64 {
        let fitting = |time: Duration| fitting_runs(time, self.started.elapsed()).clamp(1, self.max);
        self.time_per_run.map_or(1, fitting)
    }

    /// Runs `work`, which computes `runs` runs, and times it.
    pub(super) fn timed<T>(&mut self, runs: u64, work: impl FnOnce() -> T) -> T {
        let begin = Instant::now();
        let result = work();
        let share = if runs < self.max { FULL_GROUP_SPEEDUP } else { 1.0 };
        self.time_per_run = Some(begin.elapsed().mul_f64(share / runs.max(1) as f64));
        result
    }
}

/// The number of runs that fit in the allowed time of a group.
fn fitting_runs(time_per_run: Duration, elapsed: Duration) -> u64 {
    let time = MIN_GROUP_TIME.max(elapsed.mul_f64(ELAPSED_FRACTION));
    (time.as_secs_f64() / time_per_run.as_secs_f64()) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_short_compared_with_the_sweep() {
        let fits = |each, elapsed| fitting_runs(Duration::from_millis(each), Duration::from_secs(elapsed));
        assert_eq!([fits(1, 0), fits(500, 1), fits(5000, 1)], [2000, 4, 0]);
        assert_eq!([fits(500, 60), fits(5000, 600), fits(0, 0)], [30, 30, u64::MAX]);
    }

    #[test]
    fn the_first_run_is_computed_alone() {
        let mut sizer = GroupSizer::new(16);
        assert_eq!(sizer.size(), 1);
        assert_eq!(sizer.timed(1, || "a row"), "a row");
        assert_eq!(sizer.size(), 16);
        sizer.time_per_run = Some(Duration::from_secs(3600));
        assert_eq!(sizer.size(), 1);
    }
}
