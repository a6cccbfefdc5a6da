//! Plans which steps of a run are checked: a limited number, spread evenly over all its phases and repetitions.
//!
//! The steps are divided into equal parts with one check in each, at a place that differs from part to part. So the
//! checks do not always meet the same instant of a repetition. The plan depends on nothing except the numbers of steps.

use crate::low_discrepancy::golden_place;

/// Numbers of checked steps: the least, the most, and the number of steps for which one step is checked.
const CHECKED_STEPS: (u64, u64, u64) = (32, 256, 6_400_000);

/// The steps of a run that are checked.
#[derive(Debug, Clone, Copy)]
pub(super) struct CheckPlan {
    /// Number of steps of the run if no phase ends early.
    run_steps: u64,
    /// Number of checks of the run.
    checks: u64,
    /// Index of the next check, from 0.
    check: u64,
    /// Number of steps before the first part, counted from the beginning of the run.
    begin: u64,
    /// Index of the check in the first part.
    first_check: u64,
    /// Number of steps of a part, at least 1.
    part_length: f64,
    /// Number of steps before the present phase, counted as if no phase ended early.
    phase_begin: u64,
    /// The same for the end of the present phase.
    phase_end: u64,
}

impl CheckPlan {
    /// The plan of a run that takes this number of steps if no phase ends early.
    pub(super) fn new(run_steps: u64) -> Self {
        let (least, most, total) = CHECKED_STEPS;
        CheckPlan::with_checks(run_steps, (total / run_steps.max(1)).clamp(least, most))
    }

    /// The same with another number of checks.
    pub(super) fn with_checks(run_steps: u64, checks: u64) -> Self {
        CheckPlan {
            run_steps,
            checks,
            check: 0,
            begin: 0,
            first_check: 0,
            part_length: part_length(run_steps, checks),
            phase_begin: 0,
            phase_end: 0,
        }
    }

    /// Begins a phase of at most this number of steps. If the phase before ended early, its remaining checks are spread
    /// over the rest of the run.
    pub(super) fn begin_phase(&mut self, steps: u64) {
        (self.phase_begin, self.phase_end) = (self.phase_end, self.phase_end.saturating_add(steps));
        if self.position() < self.phase_begin {
            let remaining = self.run_steps.saturating_sub(self.phase_begin);
            (self.begin, self.first_check) = (self.phase_begin, self.check);
            self.part_length = part_length(remaining, self.checks - self.check);
        }
    }

    /// Number of the next step that is checked, counted from 1 in the present phase. If no check is left, it is larger
    /// than the numbers of all steps.
    pub(super) fn next(&self) -> u64 {
        self.position().saturating_sub(self.phase_begin).saturating_add(1)
    }

    /// Moves to the first check after a step with this number in the present phase.
    pub(super) fn advance(&mut self, step: u64) {
        while self.check < self.checks && self.next() <= step {
            self.check += 1;
        }
    }

    /// Number of steps of the run before the next check; the largest number if no check is left.
    fn position(&self) -> u64 {
        if self.check >= self.checks {
            return u64::MAX;
        }
        let parts = (self.check - self.first_check) as f64 + golden_place(self.check);
        self.begin.saturating_add((parts * self.part_length) as u64)
    }
}

/// The number of steps of each part, at least 1.
fn part_length(steps: u64, checks: u64) -> f64 {
    (steps as f64 / checks as f64).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The checked steps of phases, from the planned and the real number of steps of each.
    fn checked(phases: &[(u64, u64)]) -> Vec<Vec<u64>> {
        let mut plan = CheckPlan::new(phases.iter().map(|(planned, _)| planned).sum());
        let checked_in = |(planned, taken): &(u64, u64)| {
            plan.begin_phase(*planned);
            let mut steps = Vec::new();
            while plan.next() <= *taken {
                steps.push(plan.next());
                plan.advance(plan.next());
            }
            steps
        };
        phases.iter().map(checked_in).collect()
    }

    #[test]
    fn all_steps_of_a_short_run_are_checked() {
        assert_eq!(checked(&[(3, 3), (1, 1), (0, 0), (2, 2)]), [vec![1, 2, 3], vec![1], vec![], vec![1, 2]]);
    }

    #[test]
    fn checks_of_a_long_phase_are_spread_evenly() {
        for (steps, count) in [(25_600, 250), (100_000, 64), (1_000_000_000, 32)] {
            let found = checked(&[(steps, steps)]).concat();
            assert_eq!((found.len(), found[0]), (count, 1), "{steps}");
            let longest = found.windows(2).map(|pair| pair[1] - pair[0]).max();
            assert!(found.is_sorted() && longest < Some(2 * steps / count as u64 + 2), "{steps}: {found:?}");
        }
    }

    #[test]
    fn short_phases_have_the_checks_of_one_long_phase_at_different_places() {
        let mut found = checked(&[(100, 100); 1000]).concat();
        assert_eq!(found.len(), 64);
        found.sort_unstable();
        found.dedup();
        assert!(found.len() > 20, "{found:?}");
    }

    #[test]
    fn checks_of_phases_that_end_early_are_made_later() {
        let found = checked(&[(1000, 100); 10]);
        assert!(found.iter().all(|steps| steps.len() >= 2), "{found:?}");
        assert!(found[9].len() >= 15 && found.concat().len() <= 256, "{found:?}");
    }
}
