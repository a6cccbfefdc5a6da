//! Reads the lines of a CSV file: comments, the names of columns, and rows.

use std::path::Path;
use std::rc::Rc;

use super::column_name::split_unit_text;
use super::{
    ColumnSelector, CsvFault, CsvTable, MAX_EXCERPT_CHARACTERS, MAX_FAULTS, UnitComment, excerpt, split_unit,
};
use crate::document::{MAX_NAME_CHARACTERS, is_name_too_long, suggestion};

/// Number of bytes of a line at most. A file without line ends would otherwise be one line of 100 MB.
pub(super) const MAX_LINE_BYTES: usize = 10_000_000;

/// Number of columns of a table at most, and of comment lines that give units. Every name takes memory.
pub(super) const MAX_COLUMNS: usize = 10_000;

/// Number of rows of a table at most. Every row ends a step, so a longer table would make a run of hours.
pub(super) const MAX_ROWS: usize = 2_000_000;

/// The hint for a file that does not contain text.
const NOT_TEXT_HINT: &str = "name a CSV file, saved with the encoding UTF-8";

/// The state of reading a file.
pub(super) struct Reader<'a> {
    /// Path of the file, for messages.
    path: &'a Path,
    /// The selectors, in the order in which the table has their columns.
    selectors: &'a [ColumnSelector<'a>],
    /// Whether a field that is not a finite number becomes NaN. Otherwise it is a fault.
    has_words: bool,
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

impl<'a> Reader<'a> {
    /// A reader that has not read a line yet. `path` is for messages.
    pub(super) fn new(path: &'a Path, selectors: &'a [ColumnSelector<'a>]) -> Self {
        Reader {
            path,
            selectors,
            has_words: false,
            line_number: 0,
            unit_comments: Vec::new(),
            columns: None,
            row: Vec::new(),
            table: CsvTable::default(),
            faults: Vec::new(),
        }
    }

    /// The same reader, for columns that may contain words: they become NaN.
    pub(super) fn with_words(self) -> Self {
        Reader { has_words: true, ..self }
    }

    /// The path of the file, for messages.
    pub(super) fn path(&self) -> &'a Path {
        self.path
    }

    /// Whether the line of names was read.
    pub(super) fn has_names(&self) -> bool {
        self.columns.is_some()
    }

    /// Whether the rest of the file is not read. A file whose first row is wrong may not be a table at all.
    pub(super) fn is_stopped(&self) -> bool {
        let is_table = self.columns.is_some() && !self.table.lines.is_empty();
        self.faults.len() >= MAX_FAULTS || (!is_table && !self.faults.is_empty())
    }

    /// Reads one line: a comment, the names, or a row. A byte order mark at the start of the file is skipped.
    pub(super) fn line(&mut self, bytes: &[u8]) {
        self.line_number += 1;
        if bytes.len() > MAX_LINE_BYTES {
            // The rest of the line would count as the next line, so the reader stops.
            self.columns = None;
            return self.fault(&format!("has more than {} MB", MAX_LINE_BYTES / 1_000_000), NOT_TEXT_HINT);
        }
        let text = match line_text(bytes, self.line_number == 1) {
            Ok(text) => text,
            Err([what, hint]) => return self.fault(what, hint),
        };
        if let Some(comment) = text.strip_prefix('#') {
            return self.comment(comment);
        }
        if text.trim().is_empty() {
            return;
        }
        let fields = fields(text);
        if fields.len() > MAX_COLUMNS {
            return self.fault(&format!("has more than {MAX_COLUMNS} columns"), "use fewer columns");
        }
        match self.columns.clone() {
            None => self.names(&fields),
            Some(columns) => self.row(&columns, &fields),
        }
    }

    /// Reads a comment line without its `#`. In front of the line of names, `name: unit` gives the unit of a column.
    fn comment(&mut self, comment: &str) {
        let Some((name, unit)) = comment.split_once(':').filter(|_| self.columns.is_none()) else { return };
        if self.unit_comments.len() == MAX_COLUMNS {
            let what = format!("exceeds the limit of {MAX_COLUMNS} comment lines with a colon");
            return self.fault(&what, "remove the comment lines that give no unit of a column");
        }
        let unit = UnitComment { text: unit.trim().to_owned(), line: self.line_number };
        self.unit_comments.push((name.trim().to_owned(), unit));
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
        if let Some(selector_index) = indices.iter().position(|index| is_name_too_long(&fields[*index])) {
            let message = format!(
                "line {} of {} has a column name of more than {MAX_NAME_CHARACTERS} characters",
                self.line_number,
                self.path.display()
            );
            let fault = CsvFault::new(message, "give the column a shorter name");
            return self.faults.push(CsvFault { column: Some(selector_index), ..fault });
        }
        self.table.columns = vec![Vec::new(); indices.len()];
        self.table.names = indices.iter().map(|index| fields[*index].clone()).collect();
        self.table.all_names = fields.to_vec();
        self.table.units = self.table.names.iter().map(|name| self.unit(name)).collect();
        self.check_units();
        self.table.names_line = self.line_number;
        self.columns = Some(SelectedColumns { count: fields.len(), indices });
    }

    /// The unit of a column, from a comment line or else from its name. If a column has several comments, the last one
    /// counts. The text of the unit remains as it is written, for messages.
    fn unit(&self, column: &str) -> Option<UnitComment> {
        let in_name = split_unit_text(column);
        let is_meant = |name: &str| name == column || in_name.is_some_and(|(bare, _)| bare == name);
        let comment = self.unit_comments.iter().rev().find(|(name, _)| is_meant(name.as_str()));
        comment.map(|(_, unit)| unit.clone()).or_else(|| {
            let (_, text) = in_name?;
            Some(UnitComment { text: text.to_owned(), line: self.line_number })
        })
    }

    /// Reports the selected columns whose comment line gives another unit than their name.
    fn check_units(&mut self) {
        for (selector_index, (name, unit)) in self.table.names.iter().zip(&self.table.units).enumerate() {
            let (Some((_, named)), Some(unit)) = (split_unit(name), unit) else { continue };
            let Some(commented) = unit.unit() else { continue };
            if !named.is_same_as(&commented) {
                let message = format!(
                    "line {} of {} names a column {}, but line {} gives its unit as {}",
                    self.line_number,
                    self.path.display(),
                    excerpt(name),
                    unit.line,
                    excerpt(&unit.text)
                );
                let hint = "correct or remove one of the two units";
                self.faults.push(CsvFault { column: Some(selector_index), ..CsvFault::new(message, hint) });
            }
        }
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

    /// The index of the column with a name, or else of the column with this name and a unit. Reports a name that no
    /// column or more than one column has.
    fn named_column(&mut self, fields: &[String], selector_index: usize, name: &str) -> Option<usize> {
        let (first, second) = match first_two(fields, |field| field == name) {
            (None, _) => first_two(fields, |field| split_unit(field).is_some_and(|(bare, _)| bare == name)),
            found => found,
        };
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
                None if self.has_words => self.row.push(f64::NAN),
                None => return self.not_a_number(selector_index, &fields[*column]),
            }
        }
        if self.table.lines.len() == MAX_ROWS {
            self.columns = None;
            return self
                .fault(&format!("exceeds the limit of {MAX_ROWS} rows for a table"), "use fewer rows");
        }
        for (column, number) in self.table.columns.iter_mut().zip(&self.row) {
            column.push(*number);
        }
        self.table.lines.push(self.line_number);
    }

    /// Reports a field that is not a finite number.
    fn not_a_number(&mut self, selector_index: usize, field: &str) {
        let hint = match field {
            "" => "write a number into the cell, or remove the row",
            _ if field.contains(',') => "write 0.5, not 0,5",
            _ => "every row needs a finite number in each column that is read",
        };
        let found =
            if field.is_empty() { "an empty cell".to_owned() } else { format!("\"{}\"", excerpt(field)) };
        // The document contains the names of named columns. Names from the file are not shown: it may be another file.
        let column = match self.selectors[selector_index] {
            ColumnSelector::Named(name) => format!(", in the column {name}"),
            ColumnSelector::First | ColumnSelector::Next => String::new(),
        };
        self.fault(&format!("has {found} instead of a number{column}"), hint);
    }

    /// The table, or the faults if there are any.
    ///
    /// # Errors
    /// If the file is empty, or if a line or a number has a fault. All faults are returned.
    pub(super) fn finish(mut self) -> Result<CsvTable, Vec<CsvFault>> {
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

/// The indices of the first two fields that satisfy a condition.
fn first_two(fields: &[String], is_meant: impl Fn(&str) -> bool) -> (Option<usize>, Option<usize>) {
    let matches = fields.iter().enumerate().filter(|(_, field)| is_meant(field));
    let mut indices = matches.map(|(index, _)| index);
    (indices.next(), indices.next())
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

/// The text of a line without its line end, and without the byte order mark of the first line.
///
/// # Errors
/// If the bytes are not text: what is wrong with the line, and the hint.
fn line_text(bytes: &[u8], is_first: bool) -> Result<&str, [&'static str; 2]> {
    let text = std::str::from_utf8(bytes).map_err(|_| ["is not UTF-8 text", NOT_TEXT_HINT])?;
    let text = text.trim_end_matches(['\r', '\n']);
    let text = if is_first { text.strip_prefix('\u{feff}').unwrap_or(text) } else { text };
    if text.contains('\r') {
        let hint = "end lines with a line feed, with or without a carriage return before it";
        return Err(["contains a carriage return", hint]);
    }
    if text.contains(is_control_character) {
        return Err(["contains control characters", NOT_TEXT_HINT]);
    }
    Ok(text)
}

/// Whether a character cannot be part of a text file. Tabs can.
fn is_control_character(letter: char) -> bool {
    letter.is_control() && letter != '\t'
}

/// The fields of a line, without quotes and surrounding blanks. There is at least one field, and at most one more than
/// [`MAX_COLUMNS`].
fn fields(text: &str) -> Vec<String> {
    if !text.contains('"') {
        return text.split(',').take(MAX_COLUMNS + 1).map(|field| field.trim().to_owned()).collect();
    }
    let mut builder = csv::ReaderBuilder::new();
    builder.has_headers(false).flexible(true).trim(csv::Trim::All).buffer_capacity(text.len().max(1));
    let record = builder.from_reader(text.as_bytes()).into_records().next();
    let fields: Vec<String> = match record {
        Some(Ok(record)) => record.iter().take(MAX_COLUMNS + 1).map(str::to_owned).collect(),
        _ => Vec::new(),
    };
    if fields.is_empty() { vec![String::new()] } else { fields }
}
