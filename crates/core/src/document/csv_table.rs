//! Reads selected columns of a CSV file, line by line.
//!
//! A table is a line of column names, and then a line of numbers for every row. Blank lines and comment lines, which
//! start with `#`, are skipped. Comment lines `# name: unit` in front of the names give the units of columns. The
//! reader collects up to ten faults, each with its line.

use std::fs::File;
use std::io::{BufRead as _, BufReader, ErrorKind};
use std::path::Path;
use std::rc::Rc;

use super::wording::suggestion;
use crate::output::io_reason;

/// Size of the largest file that is read, in bytes.
const MAX_FILE_BYTES: u64 = 100_000_000;
/// Number of rows of a table at most. Every row ends a step, so a longer table would make a run of hours.
const MAX_ROWS: usize = 2_000_000;
/// Number of faults after which the reader stops. Further faults usually have the same cause.
const MAX_FAULTS: usize = 10;

/// The hint for a file that does not contain text.
const NOT_TEXT_HINT: &str = "name a CSV file, saved with the encoding UTF-8";

/// A fault of a CSV file.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::csv_table::{self, ColumnSelector};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let file = tempfile::NamedTempFile::new()?;
/// std::fs::write(file.path(), "t;x\n0;1\n")?;
/// let faults = csv_table::read(file.path(), &[ColumnSelector::First]).unwrap_err();
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

/// The unit of a column from a comment line `# name: unit`.
#[derive(Debug, Clone, PartialEq)]
pub struct UnitComment {
    /// Text of the unit. It may not be a valid unit.
    pub text: String,
    /// Line of the comment in the file, from 1.
    pub line: usize,
}

/// Selects a column of a file.
#[derive(Debug, Clone, Copy)]
pub enum ColumnSelector<'a> {
    /// The column with this name.
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
    /// Units of the selected columns. `None` if no comment line gives the unit.
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
/// std::fs::write(file.path(), "# x: mm\nt,x\n0,1\n1,3\n")?;
/// let selectors = [ColumnSelector::Named("t"), ColumnSelector::Next];
/// let table = csv_table::read(file.path(), &selectors).map_err(|faults| faults[0].message.clone())?;
/// assert_eq!(table.columns, [[0.0, 1.0], [1.0, 3.0]]);
/// assert_eq!(table.lines, [3, 4]);
/// assert_eq!(table.units[1].as_ref().map(|unit| unit.text.as_str()), Some("mm"));
/// # Ok(())
/// # }
/// ```
pub fn read(path: &Path, selectors: &[ColumnSelector<'_>]) -> Result<CsvTable, Vec<CsvFault>> {
    let mut lines = BufReader::new(open(path).map_err(|fault| vec![fault])?);
    let mut reader = Reader {
        path,
        selectors,
        line_number: 0,
        unit_comments: Vec::new(),
        columns: None,
        row: Vec::new(),
        table: CsvTable::default(),
        faults: Vec::new(),
    };
    let mut line = Vec::new();
    while !reader.is_stopped() {
        line.clear();
        match lines.read_until(b'\n', &mut line) {
            Ok(0) => break,
            Ok(_) => reader.line(&line),
            Err(error) => return Err(vec![unreadable(path, &error)]),
        }
    }
    reader.finish()
}

/// Opens a file, if it is a regular file of at most 100 MB.
fn open(path: &Path) -> Result<File, CsvFault> {
    let metadata = path.metadata().map_err(|error| unreadable(path, &error))?;
    if !metadata.is_file() {
        return Err(CsvFault::new(format!("{} is not a file", path.display()), "name a CSV file"));
    }
    if metadata.len() > MAX_FILE_BYTES {
        let message = format!("{} has more than {} MB", path.display(), MAX_FILE_BYTES / 1_000_000);
        return Err(CsvFault::new(message, "record fewer columns, or less often"));
    }
    File::open(path).map_err(|error| unreadable(path, &error))
}

/// The fault for an error of the file system.
fn unreadable(path: &Path, error: &std::io::Error) -> CsvFault {
    if error.kind() == ErrorKind::NotFound {
        let hint = "paths are relative to the folder of the document that names the file";
        return CsvFault::new(format!("there is no file {}", path.display()), hint);
    }
    CsvFault::new(
        format!("cannot read {}: {}", path.display(), io_reason(error)),
        "check the file's permissions",
    )
}

/// The state of reading a file.
struct Reader<'a> {
    /// Path of the file, for messages.
    path: &'a Path,
    /// The selectors, in the order in which the table has their columns.
    selectors: &'a [ColumnSelector<'a>],
    /// Number of the current line, from 1.
    line_number: usize,
    /// Names and units from the comment lines.
    unit_comments: Vec<(String, UnitComment)>,
    /// `None` until the line of names was read.
    columns: Option<SelectedColumns>,
    /// The selected numbers of the current line.
    row: Vec<f64>,
    /// The rows so far.
    table: CsvTable,
    /// The faults so far. If there is any, the table is discarded at the end.
    faults: Vec<CsvFault>,
}

/// The number of columns of a file, and which of them are selected.
#[derive(Clone)]
struct SelectedColumns {
    /// Number of columns of the file.
    count: usize,
    /// For each selector, the index of its column.
    indices: Rc<[usize]>,
}

impl Reader<'_> {
    /// Whether the rest of the file is not read. A file whose first row is wrong may not be a table at all.
    fn is_stopped(&self) -> bool {
        let is_table = self.columns.is_some() && !self.table.lines.is_empty();
        self.faults.len() >= MAX_FAULTS || (!is_table && !self.faults.is_empty())
    }

    /// Reads one line: a comment, the names, or a row. A byte order mark at the start of the file is skipped.
    fn line(&mut self, bytes: &[u8]) {
        self.line_number += 1;
        let Ok(text) = std::str::from_utf8(bytes) else {
            return self.fault("is not UTF-8 text", NOT_TEXT_HINT);
        };
        let text = text.trim_end_matches(['\r', '\n']);
        let text = if self.line_number == 1 { text.strip_prefix('\u{feff}').unwrap_or(text) } else { text };
        if text.contains('\r') {
            return self.fault(
                "contains a carriage return",
                "end lines with a line feed, with or without a carriage return before it",
            );
        }
        if text.contains(is_control_character) {
            return self.fault("contains control characters", NOT_TEXT_HINT);
        }
        if let Some(comment) = text.strip_prefix('#') {
            let unit_comment =
                |unit: &str| UnitComment { text: unit.trim().to_owned(), line: self.line_number };
            self.unit_comments.extend(
                comment.split_once(':').map(|(name, unit)| (name.trim().to_owned(), unit_comment(unit))),
            );
        } else if !text.trim().is_empty() {
            let fields = fields(text);
            match self.columns.clone() {
                None => self.names(&fields),
                Some(columns) => self.row(&columns, &fields),
            }
        }
    }

    /// Adds a fault of the current line. `what` is a predicate, such as "is empty".
    fn fault(&mut self, what: &str, hint: &str) {
        let message = format!("line {} of {} {what}", self.line_number, self.path.display());
        self.faults.push(CsvFault::new(message, hint));
    }

    /// Reads the line of names and finds the selected columns.
    fn names(&mut self, fields: &[String]) {
        if let Some(separator) = [';', '\t'].into_iter().find(|separator| fields[0].contains(*separator)) {
            let quoted = if separator == '\t' { "tabs".to_owned() } else { format!("\"{separator}\"") };
            let what = format!("separates its columns by {quoted}");
            return self
                .fault(&what, "separate the columns by commas, and write decimal points in the numbers");
        }
        if fields.iter().any(|field| field.parse::<f64>().is_ok()) {
            return self
                .fault("has numbers instead of column names", "begin with a line of names, such as t,x");
        }
        let mut indices: Vec<Option<usize>> = Vec::new();
        for (selector_index, selector) in self.selectors.iter().enumerate() {
            let before = indices.last().copied().flatten();
            indices.push(self.column(fields, selector_index, *selector, before));
        }
        let Some(indices) = indices.into_iter().collect::<Option<Rc<[usize]>>>() else { return };
        self.table.columns = vec![Vec::new(); indices.len()];
        self.table.names = indices.iter().map(|index| fields[*index].clone()).collect();
        self.table.all_names = fields.to_vec();
        // If a column has several units, the last one counts.
        let unit = |name: &String| {
            self.unit_comments.iter().rev().find(|(column, _)| column == name).map(|(_, unit)| unit.clone())
        };
        self.table.units = self.table.names.iter().map(unit).collect();
        self.columns = Some(SelectedColumns { count: fields.len(), indices });
    }

    /// The index of the column that a selector selects. `before` is the index for the preceding selector.
    fn column(
        &mut self,
        fields: &[String],
        selector_index: usize,
        selector: ColumnSelector<'_>,
        before: Option<usize>,
    ) -> Option<usize> {
        match selector {
            ColumnSelector::Named(name) => self.named_column(fields, selector_index, name),
            ColumnSelector::First => Some(0),
            ColumnSelector::Next => {
                // If the preceding column is missing, that has been reported.
                let next = before? + 1;
                if next == fields.len() {
                    self.fault("has no column to the right of the x column", "a table needs two columns");
                }
                Some(next).filter(|next| *next < fields.len())
            }
        }
    }

    /// The index of the column with a name. Reports a name that no column or more than one column has.
    fn named_column(&mut self, fields: &[String], selector_index: usize, name: &str) -> Option<usize> {
        let mut matches =
            fields.iter().enumerate().filter(|(_, field)| *field == name).map(|(index, _)| index);
        let (first, second) = (matches.next(), matches.next());
        let (what, hint) = match first {
            Some(_) if second.is_none() => return first,
            Some(_) => ("has more than one column", "give every column a different name".to_owned()),
            None => ("has no column", column_hint(name, fields)),
        };
        let message = format!("line {} of {} {what} \"{name}\"", self.line_number, self.path.display());
        self.faults.push(CsvFault { column: Some(selector_index), ..CsvFault::new(message, hint) });
        None
    }

    /// Reads a row. The fields of columns that are not selected may contain anything.
    fn row(&mut self, columns: &SelectedColumns, fields: &[String]) {
        if fields.len() != columns.count {
            let noun = if fields.len() == 1 { "field" } else { "fields" };
            let what = format!("has {} {noun}, but the line of names has {}", fields.len(), columns.count);
            let hint = match fields.len() > columns.count {
                true => "write decimal points, not commas, in the numbers, and one field for every name",
                false => "write one field for every name; the line may have been cut off",
            };
            return self.fault(&what, hint);
        }
        self.row.clear();
        for (selector_index, column) in columns.indices.iter().enumerate() {
            match fields[*column].parse::<f64>().ok().filter(|number| number.is_finite()) {
                Some(number) => self.row.push(number),
                None => return self.not_a_number(selector_index, &fields[*column]),
            }
        }
        if self.table.lines.len() == MAX_ROWS {
            self.columns = None;
            return self
                .fault(&format!("exceeds the limit of {MAX_ROWS} rows for a table"), "record less often");
        }
        for (column, number) in self.table.columns.iter_mut().zip(&self.row) {
            column.push(*number);
        }
        self.table.lines.push(self.line_number);
    }

    /// Reports a field that is not a finite number.
    fn not_a_number(&mut self, selector_index: usize, field: &str) {
        let hint = if field.contains(',') {
            "write 0.5, not 0,5"
        } else {
            "every row needs a finite number in each column that is read"
        };
        // The document contains the names of named columns. Names from the file are not shown: it may be another file.
        let column = match self.selectors[selector_index] {
            ColumnSelector::Named(name) => format!(", in the column {name}"),
            ColumnSelector::First | ColumnSelector::Next => String::new(),
        };
        self.fault(&format!("has \"{}\" instead of a number{column}", excerpt(field)), hint);
    }

    /// The table, or the faults if there are any.
    fn finish(mut self) -> Result<CsvTable, Vec<CsvFault>> {
        if self.columns.is_none() && self.faults.is_empty() {
            let message = format!("{} is empty", self.path.display());
            self.faults.push(CsvFault::new(
                message,
                "a table is a line of names, and a line of numbers for every point",
            ));
        }
        if self.faults.is_empty() { Ok(self.table) } else { Err(self.faults) }
    }
}

/// The hint for a name that no column has: similar names, or the names of the file.
///
/// A file whose fields do not look like names may not be a table, and may be confidential. Its fields are not shown.
fn column_hint(name: &str, fields: &[String]) -> String {
    let is_name = |field: &&str| {
        let is_unusual = |letter: char| !(letter.is_alphanumeric() || " _.-()[]/%^*°²".contains(letter));
        field.len() <= MAX_EXCERPT_CHARACTERS && !field.contains(is_unusual)
    };
    let known: Vec<_> = fields.iter().map(String::as_str).collect();
    let hint = known.iter().all(is_name).then(|| suggestion(name, &known)).flatten();
    hint.unwrap_or_else(|| "a table begins with a line of names, such as t,x".to_owned())
}

/// Number of characters of a field that a message shows at most. It limits how much of a wrong file is shown.
const MAX_EXCERPT_CHARACTERS: usize = 30;

/// The beginning of a field for a message, with "..." if the field is longer than 30 characters.
pub(crate) fn excerpt(field: &str) -> String {
    let shown: String = field.chars().take(MAX_EXCERPT_CHARACTERS).collect();
    if shown.len() < field.len() { format!("{shown}...") } else { shown }
}

/// Whether a character cannot be part of a text file. Tabs can.
fn is_control_character(letter: char) -> bool {
    letter.is_control() && letter != '\t'
}

/// The fields of a line, without quotes and surrounding blanks. There is at least one field.
fn fields(text: &str) -> Vec<String> {
    if !text.contains('"') {
        return text.split(',').map(|field| field.trim().to_owned()).collect();
    }
    let mut builder = csv::ReaderBuilder::new();
    builder.has_headers(false).flexible(true).trim(csv::Trim::All).buffer_capacity(text.len().max(1));
    let record = builder.from_reader(text.as_bytes()).into_records().next();
    let fields: Vec<String> = match record {
        Some(Ok(record)) => record.iter().map(str::to_owned).collect(),
        _ => Vec::new(),
    };
    if fields.is_empty() { vec![String::new()] } else { fields }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Selects the first two columns.
    const FIRST_TWO: [ColumnSelector<'_>; 2] = [ColumnSelector::First, ColumnSelector::Next];

    fn table(text: &str, selectors: &[ColumnSelector<'_>]) -> Result<CsvTable, Vec<CsvFault>> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        read(file.path(), selectors)
    }

    fn columns(text: &str, selectors: &[ColumnSelector<'_>]) -> Vec<Vec<f64>> {
        table(text, selectors).unwrap_or_else(|faults| panic!("{faults:?}")).columns
    }

    #[test]
    fn columns_are_selected_by_name_or_by_position() {
        let text = "t,x,v\n0,1,2\n1,3,4\n";
        let named = ColumnSelector::Named;
        assert_eq!(columns(text, &FIRST_TWO), [[0.0, 1.0], [1.0, 3.0]]);
        assert_eq!(columns(text, &[named("t"), named("v")]), [[0.0, 1.0], [2.0, 4.0]]);
        assert_eq!(
            columns(text, &[named("x"), ColumnSelector::Next]),
            [[1.0, 3.0], [2.0, 4.0]],
            "the next column"
        );
        assert_eq!(
            columns(text, &[named("v"), named("t"), named("v")]),
            [[2.0, 4.0], [0.0, 1.0], [2.0, 4.0]]
        );
    }

    #[test]
    fn a_fault_names_the_column_that_was_selected_by_name() {
        let faults =
            table("t,x\n0,1\n1,\n", &[ColumnSelector::First, ColumnSelector::Named("x")]).unwrap_err();
        assert!(faults[0].message.ends_with("has \"\" instead of a number, in the column x"), "{faults:?}");
    }

    #[test]
    fn every_missing_column_is_reported() {
        let faults = table(
            "t,x\n0,1\n",
            &[ColumnSelector::Named("y"), ColumnSelector::Named("t"), ColumnSelector::Named("z")],
        )
        .unwrap_err();
        let missing: Vec<_> = faults.iter().map(|fault| fault.column).collect();
        assert_eq!(missing, [Some(0), Some(2)], "{faults:?}");
    }

    #[test]
    fn byte_order_marks_line_ends_quotes_blanks_and_comments_are_skipped() {
        let text = "\u{feff}# made by hand\r\n# t: s\r\n# \"force\": N\r\n\"t\",\"a force\"\r\n\r\n0, 1e3\r\n# more\r\n  \r\n\"+.5\", -2";
        let table = table(text, &[ColumnSelector::First, ColumnSelector::Named("a force")]).unwrap();
        assert_eq!((table.columns, table.lines), (vec![vec![0.0, 0.5], vec![1000.0, -2.0]], vec![6, 9]));
        assert_eq!(table.units, [Some(UnitComment { text: "s".to_owned(), line: 2 }), None]);
    }

    /// Message and hint of the only fault of a table, with its path replaced by FILE.
    fn only_fault(text: &str) -> String {
        let faults = table(text, &FIRST_TWO).unwrap_err();
        assert_eq!(faults.len(), 1, "{faults:?}");
        let path =
            faults[0].message.split(' ').find(|word| word.starts_with('/')).unwrap_or_default().to_owned();
        format!("{}; {}", faults[0].message.replace(&path, "FILE"), faults[0].hint)
    }

    #[test]
    fn a_fault_of_a_table_names_its_line() {
        let cases = [
            ("", "FILE is empty"),
            ("# t: s\n\n", "FILE is empty"),
            ("t;x\n0,5;1\n", "line 1 of FILE separates its columns by \";\"; separate the columns"),
            ("t\tx\n0\t1\n", "line 1 of FILE separates its columns by tabs"),
            ("0,1\n1,2\n", "line 1 of FILE has numbers instead of column names"),
            ("t\n0\n", "line 1 of FILE has no column to the right of"),
            (
                "t,x\n0,5,1,5\n",
                "line 2 of FILE has 4 fields, but the line of names has 2; write decimal points",
            ),
            ("t,x\n\"0,5\",1\n", "line 2 of FILE has \"0,5\" instead of a number; write 0.5, not 0,5"),
            ("t,x\n0,\n", "line 2 of FILE has \"\" instead of a number"),
            ("t,x\n0,NaN\n", "line 2 of FILE has \"NaN\" instead of a number"),
            ("t,x\n0,1e999\n", "line 2 of FILE has \"1e999\" instead of a number"),
            ("t,x\n\"0,1\n", "line 2 of FILE has 1 field, but the line of names has 2; write one field"),
            ("t,x\r0,1\r", "line 1 of FILE contains a carriage return"),
            ("t\0,\0x\0\n", "line 1 of FILE contains control characters; name a CSV file"),
        ];
        for (text, expected) in cases {
            assert!(only_fault(text).starts_with(expected), "{text:?}: {}", only_fault(text));
        }
    }

    #[test]
    fn bytes_that_are_not_text_are_reported_with_their_line() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), b"t,x\n0,1\n1,\xe9\n").unwrap();
        let faults = read(file.path(), &FIRST_TWO).unwrap_err();
        assert!(
            faults[0].message.starts_with("line 3 of ") && faults[0].hint.contains("UTF-8"),
            "{faults:?}"
        );
    }

    #[test]
    fn only_the_first_ten_faults_are_reported() {
        let faults = table(&format!("t,x\n0,1\n{}", "a,b\n".repeat(1000)), &FIRST_TWO).unwrap_err();
        assert_eq!(faults.len(), MAX_FAULTS);
    }

    #[test]
    fn at_most_one_field_of_a_file_that_is_not_a_table_is_shown() {
        let users = "root:x:0:0:Charlie,,:/root:/bin/sh\nann:x:1:1:Ann,Room 7,:/home/ann:/bin/sh\n";
        let notes = format!("to do,when\n{},today\n{},later\n", "call the office ".repeat(9), "rest");
        for (text, first) in [
            (users, ColumnSelector::Named("t")),
            (users, ColumnSelector::First),
            (&notes, ColumnSelector::First),
        ] {
            let faults = table(text, &[first, ColumnSelector::Next]).unwrap_err();
            assert_eq!(faults.len(), 1, "{faults:?}");
            let printed = format!("{} {}", faults[0].message, faults[0].hint);
            let confidential = ["Charlie", "Room", "call the office call the office call", "rest"];
            assert!(!confidential.iter().any(|part| printed.contains(part)), "{printed}");
        }
    }

    #[test]
    fn a_folder_and_a_table_with_too_many_rows_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        assert!(read(folder.path(), &FIRST_TWO).unwrap_err()[0].message.ends_with("is not a file"));
        let endless = "t,x\n".to_owned() + &"0,1\n".repeat(MAX_ROWS + 1);
        assert!(only_fault(&endless).contains("the limit of 2000000 rows"), "{}", only_fault(&endless));
    }
}
