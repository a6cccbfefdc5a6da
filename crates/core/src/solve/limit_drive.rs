//! How an integrator is driven against its limits of ±100 V: at which limit, for how long, and at which rate.
//!
//! The record does not depend on how long a run lasts after its circuit has settled, except for the time in which the
//! integrator is still driven at the end.

use crate::machines::REFERENCE;
use crate::trace::LimitDrive;

/// The record of one integrator since the last initial condition.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct DriveRecord {
    /// Problem seconds for which the integrator has been driven against its limit without interruption; 0 if it is not
    /// driven at present.
    present: f64,
    /// The longest such time, in problem seconds.
    longest: f64,
    /// Whether the longest time is the present one.
    is_present_longest: bool,
    /// Whether the integrator has been driven against its limit.
    was_driven: bool,
    /// The limit of the longest time, in volts. Before the first such time, the limit that was reached fastest.
    limit: f64,
    /// The largest rate at which the integrator was driven against a limit, in volts per second. Before the first such
    /// time, the largest mean rate in a step that reached a limit.
    rate: f64,
}

impl DriveRecord {
    /// Records a step of some seconds in which the output rose or fell to a limit by `change` volts. `volts` is the
    /// output at its end.
    pub(super) fn reach(&mut self, volts: f64, change: f64, seconds: f64) {
        let rate = if seconds > 0.0 { change.abs() / seconds } else { 0.0 };
        if !self.was_driven && rate >= self.rate {
            (self.limit, self.rate) = (REFERENCE.copysign(volts), rate);
        }
    }

    /// Records that the integrator was driven against its limit for some seconds, at a rate of at most `rate` volts per
    /// second. `volts` is its output.
    pub(super) fn drive(&mut self, volts: f64, rate: f64, seconds: f64) {
        let is_first = !std::mem::replace(&mut self.was_driven, true);
        self.present += seconds;
        self.rate = if is_first { rate } else { self.rate.max(rate) };
        if is_first || self.present > self.longest {
            (self.longest, self.limit) = (self.present, REFERENCE.copysign(volts));
            self.is_present_longest = self.present > 0.0;
        }
    }

    /// Records that the integrator is not driven against its limit at present.
    pub(super) fn release(&mut self) {
        (self.present, self.is_present_longest) = (0.0, false);
    }

    /// The record up to now, with the longest time.
    pub(super) fn limit_drive(&self) -> LimitDrive {
        let DriveRecord { longest, is_present_longest, limit, rate, .. } = *self;
        LimitDrive { limit, seconds: longest, is_at_end: is_present_longest, rate }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_that_is_only_reached_counts_until_the_integrator_is_held() {
        let mut record = DriveRecord::default();
        record.reach(-100.0, -60.0, 0.5);
        record.reach(100.0, 10.0, 0.5);
        let reached = LimitDrive { limit: -100.0, seconds: 0.0, is_at_end: false, rate: 120.0 };
        assert_eq!(record.limit_drive(), reached);
        record.drive(100.0, 8.0, 0.25);
        let held = LimitDrive { limit: 100.0, seconds: 0.25, is_at_end: true, rate: 8.0 };
        assert_eq!(record.limit_drive(), held);
    }

    #[test]
    fn the_longest_time_and_the_largest_rate_count() {
        let mut record = DriveRecord::default();
        record.drive(100.0, 8.0, 0.25);
        record.drive(100.0, 3.0, 0.5);
        record.release();
        // A time of the same length is not the longest.
        record.drive(-100.0, 9.0, 0.75);
        let longest = LimitDrive { limit: 100.0, seconds: 0.75, is_at_end: false, rate: 9.0 };
        assert_eq!(record.limit_drive(), longest);
        record.drive(-100.0, 9.0, 0.25);
        let last = LimitDrive { limit: -100.0, seconds: 1.0, is_at_end: true, ..longest };
        assert_eq!(record.limit_drive(), last);
    }

    #[test]
    fn a_first_step_without_length_counts() {
        let mut record = DriveRecord::default();
        record.drive(-100.0, 9.0, 0.0);
        let first = LimitDrive { limit: -100.0, seconds: 0.0, is_at_end: false, rate: 9.0 };
        assert_eq!(record.limit_drive(), first);
        record.reach(100.0, 50.0, 0.5);
        record.drive(-100.0, 4.0, 0.5);
        assert_eq!(record.limit_drive(), LimitDrive { seconds: 0.5, is_at_end: true, ..first });
    }
}
