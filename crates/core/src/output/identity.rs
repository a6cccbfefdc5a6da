//! What identifies a file, whatever path leads to it.

use std::fs::{self, Metadata};
use std::io::{Error, Result};
use std::path::{Component, Path, PathBuf, absolute};

use super::folder_of;

/// The identity of a file that exists or will be written.
///
/// Links, `.` and `..` in a path make no difference. On Unix, two names of one existing file (hard links) make none
/// either.
///
/// # Examples
///
/// ```
/// use patchcord_core::output::FileIdentity;
///
/// let folder = tempfile::tempdir()?;
/// let identity = |name: &str| FileIdentity::of(folder.path().join(name));
/// assert!(identity("new.csv")?.is_same(&identity("./new.csv")?));
/// assert!(!identity("new.csv")?.is_same(&identity("other.csv")?));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct FileIdentity {
    /// The path without links and "..".
    path: PathBuf,
    /// The device and the number of the file on it. `None` if the file does not exist, or if the system has no numbers.
    number: Option<[u64; 2]>,
}

impl FileIdentity {
    /// The identity of the file to which a path leads. The file need not exist.
    ///
    /// # Errors
    /// If the path is empty, or if its links form a cycle.
    pub fn of(path: impl AsRef<Path>) -> Result<FileIdentity> {
        let path = path.as_ref();
        let number = fs::metadata(path).ok().as_ref().and_then(file_number);
        Ok(FileIdentity { path: destination(path)?, number })
    }

    /// Whether both are the same file.
    pub fn is_same(&self, other: &FileIdentity) -> bool {
        self.path == other.path || (self.number.is_some() && self.number == other.number)
    }

    /// The folder of the file. `None` for a root folder.
    pub fn folder(&self) -> Option<&Path> {
        self.path.parent()
    }
}

/// The device and the number of an existing file on it. `None` on systems other than Unix.
///
/// # Examples
///
/// ```
/// use patchcord_core::output::file_number;
///
/// let file = tempfile::NamedTempFile::new()?;
/// assert_eq!(file_number(&file.path().metadata()?), file_number(&file.as_file().metadata()?));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[cfg(unix)]
pub fn file_number(metadata: &Metadata) -> Option<[u64; 2]> {
    use std::os::unix::fs::MetadataExt as _;
    Some([metadata.dev(), metadata.ino()])
}

/// The device and the number of an existing file on it. `None` on systems other than Unix.
#[cfg(not(unix))]
pub fn file_number(_: &Metadata) -> Option<[u64; 2]> {
    None
}

/// The path that a path leads to after all links are followed. The file need not exist.
///
/// # Errors
/// If the path is empty, or if its links form a cycle.
pub(super) fn destination(path: &Path) -> Result<PathBuf> {
    if let Ok(existing) = fs::canonicalize(path) {
        return Ok(existing);
    }
    Ok(without_links(&absolute(follow_links(path)?)?))
}

/// A chain of more symbolic links than this counts as a cycle. Linux has the same limit.
const MAX_LINKS: usize = 40;

/// The end of a chain of symbolic links.
fn follow_links(path: &Path) -> Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        let Ok(next) = fs::read_link(&path) else { return Ok(path) };
        path = folder_of(&path).join(next);
    }
    Err(Error::other("its links form a cycle"))
}

/// An absolute path without links and "..". In the part that does not exist, ".." cancels the name before it.
fn without_links(path: &Path) -> PathBuf {
    let resolved = |folder| Some((folder, fs::canonicalize(folder).ok()?));
    let Some((existing, mut found)) = path.ancestors().find_map(resolved) else { return path.to_owned() };
    for part in path.strip_prefix(existing).into_iter().flat_map(Path::components) {
        match part {
            Component::ParentDir => {
                found.pop();
            }
            part => found.push(part),
        }
    }
    found
}
