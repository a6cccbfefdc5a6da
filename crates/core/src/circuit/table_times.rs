//! Warns of tables of time that do not fit the length of the run.
//!
//! A table that the run never reaches is a constant, which is rarely intended. Usually its times are Unix times, or are
//! in another unit than seconds.

use crate::document::{Code, Diagnostic, Span, format_distinct, format_number};
use crate::elements::SettingQuantity;
use crate::patch::{Amount, Patch, RunPlan};

/// Warns of each table of a drive whose points are all outside the run, and of each table that seems to be in another
/// unit than seconds. `plan` is that of the run, which need not be the plan of the patch.
pub(super) fn check(patch: &Patch, plan: &RunPlan, findings: &mut Vec<Diagnostic>) {
    let Some(end) = plan.longest_repetition().filter(|end| *end > 0.0) else { return };
    for (name, drive) in &patch.drives {
        for (row, setting) in drive.kind.settings.iter().zip(&drive.settings) {
            let (SettingQuantity::Points, Some(placed)) = (row.quantity, setting) else { continue };
            let Amount::Points(points) = &placed.value else { continue };
            if let (Some([first, _]), Some([last, _])) = (points.first(), points.last()) {
                findings.extend(warning(name, placed.span, (*first, *last), end));
            }
        }
    }
}

/// The warning about a table with these first and last times, in seconds. `end` is the length of the run.
fn warning(drive: &str, span: Span, (first, last): (f64, f64), end: f64) -> Option<Diagnostic> {
    let [last_text, end_text] = [last, end].map(format_number);
    let (message, hint) = if first > end {
        let message = format!(
            "the table of {drive} begins at {} s, but the run ends at {} s",
            format_distinct(first, end),
            format_distinct(end, first)
        );
        (message, late_hint(first).to_owned())
    } else if last < 0.0 {
        let message = format!("the table of {drive} ends at {last_text} s, but the run begins at 0 s");
        (message, OTHER_ZERO_HINT.to_owned())
    } else {
        let (ratio, unit) = likely_unit(last / end)?;
        let message = format!(
            "the table of {drive} ends at {last_text} s, about {} times the length of the run, {end_text} s",
            format_number(ratio)
        );
        let hint =
            format!("are its times in {unit}? convert them to seconds, or name the column \"t ({unit})\"");
        (message, hint)
    };
    Some(Diagnostic::at(Code::UNREACHED_TABLE, span, message).hint(hint))
}

/// The hint for a table whose times seem to count from another instant than the start of the run.
const OTHER_ZERO_HINT: &str =
    "subtract the first time from all times, so that the table begins with the run; times are in seconds";

/// The hint for a table with Unix times.
const UNIX_TIME_HINT: &str = "these look like Unix times: subtract the first time from all times";

/// The smallest number that looks like a Unix time: 1973 in seconds. Runs are shorter than this.
const LEAST_UNIX_TIME: f64 = 1e8;

/// The hint for a table that begins after the end of the run, at this time in seconds.
fn late_hint(first: f64) -> &'static str {
    if first >= LEAST_UNIX_TIME { UNIX_TIME_HINT } else { OTHER_ZERO_HINT }
}

/// Units of time that are often read as seconds by mistake, with their number in a second.
const SMALL_UNITS: [(f64, &str); 3] = [(1e3, "ms"), (1e6, "us"), (1e9, "ns")];

/// The relative difference between the lengths of a table and a run of the same experiment. A chosen limit.
const LENGTH_TOLERANCE: f64 = 0.05;

/// The unit in which a table would be as long as the run, with its number in a second. `ratio` is the length of the
/// table in that of the run. `None` if there is no such unit.
fn likely_unit(ratio: f64) -> Option<(f64, &'static str)> {
    SMALL_UNITS.into_iter().find(|(per_second, _)| (ratio / per_second - 1.0).abs() <= LENGTH_TOLERANCE)
}

#[cfg(test)]
mod tests {
    use crate::circuit::Circuit;
    use crate::patch::Patch;

    /// The messages of the warnings about a table with these times in a run with these settings.
    fn warnings(times: &[f64], run: &str) -> Vec<String> {
        let points: Vec<_> = times.iter().map(|time| [*time, 1.0]).collect();
        let text = format!(
            r#"{{"patchcord": 1, "scales": {{"volt": {{"per_volt": 1, "unit": "V"}}}},
                "drives": {{"D": {{"kind": "table", "scale": "volt", "points": {points:?}}}}},
                "signals": {{"d": {{"at": "D", "scale": "volt"}}}}, "run": {run}}}"#
        );
        let circuit = Circuit::new(&Patch::parse("p.json", &text).unwrap());
        let circuit = circuit.unwrap_or_else(|report| panic!("{report}"));
        circuit.warnings().findings.into_iter().map(|finding| finding.message).collect()
    }

    #[test]
    fn a_table_outside_the_run_gives_a_warning() {
        let run = r#"{"for": 3, "step": 0.01}"#;
        let late = ["the table of D begins at 4 s, but the run ends at 3 s"];
        assert_eq!(warnings(&[4.0, 5.0], run), late);
        assert_eq!(warnings(&[-4.0, -1.0], run), ["the table of D ends at -1 s, but the run begins at 0 s"]);
        let phases = r#"{"step": 0.01, "phases": [{"initial_condition": true}, {"operate": 1}, {"operate": 2},
            {"initial_condition": true}, {"operate": 1}]}"#;
        assert_eq!(warnings(&[4.0, 5.0], phases), late);
    }

    #[test]
    fn a_table_in_milliseconds_gives_a_warning() {
        let run = r#"{"for": 3, "step": 0.01}"#;
        let long = |end: &str, ratio: &str| {
            [format!("the table of D ends at {end} s, about {ratio} times the length of the run, 3 s")]
        };
        assert_eq!(warnings(&[0.0, 10.0, 2990.0], run), long("2990", "1000"));
        assert_eq!(warnings(&[0.0, 3.1e6], run), long("3100000", "1000000"));
    }

    #[test]
    fn other_tables_give_no_warning() {
        let run = r#"{"for": 3, "step": 0.01}"#;
        let fitting: [&[f64]; 6] =
            [&[0.0], &[-5.0, 0.0], &[3.0], &[-5.0, 5.0], &[1.0, 100.0], &[0.0, 3600.0]];
        for times in fitting {
            assert!(warnings(times, run).is_empty(), "{times:?}");
        }
        assert!(warnings(&[4.0, 5.0], r#"{"step": 0.01}"#).is_empty(), "the length of the run is unknown");
    }
}
