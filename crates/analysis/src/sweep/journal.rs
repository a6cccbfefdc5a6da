//! The table of a sweep on disk: rows are appended, so that a sweep that was killed goes on where it was.
//!
//! Every other file is written beside its place and renamed. This one grows in place, because what was worked out for
//! hours must not be lost with the process. It begins with a head of comment lines and the names of the columns that
//! says which sweep it belongs to, to the bit. Whoever opens it again finds the head, whole rows, and at most one part
//! of a row, which is cut off; the rows are those that the sweep writes anew, so that the file ends with the same bytes.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, BufRead, BufReader, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use super::error::JournalError;
use super::fingerprint::FORMAT_VERSION;

/// A table that rows can be appended to.
pub(super) struct Journal {
    path: PathBuf,
    file: File,
    /// Rows that it holds.
    pub rows: u64,
}

impl Journal {
    /// Opens a table, or makes it. One that is there must have this head, and rows of which each begins as told for
    /// its number, and no more of them than there are runs; each is shown to `look`. It is locked until it is closed.
    pub fn open(
        path: &Path,
        head: &str,
        runs: u64,
        beginning: impl Fn(u64) -> String,
        look: impl FnMut(&[u8]),
    ) -> Result<Journal, JournalError> {
        let refused = |error| JournalError::Io { file: path.to_owned(), error };
        if path.metadata().is_ok_and(|there| !there.is_file()) {
            // A pipe or a device has no past.
            let file = OpenOptions::new().write(true).open(path).map_err(refused)?;
            let mut journal = Journal { path: path.to_owned(), file, rows: 0 };
            journal.append(head)?;
            return Ok(journal);
        }
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path);
        let file = file.map_err(refused)?;
        lock(&file, path)?;
        let mut reader = Reader { path, lines: BufReader::new(&file), line: 0, whole: 0 };
        let rows = if reader.head(head)? { reader.rows(runs, beginning, look)? } else { 0 };
        let whole = reader.whole;
        file.set_len(whole).map_err(refused)?;
        let mut journal = Journal { path: path.to_owned(), file, rows };
        journal.file.seek(SeekFrom::End(0)).map_err(refused)?;
        if whole == 0 {
            journal.append(head)?;
        }
        Ok(journal)
    }

    /// Appends whole rows.
    pub fn append(&mut self, text: &str) -> Result<(), JournalError> {
        let written = self.file.write_all(text.as_bytes());
        written.map_err(|error| JournalError::Io { file: self.path.clone(), error })
    }
}

/// Keeps other sweeps out. The system takes the lock away with the process, however that ends; where it has no locks,
/// nobody is kept out.
fn lock(file: &File, path: &Path) -> Result<(), JournalError> {
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(JournalError::Busy { file: path.to_owned() }),
        _ => Ok(()),
    }
}

/// Reads what is there.
struct Reader<'a> {
    path: &'a Path,
    lines: BufReader<&'a File>,
    /// Lines that were read.
    line: u64,
    /// Bytes of head and whole rows.
    whole: u64,
}

/// Of a line that belongs to something else so much is read, and less shown.
const LONGEST: u64 = 1 << 20;
const SHOWN: usize = 200;

impl Reader<'_> {
    /// The next line with its end, or what there is of it.
    fn next(&mut self) -> Result<Vec<u8>, JournalError> {
        let mut line = Vec::new();
        let read = self.lines.by_ref().take(LONGEST).read_until(b'\n', &mut line);
        read.map_err(|error: io::Error| JournalError::Io { file: self.path.to_owned(), error })?;
        self.line += 1;
        Ok(line)
    }

    /// Whether the head stands there whole; what was killed while it wrote the head begins anew.
    fn head(&mut self, head: &str) -> Result<bool, JournalError> {
        for wanted in head.split_inclusive('\n') {
            let found = self.next()?;
            if found != wanted.as_bytes() {
                let is_cut = !found.ends_with(b"\n") && wanted.as_bytes().starts_with(&found);
                return if is_cut { Ok(false) } else { Err(self.of_another(&found, wanted)) };
            }
        }
        self.whole = head.len() as u64;
        Ok(true)
    }

    /// How many whole rows there are.
    fn rows(
        &mut self,
        runs: u64,
        beginning: impl Fn(u64) -> String,
        mut look: impl FnMut(&[u8]),
    ) -> Result<u64, JournalError> {
        let mut rows = 0;
        loop {
            let found = self.next()?;
            if found.is_empty() {
                return Ok(rows);
            }
            if rows == runs {
                return Err(JournalError::TooLong { file: self.path.to_owned(), line: self.line });
            }
            let wanted = beginning(rows);
            let is_whole = found.ends_with(b"\n");
            let compared = found.len().min(wanted.len());
            let is_no_row =
                if is_whole { found.len() <= wanted.len() } else { found.len() as u64 == LONGEST };
            if is_no_row || found[..compared] != wanted.as_bytes()[..compared] {
                return Err(self.of_another(&found, &format!("{wanted}...")));
            }
            if !is_whole {
                return Ok(rows);
            }
            look(&found);
            self.whole += found.len() as u64;
            rows += 1;
        }
    }

    fn of_another(&self, found: &[u8], wanted: &str) -> JournalError {
        let found = String::from_utf8_lossy(found);
        if self.line == 1 && !found.contains('\r') && is_first_line(&found) && is_first_line(wanted) {
            let version = |line: &str| line["# ".len()..].trim_end().to_owned();
            return JournalError::OtherVersion {
                file: self.path.to_owned(),
                found: version(&found),
                wanted: version(wanted),
            };
        }
        let shown =
            |text: &str| text.trim_end_matches('\n').replace('\r', "\\r").chars().take(SHOWN).collect();
        JournalError::OfAnother {
            file: self.path.to_owned(),
            change: change(&found, wanted),
            line: self.line,
            found: shown(&found),
            wanted: shown(wanted),
        }
    }
}

/// What happened since the file was written, where two lines tell.
fn change(found: &str, wanted: &str) -> String {
    if found.strip_suffix("\r\n").is_some_and(|found| wanted.strip_suffix('\n') == Some(found)) {
        return "another program has ended its lines with carriage returns; ".to_owned();
    }
    let print = wanted.strip_prefix(FINGERPRINT).and_then(|print| print.split_once(':'));
    match print.filter(|(what, _)| found.starts_with(&format!("{FINGERPRINT}{what}:"))) {
        Some((what, _)) => format!("{what} changed since; "),
        None => String::new(),
    }
}

/// The line of the head with the fingerprint of an input, without its "# ".
pub(super) fn fingerprint_line(of: &str, print: &str) -> String {
    format!("{}{of}: {print}", &FINGERPRINT["# ".len()..])
}

/// The first line of the head, without its "# ". A file with another one was written by another version.
pub(super) fn first_line() -> String {
    format!("patchcord {} sweep, format {FORMAT_VERSION}", env!("CARGO_PKG_VERSION"))
}

/// What the first line of every version's sweep files looks like: "# patchcord 0.1.0 sweep".
fn is_first_line(line: &str) -> bool {
    line.strip_prefix("# patchcord ").is_some_and(|rest| rest.contains(" sweep"))
}

const FINGERPRINT: &str = "# fingerprint of ";

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    const HEAD: &str = "# a sweep\n# of k\nk,x\n";
    const WHOLE: &str = "# a sweep\n# of k\nk,x\n0,zero\n1,one\n2,two\n";

    fn row(index: u64) -> String {
        format!("{index},{}\n", ["zero", "one", "two"][index as usize])
    }

    /// What a sweep makes of a file with this text in it.
    fn gone_on(text: &str) -> Result<String, String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        fs::write(file.path(), text).unwrap();
        let journal = Journal::open(file.path(), HEAD, 3, |row| format!("{row},"), |_| ());
        let mut journal = match journal {
            Ok(journal) => journal,
            Err(error) => {
                assert_eq!(fs::read_to_string(file.path()).unwrap(), text, "it was left as it is");
                let named = file.path().display().to_string();
                return Err(error.to_string().replace(&named, "FILE"));
            }
        };
        (journal.rows..3).for_each(|index| journal.append(&row(index)).unwrap());
        Ok(fs::read_to_string(file.path()).unwrap())
    }

    #[test]
    fn cut_anywhere_it_ends_with_the_same_bytes() {
        for cut in 0..=WHOLE.len() {
            assert_eq!(gone_on(&WHOLE[..cut]).as_deref(), Ok(WHOLE), "cut at {cut}");
        }
    }

    #[test]
    fn what_is_another_table_is_left_as_it_is() {
        let cases = [
            (
                "t,x\n",
                "FILE is not the table of this sweep, and was left as it is: line 1 is \"t,x\", and this",
            ),
            ("# a sweep\n# of m\n", "FILE is not the table of this sweep, and was left as it is: line 2 is"),
            (
                "# a sweep\r\n# of k\r\n",
                "FILE is not the table of this sweep, and was left as it is: another program has ended its lines with \
                 carriage returns; line 1 is \"# a sweep\\r\", and this sweep has \"# a sweep\" there",
            ),
            ("# a sweep\n# of k\nk,x\n1,one\n", "FILE is not the table of this sweep"),
            ("# a sweep\n# of k\nk,x\n0\n", "FILE is not the table of this sweep"),
            ("# a sweep\n# of k\nk,x\n0,zero\n1,", ""),
            ("notes", "FILE is not the table of this sweep, and was left as it is: line 1 is \"notes\""),
        ];
        for (text, expected) in cases {
            match gone_on(text) {
                Ok(whole) => assert_eq!((whole.as_str(), expected), (WHOLE, "")),
                Err(error) => assert!(!expected.is_empty() && error.starts_with(expected), "{text}: {error}"),
            }
        }
        let error = gone_on(&format!("{WHOLE}3,three\n")).unwrap_err();
        assert!(error.starts_with("FILE goes on after the last row of this sweep, in line 7"), "{error}");
    }

    #[test]
    fn a_file_of_another_version_is_left_as_it_is() {
        let file = tempfile::NamedTempFile::new().unwrap();
        fs::write(file.path(), "# patchcord 0.1.0 sweep\n# patch: a.json\n").unwrap();
        let head = format!("# {}\n", first_line());
        let error = Journal::open(file.path(), &head, 3, row, |_| ()).err().unwrap().to_string();
        let expected = "was written by another version of patchcord (its first line is \"patchcord 0.1.0 sweep\", this \
             version writes \"patchcord 0.1.0 sweep, format 2\"), and was left as it is: finish it with the version that began \
             it, or give another file";
        assert!(error.ends_with(expected), "{error}");
    }

    #[test]
    fn a_folder_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        assert!(matches!(Journal::open(folder.path(), HEAD, 3, row, |_| ()), Err(JournalError::Io { .. })));
    }
}
