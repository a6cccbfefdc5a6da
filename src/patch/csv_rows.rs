//! Two columns of a CSV file, read line by line.

use std::fs::File;
use std::io::{BufRead as _, BufReader, ErrorKind};
use std::path::Path;

use super::diagnostic::suggestion;
use crate::output::refusal;

/// Bytes of the largest file that is read.
const LARGEST: u64 = 100_000_000;
/// More points than this would make a run that nobody waits for: every one ends a step.
const MOST_POINTS: usize = 2_000_000;
/// After so many faults the rest of a file is not read.
const MOST_FAULTS: usize = 10;

/// What to do about a file that is no text.
const NO_TEXT: &str = "name a CSV file, saved with the encoding UTF-8";

/// What is wrong with a file.
#[derive(Debug, PartialEq)]
pub(super) struct Fault {
    pub message: String,
    pub hint: String,
    /// The axis whose column it is about, if it is about one: 0 or 1.
    pub axis: Option<usize>,
}

impl Fault {
    pub fn new(message: impl Into<String>, hint: impl Into<String>) -> Self {
        Fault { message: message.into(), hint: hint.into(), axis: None }
    }
}

/// A unit as a comment line tells it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Told {
    pub text: String,
    /// The line of the file, from 1.
    pub line: usize,
}

/// The numbers of two columns.
#[derive(Debug, Default)]
pub(super) struct Rows {
    pub points: Vec<[f64; 2]>,
    /// The line that each stands in, from 1.
    pub lines: Vec<usize>,
    /// The names of the two columns.
    pub names: [String; 2],
    /// The names of all columns.
    pub all_names: Vec<String>,
    /// The units that comment lines `# name: unit` tell for them.
    pub units: [Option<Told>; 2],
}

/// Reads the columns of these names; without names the first column, and the one beside the column along x.
///
/// # Errors
/// Everything that is wrong with the file, or the first things.
pub(super) fn read(path: &Path, asked: [Option<&str>; 2]) -> Result<Rows, Vec<Fault>> {
    let mut lines = BufReader::new(open(path).map_err(|fault| vec![fault])?);
    let mut reader = Reader {
        path,
        asked,
        number: 0,
        comments: Vec::new(),
        columns: None,
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
        let hint = "a table's file is looked for from the folder in which the patch lies";
        return Fault::new(format!("there is no file {}", path.display()), hint);
    }
    Fault::new(
        format!("cannot read {}: {}", path.display(), refusal(error)),
        "look at the file's permissions",
    )
}

struct Reader<'a> {
    path: &'a Path,
    asked: [Option<&'a str>; 2],
    /// Of the line that is being read.
    number: usize,
    /// Name and unit, as comment lines above the names tell them.
    comments: Vec<(String, Told)>,
    columns: Option<Columns>,
    rows: Rows,
    faults: Vec<Fault>,
}

#[derive(Clone, Copy)]
struct Columns {
    count: usize,
    places: [usize; 2],
}

impl Reader<'_> {
    /// Whether the rest of the file is of no use: a file whose first row is wrong may be no table at all.
    fn is_lost(&self) -> bool {
        let is_table = self.columns.is_some() && !self.rows.points.is_empty();
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
            match self.columns {
                None => self.names(&fields),
                Some(columns) => self.row(columns, &fields),
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
        let Some(x) = self.column(fields, 0, Some(0)) else { return };
        let Some(y) = self.column(fields, 1, Some(x + 1).filter(|beside| *beside < fields.len())) else {
            return;
        };
        self.columns = Some(Columns { count: fields.len(), places: [x, y] });
        self.rows.names = [x, y].map(|place| fields[place].clone());
        self.rows.all_names = fields.to_vec();
        let unit = |name: &String| {
            self.comments.iter().rev().find(|(told, _)| told == name).map(|(_, unit)| unit.clone())
        };
        self.rows.units = self.rows.names.each_ref().map(unit);
    }

    /// The place of the column along an axis.
    fn column(&mut self, fields: &[String], axis: usize, unnamed: Option<usize>) -> Option<usize> {
        let Some(name) = self.asked[axis] else {
            if unnamed.is_none() {
                self.fault("names no column beside the one along x", "a table needs two columns");
            }
            return unnamed;
        };
        let mut found = fields.iter().enumerate().filter(|(_, field)| *field == name).map(|(place, _)| place);
        let (first, second) = (found.next(), found.next());
        let (what, hint) = match first {
            Some(_) if second.is_none() => return first,
            Some(_) => ("names more than one column", "give every column a name of its own".to_owned()),
            None => ("names no column", told_names(name, fields)),
        };
        let message = format!("line {} of {} {what} \"{name}\"", self.number, self.path.display());
        self.faults.push(Fault { axis: Some(axis), ..Fault::new(message, hint) });
        None
    }

    fn row(&mut self, columns: Columns, fields: &[String]) {
        if fields.len() != columns.count {
            let what = format!("has {} fields, and the line of names {}", fields.len(), columns.count);
            return self.fault(&what, "write points in the numbers, not commas, and a field for every name");
        }
        let mut point = [0.0; 2];
        for (number, place) in point.iter_mut().zip(columns.places) {
            match fields[place].parse::<f64>().ok().filter(|number| number.is_finite()) {
                Some(read) => *number = read,
                None => return self.no_number(&fields[place]),
            }
        }
        if self.rows.points.len() == MOST_POINTS {
            self.columns = None;
            return self.fault(
                &format!("is beyond the {MOST_POINTS} points that a table may have"),
                "record less often",
            );
        }
        self.rows.points.push(point);
        self.rows.lines.push(self.number);
    }

    fn no_number(&mut self, field: &str) {
        let hint = if field.contains(',') {
            "write 0.5, not 0,5"
        } else {
            "every row needs a finite number in each of the two columns"
        };
        self.fault(&format!("has \"{}\" where a number is needed", excerpt(field)), hint);
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
        let is_sign = |sign: char| !(sign.is_alphanumeric() || "_.-()[]/%".contains(sign));
        field.len() <= LONGEST_EXCERPT && !field.contains(is_sign)
    };
    let known: Vec<_> = fields.iter().map(String::as_str).collect();
    let hint = known.iter().all(is_name).then(|| suggestion(name, &known)).flatten();
    hint.unwrap_or_else(|| "a table begins with a line of names, such as t,x".to_owned())
}

/// Characters of a file that a report shows.
const LONGEST_EXCERPT: usize = 30;

/// The beginning of a field.
pub(super) fn excerpt(field: &str) -> String {
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

    fn rows(text: &str, asked: [Option<&str>; 2]) -> Result<Rows, Vec<Fault>> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        read(file.path(), asked)
    }

    fn points(text: &str, asked: [Option<&str>; 2]) -> Vec<[f64; 2]> {
        rows(text, asked).unwrap_or_else(|faults| panic!("{faults:?}")).points
    }

    #[test]
    fn columns_are_found_by_name_or_are_the_first_two() {
        let text = "t,x,v\n0,1,2\n1,3,4\n";
        assert_eq!(points(text, [None, None]), [[0.0, 1.0], [1.0, 3.0]]);
        assert_eq!(points(text, [Some("t"), Some("v")]), [[0.0, 2.0], [1.0, 4.0]]);
        assert_eq!(points(text, [Some("x"), None]), [[1.0, 2.0], [3.0, 4.0]], "the one beside it");
    }

    #[test]
    fn marks_line_ends_quotes_blanks_and_comments_are_read_over() {
        let text = "\u{feff}# made by hand\r\n# t: s\r\n# \"force\": N\r\n\"t\",\"a force\"\r\n\r\n0, 1e3\r\n# more\r\n  \r\n\"+.5\", -2";
        let rows = rows(text, [None, Some("a force")]).unwrap();
        assert_eq!((rows.points, rows.lines), (vec![[0.0, 1000.0], [0.5, -2.0]], vec![6, 9]));
        assert_eq!(rows.units, [Some(Told { text: "s".to_owned(), line: 2 }), None]);
    }

    /// The only fault of a table.
    fn told(text: &str) -> String {
        let faults = rows(text, [None, None]).unwrap_err();
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
            ("t,x\n\"0,1\n", "line 2 of FILE has 1 fields"),
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
        let faults = read(file.path(), [None, None]).unwrap_err();
        assert!(
            faults[0].message.starts_with("line 3 of ") && faults[0].hint.contains("UTF-8"),
            "{faults:?}"
        );
    }

    #[test]
    fn the_first_ten_faults_are_told() {
        let faults = rows(&format!("t,x\n0,1\n{}", "a,b\n".repeat(1000)), [None, None]).unwrap_err();
        assert_eq!(faults.len(), MOST_FAULTS);
    }

    #[test]
    fn of_a_file_that_is_no_table_no_more_than_a_field_is_shown() {
        let users = "root:x:0:0:Charlie,,:/root:/bin/sh\nann:x:1:1:Ann,Room 7,:/home/ann:/bin/sh\n";
        let notes = format!("to do,when\n{},today\n{},later\n", "call the office ".repeat(9), "rest");
        for (text, asked) in [(users, [Some("t"), None]), (users, [None, None]), (&notes, [None, None])] {
            let faults = rows(text, asked).unwrap_err();
            assert_eq!(faults.len(), 1, "{faults:?}");
            let told = format!("{} {}", faults[0].message, faults[0].hint);
            let shown = ["Charlie", "Room", "call the office call the office call", "rest"];
            assert!(!shown.iter().any(|part| told.contains(part)), "{told}");
        }
    }

    #[test]
    fn a_folder_and_an_endless_table_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        assert!(read(folder.path(), [None, None]).unwrap_err()[0].message.ends_with("is no file"));
        let endless = "t,x\n".to_owned() + &"0,1\n".repeat(MOST_POINTS + 1);
        assert!(told(&endless).contains("beyond the 2000000 points"), "{}", told(&endless));
    }
}
