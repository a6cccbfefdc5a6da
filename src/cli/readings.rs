//! Formats the readings of a run as text and as JSON.
//!
//! A reading is start, end, minimum and maximum of a signal in one run. Repetitive operation has one reading per signal
//! and run.

use std::collections::HashMap;

use serde_json::{Value, json};

use super::table::Table;
use patchcord::format::QuantityFormat;
use patchcord::instruments::{Sensitivity, VoltmeterReading, readings, sensitivities};
use patchcord::trace::Trace;

/// The largest number of lines for several runs. At least one run is always printed.
const MAX_ROWS: usize = 40;

/// The table of start, end and extremes of every signal, one line per run. The largest derivatives follow in a second
/// table.
///
/// The column of the run is left out if there is only one.
pub(super) fn readings_text(trace: &Trace) -> String {
    let mut readings = readings(trace);
    let is_signal = |name: &str| trace.track(name).is_some_and(|track| track.derivative.is_none());
    readings.retain(|reading| is_signal(&reading.signal));
    let largest = largest(&readings);
    let runs = trace.sweeps.len();
    let shown = (MAX_ROWS / trace.tracks.len().max(1)).clamp(1, runs.max(1));
    let mut table = Table::new(["run", "signal", "unit", "start", "end", "least", "at s", "most", "at s"]);
    for reading in readings.iter().filter(|reading| reading.run < shown) {
        table.row(line(reading, largest[reading.signal.as_str()]));
    }
    if runs < 2 {
        table.drop_first();
    }
    let omitted = runs - shown.min(runs);
    let more = if omitted > 0 { format!("and {omitted} more runs: see --json\n") } else { String::new() };
    table.text() + &more + &sensitivities_text(trace, shown)
}

/// The table of the largest derivatives of the first `runs` runs; empty if none are recorded.
fn sensitivities_text(trace: &Trace, runs: usize) -> String {
    let mut table = Table::new(["run", "derivative", "unit", "most", "at s", "% per %"]);
    for sensitivity in sensitivities(trace).iter().filter(|sensitivity| sensitivity.run < runs) {
        // A prefix before a quotient of units would be ambiguous.
        let number = |value: f64| QuantityFormat::new("", 1.0).number(value);
        table.row([
            (sensitivity.run + 1).to_string(),
            sensitivity.name.clone(),
            sensitivity.unit.clone(),
            number(sensitivity.most.value),
            number(sensitivity.most.time),
            sensitivity.relative.map_or(String::new(), number),
        ]);
    }
    if trace.sweeps.len() < 2 {
        table.drop_first();
    }
    let text = table.text();
    if text.is_empty() { text } else { format!("\n{text}") }
}

/// The largest absolute value of every signal over all runs, which selects its unit prefix.
fn largest(readings: &[VoltmeterReading]) -> HashMap<&str, f64> {
    let mut largest = HashMap::new();
    for reading in readings {
        let value = largest.entry(reading.signal.as_str()).or_insert(0.0);
        *value = reading.largest().max(*value);
    }
    largest
}

/// One row of the table.
///
/// The largest value of the signal over all runs selects the prefix of the unit.
fn line(reading: &VoltmeterReading, largest: f64) -> [String; 9] {
    let format = QuantityFormat::new(&reading.unit, largest);
    let seconds = QuantityFormat::new("", 1.0);
    [
        (reading.run + 1).to_string(),
        reading.signal.clone(),
        format.unit.clone(),
        format.number(reading.start),
        format.number(reading.end),
        format.number(reading.least.value),
        seconds.number(reading.least.time),
        format.number(reading.most.value),
        seconds.number(reading.most.time),
    ]
}

/// The readings as JSON.
pub(super) fn readings_json(trace: &Trace) -> Value {
    readings(trace).iter().map(reading_json).collect()
}

/// `run` counts from 1. Values are in `unit`, without a prefix; `t` is the time in seconds.
fn reading_json(reading: &VoltmeterReading) -> Value {
    json!({
        "run": reading.run + 1,
        "signal": reading.signal,
        "unit": reading.unit,
        "start": reading.start,
        "end": reading.end,
        "least": {"value": reading.least.value, "t": reading.least.time},
        "most": {"value": reading.most.value, "t": reading.most.time},
    })
}

/// The largest derivatives as JSON.
pub(super) fn sensitivities_json(trace: &Trace) -> Value {
    sensitivities(trace).iter().map(sensitivity_json).collect()
}

/// `most` is the largest derivative with its time. `relative` is the percentage change per percent of the parameter, or
/// null.
fn sensitivity_json(sensitivity: &Sensitivity) -> Value {
    json!({
        "run": sensitivity.run + 1,
        "name": sensitivity.name,
        "signal": sensitivity.signal,
        "parameter": sensitivity.parameter,
        "unit": sensitivity.unit,
        "most": {"value": sensitivity.most.value, "t": sensitivity.most.time},
        "relative": sensitivity.relative,
    })
}
