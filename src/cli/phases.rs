//! The phases of a run, told to people and to programs.

use serde_json::{Value, json};

use super::table::Table;
use patchcord::instruments::{deed, ending, missed};
use patchcord::trace::{Deed, Ending, Mark, Trace};

/// More phases than this are not listed but counted.
const MOST_TOLD: usize = 40;

/// What was done when; nothing for a run without phases.
pub(super) fn phases_told(trace: &Trace) -> String {
    if !trace.has_phases() {
        return String::new();
    }
    let mut table = Table::new(["phase", "run", "from s", "to s", "what", "ended by"]);
    for (index, mark) in trace.marks.iter().enumerate().take(MOST_TOLD) {
        let seconds = |time: f64| format!("{time:.6}");
        let (number, run) = ((index + 1).to_string(), (mark.sweep + 1).to_string());
        table.row([number, run, seconds(mark.begin), seconds(mark.end), deed(mark), ending(mark)]);
    }
    let left = trace.marks.len().saturating_sub(MOST_TOLD);
    let more = if left > 0 { format!("and {left} more: --json tells all\n") } else { String::new() };
    let warning = |(index, mark)| Some(format!("warning: phase {}: {}\n", index + 1, missed(mark)?));
    let warnings: String = trace.marks.iter().enumerate().filter_map(warning).take(MOST_TOLD).collect();
    format!("\n{}{more}{warnings}", table.text())
}

/// The phase in which a run stopped, as the beginning of a message.
pub(super) fn phase_told(trace: &Trace) -> String {
    match trace.marks.last() {
        Some(mark) if trace.has_phases() => format!("phase {} ({}): ", trace.marks.len(), deed(mark)),
        _ => String::new(),
    }
}

pub(super) fn phases_json(trace: &Trace) -> Value {
    trace.marks.iter().map(phase_json).collect()
}

fn phase_json(mark: &Mark) -> Value {
    let mut told = json!({
        "run": mark.sweep + 1,
        "what": word(&mark.phase),
        "begin": mark.begin,
        "end": mark.end,
        "problem_time": mark.problem_time,
        "sample": mark.sample,
        "ended_by": ended_by(mark),
    });
    match &mark.phase {
        Deed::Operate { until: Some((relay, position)) } => {
            let switched = match &mark.ended {
                Ending::Switched(position) => Some(position),
                _ => None,
            };
            told["until"] = json!({"relay": relay, "becomes": position, "became": switched});
        }
        Deed::Set(values) => {
            let values = values.iter();
            told["set"] = values
                .map(|new| json!({"name": new.parameter, "value": new.value, "before": new.before, "unit": new.unit}))
                .collect();
        }
        _ => {}
    }
    told
}

fn word(deed: &Deed) -> &'static str {
    match deed {
        Deed::InitialCondition => "initial_condition",
        Deed::Operate { .. } => "operate",
        Deed::Hold => "hold",
        Deed::Set(_) => "set",
    }
}

/// What ended a phase; nothing for one that takes no time.
fn ended_by(mark: &Mark) -> Option<&'static str> {
    match (&mark.phase, &mark.ended) {
        (_, Ending::Stopped) => Some("error"),
        (Deed::InitialCondition | Deed::Set(_), _) => None,
        (_, Ending::Time) => Some("time"),
        (_, Ending::Switched(_)) => Some("relay"),
        (_, Ending::Overload) => Some("overload"),
    }
}
