//! Formats the phases of a run as text and as JSON.

use serde_json::{Value, json};

use super::table::Table;
use patchcord::instruments::{phase_description, phase_end_description, unmet_condition};
use patchcord::trace::{PhaseEnd, PhaseKind, PhaseRecord, Trace};

/// The largest number of phases in the table.
const MAX_ROWS: usize = 40;

/// The table of phases and the warnings; empty for a run without phases.
///
/// Warnings concern phases that ended by time although they waited for a relay.
pub(super) fn phases_text(trace: &Trace) -> String {
    if !trace.has_phases() {
        return String::new();
    }
    let mut table = Table::new(["phase", "run", "from s", "to s", "what", "ended by"]);
    for (index, mark) in trace.phase_records.iter().enumerate().take(MAX_ROWS) {
        let seconds = |time: f64| format!("{time:.6}");
        let (number, run) = ((index + 1).to_string(), (mark.sweep + 1).to_string());
        let (what, end) = (phase_description(mark), phase_end_description(mark));
        table.row([number, run, seconds(mark.begin), seconds(mark.end), what, end]);
    }
    let omitted = trace.phase_records.len().saturating_sub(MAX_ROWS);
    let more = if omitted > 0 { format!("and {omitted} more: see --json\n") } else { String::new() };
    let warning = |(index, mark)| Some(format!("warning: phase {}: {}\n", index + 1, unmet_condition(mark)?));
    let warnings: String =
        trace.phase_records.iter().enumerate().filter_map(warning).take(MAX_ROWS).collect();
    format!("\n{}{more}{warnings}", table.text())
}

/// The phase in which a run stopped, as the start of a message. Empty for a run without phases.
pub(super) fn phase_prefix(trace: &Trace) -> String {
    match trace.phase_records.last() {
        Some(mark) if trace.has_phases() => {
            format!("phase {} ({}): ", trace.phase_records.len(), phase_description(mark))
        }
        _ => String::new(),
    }
}

/// The phases as JSON.
pub(super) fn phases_json(trace: &Trace) -> Value {
    trace.phase_records.iter().map(phase_json).collect()
}

/// Keys: `run` from 1, `what`, `begin` and `end` in seconds, `problem_time`, `sample`, `ended_by`. A phase that waits
/// for a relay has `until`, one that changes parameters has `set`, a list of `name`, `value`, `before` and `unit`.
fn phase_json(mark: &PhaseRecord) -> Value {
    let mut document = json!({
        "run": mark.sweep + 1,
        "what": word(&mark.phase),
        "begin": mark.begin,
        "end": mark.end,
        "problem_time": mark.problem_time,
        "sample": mark.sample,
        "ended_by": ended_by(mark),
    });
    match &mark.phase {
        PhaseKind::Operate { until: Some((relay, position)) } => {
            let switched = match &mark.ended {
                PhaseEnd::Switched(position) => Some(position),
                _ => None,
            };
            document["until"] = json!({"relay": relay, "becomes": position, "became": switched});
        }
        PhaseKind::Set(values) => {
            let values = values.iter();
            document["set"] = values
                .map(|new| json!({"name": new.parameter, "value": new.value, "before": new.before, "unit": new.unit}))
                .collect();
        }
        _ => {}
    }
    document
}

/// The kind of a phase as a JSON value.
fn word(kind: &PhaseKind) -> &'static str {
    match kind {
        PhaseKind::InitialCondition => "initial_condition",
        PhaseKind::Operate { .. } => "operate",
        PhaseKind::Hold => "hold",
        PhaseKind::Set(_) => "set",
    }
}

/// What ended a phase, as a JSON value; None for a phase without a duration.
fn ended_by(mark: &PhaseRecord) -> Option<&'static str> {
    match (&mark.phase, &mark.ended) {
        (_, PhaseEnd::Stopped) => Some("error"),
        (PhaseKind::InitialCondition | PhaseKind::Set(_), _) => None,
        (_, PhaseEnd::Time) => Some("time"),
        (_, PhaseEnd::Switched(_)) => Some("relay"),
        (_, PhaseEnd::Overload) => Some("overload"),
    }
}
