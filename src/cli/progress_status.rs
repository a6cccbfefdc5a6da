//! The status of long work in words: what is done, how much of it, and about how long the rest takes.
//!
//! The caller passes the present time, so the estimate does not depend on a clock.

use std::time::{Duration, Instant};

use patchcord::expr::format_significant;

/// How much of the work is done, and all of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Amount {
    /// Items, such as runs.
    Items(u64, u64),
    /// Problem time in seconds.
    Seconds(f64, f64),
}

impl Amount {
    /// The fraction of the work that is done, from 0 to 1. Work of size 0 is done.
    fn fraction(self) -> f64 {
        let [done, all] = match self {
            Amount::Items(done, all) => [done as f64, all as f64],
            Amount::Seconds(done, all) => [done, all],
        };
        if all > 0.0 { (done / all).clamp(0.0, 1.0) } else { 1.0 }
    }

    /// All of the work, as a number of items or of seconds.
    fn whole(self) -> f64 {
        match self {
            Amount::Items(_, all) => all as f64,
            Amount::Seconds(_, all) => all,
        }
    }

    /// The amount in words: "500 of 1000" or "1.2500 of 60 s".
    fn text(self) -> String {
        match self {
            Amount::Items(done, all) => format!("{done} of {all}"),
            Amount::Seconds(done, all) => format!("{done:.4} of {} s", format_significant(all, 6)),
        }
    }
}

/// The amount of counted work, with the times that the estimate needs.
#[derive(Debug)]
struct Count {
    /// When the work was counted first.
    begin: Instant,
    /// The fraction that was done then.
    first: f64,
    /// When the work was counted last.
    last: Instant,
    /// The amount that was done then.
    amount: Amount,
}

impl Count {
    /// The estimated remaining time. None if it cannot be estimated yet, or if the work takes longer than estimated.
    ///
    /// The work since the first count gives the rate. What was done before that, such as by an earlier command, does
    /// not count.
    fn remaining(&self, now: Instant) -> Option<Duration> {
        let fraction = self.amount.fraction();
        let (done, left) = (fraction - self.first, 1.0 - fraction);
        if done <= 0.0 || left <= 0.0 {
            return None;
        }
        let elapsed = self.last.saturating_duration_since(self.begin).as_secs_f64();
        let after_last = Duration::try_from_secs_f64(elapsed * left / done).ok()?;
        after_last.checked_sub(now.saturating_duration_since(self.last))
    }
}

/// The status of long work.
#[derive(Debug)]
pub(super) struct Status {
    /// The work in words; if it is counted, what is counted, in the plural.
    what: String,
    /// What ends when the estimated time is over: "left", or "left in this phase".
    left: &'static str,
    /// A result that is known already; empty if there is none.
    note: String,
    /// How much is done; None if the work is not counted, or not yet.
    count: Option<Count>,
}

impl Status {
    /// The status of work that is not counted yet.
    pub(super) fn new(what: &str, left: &'static str) -> Self {
        Status { what: what.to_owned(), left, note: String::new(), count: None }
    }

    /// Changes the work. Counting starts again, unless `what` is the same.
    pub(super) fn switch_to(&mut self, what: &str) {
        if self.what != what {
            self.begin(what);
        }
    }

    /// Begins a piece of work, which is not counted yet.
    pub(super) fn begin(&mut self, what: &str) {
        self.what = what.to_owned();
        self.count = None;
    }

    /// Sets the result that is known already.
    pub(super) fn set_note(&mut self, note: String) {
        self.note = note;
    }

    /// Sets the amount that is done at the time `now`. Returns whether a new count begins with it: the first one, one
    /// with another whole, or a smaller one.
    pub(super) fn set_amount(&mut self, amount: Amount, now: Instant) -> bool {
        let is_same = |count: &&mut Count| {
            let before = count.amount;
            before.whole() == amount.whole() && before.fraction() <= amount.fraction()
        };
        match self.count.as_mut().filter(is_same) {
            Some(count) => {
                (count.amount, count.last) = (amount, now);
                false
            }
            None => {
                self.count = Some(Count { begin: now, first: amount.fraction(), last: now, amount });
                true
            }
        }
    }

    /// The status at the time `now`: "500 of 1000 runs, about 2 min left".
    pub(super) fn text(&self, now: Instant) -> String {
        let amount = self.count.as_ref().map_or_else(String::new, |count| count.amount.text() + " ");
        let remaining = self.count.as_ref().and_then(|count| count.remaining(now));
        let remaining = remaining.map(|time| format!(", about {} {}", rough_text(time), self.left));
        let note = if self.note.is_empty() { String::new() } else { format!("; {}", self.note) };
        format!("{amount}{}{}{note}", self.what, remaining.unwrap_or_default())
    }
}

/// A time in one or two digits, for an estimate: "40 s", "2 min", "5 h". It is at least one second.
fn rough_text(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    let [minutes, hours, days] = [60.0, 3600.0, 86400.0].map(|unit| seconds / unit);
    if seconds < 10.0 {
        format!("{:.0} s", seconds.max(1.0))
    } else if seconds < 57.5 {
        format!("{:.0} s", 5.0 * (seconds / 5.0).round())
    } else if minutes < 99.5 {
        format!("{minutes:.0} min")
    } else if hours < 47.5 {
        format!("{hours:.0} h")
    } else {
        format!("{days:.0} days")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The text of a status at `now` seconds. Each report has its time in seconds and the number of finished runs of
    /// 1000.
    fn text(reports: &[(u64, u64)], now: u64) -> String {
        let begin = Instant::now();
        let mut status = Status::new("runs", "left");
        for (seconds, done) in reports {
            status.set_amount(Amount::Items(*done, 1000), begin + Duration::from_secs(*seconds));
        }
        status.text(begin + Duration::from_secs(now))
    }

    #[test]
    fn the_rate_since_the_first_count_gives_the_remaining_time() {
        assert_eq!(text(&[(0, 0), (120, 500)], 120), "500 of 1000 runs, about 2 min left");
        assert_eq!(text(&[(0, 0), (120, 500)], 150), "500 of 1000 runs, about 2 min left");
        assert_eq!(text(&[(0, 0), (120, 500)], 200), "500 of 1000 runs, about 40 s left");
        // The first 900 runs are those of an earlier sweep.
        assert_eq!(text(&[(0, 900), (40, 910)], 40), "910 of 1000 runs, about 6 min left");
    }

    #[test]
    fn without_a_rate_there_is_no_estimate() {
        assert_eq!(text(&[], 10), "runs");
        assert_eq!(text(&[(0, 0)], 10), "0 of 1000 runs");
        assert_eq!(text(&[(0, 900), (5, 900)], 10), "900 of 1000 runs");
        assert_eq!(text(&[(0, 0), (10, 1000)], 10), "1000 of 1000 runs");
        // The work takes longer than estimated.
        assert_eq!(text(&[(0, 0), (10, 999)], 20), "999 of 1000 runs");
    }

    #[test]
    fn other_work_starts_a_new_count() {
        let begin = Instant::now();
        let after = |seconds: u64| begin + Duration::from_secs(seconds);
        let mut status = Status::new("effects", "left in this phase");
        assert!(status.set_amount(Amount::Items(0, 10), begin));
        assert!(!status.set_amount(Amount::Items(5, 10), after(60)));
        status.set_note("best so far: leak at I2".to_owned());
        let text = "5 of 10 effects, about 1 min left in this phase; best so far: leak at I2";
        assert_eq!(status.text(after(60)), text);
        status.switch_to("effects");
        assert_eq!(status.text(after(60)), text);
        assert!(status.set_amount(Amount::Items(0, 4), after(60)));
        assert!(!status.set_amount(Amount::Items(1, 4), after(61)));
        assert!(status.text(after(61)).starts_with("1 of 4 effects, about 3 s left"), "{status:?}");
        assert!(status.set_amount(Amount::Items(0, 4), after(62)), "the same work begins again");
        status.begin("fitting the patch");
        assert_eq!(status.text(after(63)), "fitting the patch; best so far: leak at I2");
    }

    #[test]
    fn a_run_counts_problem_time() {
        let begin = Instant::now();
        let mut status = Status::new("simulated", "left");
        status.set_amount(Amount::Seconds(0.0, 60.0), begin);
        status.set_amount(Amount::Seconds(15.0, 60.0), begin + Duration::from_secs(30));
        assert_eq!(
            status.text(begin + Duration::from_secs(30)),
            "15.0000 of 60 s simulated, about 2 min left"
        );
        assert_eq!(Amount::Seconds(0.0, 0.0).fraction(), 1.0);
    }

    #[test]
    fn times_have_one_or_two_digits() {
        let cases = [
            (0.0, "1 s"),
            (7.4, "7 s"),
            (12.6, "15 s"),
            (57.4, "55 s"),
            (57.6, "1 min"),
            (130.0, "2 min"),
            (5900.0, "98 min"),
            (7200.0, "2 h"),
            (86400.0, "24 h"),
            (200_000.0, "2 days"),
        ];
        for (seconds, text) in cases {
            assert_eq!(rough_text(Duration::from_secs_f64(seconds)), text, "{seconds}");
        }
    }
}
