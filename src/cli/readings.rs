//! Formats the readings of a run as text and as JSON.
//!
//! A reading is start, end, minimum and maximum of a signal in one run. Repetitive operation has one reading per signal
//! and run.

use std::collections::HashMap;

use serde::Serialize;

use super::table::Table;
use patchcord::format::{QuantityFormat, format_pure_number};
use patchcord::instruments::{Extreme, Sensitivity, VoltmeterReading, readings, sensitivities};
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
    let runs = trace.repetitions.len();
    let shown = (MAX_ROWS / trace.tracks.len().max(1)).clamp(1, runs.max(1));
    let mut table = Table::new(["run", "signal", "unit", "start", "end", "least", "at s", "most", "at s"]);
    for reading in readings.iter().filter(|reading| reading.run < shown) {
        table.row(line(reading, largest[reading.signal.as_str()]));
    }
    if runs < 2 {
        table.drop_column(0);
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
        table.row([
            (sensitivity.run + 1).to_string(),
            sensitivity.name.clone(),
            sensitivity.unit.clone(),
            format_pure_number(sensitivity.most.value),
            format_pure_number(sensitivity.most.time),
            sensitivity.relative.map_or(String::new(), format_pure_number),
        ]);
    }
    if trace.repetitions.len() < 2 {
        table.drop_column(0);
    }
    let text = table.text();
    if text.is_empty() { text } else { format!("\n{text}") }
}

/// The largest absolute value of every signal over all runs. Values that are negligible compared with it are 0.
fn largest(readings: &[VoltmeterReading]) -> HashMap<&str, f64> {
    let mut largest = HashMap::new();
    for reading in readings {
        let value = largest.entry(reading.signal.as_str()).or_insert(0.0);
        *value = reading.largest().max(*value);
    }
    largest
}

/// One row of the table, in the unit that the patch gives to the signal. `largest` is the largest value of the signal
/// over all runs.
fn line(reading: &VoltmeterReading, largest: f64) -> [String; 9] {
    let format = QuantityFormat::unprefixed(&reading.unit, largest);
    [
        (reading.run + 1).to_string(),
        reading.signal.clone(),
        format.unit.clone(),
        format.number(reading.start),
        format.number(reading.end),
        format.number(reading.least.value),
        format_pure_number(reading.least.time),
        format.number(reading.most.value),
        format_pure_number(reading.most.time),
    ]
}

/// A reading for `--json`. `run` counts from 1. Values are in `unit`, without a prefix.
#[derive(Serialize)]
pub(super) struct ReadingDocument {
    run: usize,
    signal: String,
    unit: String,
    start: f64,
    end: f64,
    least: ExtremeDocument,
    most: ExtremeDocument,
}

/// The largest derivative of a signal for `--json`. `relative` is the percentage change per percent of the parameter,
/// or null.
#[derive(Serialize)]
pub(super) struct SensitivityDocument {
    run: usize,
    name: String,
    signal: String,
    parameter: String,
    unit: String,
    most: ExtremeDocument,
    relative: Option<f64>,
}

/// An extreme value with its time in seconds.
#[derive(Serialize)]
struct ExtremeDocument {
    value: f64,
    #[serde(rename = "t")]
    time: f64,
}

impl From<Extreme> for ExtremeDocument {
    fn from(Extreme { value, time }: Extreme) -> Self {
        ExtremeDocument { value, time }
    }
}

impl ReadingDocument {
    /// The readings of all signals in all runs.
    pub(super) fn all(trace: &Trace) -> Vec<Self> {
        let document = |reading: VoltmeterReading| ReadingDocument {
            run: reading.run + 1,
            signal: reading.signal,
            unit: reading.unit,
            start: reading.start,
            end: reading.end,
            least: reading.least.into(),
            most: reading.most.into(),
        };
        readings(trace).into_iter().map(document).collect()
    }
}

impl SensitivityDocument {
    /// The largest derivatives of all runs.
    pub(super) fn all(trace: &Trace) -> Vec<Self> {
        let document = |sensitivity: Sensitivity| SensitivityDocument {
            run: sensitivity.run + 1,
            name: sensitivity.name,
            signal: sensitivity.signal,
            parameter: sensitivity.parameter,
            unit: sensitivity.unit,
            most: sensitivity.most.into(),
            relative: sensitivity.relative,
        };
        sensitivities(trace).into_iter().map(document).collect()
    }
}
