//! The readings of a run, told to people and to programs.

use std::collections::HashMap;

use serde_json::{Value, json};

use super::table::Table;
use patchcord::instruments::{Display, Reading, readings};
use patchcord::trace::Trace;

/// Of several runs no more lines than this are printed, but one run at least.
const MOST_TOLD: usize = 40;

/// Start, end and extremes of every signal; in a line for every run where there are several.
pub(super) fn readings_told(trace: &Trace) -> String {
    let readings = readings(trace);
    let largest = largest(&readings);
    let runs = trace.sweeps.len();
    let told = (MOST_TOLD / trace.tracks.len().max(1)).clamp(1, runs.max(1));
    let mut table = Table::new(["run", "signal", "unit", "start", "end", "least", "at s", "most", "at s"]);
    for reading in readings.iter().filter(|reading| reading.run < told) {
        table.row(line(reading, largest[reading.signal.as_str()]));
    }
    if runs < 2 {
        table.drop_first();
    }
    let left = runs - told.min(runs);
    let more = if left > 0 { format!("and {left} more runs: --json tells all\n") } else { String::new() };
    table.text() + &more
}

/// The largest value without sign of every signal: its unit is the same in all runs.
fn largest(readings: &[Reading]) -> HashMap<&str, f64> {
    let mut largest = HashMap::new();
    for reading in readings {
        let value = largest.entry(reading.signal.as_str()).or_insert(0.0);
        *value = reading.largest().max(*value);
    }
    largest
}

fn line(reading: &Reading, largest: f64) -> [String; 9] {
    let shown = Display::new(&reading.unit, largest);
    let seconds = Display::new("", 1.0);
    [
        (reading.run + 1).to_string(),
        reading.signal.clone(),
        shown.unit.clone(),
        shown.number(reading.start),
        shown.number(reading.end),
        shown.number(reading.least.value),
        seconds.number(reading.least.time),
        shown.number(reading.most.value),
        seconds.number(reading.most.time),
    ]
}

pub(super) fn readings_json(trace: &Trace) -> Value {
    readings(trace).iter().map(reading_json).collect()
}

fn reading_json(reading: &Reading) -> Value {
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
