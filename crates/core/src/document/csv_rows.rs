//! Columns of a CSV file, read line by line.

use std::fs::File;
use std::io::{BufRead as _, BufReader, ErrorKind};
use std::path::Path;
use std::rc::Rc;

use super::diagnostic::suggestion;
use crate::output::refusal;

/// Bytes of the largest file that is read.
const LARGEST: u64 = 100_000_000;
/// More rows than this would make a run that nobody waits for: every one ends a step.
const MOST_ROWS: usize = 2_000_000;
/// After so many faults the rest of a file is not read.
const MOST_FAULTS: usize = 10;

/// What to do about a file that is no text.
const NO_TEXT: &str = "name a CSV file, saved with the encoding UTF-8";

/// What is wrong with a file.
#[derive(Debug, PartialEq)]
pub struct Fault {
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    pub hint: String,
    /// Which of the columns asked for it is about, if it is about one.
    pub column: Option<usize>,
}

impl Fault {
    /// A fault of the file as a whole.
    pub fn new(message: impl Into<String>, hint: impl Into<String>) -> Self {
        Fault { message: message.into(), hint: hint.into(), column: None }
    }
}

/// A unit as a comment line tells it.
#[derive(Debug, Clone, PartialEq)]
pub struct Told {
    /// The text of the unit.
    pub text: String,
    /// The line of the file, from 1.
    pub line: usize,
}

/// A column that is asked for.
#[derive(Debug, Clone, Copy)]
pub enum Asked<'a> {
    /// That of this name.
    Named(&'a str),
    /// The first.
    First,
    /// The one to the right of the column asked for before.
    Beside,
}

/// The numbers of the columns asked for.
#[derive(Debug, Default)]
pub struct Rows {
    /// Those of each column, row by row.
    pub columns: Vec<Vec<f64>>,
    /// The line that each row stands in, from 1.
    pub lines: Vec<usize>,
    /// The names of the columns.
    pub names: Vec<String>,
    /// The names of all columns of the file.
    pub all_names: Vec<String>,
    /// The units that comment lines `# name: unit` tell for the columns.
    pub units: Vec<Option<Told>>,
}

/// Reads columns of a file.
///
/// # Errors
/// Everything that is wrong with the file, or the first things.
pub fn read(path: &Path, asked: &[Asked<'_>]) -> Result<Rows, Vec<Fault>> {
    let mut lines = BufReader::new(open(path).map_err(|fault| vec![fault])?);
    let mut reader = Reader {
        path,
        asked,
        number: 0,
        comments: Vec::new(),
        columns: None,
        row: Vec::new(),
        rows: Rows::default(),
        faults: Vec::new(),
    };
    let mut line = Vec::new();
    while !reader.is_lost() {
        line.clear();
        match lines.read_until(b'\n', &mut line) {
            Ok(0) => break,
            Ok(_) => reader.line(&line),
            Err(error) => return Err(vec![unreadable(path, &error)]),
        }
    }
    reader.finish()
}

fn open(path: &Path) -> Result<File, Fault> {
    let looked_up = path.metadata().map_err(|error| unreadable(path, &error))?;
    if !looked_up.is_file() {
        return Err(Fault::new(format!("{} is no file", path.display()), "name a CSV file"));
    }
    if looked_up.len() > LARGEST {
        let message = format!("{} has more than {} MB", path.display(), LARGEST / 1_000_000);
        return Err(Fault::new(message, "record fewer columns, or less often"));
    }
    File::open(path).map_err(|error| unreadable(path, &error))
}

fn unreadable(path: &Path, error: &std::io::Error) -> Fault {
    if error.kind() == ErrorKind::NotFound {
        let hint = "a file is looked for from the folder of the document that names it";
        return Fault::new(format!("there is no file {}", path.display()), hint);
    }
    Fault::new(
        format!("cannot read {}: {}", path.display(), refusal(error)),
        "look at the file's permissions",
    )
}

struct Reader<'a> {
    path: &'a Path,
    asked: &'a [Asked<'a>],
    /// Of the line that is being read.
    number: usize,
    /// Name and unit, as comment lines above the names tell them.
    comments: Vec<(String, Told)>,
    columns: Option<Columns>,
    /// The numbers of the line that is being read.
    row: Vec<f64>,
    rows: Rows,
    faults: Vec<Fault>,
}

/// How many columns a file has, and which of them were asked for.
#[derive(Clone)]
struct Columns {
    count: usize,
    places: Rc<[usize]>,
}

impl Reader<'_> {
    /// Whether the rest of the file is of no use: a file whose first row is wrong may be no table at all.
    fn is_lost(&self) -> bool {
        let is_table = self.columns.is_some() && !self.rows.lines.is_empty();
        self.faults.len() >= MOST_FAULTS || (!is_table && !self.faults.is_empty())
    }

    fn line(&mut self, bytes: &[u8]) {
        self.number += 1;
        let Ok(text) = std::str::from_utf8(bytes) else {
            return self.fault("is not UTF-8 text", NO_TEXT);
        };
        let text = text.trim_end_matches(['\r', '\n']);
        let text = if self.number == 1 { text.strip_prefix('\u{feff}').unwrap_or(text) } else { text };
        if text.contains('\r') {
            return self.fault(
                "holds a carriage return",
                "end lines with a line feed, with or without a carriage return before it",
            );
        }
        if text.contains(is_unprintable) {
            return self.fault("holds signs that are no text", NO_TEXT);
        }
        if let Some(comment) = text.strip_prefix('#') {
            let told = |unit: &str| Told { text: unit.trim().to_owned(), line: self.number };
            self.comments
                .extend(comment.split_once(':').map(|(name, unit)| (name.trim().to_owned(), told(unit))));
        } else if !text.trim().is_empty() {
            let fields = fields(text);
            match self.columns.clone() {
                None => self.names(&fields),
                Some(columns) => self.row(&columns, &fields),
            }
        }
    }

    fn fault(&mut self, what: &str, hint: &str) {
        let message = format!("line {} of {} {what}", self.number, self.path.display());
        self.faults.push(Fault::new(message, hint));
    }

    /// The line of names.
    fn names(&mut self, fields: &[String]) {
        if let Some(separator) = [';', '\t'].into_iter().find(|separator| fields[0].contains(*separator)) {
            let told = if separator == '\t' { "tabs".to_owned() } else { format!("\"{separator}\"") };
            let what = format!("separates its columns by {told}");
            return self.fault(&what, "write commas between the columns, and points in the numbers");
        }
        if fields.iter().any(|field| field.parse::<f64>().is_ok()) {
            return self.fault(
                "has numbers where the names of the columns stand",
                "begin with a line of names, such as t,x",
            );
        }
        let mut places = Vec::new();
        for (index, asked) in self.asked.iter().enumerate() {
            places.push(self.column(fields, index, *asked, places.last().copied().flatten()));
        }
        let Some(places) = places.into_iter().collect::<Option<Rc<[usize]>>>() else { return };
        self.rows.columns = vec![Vec::new(); places.len()];
        self.rows.names = places.iter().map(|place| fields[*place].clone()).collect();
        self.rows.all_names = fields.to_vec();
        let unit = |name: &String| {
            self.comments.iter().rev().find(|(told, _)| told == name).map(|(_, unit)| unit.clone())
        };
        self.rows.units = self.rows.names.iter().map(unit).collect();
        self.columns = Some(Columns { count: fields.len(), places });
    }

    /// The place of a column that is asked for.
    fn column(
        &mut self,
        fields: &[String],
        index: usize,
        asked: Asked<'_>,
        before: Option<usize>,
    ) -> Option<usize> {
        match asked {
            Asked::Named(name) => self.named(fields, index, name),
            Asked::First => Some(0),
            Asked::Beside => {
                // Where the column before is not there, that has been told.
                let beside = before? + 1;
                if beside == fields.len() {
                    self.fault("names no column beside the one along x", "a table needs two columns");
                }
                Some(beside).filter(|beside| *beside < fields.len())
            }
        }
    }

    fn named(&mut self, fields: &[String], index: usize, name: &str) -> Option<usize> {
        let mut found = fields.iter().enumerate().filter(|(_, field)| *field == name).map(|(place, _)| place);
        let (first, second) = (found.next(), found.next());
        let (what, hint) = match first {
            Some(_) if second.is_none() => return first,
            Some(_) => ("names more than one column", "give every column a name of its own".to_owned()),
            None => ("names no column", told_names(name, fields)),
        };
        let message = format!("line {} of {} {what} \"{name}\"", self.number, self.path.display());
        self.faults.push(Fault { column: Some(index), ..Fault::new(message, hint) });
        None
    }

    fn row(&mut self, columns: &Columns, fields: &[String]) {
        if fields.len() != columns.count {
            let noun = if fields.len() == 1 { "field" } else { "fields" };
            let what = format!("has {} {noun}, and the line of names {}", fields.len(), columns.count);
            let hint = match fields.len() > columns.count {
                true => "write points in the numbers, not commas, and a field for every name",
                false => "write a field for every name; the line may have been cut off",
            };
            return self.fault(&what, hint);
        }
        self.row.clear();
        for (index, place) in columns.places.iter().enumerate() {
            match fields[*place].parse::<f64>().ok().filter(|number| number.is_finite()) {
                Some(read) => self.row.push(read),
                None => return self.no_number(index, &fields[*place]),
            }
        }
        if self.rows.lines.len() == MOST_ROWS {
            self.columns = None;
            return self.fault(
                &format!("is beyond the {MOST_ROWS} rows that a table may have"),
                "record less often",
            );
        }
        for (column, number) in self.rows.columns.iter_mut().zip(&self.row) {
            column.push(*number);
        }
        self.rows.lines.push(self.number);
    }

    fn no_number(&mut self, index: usize, field: &str) {
        let hint = if field.contains(',') {
            "write 0.5, not 0,5"
        } else {
            "every row needs a finite number in each column that is read"
        };
        // What was not asked for by name may be no table at all, and is not shown.
        let column = match self.asked[index] {
            Asked::Named(name) => format!(", in the column {name}"),
            Asked::First | Asked::Beside => String::new(),
        };
        self.fault(&format!("has \"{}\" where a number is needed{column}", excerpt(field)), hint);
    }

    fn finish(mut self) -> Result<Rows, Vec<Fault>> {
        if self.columns.is_none() && self.faults.is_empty() {
            let message = format!("{} is empty", self.path.display());
            self.faults.push(Fault::new(
                message,
                "a table is a line of names, and a line of numbers for every point",
            ));
        }
        if self.faults.is_empty() { Ok(self.rows) } else { Err(self.faults) }
    }
}

/// Columns that a name may be meant for. Of a file that is no table little is shown.
fn told_names(name: &str, fields: &[String]) -> String {
    let is_name = |field: &&str| {
        let is_sign = |sign: char| !(sign.is_alphanumeric() || " _.-()[]/%^*°²".contains(sign));
        field.len() <= LONGEST_EXCERPT && !field.contains(is_sign)
    };
    let known: Vec<_> = fields.iter().map(String::as_str).collect();
    let hint = known.iter().all(is_name).then(|| suggestion(name, &known)).flatten();
    hint.unwrap_or_else(|| "a table begins with a line of names, such as t,x".to_owned())
}

/// Characters of a file that a report shows.
const LONGEST_EXCERPT: usize = 30;

/// The beginning of a field.
pub(crate) fn excerpt(field: &str) -> String {
    let shown: String = field.chars().take(LONGEST_EXCERPT).collect();
    if shown.len() < field.len() { format!("{shown}...") } else { shown }
}

fn is_unprintable(sign: char) -> bool {
    sign.is_control() && sign != '\t'
}

/// The fields of a line, quotes and the blanks around them taken away.
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

    const UNNAMED: [Asked<'_>; 2] = [Asked::First, Asked::Beside];

    fn rows(text: &str, asked: &[Asked<'_>]) -> Result<Rows, Vec<Fault>> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        read(file.path(), asked)
    }

    fn columns(text: &str, asked: &[Asked<'_>]) -> Vec<Vec<f64>> {
        rows(text, asked).unwrap_or_else(|faults| panic!("{faults:?}")).columns
    }

    #[test]
    fn columns_are_found_by_name_or_are_the_first_two() {
        let text = "t,x,v\n0,1,2\n1,3,4\n";
        let named = Asked::Named;
        assert_eq!(columns(text, &UNNAMED), [[0.0, 1.0], [1.0, 3.0]]);
        assert_eq!(columns(text, &[named("t"), named("v")]), [[0.0, 1.0], [2.0, 4.0]]);
        assert_eq!(
            columns(text, &[named("x"), Asked::Beside]),
            [[1.0, 3.0], [2.0, 4.0]],
            "the one beside it"
        );
        assert_eq!(
            columns(text, &[named("v"), named("t"), named("v")]),
            [[2.0, 4.0], [0.0, 1.0], [2.0, 4.0]]
        );
    }

    #[test]
    fn the_column_asked_for_by_name_is_told() {
        let faults = rows("t,x\n0,1\n1,\n", &[Asked::First, Asked::Named("x")]).unwrap_err();
        assert!(
            faults[0].message.ends_with("has \"\" where a number is needed, in the column x"),
            "{faults:?}"
        );
    }

    #[test]
    fn every_column_that_is_missing_is_told() {
        let faults =
            rows("t,x\n0,1\n", &[Asked::Named("y"), Asked::Named("t"), Asked::Named("z")]).unwrap_err();
        let told: Vec<_> = faults.iter().map(|fault| fault.column).collect();
        assert_eq!(told, [Some(0), Some(2)], "{faults:?}");
    }

    #[test]
    fn marks_line_ends_quotes_blanks_and_comments_are_read_over() {
        let text = "\u{feff}# made by hand\r\n# t: s\r\n# \"force\": N\r\n\"t\",\"a force\"\r\n\r\n0, 1e3\r\n# more\r\n  \r\n\"+.5\", -2";
        let rows = rows(text, &[Asked::First, Asked::Named("a force")]).unwrap();
        assert_eq!((rows.columns, rows.lines), (vec![vec![0.0, 0.5], vec![1000.0, -2.0]], vec![6, 9]));
        assert_eq!(rows.units, [Some(Told { text: "s".to_owned(), line: 2 }), None]);
    }

    /// The only fault of a table.
    fn told(text: &str) -> String {
        let faults = rows(text, &UNNAMED).unwrap_err();
        assert_eq!(faults.len(), 1, "{faults:?}");
        let path =
            faults[0].message.split(' ').find(|word| word.starts_with('/')).unwrap_or_default().to_owned();
        format!("{}; {}", faults[0].message.replace(&path, "FILE"), faults[0].hint)
    }

    #[test]
    fn what_is_no_table_is_told_with_its_line() {
        let cases = [
            ("", "FILE is empty"),
            ("# t: s\n\n", "FILE is empty"),
            ("t;x\n0,5;1\n", "line 1 of FILE separates its columns by \";\"; write commas"),
            ("t\tx\n0\t1\n", "line 1 of FILE separates its columns by tabs"),
            ("0,1\n1,2\n", "line 1 of FILE has numbers where the names"),
            ("t\n0\n", "line 1 of FILE names no column beside"),
            ("t,x\n0,5,1,5\n", "line 2 of FILE has 4 fields, and the line of names 2; write points"),
            ("t,x\n\"0,5\",1\n", "line 2 of FILE has \"0,5\" where a number is needed; write 0.5, not 0,5"),
            ("t,x\n0,\n", "line 2 of FILE has \"\" where a number is needed"),
            ("t,x\n0,NaN\n", "line 2 of FILE has \"NaN\" where a number is needed"),
            ("t,x\n0,1e999\n", "line 2 of FILE has \"1e999\" where a number is needed"),
            ("t,x\n\"0,1\n", "line 2 of FILE has 1 field, and the line of names 2; write a field"),
            ("t,x\r0,1\r", "line 1 of FILE holds a carriage return"),
            ("t\0,\0x\0\n", "line 1 of FILE holds signs that are no text; name a CSV file"),
        ];
        for (text, expected) in cases {
            assert!(told(text).starts_with(expected), "{text:?}: {}", told(text));
        }
    }

    #[test]
    fn bytes_that_are_no_text_are_told_with_their_line() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), b"t,x\n0,1\n1,\xe9\n").unwrap();
        let faults = read(file.path(), &UNNAMED).unwrap_err();
        assert!(
            faults[0].message.starts_with("line 3 of ") && faults[0].hint.contains("UTF-8"),
            "{faults:?}"
        );
    }

    #[test]
    fn the_first_ten_faults_are_told() {
        let faults = rows(&format!("t,x\n0,1\n{}", "a,b\n".repeat(1000)), &UNNAMED).unwrap_err();
        assert_eq!(faults.len(), MOST_FAULTS);
    }

    #[test]
    fn of_a_file_that_is_no_table_no_more_than_a_field_is_shown() {
        let users = "root:x:0:0:Charlie,,:/root:/bin/sh\nann:x:1:1:Ann,Room 7,:/home/ann:/bin/sh\n";
        let notes = format!("to do,when\n{},today\n{},later\n", "call the office ".repeat(9), "rest");
        for (text, first) in [(users, Asked::Named("t")), (users, Asked::First), (&notes, Asked::First)] {
            let faults = rows(text, &[first, Asked::Beside]).unwrap_err();
            assert_eq!(faults.len(), 1, "{faults:?}");
            let told = format!("{} {}", faults[0].message, faults[0].hint);
            let shown = ["Charlie", "Room", "call the office call the office call", "rest"];
            assert!(!shown.iter().any(|part| told.contains(part)), "{told}");
        }
    }

    #[test]
    fn a_folder_and_an_endless_table_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        assert!(read(folder.path(), &UNNAMED).unwrap_err()[0].message.ends_with("is no file"));
        let endless = "t,x\n".to_owned() + &"0,1\n".repeat(MOST_ROWS + 1);
        assert!(told(&endless).contains("beyond the 2000000 rows"), "{}", told(&endless));
    }
}
