//! Paths at which a case has no regular file that can be read: pipes, devices, folders, links and protected files.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};
use std::{fs, io};

/// A device on which nothing can be written.
pub(crate) const FULL_DEVICE: &str = "/dev/full";

/// The special files of a case, by their path in its folder.
pub(crate) type Specials = BTreeMap<String, Special>;

/// What is at a path of a case.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Special {
    /// A pipe that no process writes to.
    Pipe,
    /// An empty folder.
    Folder,
    /// A symbolic link to this path, which need not exist.
    Link(String),
    /// A file of the case that nobody may read or write. The permission is ignored for root.
    Protected,
}

impl Special {
    /// Creates it at a path. A file that is to be protected exists.
    ///
    /// # Errors
    /// If the system cannot create it.
    pub(crate) fn create(&self, path: &Path) -> io::Result<()> {
        match self {
            Special::Pipe => make_pipe(path),
            Special::Folder => fs::create_dir(path),
            Special::Link(target) => link(target, path),
            Special::Protected => protect(path),
        }
    }

    /// Whether a path still has what was created there. The bytes of a protected file are not examined.
    pub(crate) fn is_kept(&self, path: &Path) -> bool {
        let Ok(metadata) = fs::symlink_metadata(path) else { return false };
        match self {
            Special::Pipe => !metadata.is_file() && !metadata.is_dir() && !metadata.is_symlink(),
            Special::Folder => metadata.is_dir(),
            Special::Link(target) => fs::read_link(path).is_ok_and(|found| found == Path::new(target)),
            Special::Protected => metadata.is_file(),
        }
    }
}

/// Creates a pipe with a name.
fn make_pipe(path: &Path) -> io::Result<()> {
    let status = Command::new("mkfifo").arg(path).stderr(Stdio::null()).status()?;
    if status.success() { Ok(()) } else { Err(io::Error::other("mkfifo cannot create a pipe")) }
}

/// Creates a symbolic link.
#[cfg(unix)]
fn link(target: &str, path: &Path) -> io::Result<()> {
    std::os::unix::fs::symlink(target, path)
}

#[cfg(not(unix))]
fn link(_: &str, _: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Takes all permissions from a file.
#[cfg(unix)]
fn protect(path: &Path) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt as _;
    fs::set_permissions(path, fs::Permissions::from_mode(0o0))
}

#[cfg(not(unix))]
fn protect(_: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}
