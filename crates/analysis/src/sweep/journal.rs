//! The CSV file of a sweep. Rows are appended, so an interrupted sweep can be continued.
//!
//! Other files are written to a temporary name and renamed. This file grows in place, because hours of results must
//! survive the end of the process. Its head of comment lines and column names identifies the sweep exactly. When the
//! file is opened again, it must contain this head, complete rows of this sweep, and at most one incomplete row. The
//! incomplete row is removed, so the completed file is identical to that of an uninterrupted sweep.
//!
//! Before each row is appended, the file must still be the one that was opened, with the size of what was written. So
//! no row is lost in a deleted file or added to a file that another program has changed.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, BufRead, BufReader, ErrorKind, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use super::error::JournalError;
use super::fingerprint::FORMAT_VERSION;
use patchcord_core::output::file_number;

/// An open sweep file, locked for other sweeps.
pub(super) struct Journal {
    /// Path of the file, for error messages.
    path: PathBuf,
    /// The open file. New rows are appended at its end.
    file: File,
    /// The number of complete rows in the file.
    pub rows: u64,
    /// Size of the file, in bytes. None for a pipe or a device, which has no size.
    size: Option<u64>,
}

impl Journal {
    /// Opens a sweep file, or creates it. An existing file must have this head and at most `runs` rows. Row n must
    /// start with `beginning(n)`. Each existing row is passed to `inspect`, whose error says what is wrong with it. The
    /// file stays locked until it is closed.
    ///
    /// # Errors
    /// If the file cannot be opened, is locked, or is not the beginning of this sweep. It is then unchanged.
    pub(super) fn open(
        path: &Path,
        head: &str,
        runs: u64,
        beginning: impl Fn(u64) -> String,
        inspect: impl FnMut(&[u8]) -> Result<(), String>,
    ) -> Result<Journal, JournalError> {
        let io_error = |error| JournalError::Io { file: path.to_owned(), error };
        if path.metadata().is_ok_and(|existing| !existing.is_file()) {
            // A pipe or a device has no existing content.
            let file = OpenOptions::new().write(true).open(path).map_err(io_error)?;
            let mut journal = Journal { path: path.to_owned(), file, rows: 0, size: None };
            journal.append(head)?;
            return Ok(journal);
        }
        let file = open(path).map_err(io_error)?;
        lock(&file, path)?;
        let mut reader = Reader { path, lines: BufReader::new(&file), line: 0, whole: 0 };
        let rows = if reader.head(head)? { reader.rows(runs, beginning, inspect)? } else { 0 };
        let whole = reader.whole;
        if file.metadata().map_err(io_error)?.len() != whole {
            file.set_len(whole).map_err(io_error)?;
        }
        let mut journal = Journal { path: path.to_owned(), file, rows, size: Some(whole) };
        journal.file.seek(SeekFrom::End(0)).map_err(io_error)?;
        if whole == 0 {
            journal.append(head)?;
        }
        Ok(journal)
    }

    /// Appends complete rows.
    ///
    /// # Errors
    /// If the file cannot be written, for example because the disk is full, or if others have changed it.
    pub(super) fn append(&mut self, text: &str) -> Result<(), JournalError> {
        self.check_unchanged()?;
        let written = self.file.write_all(text.as_bytes());
        written.map_err(|error| JournalError::Io { file: self.path.clone(), error })?;
        self.size = self.size.map(|size| size + text.len() as u64);
        Ok(())
    }

    /// Checks that the path still leads to this file, and that the file has the size of what was written.
    ///
    /// # Errors
    /// If the file was deleted, replaced or changed by others.
    pub(super) fn check_unchanged(&self) -> Result<(), JournalError> {
        let Some(expected) = self.size else { return Ok(()) };
        let file = self.path.clone();
        let [at_path, own] = match (self.path.metadata(), self.file.metadata()) {
            (Ok(at_path), Ok(own)) => [at_path, own],
            (Err(error), _) if error.kind() == ErrorKind::NotFound => {
                return Err(JournalError::Removed { file });
            }
            (Err(error), _) | (_, Err(error)) => return Err(JournalError::Io { file, error }),
        };
        if file_number(&at_path) != file_number(&own) {
            return Err(JournalError::Replaced { file });
        }
        match own.len() {
            found if found != expected => Err(JournalError::Resized { file, found, expected }),
            _ => Ok(()),
        }
    }
}

/// Opens or creates a sweep file for reading and appending. Windows cannot shorten a file that is open for appending,
/// so it is opened for writing there.
fn open(path: &Path) -> io::Result<File> {
    let mut options = OpenOptions::new();
    options.read(true).write(true).append(cfg!(unix)).create(true).truncate(false);
    options.open(path)
}

/// Locks the file against other sweeps. The operating system releases the lock when the process ends. A system without
/// locks gives no protection.
fn lock(file: &File, path: &Path) -> Result<(), JournalError> {
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(JournalError::Busy { file: path.to_owned() }),
        _ => Ok(()),
    }
}

/// Reads and checks the existing content.
struct Reader<'a> {
    /// Path of the file, for error messages.
    path: &'a Path,
    /// The content of the file.
    lines: BufReader<&'a File>,
    /// The number of lines read so far.
    line: u64,
    /// Size of the head and all complete rows, in bytes.
    whole: u64,
}

/// The longest line that is read, in bytes. A longer line is no row.
const MAX_LINE: u64 = 1 << 20;
/// The longest text of a line in an error message, in characters.
const MAX_SHOWN: usize = 200;

impl Reader<'_> {
    /// The next line with its line end. It is incomplete at the end of the file, and empty after it.
    fn next(&mut self) -> Result<Vec<u8>, JournalError> {
        let mut line = Vec::new();
        let read = self.lines.by_ref().take(MAX_LINE).read_until(b'\n', &mut line);
        read.map_err(|error: io::Error| JournalError::Io { file: self.path.to_owned(), error })?;
        self.line += 1;
        Ok(line)
    }

    /// Whether the file has the complete head. False if only the beginning of the head was written: then start again.
    fn head(&mut self, head: &str) -> Result<bool, JournalError> {
        for wanted in head.split_inclusive('\n') {
            let found = self.next()?;
            if found != wanted.as_bytes() {
                let is_cut = !found.ends_with(b"\n") && wanted.as_bytes().starts_with(&found);
                return if is_cut { Ok(false) } else { Err(self.mismatch(&found, wanted)) };
            }
        }
        self.whole = head.len() as u64;
        Ok(true)
    }

    /// The number of complete rows.
    fn rows(
        &mut self,
        runs: u64,
        beginning: impl Fn(u64) -> String,
        mut inspect: impl FnMut(&[u8]) -> Result<(), String>,
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
                if is_whole { found.len() <= wanted.len() } else { found.len() as u64 == MAX_LINE };
            if is_no_row || found[..compared] != wanted.as_bytes()[..compared] {
                return Err(self.mismatch(&found, &format!("{wanted}...")));
            }
            if !is_whole {
                return Ok(rows);
            }
            inspect(&found).map_err(|reason| JournalError::BadRow {
                file: self.path.to_owned(),
                line: self.line,
                reason,
            })?;
            self.whole += found.len() as u64;
            rows += 1;
        }
    }

    /// The error for a line that does not belong to this sweep.
    fn mismatch(&self, found: &[u8], wanted: &str) -> JournalError {
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
            |text: &str| text.trim_end_matches('\n').replace('\r', "\\r").chars().take(MAX_SHOWN).collect();
        JournalError::OtherSweep {
            file: self.path.to_owned(),
            change: change(&found, wanted),
            line: self.line,
            found: shown(&found),
            wanted: shown(wanted),
        }
    }
}

/// The change since the file was written, if the two lines show it. Ends in "; ", or is empty.
fn change(found: &str, wanted: &str) -> String {
    if found.strip_suffix("\r\n").is_some_and(|found| wanted.strip_suffix('\n') == Some(found)) {
        return "its line ends were changed to carriage returns; ".to_owned();
    }
    let fingerprint = wanted.strip_prefix(FINGERPRINT).and_then(|rest| rest.split_once(':'));
    match fingerprint.filter(|(what, _)| found.starts_with(&format!("{FINGERPRINT}{what}:"))) {
        Some((what, _)) => format!("{what} changed after the file was started; "),
        None => String::new(),
    }
}

/// The head line with the fingerprint of an input, without the leading "# ".
pub(super) fn fingerprint_line(of: &str, fingerprint: &str) -> String {
    format!("{}{of}: {fingerprint}", &FINGERPRINT["# ".len()..])
}

/// The first head line, without the leading "# ". It contains the version of the program and of the file format.
pub(super) fn first_line() -> String {
    format!("patchcord {} sweep, format {FORMAT_VERSION}", env!("CARGO_PKG_VERSION"))
}

/// Whether a line looks like the first line of a sweep file of any version: "# patchcord 0.1.0 sweep".
fn is_first_line(line: &str) -> bool {
    line.strip_prefix("# patchcord ").is_some_and(|rest| rest.contains(" sweep"))
}

/// The start of a fingerprint line.
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

    /// Continues a sweep whose file has this text, and returns the final text or the error.
    fn continued(text: &str) -> Result<String, String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        fs::write(file.path(), text).unwrap();
        let journal = Journal::open(file.path(), HEAD, 3, |row| format!("{row},"), |_| Ok(()));
        let mut journal = match journal {
            Ok(journal) => journal,
            Err(error) => {
                assert_eq!(fs::read_to_string(file.path()).unwrap(), text, "the file is unchanged");
                let named = file.path().display().to_string();
                return Err(error.to_string().replace(&named, "FILE"));
            }
        };
        (journal.rows..3).for_each(|index| journal.append(&row(index)).unwrap());
        Ok(fs::read_to_string(file.path()).unwrap())
    }

    #[test]
    fn a_file_cut_anywhere_is_completed_to_the_same_bytes() {
        for cut in 0..=WHOLE.len() {
            assert_eq!(continued(&WHOLE[..cut]).as_deref(), Ok(WHOLE), "cut at {cut}");
        }
    }

    #[test]
    fn another_file_is_left_unchanged() {
        let cases = [
            ("t,x\n", "FILE does not belong to this sweep: line 1 is \"t,x\", expected \"# a sweep\""),
            ("# a sweep\n# of m\n", "FILE does not belong to this sweep: line 2 is"),
            (
                "# a sweep\r\n# of k\r\n",
                "FILE does not belong to this sweep: its line ends were changed to carriage returns; line 1 is \
                 \"# a sweep\\r\", expected \"# a sweep\"; the file is unchanged",
            ),
            ("# a sweep\n# of k\nk,x\n1,one\n", "FILE does not belong to this sweep"),
            ("# a sweep\n# of k\nk,x\n0\n", "FILE does not belong to this sweep"),
            ("# a sweep\n# of k\nk,x\n0,zero\n1,", ""),
            ("notes", "FILE does not belong to this sweep: line 1 is \"notes\""),
        ];
        for (text, expected) in cases {
            match continued(text) {
                Ok(whole) => assert_eq!((whole.as_str(), expected), (WHOLE, "")),
                Err(error) => assert!(!expected.is_empty() && error.starts_with(expected), "{text}: {error}"),
            }
        }
        let error = continued(&format!("{WHOLE}3,three\n")).unwrap_err();
        assert!(error.starts_with("FILE continues after the last row of this sweep, in line 7"), "{error}");
    }

    #[test]
    fn a_file_of_another_version_is_left_unchanged() {
        let file = tempfile::NamedTempFile::new().unwrap();
        fs::write(file.path(), "# patchcord 0.1.0 sweep\n# patch: a.json\n").unwrap();
        let head = format!("# {}\n", first_line());
        let error = Journal::open(file.path(), &head, 3, row, |_| Ok(())).err().unwrap().to_string();
        let expected = "was written by another version of patchcord (its first line is \"patchcord 0.1.0 sweep\", this \
             version writes \"patchcord 0.1.0 sweep, format 3\"); the file is unchanged: complete it with the version \
             that started it, or specify another file";
        assert!(error.ends_with(expected), "{error}");
    }

    #[test]
    fn a_folder_returns_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let opened = Journal::open(folder.path(), HEAD, 3, row, |_| Ok(()));
        assert!(matches!(opened, Err(JournalError::Io { .. })));
    }
}
