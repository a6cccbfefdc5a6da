//! The columns of a data file, for a user who selects among them before there is an experiment.

use std::path::Path;

use crate::data::codes;
use crate::data::measured_file::too_few_rows;
use crate::statistics::descriptive::extremes;
use patchcord_core::document::csv_table::{self, ColumnSelector, CsvFault, CsvTable, UnitComment};
use patchcord_core::document::{Diagnostic, Report};

/// A column of a data file.
#[derive(Debug, Clone, PartialEq)]
pub struct DataColumn {
    /// The name as the file has it, such as "t (ms)". An experiment can name the column so.
    pub name: String,
    /// The unit from a comment line or from the name. It is the text of the file if that is not a unit. None if the
    /// file does not give a unit.
    pub unit: Option<String>,
    /// The least number of the column. NaN if it has no numbers: then it cannot be used in an experiment.
    pub least: f64,
    /// The largest number of the column. NaN if it has no numbers.
    pub most: f64,
    /// Whether every row has a number that is larger than the one before. Only such a column can contain the times.
    pub is_rising: bool,
}

/// Returns the columns of a data file, in the order of the file. `name` is the name of the file in reports.
///
/// Columns with words or empty cells are listed too. An experiment that uses one reports the first such cell.
///
/// # Errors
/// If the text is not a table, if it has fewer than two rows, or if no column has a number. The report has the
/// diagnostics that an experiment with this file would have.
///
/// # Examples
///
/// ```
/// use patchcord_ident::data_columns;
///
/// let text = "# x: mm\nt (ms),x,state\n0,5,begin\n10,3,\n20,4,end\n";
/// let columns = data_columns("measured.csv", text).map_err(|report| report.to_string())?;
/// let [time, position, state] = columns.as_slice() else { return Err("three columns".to_owned()) };
/// assert_eq!((time.name.as_str(), time.unit.as_deref(), time.is_rising), ("t (ms)", Some("ms"), true));
/// assert_eq!((position.unit.as_deref(), position.least, position.most), (Some("mm"), 3.0, 5.0));
/// assert!(state.least.is_nan() && !position.is_rising);
/// # Ok::<(), String>(())
/// ```
pub fn data_columns(name: &str, text: &str) -> Result<Vec<DataColumn>, Report> {
    let report = |findings| Report::new(name, text, findings);
    let bad_data = |faults: Vec<CsvFault>| {
        let finding =
            |fault: CsvFault| Diagnostic::without_span(codes::BAD_DATA, fault.message).hint(fault.hint);
        report(faults.into_iter().map(finding).collect())
    };
    let table = csv_table::parse_all(name, text).map_err(bad_data)?;
    if let Some(message) = too_few_rows(Path::new(name), &table) {
        return Err(report(vec![Diagnostic::without_span(codes::TOO_FEW_SAMPLES, message)]));
    }
    if table.columns.iter().flatten().all(|number| number.is_nan()) {
        // The strict reader says why the first cells are not numbers, for example because of decimal commas.
        csv_table::parse(name, text, &[ColumnSelector::First]).map_err(bad_data)?;
    }
    Ok(columns_of(table))
}

/// Describes the columns of a table.
fn columns_of(table: CsvTable) -> Vec<DataColumn> {
    let columns = table.names.into_iter().zip(table.units).zip(table.columns);
    columns.map(|((name, unit), numbers)| column(name, unit.as_ref(), &numbers)).collect()
}

/// Describes one column.
fn column(name: String, unit: Option<&UnitComment>, numbers: &[f64]) -> DataColumn {
    let has_numbers = numbers.iter().any(|number| !number.is_nan());
    let [least, most] = if has_numbers { extremes(numbers.iter().copied()) } else { [f64::NAN; 2] };
    let is_rising = numbers.windows(2).all(|pair| pair[0] < pair[1]);
    DataColumn { name, unit: unit.map(unit_text), least, most, is_rising }
}

/// The text of a unit: its usual form, or the text of the file if that is not a unit.
fn unit_text(comment: &UnitComment) -> String {
    comment.unit().map_or_else(|| comment.text.clone(), |unit| unit.text().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The columns of a text: name, unit, least and largest number, and whether they rise.
    fn columns(text: &str) -> Vec<(String, Option<String>, [f64; 2], bool)> {
        let columns = data_columns("a.csv", text).unwrap_or_else(|report| panic!("{report}"));
        let fields =
            |column: DataColumn| (column.name, column.unit, [column.least, column.most], column.is_rising);
        columns.into_iter().map(fields).collect()
    }

    /// The code, the message and the advice of the only diagnostic of a text.
    fn fault(text: &str) -> (&'static str, String, String) {
        let report = data_columns("a.csv", text).unwrap_err();
        assert_eq!((report.file.as_str(), report.findings.len()), ("a.csv", 1), "{report}");
        let finding = &report.findings[0];
        (finding.code.as_str(), finding.message.clone(), finding.advice().to_owned())
    }

    #[test]
    fn names_and_units_are_those_of_the_file() {
        let text = "# delay: msec\n# v: filtered\nTime [s],delay,x (m),v\n-1,2,3,4\n0,-2,3,4\n";
        let owned = |text: &str| Some(text.to_owned());
        assert_eq!(
            columns(text),
            [
                ("Time [s]".to_owned(), owned("s"), [-1.0, 0.0], true),
                ("delay".to_owned(), owned("ms"), [-2.0, 2.0], false),
                ("x (m)".to_owned(), owned("m"), [3.0, 3.0], false),
                ("v".to_owned(), owned("filtered"), [4.0, 4.0], false),
            ]
        );
    }

    #[test]
    fn an_empty_cell_leaves_the_other_numbers_of_its_column() {
        let columns = columns("t,x\n0,1\n1,\n2,3\n");
        assert_eq!(columns[1], ("x".to_owned(), None, [1.0, 3.0], false));
    }

    #[test]
    fn a_text_without_numbers_is_not_a_data_file() {
        let (code, message, advice) = fault("t,x\n\"0,0\",\"0,1\"\n\"0,5\",\"0,2\"\n");
        assert_eq!((code, advice.as_str()), ("bad-data", "write 0.5, not 0,5"), "{message}");
        let (code, message, _) = fault("t;x\n0;1\n1;2\n");
        assert_eq!((code, message.as_str()), ("bad-data", "line 1 of a.csv separates its columns by \";\""));
        let (code, message, _) = fault("t,x\n0,1\n");
        assert_eq!((code, message.as_str()), ("too-few-samples", "a.csv has 1 row of data, but needs 2"));
    }
}
