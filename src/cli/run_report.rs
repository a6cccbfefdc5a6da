//! Formats the work, the overloads and the summary of a run as text.
//!
//! The summary has the time that the run took. This time differs from run to run, so it is only printed: no file and
//! no JSON document has it.

use std::time::Duration;

use super::overloads::overload_lines;
use patchcord::document::plural;
use patchcord::expr::format_significant;
use patchcord::trace::{Trace, WorkCounters};

/// The work of the solver: steps, switchings, kinks and evaluations.
///
/// Sums over all runs of repetitive operation. Example: "3000 steps, 2 switchings, 1 kink, 12000 evaluations".
pub(super) fn work_text(trace: &Trace) -> String {
    let total =
        |count: fn(&WorkCounters) -> u64| trace.repetitions.iter().map(|run| count(&run.work)).sum::<u64>();
    let rejected = match total(|work| work.rejections) {
        0 => String::new(),
        rejections => format!(" ({rejections} rejected)"),
    };
    let [steps, switchings, kinks, evaluations] = [
        plural(total(|work| work.steps), "step"),
        plural(total(|work| work.changes), "switching"),
        plural(total(|work| work.crossings), "kink"),
        plural(total(|work| work.evaluations), "evaluation"),
    ];
    format!("{steps}{rejected}, {switchings}, {kinks}, {evaluations}\n")
}

/// The overloads of all runs, one per line, in colour if `is_coloured`. Empty if there are none.
///
/// The cause is named if an earlier overload explains it. A run that was switched to hold has a line with its time.
pub(super) fn overloads_text(trace: &Trace, is_coloured: bool) -> String {
    let mut text = String::new();
    for (index, run) in trace.repetitions.iter().enumerate() {
        let which = if trace.repetitions.len() > 1 { format!("run {}: ", index + 1) } else { String::new() };
        text += &overload_lines(&which, &run.overloads, is_coloured);
        if run.is_held {
            text += &format!("{which}held at t = {:.6} s\n", run.end);
        }
    }
    text
}

/// The last line of a run: the simulated time of all runs with their holds, their number if there are several, the
/// time that they took, and the number of overloads.
///
/// Example: "8.47 s simulated in 0.14 s; no overload".
pub(super) fn summary_text(trace: &Trace, elapsed: Duration) -> String {
    let simulated = seconds_text(trace.repetitions.iter().map(|run| run.end).sum(), 3);
    let runs = match trace.repetitions.len() {
        0 | 1 => String::new(),
        runs => format!(" in {runs} runs,"),
    };
    let overloads = match trace.overloads().count() {
        0 => "no overload".to_owned(),
        count => plural(count, "overload"),
    };
    format!("{simulated}{runs} simulated in {}; {overloads}\n", elapsed_text(elapsed))
}

/// The time that a run took, to two digits. Times below a hundredth of a second are mostly chance.
fn elapsed_text(elapsed: Duration) -> String {
    match elapsed.as_secs_f64() {
        seconds if seconds < 0.01 => "less than 0.01 s".to_owned(),
        seconds => seconds_text(seconds, 2),
    }
}

/// A time to this many digits; from 100 s on in whole seconds.
fn seconds_text(seconds: f64, digits: usize) -> String {
    if (100.0..1e7).contains(&seconds) {
        format!("{seconds:.0} s")
    } else {
        format!("{} s", format_significant(seconds, digits))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use patchcord::trace::{Demand, Overload, Repetition};

    /// A trace of runs with these ends in seconds. The last one has this number of overloads.
    fn trace(ends: &[f64], overloads: usize) -> Trace {
        let demand = Demand::Peak(120.0);
        let lamp = Overload { element: "A2".to_owned(), time: 0.31, demand, caused_by: None };
        let mut repetitions: Vec<Repetition> =
            ends.iter().map(|end| Repetition { end: *end, ..Repetition::default() }).collect();
        repetitions.last_mut().unwrap().overloads = vec![lamp; overloads];
        Trace { repetitions, ..Trace::default() }
    }

    #[test]
    fn the_summary_has_both_times_and_the_number_of_overloads() {
        let summary = |ends: &[f64], overloads, millis| {
            summary_text(&trace(ends, overloads), Duration::from_millis(millis))
        };
        assert_eq!(summary(&[8.466_666], 0, 138), "8.47 s simulated in 0.14 s; no overload\n");
        assert_eq!(summary(&[3.25], 1, 4), "3.25 s simulated in less than 0.01 s; 1 overload\n");
        assert_eq!(summary(&[4.92, 5.9], 0, 23), "10.8 s in 2 runs, simulated in 0.023 s; no overload\n");
        assert_eq!(summary(&[1234.4], 3, 2345), "1234 s simulated in 2.3 s; 3 overloads\n");
        assert_eq!(summary(&[2e-5], 0, 130_400), "2e-5 s simulated in 130 s; no overload\n");
    }

    #[test]
    fn each_overload_has_a_line_with_its_run() {
        assert_eq!(overloads_text(&trace(&[1.0, 1.0], 0), false), "");
        let text = overloads_text(&trace(&[1.0, 1.0], 1), false);
        assert_eq!(text, "run 2: overload: A2 at t = 0.310000 s, needs 120.0 V (first)\n");
    }
}
