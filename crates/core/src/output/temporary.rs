//! Temporary files next to outputs, and the removal of those that a killed process has left.
//!
//! The name of a temporary file is `.patchcord-PROCESS-RANDOM.tmp`, with the number of its process. While the process
//! uses the file, it holds a lock on it. A file is left over if its process does not exist and its lock is free. Both
//! are required: another machine or container that uses the folder has other processes.

use std::fs::{self, OpenOptions};
use std::io::{Error, Result};
use std::path::Path;
use std::process;

use tempfile::{Builder, NamedTempFile};

/// The beginning of the name of a temporary file.
const PREFIX: &str = ".patchcord-";
/// The end of the name of a temporary file.
const SUFFIX: &str = ".tmp";

/// Creates a temporary file in a folder. The file is removed when it is dropped.
///
/// # Errors
/// The kind of the system's error. Its message would name the temporary file, which the user does not know.
pub(super) fn create(folder: &Path) -> Result<NamedTempFile> {
    let prefix = format!("{PREFIX}{}-", process::id());
    let mut builder = Builder::new();
    builder.prefix(&prefix).suffix(SUFFIX);
    set_usual_mode(&mut builder);
    let file = builder.tempfile_in(folder).map_err(|error| Error::from(error.kind()))?;
    // A file system without locks never gives one to `is_unlocked` either, so nothing is removed there.
    let _ = file.as_file().try_lock();
    Ok(file)
}

/// Gives the file the usual mode of a new file. By default, the library makes it private to the owner.
#[cfg(unix)]
fn set_usual_mode(builder: &mut Builder<'_, '_>) {
    use std::os::unix::fs::PermissionsExt as _;
    builder.permissions(fs::Permissions::from_mode(0o666));
}

#[cfg(not(unix))]
fn set_usual_mode(_: &mut Builder<'_, '_>) {}

/// Removes the temporary files in a folder whose processes no longer exist.
///
/// Files that cannot be removed stay, without an error: they do no harm.
///
/// # Examples
///
/// ```
/// use patchcord_core::output::remove_leftovers;
///
/// let folder = tempfile::tempdir()?;
/// std::fs::write(folder.path().join("results.csv"), "t,x\n")?;
/// remove_leftovers(folder.path());
/// assert!(folder.path().join("results.csv").exists());
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn remove_leftovers(folder: impl AsRef<Path>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for path in entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|path| is_leftover(path)) {
        let _ = fs::remove_file(path);
    }
}

/// Whether a file is a temporary file that no process uses.
fn is_leftover(path: &Path) -> bool {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let is_file = || fs::symlink_metadata(path).is_ok_and(|metadata| metadata.is_file());
    process_of(name).is_some_and(|process| !is_running(process) && is_file() && is_unlocked(path))
}

/// The number of the process in the name of a temporary file. `None` for other names.
fn process_of(name: &str) -> Option<u32> {
    let (process, _random) = name.strip_prefix(PREFIX)?.strip_suffix(SUFFIX)?.split_once('-')?;
    process.parse().ok()
}

/// Whether a process with this number exists. On systems other than Linux, only this process is known to exist.
fn is_running(process: u32) -> bool {
    process == process::id() || Path::new("/proc").join(process.to_string()).exists()
}

/// Whether no process holds a lock on a file. False if that cannot be determined.
fn is_unlocked(path: &Path) -> bool {
    OpenOptions::new().write(true).open(path).is_ok_and(|file| file.try_lock().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A number that no process has: it is above the largest that Linux permits.
    const NO_PROCESS: u32 = 4_194_305;

    #[test]
    fn only_files_of_processes_that_no_longer_exist_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let [own, left, locked] = [process::id(), NO_PROCESS, NO_PROCESS + 1]
            .map(|process| path(&format!("{PREFIX}{process}-abc123{SUFFIX}")));
        let others = [".patchcord-notes.tmp", ".patchcord-4194305-abc123", "4194305-abc123.tmp"].map(path);
        for file in [&own, &left, &locked].into_iter().chain(&others) {
            fs::write(file, "x").unwrap();
        }
        let in_use = fs::File::open(&locked).unwrap();
        in_use.lock().unwrap();
        remove_leftovers(folder.path());
        assert!(!left.exists());
        assert!([&own, &locked].into_iter().chain(&others).all(|file| file.exists()));
        drop(in_use);
        remove_leftovers(folder.path());
        assert!(!locked.exists() && own.exists());
    }

    #[test]
    fn a_temporary_file_is_recognised_while_it_exists() {
        let folder = tempfile::tempdir().unwrap();
        let file = create(folder.path()).unwrap();
        let name = file.path().file_name().unwrap().to_str().unwrap();
        assert_eq!(process_of(name), Some(process::id()), "{name}");
        assert!(!is_unlocked(file.path()));
        remove_leftovers(folder.path());
        assert!(file.path().exists());
    }
}
