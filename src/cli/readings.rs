//! The readings of a run, told to people and to programs.

use std::collections::HashMap;

use serde_json::{Value, json};

use super::table::Table;
use patchcord::instruments::{Display, Reading, Sensitivity, readings, sensitivities};
use patchcord::trace::Trace;

/// Of several runs no more lines than this are printed, but one run at least.
const MOST_TOLD: usize = 40;

/// Start, end and extremes of every signal; in a line for every run where there are several. Derivatives are told
/// below, where they are largest.
pub(super) fn readings_told(trace: &Trace) -> String {
    let mut readings = readings(trace);
    let is_signal = |name: &str| trace.track(name).is_some_and(|track| track.derivative.is_none());
    readings.retain(|reading| is_signal(&reading.signal));
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
    table.text() + &more + &sensitivities_told(trace, told)
}

/// The largest derivatives of so many runs; nothing where none were asked for.
fn sensitivities_told(trace: &Trace, runs: usize) -> String {
    let mut table = Table::new(["run", "derivative", "unit", "most", "at s", "% per %"]);
    for told in sensitivities(trace).iter().filter(|told| told.run < runs) {
        // A prefix in front of a quotient of units would be read wrongly.
        let number = |value: f64| Display::new("", 1.0).number(value);
        table.row([
            (told.run + 1).to_string(),
            told.name.clone(),
            told.unit.clone(),
            number(told.most.value),
            number(told.most.time),
            told.relative.map_or(String::new(), number),
        ]);
    }
    if trace.sweeps.len() < 2 {
        table.drop_first();
    }
    let text = table.text();
    if text.is_empty() { text } else { format!("\n{text}") }
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

pub(super) fn sensitivities_json(trace: &Trace) -> Value {
    sensitivities(trace).iter().map(sensitivity_json).collect()
}

fn sensitivity_json(told: &Sensitivity) -> Value {
    json!({
        "run": told.run + 1,
        "name": told.name,
        "signal": told.signal,
        "parameter": told.parameter,
        "unit": told.unit,
        "most": {"value": told.most.value, "t": told.most.time},
        "relative": told.relative,
    })
}
