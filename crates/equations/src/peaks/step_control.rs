//! The length of the steps of a solution.
//!
//! The estimated error of a step decides about the length of the next one. The number of short steps is limited: a
//! comparator that switches without end would shorten every step. When it is used up, short steps are accepted with a
//! larger error.

use patchcord_core::solve::DORMAND_PRINCE;

use super::times::RunTimes;

/// Length of the next step as a share of the length whose predicted error is exactly the tolerance.
const SAFETY_FACTOR: f64 = 0.9;
/// Largest ratio between the lengths of two successive steps, in both directions.
const MAX_CHANGE: f64 = 5.0;
/// Longest step as a share of the run, and in steps of the patch.
const LONGEST: (f64, f64) = (0.02, 10.0);
/// Steps shorter than this share of the run, and than a step of the patch, are short.
const SHORT_SHARE: f64 = 1e-5;
/// Least length of a step as a share of the run.
const LEAST_SHARE: f64 = 1e-12;
/// Number of short steps whose error must be within the tolerance.
const MAX_EXACT_SHORT_STEPS: u32 = 20_000;
/// Largest error of any step that is accepted, in tolerances.
const MAX_EXCESS: f64 = 1e4;

/// The control of the length of steps. Lengths are in problem seconds.
#[derive(Debug)]
pub(super) struct StepControl {
    /// The length of the next step according to the error of the last one.
    next: f64,
    /// The longest step.
    longest: f64,
    /// The length below which a step is short.
    short: f64,
    /// The least length of a step.
    least: f64,
    /// Number of short steps that may still be taken with an error within the tolerance.
    exact_short_steps: u32,
}

impl StepControl {
    /// The control before the first step. No step is longer than the shortest delay.
    pub(super) fn new(times: RunTimes, shortest_delay: f64) -> Self {
        let (share, steps) = LONGEST;
        let longest = (steps * times.step).max(times.every).min(share * times.duration).min(shortest_delay);
        StepControl {
            next: times.step.min(longest),
            longest,
            short: times.step.min(SHORT_SHARE * times.duration).min(longest),
            least: (LEAST_SHARE * times.duration).min(longest),
            exact_short_steps: MAX_EXACT_SHORT_STEPS,
        }
    }

    /// The length of the next step if the next stop is this far away. The last two steps before a stop share the time
    /// that remains, so that neither is much too short.
    pub(super) fn length(&self, remaining: f64) -> f64 {
        let next = self.next.min(self.longest);
        if next >= remaining {
            remaining
        } else if 2.0 * next > remaining {
            0.5 * remaining
        } else {
            next
        }
    }

    /// Whether a step of this length is accepted. Its error is in tolerances.
    pub(super) fn is_acceptable(&self, length: f64, error: f64) -> bool {
        error <= 1.0 || (length <= self.least_exact() && error <= MAX_EXCESS)
    }

    /// The least length of a step whose error must be within the tolerance.
    fn least_exact(&self) -> f64 {
        if self.exact_short_steps > 0 { self.least } else { self.short }
    }

    /// Whether no shorter step than this one is tried.
    pub(super) fn is_shortest(&self, length: f64) -> bool {
        length <= self.least
    }

    /// Follows from the error of a step which length the next one has.
    pub(super) fn adapt(&mut self, length: f64, error: f64) {
        // The error of one step grows with the length to the order of the method and one more.
        let change = SAFETY_FACTOR * error.powf(-1.0 / (DORMAND_PRINCE.error_order + 1.0));
        let change =
            if error.is_finite() { change.clamp(1.0 / MAX_CHANGE, MAX_CHANGE) } else { 1.0 / MAX_CHANGE };
        if self.is_acceptable(length, error) {
            self.exact_short_steps -= u32::from(length < self.short).min(self.exact_short_steps);
            let was_cut = length < self.next * SAFETY_FACTOR;
            self.next = if was_cut { self.next.max(length * change) } else { length * change };
        } else {
            self.next = length * change;
        }
        let shortest = if error <= MAX_EXCESS { self.least_exact() } else { self.least };
        self.next = self.next.max(shortest);
    }
}
