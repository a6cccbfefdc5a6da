//! Reads selected columns of a CSV file, line by line.
//!
//! A table is a line of column names, and then a line of numbers for every row. Blank lines and comment lines, which
//! start with `#`, are skipped. Comment lines `# name: unit` in front of the names, or names such as `t (ms)`, give the
//! units of columns. The reader collects up to ten faults, each with its line. `reader` reads the lines, and
//! `column_name` splits the names.

mod column_name;
mod reader;

use std::io::{BufRead as _, BufReader, ErrorKind, Read};
use std::path::Path;

use super::input_file::{InputFile, LimitedReader};
use crate::output::io_reason;
use patchcord_expr::{Unit, UnitLabel};
use reader::{MAX_LINE_BYTES, Reader};

pub use column_name::{split_unit, unclear_time, unclear_value, without_unit};

/// Size of the largest file that is read, in bytes.
const MAX_FILE_BYTES: u64 = 100_000_000;
/// Number of faults after which the reader stops. Further faults usually have the same cause.
const MAX_FAULTS: usize = 10;

/// A fault of a CSV file.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::csv_table::{self, ColumnSelector};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let file = tempfile::NamedTempFile::new()?;
/// std::fs::write(&file, "t;x\n0;1\n")?;
/// let faults = csv_table::read(&file, &[ColumnSelector::First]).unwrap_err();
/// assert!(faults[0].message.ends_with("separates its columns by \";\""));
/// assert_eq!(faults[0].column, None);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, PartialEq)]
pub struct CsvFault {
    /// What is wrong, with the line and the file.
    pub message: String,
    /// What to do about it.
    pub hint: String,
    /// Index of the selector to which the fault belongs. `None` if it belongs to the whole file or to a line.
    pub column: Option<usize>,
}

impl CsvFault {
    /// A fault that does not belong to a selector.
    pub fn new(message: impl Into<String>, hint: impl Into<String>) -> Self {
        CsvFault { message: message.into(), hint: hint.into(), column: None }
    }
}

/// The unit of a column from a comment line `# name: unit`, or from the column's name.
#[derive(Debug, Clone, PartialEq)]
pub struct UnitComment {
    /// Text of the unit as the file has it. In a comment it may not be a valid unit.
    pub text: String,
    /// Line of the comment or of the names in the file, from 1.
    pub line: usize,
}

impl UnitComment {
    /// The unit; `None` if the text is not a unit. An empty text is none.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::document::csv_table::UnitComment;
    /// use patchcord_expr::Unit;
    ///
    /// let comment = UnitComment { text: "msec".to_owned(), line: 1 };
    /// assert_eq!(comment.unit(), Some(Unit::parse("ms")?));
    /// # Ok::<(), patchcord_expr::UnitError>(())
    /// ```
    pub fn unit(&self) -> Option<Unit> {
        match UnitLabel::read(&self.text) {
            UnitLabel::Unit(unit) if !self.text.trim().is_empty() => Some(unit),
            _ => None,
        }
    }
}

/// Selects a column of a file.
#[derive(Debug, Clone, Copy)]
pub enum ColumnSelector<'a> {
    /// The column with this name. If there is none, the column with this name and a unit: "t" selects "t (ms)".
    Named(&'a str),
    /// The first column.
    First,
    /// The column to the right of the column that the preceding selector selects.
    Next,
}

/// The selected columns of a file.
#[derive(Debug, Default)]
pub struct CsvTable {
    /// The numbers of each selected column, in the order of the rows.
    pub columns: Vec<Vec<f64>>,
    /// Line of each row in the file, from 1.
    pub lines: Vec<usize>,
    /// Names of the selected columns.
    pub names: Vec<String>,
    /// Names of all columns of the file.
    pub all_names: Vec<String>,
    /// Line of the names in the file, from 1.
    pub names_line: usize,
    /// Units of the selected columns. `None` if neither a comment line nor the name gives the unit.
    pub units: Vec<Option<UnitComment>>,
}

/// Reads the selected columns of a file, in the order of the selectors. Columns may be selected more than once.
///
/// # Errors
/// The faults of the file, at most ten. If the names or the first row are wrong, the reader stops there.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::csv_table::{self, ColumnSelector};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let file = tempfile::NamedTempFile::new()?;
/// std::fs::write(&file, "# x: mm\nt,x\n0,1\n1,3\n")?;
/// let selectors = [ColumnSelector::Named("t"), ColumnSelector::Next];
/// let table = csv_table::read(&file, &selectors).map_err(|faults| faults[0].message.clone())?;
/// assert_eq!(table.columns, [[0.0, 1.0], [1.0, 3.0]]);
/// assert_eq!(table.lines, [3, 4]);
/// assert_eq!(table.units[1].as_ref().map(|unit| unit.text.as_str()), Some("mm"));
/// # Ok(())
/// # }
/// ```
pub fn read(path: impl AsRef<Path>, selectors: &[ColumnSelector<'_>]) -> Result<CsvTable, Vec<CsvFault>> {
    read_until(path.as_ref(), selectors, Reader::is_stopped)
}

/// Reads the selected columns of a text as [`read`] reads those of a file. `name` is the name of the text in messages.
///
/// # Errors
/// As for [`read`].
///
/// # Examples
///
/// ```
/// use patchcord_core::document::csv_table::{self, ColumnSelector};
///
/// let text = "t (s),x (mm)\n0,1\n1,3\n";
/// let table = csv_table::parse("measured.csv", text, &[ColumnSelector::Named("x")]);
/// let table = table.map_err(|faults| faults[0].message.clone())?;
/// assert_eq!(table.columns, [[1.0, 3.0]]);
/// # Ok::<(), String>(())
/// ```
pub fn parse(
    name: impl AsRef<Path>,
    text: &str,
    selectors: &[ColumnSelector<'_>],
) -> Result<CsvTable, Vec<CsvFault>> {
    let name = name.as_ref();
    read_lines(limited(text), Reader::new(name, selectors), Reader::is_stopped)
}

/// Reads all columns of a text. A field that is not a finite number becomes NaN, so columns may contain words.
///
/// # Errors
/// The faults of the text, at most ten, except fields that are not numbers.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::csv_table;
///
/// let table = csv_table::parse_all("measured.csv", "t,state\n0,on\n1,off\n");
/// let table = table.map_err(|faults| faults[0].message.clone())?;
/// assert_eq!((table.names, &table.columns[0]), (vec!["t".to_owned(), "state".to_owned()], &vec![0.0, 1.0]));
/// assert!(table.columns[1].iter().all(|number| number.is_nan()));
/// # Ok::<(), String>(())
/// ```
pub fn parse_all(name: impl AsRef<Path>, text: &str) -> Result<CsvTable, Vec<CsvFault>> {
    let name = name.as_ref();
    let names = read_lines(limited(text), Reader::new(name, &[]), has_names_or_stops)?.all_names;
    let mut selectors = vec![ColumnSelector::Next; names.len()];
    selectors.iter_mut().take(1).for_each(|first| *first = ColumnSelector::First);
    read_lines(limited(text), Reader::new(name, &selectors).with_words(), Reader::is_stopped)
}

/// A reader of a text. Reading fails after the bytes that a file may have.
fn limited(text: &str) -> LimitedReader<&[u8]> {
    LimitedReader::new(text.as_bytes(), MAX_FILE_BYTES)
}

/// The names of all columns of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnNames {
    /// The names, in the order of the columns.
    pub names: Vec<String>,
    /// Line of the names in the file, from 1.
    pub line: usize,
}

/// Reads the names of all columns of a file, and nothing after them.
///
/// # Errors
/// The faults of the file up to the line of names, at most ten.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::csv_table;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let file = tempfile::NamedTempFile::new()?;
/// std::fs::write(&file, "# measured\nt,x\n0,1\n")?;
/// let columns = csv_table::read_names(&file).map_err(|faults| faults[0].message.clone())?;
/// assert_eq!((columns.names, columns.line), (vec!["t".to_owned(), "x".to_owned()], 2));
/// # Ok(())
/// # }
/// ```
pub fn read_names(path: impl AsRef<Path>) -> Result<ColumnNames, Vec<CsvFault>> {
    let table = read_until(path.as_ref(), &[], has_names_or_stops)?;
    Ok(ColumnNames { names: table.all_names, line: table.names_line })
}

/// Whether a reader needs no more lines to know the names.
fn has_names_or_stops(reader: &Reader<'_>) -> bool {
    reader.has_names() || reader.is_stopped()
}

/// Reads the lines of a file until the reader meets a condition.
///
/// # Errors
/// The faults of the file, at most ten.
fn read_until<'a>(
    path: &'a Path,
    selectors: &'a [ColumnSelector<'a>],
    is_done: impl Fn(&Reader<'a>) -> bool,
) -> Result<CsvTable, Vec<CsvFault>> {
    let file = InputFile::open(path, MAX_FILE_BYTES).map_err(|error| vec![unreadable(path, &error)])?;
    read_lines(file, Reader::new(path, selectors), is_done)
}

/// Passes lines to a reader until it meets a condition.
///
/// # Errors
/// The faults of the file or text, at most ten.
fn read_lines<'a>(
    bytes: impl Read,
    mut reader: Reader<'a>,
    is_done: impl Fn(&Reader<'a>) -> bool,
) -> Result<CsvTable, Vec<CsvFault>> {
    let mut lines = BufReader::new(bytes);
    let mut line = Vec::new();
    while !is_done(&reader) {
        line.clear();
        // One byte above the limit is enough for the reader to report the line.
        let mut bounded = lines.by_ref().take(MAX_LINE_BYTES as u64 + 1);
        match bounded.read_until(b'\n', &mut line).map_err(|error| vec![unreadable(reader.path(), &error)])? {
            0 => break,
            _ => reader.line(&line),
        }
    }
    reader.finish()
}

/// The fault for an error of the file system.
fn unreadable(path: &Path, error: &std::io::Error) -> CsvFault {
    if error.kind() == ErrorKind::NotFound {
        let hint = "paths are relative to the folder of the document that names the file";
        return CsvFault::new(format!("there is no file {}", path.display()), hint);
    }
    let hint = match error.kind() {
        ErrorKind::FileTooLarge => "use fewer columns or rows",
        ErrorKind::IsADirectory | ErrorKind::InvalidInput => "name a CSV file",
        _ => "check the file's permissions",
    };
    CsvFault::new(format!("cannot read {}: {}", path.display(), io_reason(error)), hint)
}

/// Number of characters of a field that a message shows at most. It limits how much of a wrong file is shown.
const MAX_EXCERPT_CHARACTERS: usize = 30;

/// The beginning of a field for a message, with "..." if the field is longer than 30 characters.
pub(crate) fn excerpt(field: &str) -> String {
    let shown: String = field.chars().take(MAX_EXCERPT_CHARACTERS).collect();
    if shown.len() < field.len() { format!("{shown}...") } else { shown }
}

#[cfg(test)]
mod tests;
