//! Writes output files so that no reader sees a file half written.
//!
//! A file is first written under a temporary name in the same folder and flushed to disk. Then it is renamed to its
//! final name, which replaces an older file in one step. If anything fails, the older file stays as it was.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Error, ErrorKind, Result, Write as _};
use std::path::{Path, PathBuf};

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
    check_writable(path)?;
    match fs::metadata(path) {
        Ok(_) if path == Path::new("/dev/stdout") => {
            // If standard output is redirected to a file, a second handle would overwrite it from the beginning.
            let mut out = io::stdout().lock();
            out.write_all(bytes).and_then(|()| out.flush())
        }
        Ok(metadata) if is_replaced(path, &metadata) => {
            replace(&fs::canonicalize(path)?, bytes, Some(metadata.permissions()))
        }
        Ok(_) => OpenOptions::new().append(true).open(path)?.write_all(bytes),
        Err(_) => replace(&destination(path)?, bytes, None),
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
    write_temporary(folder_of(path), bytes, None)?.persist_noclobber(path)?;
    Ok(())
}

/// Checks whether a file can be written, as far as that is known before writing.
///
/// # Errors
/// If the folder does not exist, if the path is a folder, or if the file is write-protected.
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
    let path = path.as_ref();
    match fs::metadata(path) {
        Ok(metadata) if metadata.is_dir() => Err(Error::new(ErrorKind::IsADirectory, "it is a folder")),
        // Renaming does not check the permissions of the file that it replaces.
        Ok(metadata) if is_replaced(path, &metadata) => check_permitted(path, &metadata),
        Ok(_) => Ok(()),
        Err(error) if error.kind() == ErrorKind::NotFound => check_folder(&destination(path)?),
        Err(error) => Err(error),
    }
}

/// Checks whether files can be created in a folder, by creating a temporary file and deleting it.
///
/// # Errors
/// If the system reports an error.
pub fn check_folder_writable(folder: impl AsRef<Path>) -> Result<()> {
    create_temporary(folder.as_ref()).map(drop).map_err(|error| Error::from(error.kind()))
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

/// Reports an error if the folder of a path does not exist.
fn check_folder(target: &Path) -> Result<()> {
    if folder_of(target).is_dir() { Ok(()) } else { Err(Error::new(ErrorKind::NotFound, "no such folder")) }
}

/// The path that a path leads to after all links are followed. The file need not exist. Two paths to the same file
/// have the same destination.
///
/// # Errors
/// If the path is empty, or if its links form a cycle.
///
/// # Examples
///
/// ```
/// use patchcord_core::output::destination;
///
/// let folder = tempfile::tempdir()?;
/// let [plain, dotted] = ["new.csv", "./new.csv"].map(|name| destination(folder.path().join(name)));
/// assert_eq!(plain?, dotted?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn destination(path: impl AsRef<Path>) -> Result<PathBuf> {
    let path = path.as_ref();
    if let Ok(existing) = fs::canonicalize(path) {
        return Ok(existing);
    }
    let target = follow_links(path)?;
    let Some(name) = target.file_name() else { return std::path::absolute(target) };
    match fs::canonicalize(folder_of(&target)) {
        Ok(folder) => Ok(folder.join(name)),
        Err(_) => std::path::absolute(target),
    }
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

/// The folder that contains a path; "." for a bare file name.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Whether the path is replaced by a new file. Devices and the streams of this process are not, even if they are
/// redirected to a regular file.
fn is_replaced(path: &Path, metadata: &fs::Metadata) -> bool {
    metadata.is_file() && !["/dev", "/proc"].iter().any(|folder| path.starts_with(folder))
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

/// Replaces or creates a file by renaming a temporary one.
fn replace(target: &Path, bytes: &[u8], permissions: Option<fs::Permissions>) -> Result<()> {
    write_temporary(folder_of(target), bytes, permissions)?.persist(target)?;
    Ok(())
}

/// A temporary file in a folder with these bytes, flushed to disk.
fn write_temporary(
    folder: &Path,
    bytes: &[u8],
    permissions: Option<fs::Permissions>,
) -> Result<tempfile::NamedTempFile> {
    // Only the kind of the error is kept: its message names the temporary file, which the user does not know.
    let temporary = create_temporary(folder).map_err(|error| Error::from(error.kind()))?;
    let mut file: &File = temporary.as_file();
    file.write_all(bytes)?;
    if let Some(permissions) = permissions {
        file.set_permissions(permissions)?;
    }
    file.sync_all()?;
    Ok(temporary)
}

/// A temporary file with the usual mode of a new file. By default, the library makes it private to the owner.
#[cfg(unix)]
fn create_temporary(folder: &Path) -> Result<tempfile::NamedTempFile> {
    use std::os::unix::fs::PermissionsExt as _;
    tempfile::Builder::new().permissions(fs::Permissions::from_mode(0o666)).tempfile_in(folder)
}

#[cfg(not(unix))]
fn create_temporary(folder: &Path) -> Result<tempfile::NamedTempFile> {
    tempfile::NamedTempFile::new_in(folder)
}

#[cfg(test)]
mod tests;
