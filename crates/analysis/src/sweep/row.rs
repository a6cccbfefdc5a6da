//! One row of a sweep file: parameter values, measured values, error code and notes, as a line of CSV.

use crate::instruments::MeasureValue;
use patchcord_core::trace::format_exact;

/// The result of one run of a sweep.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::MeasureValue;
/// use patchcord_analysis::sweep::SweepRow;
///
/// let cells = vec![Some(MeasureValue::Number(0.1)), None];
/// let row = SweepRow { values: vec![1e-3], cells, error: None, notes: vec!["no oscillation".to_owned()] };
/// assert_eq!(row.line(), "0.001,0.1,,,no oscillation\n");
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SweepRow {
    /// Values of the varied parameters, in their declared units.
    pub values: Vec<f64>,
    /// The measured values, one per column. None if a value cannot be read; a note then gives the reason.
    pub cells: Vec<Option<MeasureValue>>,
    /// The error code if the run failed.
    pub error: Option<&'static str>,
    /// Why the run failed, why values are missing, and warnings such as overloads.
    pub notes: Vec<String>,
}

impl SweepRow {
    /// The row as a line of CSV.
    pub fn line(&self) -> String {
        let cells = self.cells.iter().map(|cell| match cell {
            Some(MeasureValue::Number(value)) => format_exact(*value),
            Some(MeasureValue::Name(name)) => name.clone(),
            Some(MeasureValue::Empty) | None => String::new(),
        });
        // Journal counts rows by line ends, so a note must not contain one.
        let notes = self.notes.join("; ").replace(char::is_control, " ");
        let fields: Vec<_> = cells.chain([self.error.unwrap_or_default().to_owned(), notes]).collect();
        beginning(&self.values) + &csv_line(&fields)
    }
}

/// Whether a line of a sweep file has an error code, and whether it has a note.
pub(super) fn error_and_note(line: &[u8]) -> [bool; 2] {
    // Fast path: most rows end with two empty fields, and a quoted field cannot end like that.
    if line.ends_with(b",,\n") {
        return [false; 2];
    }
    let mut record = csv::ByteRecord::new();
    let read = csv::ReaderBuilder::new().has_headers(false).from_reader(line).read_byte_record(&mut record);
    let fields = if read.is_ok() { record.len() } else { 0 };
    [2, 1].map(|from_end| fields >= from_end && !record[fields - from_end].is_empty())
}

/// The start of the row with these parameter values, up to and including the comma before the measured values.
pub(super) fn beginning(values: &[f64]) -> String {
    values.iter().map(|value| format!("{},", format_exact(*value))).collect()
}

/// A line of CSV. Fields are quoted if necessary.
pub(super) fn csv_line(fields: &[String]) -> String {
    let quoted = fields.iter().map(|field| match field.contains([',', '"', '\n', '\r', '#']) {
        true => format!("\"{}\"", field.replace('"', "\"\"")),
        false => field.clone(),
    });
    quoted.collect::<Vec<_>>().join(",") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_one_line_of_csv() {
        let row = SweepRow {
            values: vec![1e-3, -0.0],
            cells: vec![
                Some(MeasureValue::Number(0.1)),
                None,
                Some(MeasureValue::Name("A5".into())),
                Some(MeasureValue::Empty),
            ],
            error: Some("chatter"),
            notes: vec!["a \"b\"\nc".into(), "d, e".into()],
        };
        assert_eq!(row.line(), "0.001,0,0.1,,A5,,chatter,\"a \"\"b\"\" c; d, e\"\n");
    }

    #[test]
    fn error_and_note_are_detected_in_a_line() {
        for error in [None, Some("chatter")] {
            for note in ["", "slow", "a, \"b\",,"] {
                let notes = if note.is_empty() { vec![] } else { vec![note.to_owned()] };
                let row = SweepRow {
                    values: vec![1.0],
                    cells: vec![None, Some(MeasureValue::Number(0.1))],
                    error,
                    notes,
                };
                let detected = error_and_note(row.line().as_bytes());
                assert_eq!(detected, [error.is_some(), !note.is_empty()], "{}", row.line());
            }
        }
    }
}
