//! Writes output files so that no reader sees a file half written.
//!
//! A file is first written under a temporary name in the same folder and flushed to disk. Then it is renamed to its
//! final name, which replaces an older file in one step. If anything fails, the older file stays as it was. Several
//! files can be staged under temporary names before the first one is renamed.
//!
//! `identity` decides whether two paths lead to one file. `pending` has files that are written in parts. `temporary`
//! names temporary files, and removes those that a killed process has left.

mod identity;
mod pending;
mod temporary;

pub use identity::{FileIdentity, file_number};
pub use pending::PendingFile;
pub use temporary::remove_leftovers;

use std::fs::{self, File, OpenOptions, Permissions};
use std::io::{self, Error, ErrorKind, Read, Result, Write as _};
use std::path::{Path, PathBuf};

use identity::destination;
use tempfile::NamedTempFile;

/// Writes a file completely or not at all.
///
/// The bytes go to a temporary file in the same folder, which is then renamed. Symbolic links are followed, and a
/// replaced file keeps its mode. A path that is not a regular file, such as a device or a pipe, is opened and written
/// directly.
///
/// # Errors
/// If the file system reports an error, or if the file is read-only. An existing file is then unchanged.
///
/// # Examples
///
/// ```
/// use patchcord_core::output::write_atomic;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("trace.csv");
/// write_atomic(&path, b"t,x\n")?;
/// write_atomic(&path, b"t,y\n")?;
/// assert_eq!(std::fs::read(&path)?, b"t,y\n");
/// let error = write_atomic("no/such/folder/trace.csv", b"").unwrap_err();
/// assert_eq!(error.to_string(), "no such folder");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_atomic(path: impl AsRef<Path>, bytes: &[u8]) -> Result<()> {
    let path = path.as_ref();
    match target_of(path)? {
        Target::StandardOutput => copy_to_standard_output(bytes),
        Target::Stream => copy_to_stream(path, bytes),
        Target::File { path, permissions } => staged(path, permissions, bytes)?.commit(),
    }
}

/// A file that is written completely under a temporary name, and waits for its final name.
///
/// If it is dropped without [`commit`](StagedFile::commit), it is removed.
#[derive(Debug)]
pub struct StagedFile {
    /// The file under its temporary name.
    temporary: NamedTempFile,
    /// The final path, without links.
    path: PathBuf,
}

impl StagedFile {
    /// An empty file next to its final path. `permissions` are those of the file that it replaces.
    fn new(path: PathBuf, permissions: Option<Permissions>) -> Result<StagedFile> {
        let temporary = temporary::create(folder_of(&path))?;
        if let Some(permissions) = permissions {
            temporary.as_file().set_permissions(permissions)?;
        }
        Ok(StagedFile { temporary, path })
    }

    /// Renames the file to its final name. An existing file is replaced in one step.
    ///
    /// # Errors
    /// If the file system reports an error.
    pub fn commit(self) -> Result<()> {
        self.temporary.persist(&self.path)?;
        Ok(())
    }
}

/// Writes a file under a temporary name. [`StagedFile::commit`] gives it its final name.
///
/// If all files of a set are staged before the first one is renamed, only an interruption between two renamings can
/// leave a part of the set.
///
/// # Errors
/// If the file system reports an error, if the file is read-only, or if the path is a pipe or a device.
///
/// # Examples
///
/// ```
/// use patchcord_core::output::stage;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("trace.csv");
/// let staged = stage(&path, b"t,x\n")?;
/// assert!(!path.exists());
/// staged.commit()?;
/// assert_eq!(std::fs::read(&path)?, b"t,x\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn stage(path: impl AsRef<Path>, bytes: &[u8]) -> Result<StagedFile> {
    match target_of(path.as_ref())? {
        Target::File { path, permissions } => staged(path, permissions, bytes),
        Target::StandardOutput | Target::Stream => Err(Error::other("it is a pipe or a device")),
    }
}

/// Writes a new file completely or not at all. It never replaces an existing file.
///
/// # Errors
/// [`ErrorKind::AlreadyExists`] if the path exists, even as a link that leads nowhere. Otherwise the error of the file
/// system.
///
/// # Examples
///
/// ```
/// use patchcord_core::output::write_new;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("patch.json");
/// write_new(&path, b"{}")?;
/// assert_eq!(write_new(&path, b"[]").unwrap_err().kind(), std::io::ErrorKind::AlreadyExists);
/// assert_eq!(std::fs::read(&path)?, b"{}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_new(path: impl AsRef<Path>, bytes: &[u8]) -> Result<()> {
    let path = path.as_ref();
    check_folder(path)?;
    staged(path.to_owned(), None, bytes)?.temporary.persist_noclobber(path)?;
    Ok(())
}

/// Checks whether [`write_atomic`] can write a file, as far as that is known before writing.
///
/// Whether the folder permits new files is tested with a temporary file.
///
/// # Errors
/// If the folder does not exist or is write-protected, if the path is a folder, or if the file is write-protected.
///
/// # Examples
///
/// ```
/// use patchcord_core::output::check_writable;
///
/// let error = check_writable("no/such/folder/trace.csv").unwrap_err();
/// assert_eq!(error.to_string(), "no such folder");
/// ```
pub fn check_writable(path: impl AsRef<Path>) -> Result<()> {
    match target_of(path.as_ref())? {
        Target::File { path, .. } => check_folder_writable(folder_of(&path)),
        Target::StandardOutput | Target::Stream => Ok(()),
    }
}

/// Checks whether lines can be appended to a file, as far as that is known before writing.
///
/// The folder of an existing file may be write-protected.
///
/// # Errors
/// If the path is a folder, if the file is write-protected, or if the file does not exist and cannot be created.
///
/// # Examples
///
/// ```
/// use patchcord_core::output::check_appendable;
///
/// let file = tempfile::NamedTempFile::new()?;
/// assert!(check_appendable(file.path()).is_ok());
/// assert!(check_appendable("no/such/folder/rows.csv").is_err());
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn check_appendable(path: impl AsRef<Path>) -> Result<()> {
    match target_of(path.as_ref())? {
        Target::File { path, permissions: None } => check_folder_writable(folder_of(&path)),
        _ => Ok(()),
    }
}

/// Checks whether files can be created in a folder, by creating a temporary file and deleting it.
///
/// # Errors
/// If the system reports an error.
pub fn check_folder_writable(folder: impl AsRef<Path>) -> Result<()> {
    temporary::create(folder.as_ref()).map(drop)
}

/// The system's description of an error, without the error number.
///
/// # Examples
///
/// ```
/// use patchcord_core::output::io_reason;
///
/// let error = std::io::Error::other("broken pipe (os error 32)");
/// assert_eq!(io_reason(&error), "broken pipe");
/// ```
pub fn io_reason(error: &Error) -> String {
    let text = error.to_string();
    text.split(" (os error ").next().unwrap_or_default().to_owned()
}

/// How a path is written.
enum Target {
    /// To the standard output of this process.
    StandardOutput,
    /// Directly, because it is a pipe or a device.
    Stream,
    /// By renaming a temporary file.
    File {
        /// The final path, without links.
        path: PathBuf,
        /// The permissions of the file that is replaced. `None` if the file is new.
        permissions: Option<Permissions>,
    },
}

/// How a path is written, after the checks that do not need a temporary file.
fn target_of(path: &Path) -> Result<Target> {
    if path == Path::new(STANDARD_OUTPUT) {
        return Ok(Target::StandardOutput);
    }
    let metadata = match fs::metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return new_target(path),
        found => found?,
    };
    if metadata.is_dir() {
        return Err(Error::new(ErrorKind::IsADirectory, "it is a folder"));
    }
    if !is_replaced(path, &metadata) {
        return Ok(Target::Stream);
    }
    // Renaming does not check the permissions of the file that it replaces.
    check_permitted(path, &metadata)?;
    Ok(Target::File { path: fs::canonicalize(path)?, permissions: Some(metadata.permissions()) })
}

/// The target of a file that does not exist.
fn new_target(path: &Path) -> Result<Target> {
    let path = destination(path)?;
    check_folder(&path)?;
    Ok(Target::File { path, permissions: None })
}

/// Reports an error if the folder of a path does not exist.
fn check_folder(target: &Path) -> Result<()> {
    if folder_of(target).is_dir() { Ok(()) } else { Err(Error::new(ErrorKind::NotFound, "no such folder")) }
}

/// The folder that contains a path; "." for a bare file name.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The path of the standard output of this process, on every system.
pub const STANDARD_OUTPUT: &str = "/dev/stdout";

/// The streams of a process, by their paths.
const STREAMS: [&str; 5] = ["/dev/fd", "/dev/stdin", STANDARD_OUTPUT, "/dev/stderr", "/proc"];

/// Whether the path is replaced by a new file. Devices and the streams of this process are not, even if they are
/// redirected to a regular file.
fn is_replaced(path: &Path, metadata: &fs::Metadata) -> bool {
    metadata.is_file() && !STREAMS.iter().any(|stream| path.starts_with(stream))
}

/// Reports an error if an existing file is write-protected.
fn check_permitted(path: &Path, metadata: &fs::Metadata) -> Result<()> {
    if is_read_only(metadata) {
        return Err(Error::new(ErrorKind::PermissionDenied, "it is read-only"));
    }
    OpenOptions::new().write(true).open(path).map(drop)
}

/// Whether the owner may not write. The mode is tested because root can open any file for writing.
#[cfg(unix)]
fn is_read_only(metadata: &fs::Metadata) -> bool {
    use std::os::unix::fs::PermissionsExt as _;
    metadata.permissions().mode() & 0o200 == 0
}

#[cfg(not(unix))]
fn is_read_only(metadata: &fs::Metadata) -> bool {
    metadata.permissions().readonly()
}

/// A temporary file with these bytes next to its final path, flushed to disk.
fn staged(path: PathBuf, permissions: Option<Permissions>, bytes: &[u8]) -> Result<StagedFile> {
    let staged = StagedFile::new(path, permissions)?;
    let mut file: &File = staged.temporary.as_file();
    file.write_all(bytes)?;
    file.sync_all()?;
    Ok(staged)
}

/// Copies bytes to the standard output of this process.
fn copy_to_standard_output(mut bytes: impl Read) -> Result<()> {
    // If standard output is redirected to a file, a second handle would overwrite it from the beginning.
    let mut out = io::stdout().lock();
    io::copy(&mut bytes, &mut out)?;
    out.flush()
}

/// Copies bytes to a pipe or a device.
fn copy_to_stream(path: &Path, mut bytes: impl Read) -> Result<()> {
    let mut stream = OpenOptions::new().append(true).open(path)?;
    io::copy(&mut bytes, &mut stream).map(drop)
}

#[cfg(test)]
mod tests;
