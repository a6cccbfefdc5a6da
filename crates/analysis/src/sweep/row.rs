//! One row of a sweep file: parameter values, measured values, error code and notes, as a line of CSV.
//!
//! [`SweepRow`] makes the line of a run. [`RowFormat`] checks the lines that a file has already.

use std::collections::HashSet;

use crate::instruments::{ColumnContent, Measure, MeasureValue};
use patchcord_core::document::plural;
use patchcord_core::ir::Program;
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

/// The columns of a sweep file, for the check of its rows.
#[derive(Debug)]
pub(super) struct RowFormat<'s> {
    /// The names of all columns: varied parameters, measures, "error" and "note".
    names: Vec<String>,
    /// What the columns of the measures may contain.
    contents: Vec<ColumnContent>,
    /// The names that a cell may contain.
    elements: HashSet<&'s str>,
}

/// The longest text of a cell in an error message, in characters.
const MAX_SHOWN: usize = 30;

impl<'s> RowFormat<'s> {
    /// The format of a sweep. `names` are those of all columns.
    pub(super) fn new(names: Vec<String>, measures: &[Measure], program: &'s Program) -> Self {
        let elements = program.element_outputs().iter().map(|output| output.name.as_str());
        RowFormat {
            names,
            contents: measures.iter().flat_map(Measure::contents).collect(),
            elements: elements.chain(["none"]).collect(),
        }
    }

    /// Checks a complete row. Returns whether it has an error code, and whether it has a note.
    ///
    /// The values of the varied parameters are not checked, because the caller compares them with the plan.
    ///
    /// # Errors
    /// Why the line is no row of this sweep.
    pub(super) fn check(&self, line: &[u8]) -> Result<[bool; 2], String> {
        let fields = fields(line)?;
        if fields.len() != self.names.len() {
            let found = plural(fields.len() as u64, "field");
            return Err(format!("it has {found}, expected {}", self.names.len()));
        }
        let last = fields.len() - 2;
        let found = [last, last + 1].map(|column| !fields[column].is_empty());
        let measured = last - self.contents.len()..last;
        let faults = measured.zip(&self.contents).map(|(column, content)| {
            let fault = self.fault_of_cell(&fields[column], *content, found)?;
            Some((column, fault))
        });
        let of_error = (!is_code(&fields[last])).then_some((last, "is no error code"));
        let has_control = fields[last + 1].contains(char::is_control);
        let of_note = has_control.then_some((last + 1, "has a control character"));
        match faults.chain([of_error, of_note]).flatten().next() {
            None => Ok(found),
            Some((column, fault)) => {
                let shown: String = fields[column].chars().take(MAX_SHOWN).collect();
                Err(format!("in the column {}, {shown:?} {fault}", self.names[column]))
            }
        }
    }

    /// What is wrong with the cell of a measure in a row with or without an error code and a note. None if it is right.
    fn fault_of_cell(
        &self,
        cell: &str,
        content: ColumnContent,
        [has_error, has_note]: [bool; 2],
    ) -> Option<&'static str> {
        if cell.is_empty() {
            let needs_reason = has_error || content != ColumnContent::OptionalNumber;
            return (needs_reason && !has_note).then_some("has no reason in the note");
        }
        if has_error {
            return Some("is a value of a run that failed");
        }
        match content {
            ColumnContent::Name => (!self.elements.contains(cell)).then_some("is no element"),
            _ => (!is_number(cell)).then_some("is not a finite number as a sweep writes it"),
        }
    }
}

/// The fields of a line.
///
/// # Errors
/// Why a sweep did not write the line.
fn fields(line: &[u8]) -> Result<Vec<String>, String> {
    let mut record = csv::StringRecord::new();
    let read = csv::ReaderBuilder::new().has_headers(false).from_reader(line).read_record(&mut record);
    read.map_err(|_| "it is not UTF-8 text".to_owned())?;
    let fields: Vec<String> = record.iter().map(str::to_owned).collect();
    if csv_line(&fields).as_bytes() == line {
        Ok(fields)
    } else {
        Err("its quotes or its line end are not those of a sweep".to_owned())
    }
}

/// Whether a text is a finite number in the form in which a sweep writes it.
fn is_number(text: &str) -> bool {
    text.parse().is_ok_and(|value: f64| value.is_finite() && format_exact(value) == text)
}

/// Whether a text has the form of an error code, or is empty.
fn is_code(text: &str) -> bool {
    text.bytes().all(|letter| letter.is_ascii_lowercase() || letter == b'-')
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

    /// The columns k, x (a number), a (a name), a_time (a number next to a name), error and note.
    fn format() -> RowFormat<'static> {
        let contents = vec![ColumnContent::Number, ColumnContent::Name, ColumnContent::OptionalNumber];
        let names = ["k", "x", "a", "a_time", "error", "note"].map(str::to_owned).to_vec();
        RowFormat { names, contents, elements: ["A5", "none"].into() }
    }

    #[test]
    fn rows_of_runs_are_valid() {
        let number = |value: f64| Some(MeasureValue::Number(value));
        let name = |name: &str| Some(MeasureValue::Name(name.to_owned()));
        let cases = [
            (vec![number(0.1), name("none"), Some(MeasureValue::Empty)], None, ""),
            (vec![number(-1e-300), name("A5"), number(0.5)], None, "overload of A5"),
            (vec![None, name("none"), Some(MeasureValue::Empty)], None, "x: no \"cycle\", none,,"),
            (vec![None, None, None], Some("chatter"), "too fast"),
        ];
        for (cells, error, note) in cases {
            let notes = if note.is_empty() { vec![] } else { vec![note.to_owned()] };
            let row = SweepRow { values: vec![1.0], cells, error, notes };
            let detected = format().check(row.line().as_bytes());
            assert_eq!(detected, Ok([error.is_some(), !note.is_empty()]), "{}", row.line());
        }
    }

    #[test]
    fn changed_rows_are_detected() {
        let cases: [(&[u8], &str); 13] = [
            (b"1,2\n", "it has 2 fields, expected 6"),
            (b"1,2,none,,,,\n", "it has 7 fields, expected 6"),
            (b"1,garbage\0,none,,,\n", "in the column x, \"garbage\\0\" is not a finite number as a sweep"),
            (b"1,inf,none,,,\n", "in the column x, \"inf\" is not a finite number"),
            (b"1,0.10,none,,,\n", "in the column x, \"0.10\" is not a finite number as a sweep writes it"),
            (b"1,,none,,,\n", "in the column x, \"\" has no reason in the note"),
            (b"1,2,A6,3,,\n", "in the column a, \"A6\" is no element"),
            (b"1,2,none,,chatter,too fast\n", "in the column x, \"2\" is a value of a run that failed"),
            (b"1,2,none,,Not a code,x\n", "in the column x, \"2\" is a value"),
            (b"1,,,,Not a code,x\n", "in the column error, \"Not a code\" is no error code"),
            (b"1,2,none,,,a\tb\n", "in the column note, \"a\\tb\" has a control character"),
            (b"1,2,none,,,\r\n", "its quotes or its line end are not those of a sweep"),
            (b"1,2,none,,,\xe9\n", "it is not UTF-8 text"),
        ];
        for (line, expected) in cases {
            let error = format().check(line).unwrap_err();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
