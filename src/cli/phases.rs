//! Formats the phases of a run as text and as JSON.

use serde::Serialize;

use super::table::Table;
use patchcord::instruments::{phase_description, phase_end_description, unmet_condition};
use patchcord::trace::{NewValue, PhaseEnd, PhaseKind, PhaseRecord, Trace};

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
    for (index, record) in trace.phase_records.iter().enumerate().take(MAX_ROWS) {
        let seconds = |time: f64| format!("{time:.6}");
        let (number, run) = ((index + 1).to_string(), (record.repetition + 1).to_string());
        let (what, end) = (phase_description(record), phase_end_description(record));
        table.row([number, run, seconds(record.begin), seconds(record.end), what, end]);
    }
    let omitted = trace.phase_records.len().saturating_sub(MAX_ROWS);
    let more = if omitted > 0 { format!("and {omitted} more: see --json\n") } else { String::new() };
    format!("\n{}{more}{}", table.text(), phase_warnings(trace))
}

/// The warnings about phases that ended by time although they waited for a relay, one per line.
pub(super) fn phase_warnings(trace: &Trace) -> String {
    let warning =
        |(index, record)| Some(format!("warning: phase {}: {}\n", index + 1, unmet_condition(record)?));
    trace.phase_records.iter().enumerate().filter_map(warning).take(MAX_ROWS).collect()
}

/// The phase in which a run stopped, as the start of a message. Empty for a run without phases.
pub(super) fn phase_prefix(trace: &Trace) -> String {
    match trace.phase_records.last() {
        Some(record) if trace.has_phases() => {
            format!("phase {} ({}): ", trace.phase_records.len(), phase_description(record))
        }
        _ => String::new(),
    }
}

/// A phase for `--json`. `run` counts from 1. Begin, end and problem time are in seconds. A phase that waits for a
/// relay has `until`, one that changes parameters has `set`.
#[derive(Serialize)]
pub(super) struct PhaseDocument<'a> {
    run: usize,
    what: &'static str,
    begin: f64,
    end: f64,
    problem_time: f64,
    sample: usize,
    ended_by: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    until: Option<ConditionDocument<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    set: Option<Vec<ChangeDocument<'a>>>,
}

/// The condition that ends a phase: the relay, the position that it should reach, and the position that it reached.
#[derive(Serialize)]
struct ConditionDocument<'a> {
    relay: &'a str,
    #[serde(rename = "becomes")]
    wanted: Option<&'a str>,
    #[serde(rename = "became")]
    reached: Option<&'a str>,
}

/// A change of a parameter, with both values in `unit`.
#[derive(Serialize)]
struct ChangeDocument<'a> {
    name: &'a str,
    value: f64,
    before: f64,
    unit: &'a str,
}

impl<'a> PhaseDocument<'a> {
    /// The phases of a trace, in the order of time.
    pub(super) fn all(trace: &'a Trace) -> Vec<Self> {
        trace.phase_records.iter().map(PhaseDocument::of).collect()
    }

    fn of(record: &'a PhaseRecord) -> Self {
        let set = match &record.phase {
            PhaseKind::Set(values) => Some(values.iter().map(ChangeDocument::of).collect()),
            _ => None,
        };
        PhaseDocument {
            run: record.repetition + 1,
            what: kind_text(&record.phase),
            begin: record.begin,
            end: record.end,
            problem_time: record.problem_time,
            sample: record.sample,
            ended_by: ended_by(record),
            until: ConditionDocument::of(record),
            set,
        }
    }
}

impl<'a> ConditionDocument<'a> {
    /// The condition of a phase; None if only time ends the phase.
    fn of(record: &'a PhaseRecord) -> Option<Self> {
        let PhaseKind::Operate { until: Some((relay, wanted)) } = &record.phase else { return None };
        let reached = match &record.ended {
            PhaseEnd::Switched(position) => Some(position.as_str()),
            _ => None,
        };
        Some(ConditionDocument { relay, wanted: wanted.as_deref(), reached })
    }
}

impl<'a> ChangeDocument<'a> {
    fn of(change: &'a NewValue) -> Self {
        ChangeDocument {
            name: &change.parameter,
            value: change.value,
            before: change.before,
            unit: &change.unit,
        }
    }
}

/// The kind of a phase as a JSON value.
fn kind_text(kind: &PhaseKind) -> &'static str {
    match kind {
        PhaseKind::InitialCondition => "initial_condition",
        PhaseKind::Operate { .. } => "operate",
        PhaseKind::Hold => "hold",
        PhaseKind::Set(_) => "set",
        _ => "other",
    }
}

/// What ended a phase, as a JSON value; None for a phase without a duration.
fn ended_by(record: &PhaseRecord) -> Option<&'static str> {
    match (&record.phase, &record.ended) {
        (_, PhaseEnd::Stopped) => Some("error"),
        (PhaseKind::InitialCondition | PhaseKind::Set(_), _) => None,
        (_, PhaseEnd::Time) => Some("time"),
        (_, PhaseEnd::Switched(_)) => Some("relay"),
        (_, PhaseEnd::Overload) => Some("overload"),
        _ => None,
    }
}
