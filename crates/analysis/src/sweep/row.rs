//! The row of a run: values of the parameters, what was measured, and what went wrong.

use crate::instruments::Cell;
use patchcord_core::trace::number;

/// What a run gave.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Row {
    /// Values of the parameters that are varied, in their declared units.
    pub values: Vec<f64>,
    /// What was measured, a cell a column; nothing where it could not be, for which a note tells the reason.
    pub cells: Vec<Option<Cell>>,
    /// The code of the error, where the run failed.
    pub error: Option<&'static str>,
    /// Why the run failed or cells are empty, and what else to know of it.
    pub notes: Vec<String>,
}

impl Row {
    /// The row as a line of CSV.
    pub fn line(&self) -> String {
        let cells = self.cells.iter().map(|cell| match cell {
            Some(Cell::Number(value)) => number(*value),
            Some(Cell::Name(name)) => name.clone(),
            Some(Cell::Empty) | None => String::new(),
        });
        // A row is a line: how far a file is whole is told by its line ends.
        let notes = self.notes.join("; ").replace(char::is_control, " ");
        let fields: Vec<_> = cells.chain([self.error.unwrap_or_default().to_owned(), notes]).collect();
        beginning(&self.values) + &csv_line(&fields)
    }
}

/// Whether a line of the table tells an error, and whether it has a note.
pub(super) fn error_and_note(line: &[u8]) -> [bool; 2] {
    // Most rows end with two empty fields; a field that holds commas ends with a quote.
    if line.ends_with(b",,\n") {
        return [false; 2];
    }
    let mut record = csv::ByteRecord::new();
    let read = csv::ReaderBuilder::new().has_headers(false).from_reader(line).read_byte_record(&mut record);
    let fields = if read.is_ok() { record.len() } else { 0 };
    [2, 1].map(|behind| fields >= behind && !record[fields - behind].is_empty())
}

/// What the row with these values begins with.
pub(super) fn beginning(values: &[f64]) -> String {
    values.iter().map(|value| format!("{},", number(*value))).collect()
}

/// A line of CSV, quoted where that is needed.
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
    fn a_row_is_one_line_whatever_is_in_it() {
        let row = Row {
            values: vec![1e-3, -0.0],
            cells: vec![Some(Cell::Number(0.1)), None, Some(Cell::Name("A5".into())), Some(Cell::Empty)],
            error: Some("chatter"),
            notes: vec!["a \"b\"\nc".into(), "d, e".into()],
        };
        assert_eq!(row.line(), "0.001,0,0.1,,A5,,chatter,\"a \"\"b\"\" c; d, e\"\n");
    }

    #[test]
    fn a_line_tells_whether_its_run_failed_and_has_a_note() {
        for error in [None, Some("chatter")] {
            for note in ["", "quiet", "a, \"b\",,"] {
                let notes = if note.is_empty() { vec![] } else { vec![note.to_owned()] };
                let row = Row { values: vec![1.0], cells: vec![None, Some(Cell::Number(0.1))], error, notes };
                let told = error_and_note(row.line().as_bytes());
                assert_eq!(told, [error.is_some(), !note.is_empty()], "{}", row.line());
            }
        }
    }
}
