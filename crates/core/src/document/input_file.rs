//! Opens the files that are read. Every named input is a regular file, whether a document or a table. The size of every
//! input is limited, also that of standard input, which need not be a file.
//!
//! A device or a pipe may have no end, and reading it may wait for ever. The system makes the files of `/proc` and
//! `/sys` while they are read. They have the same faults, although they look like regular files of length 0.

use std::fs::{self, File, FileType};
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// Folders whose files the system makes while they are read.
const SYSTEM_FOLDERS: [&str; 2] = ["/proc", "/sys"];

/// A reader of at most a number of bytes. Reading fails after them.
#[derive(Debug)]
pub(super) struct LimitedReader<R> {
    /// The reader of all bytes.
    reader: R,
    /// The largest number of bytes that may be read.
    limit: u64,
    /// Number of bytes that may still be read.
    remaining: u64,
}

impl<R> LimitedReader<R> {
    /// A reader of at most `limit` bytes of another reader.
    pub(super) fn new(reader: R, limit: u64) -> Self {
        LimitedReader { reader, limit, remaining: limit }
    }
}

impl<R: Read> Read for LimitedReader<R> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        let count = self.reader.read(buffer)?;
        self.remaining = self.remaining.checked_sub(count as u64).ok_or_else(|| too_large(self.limit))?;
        Ok(count)
    }
}

/// An open regular file. Reading fails after a limit of bytes, even if the file grows.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::InputFile;
///
/// let error = InputFile::open(".", 1_000_000).unwrap_err();
/// assert_eq!(error.to_string(), "it is a folder");
/// ```
#[derive(Debug)]
pub struct InputFile {
    /// The open file.
    file: LimitedReader<File>,
}

impl InputFile {
    /// Opens a regular file of at most `limit` bytes. Symbolic links are followed.
    ///
    /// # Errors
    /// The error of the file system. It has the kind `IsADirectory` for a folder, `InvalidInput` for another file that
    /// is not regular, and `FileTooLarge` for a file above the limit.
    pub fn open(path: impl AsRef<Path>, limit: u64) -> Result<InputFile> {
        let path = path.as_ref();
        let metadata = fs::metadata(path)?;
        check_regular(path, metadata.file_type())?;
        if metadata.len() > limit {
            return Err(too_large(limit));
        }
        Ok(InputFile { file: LimitedReader::new(File::open(path)?, limit) })
    }
}

impl Read for InputFile {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        self.file.read(buffer)
    }
}

/// Reports an error if a path is not that of a regular file.
fn check_regular(path: &Path, file_type: FileType) -> Result<()> {
    if file_type.is_dir() {
        return Err(Error::new(ErrorKind::IsADirectory, "it is a folder"));
    }
    if !file_type.is_file() {
        let message = format!("it is {}, not a regular file", noun(file_type));
        return Err(Error::new(ErrorKind::InvalidInput, message));
    }
    let is_of_system =
        |path: &Path| SYSTEM_FOLDERS.iter().any(|system_folder| path.starts_with(system_folder));
    if fs::canonicalize(path).is_ok_and(|path| is_of_system(&path)) {
        return Err(Error::new(ErrorKind::InvalidInput, "it is a file of the system, not a regular file"));
    }
    Ok(())
}

/// The kind of a file that is neither regular nor a folder.
#[cfg(unix)]
fn noun(file_type: FileType) -> &'static str {
    use std::os::unix::fs::FileTypeExt as _;
    if file_type.is_fifo() {
        "a pipe"
    } else if file_type.is_socket() {
        "a socket"
    } else {
        "a device"
    }
}

#[cfg(not(unix))]
fn noun(_file_type: FileType) -> &'static str {
    "a device"
}

/// The error for a file above a limit of bytes.
fn too_large(limit: u64) -> Error {
    Error::new(ErrorKind::FileTooLarge, format!("it has more than {} MB", limit / 1_000_000))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write as _;

    fn error(path: impl AsRef<Path>) -> String {
        InputFile::open(path, 1_000_000).unwrap_err().to_string()
    }

    #[test]
    fn a_file_at_the_limit_is_read_and_a_larger_one_is_refused() {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(&[b' '; 1_000_000]).unwrap();
        let mut bytes = Vec::new();
        InputFile::open(file.path(), 1_000_000).unwrap().read_to_end(&mut bytes).unwrap();
        assert_eq!(bytes.len(), 1_000_000);
        file.write_all(b" ").unwrap();
        assert_eq!(error(file.path()), "it has more than 1 MB");
    }

    #[test]
    fn the_limit_holds_for_a_file_that_grows_after_it_was_opened() {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        let mut opened = InputFile::open(file.path(), 1_000_000).unwrap();
        file.write_all(&[b' '; 1_000_001]).unwrap();
        let error = opened.read_to_end(&mut Vec::new()).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::FileTooLarge, "{error}");
    }

    #[test]
    fn a_missing_file_and_a_folder_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(error(folder.path()), "it is a folder");
        let missing = InputFile::open(folder.path().join("no.csv"), 1).unwrap_err();
        assert_eq!(missing.kind(), ErrorKind::NotFound);
    }

    #[cfg(unix)]
    #[test]
    fn pipes_and_links_to_devices_are_refused_without_waiting() {
        let folder = tempfile::tempdir().unwrap();
        let [pipe, link] = ["pipe", "link"].map(|name| folder.path().join(name));
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        std::os::unix::fs::symlink("/dev/zero", &link).unwrap();
        assert_eq!(error(pipe), "it is a pipe, not a regular file");
        assert_eq!(error(link), "it is a device, not a regular file");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn files_of_the_system_are_refused() {
        assert_eq!(error("/proc/self/pagemap"), "it is a file of the system, not a regular file");
    }
}
