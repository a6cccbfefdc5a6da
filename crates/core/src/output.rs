//! Files written so that nobody ever sees them half written.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Error, ErrorKind, Result, Write as _};
use std::path::{Path, PathBuf};

/// Writes a file whole: beside its place first, then renamed, so that what stood there before is replaced at
/// once or not at all. Symbolic links are followed, and a file that is replaced keeps its mode. What is no
/// regular file (a device, a pipe) is written into.
///
/// # Errors
/// When the file system refuses, or the file is read-only; a file that was there is then as it was.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    check_writable(path)?;
    match fs::metadata(path) {
        Ok(_) if path == Path::new("/dev/stdout") => {
            // Opened anew, a file behind it would be written from its beginning by whoever writes next.
            let mut out = io::stdout().lock();
            out.write_all(bytes).and_then(|()| out.flush())
        }
        Ok(there) if is_replaced(path, &there) => {
            replace(&fs::canonicalize(path)?, bytes, Some(there.permissions()))
        }
        Ok(_) => OpenOptions::new().append(true).open(path)?.write_all(bytes),
        Err(_) => replace(&destination(path)?, bytes, None),
    }
}

/// Writes a file whole where nothing stands yet.
///
/// # Errors
/// [`ErrorKind::AlreadyExists`] when something stands there, a link to nowhere among it; else when the file
/// system refuses.
pub fn write_new(path: &Path, bytes: &[u8]) -> Result<()> {
    check_folder(path)?;
    written_beside(folder_of(path), bytes, None)?.persist_noclobber(path)?;
    Ok(())
}

/// Looks whether a file could be written, as far as that can be told before it is.
///
/// # Errors
/// When there is no such folder, a folder stands there, or a file that may not be written to.
pub fn check_writable(path: &Path) -> Result<()> {
    match fs::metadata(path) {
        Ok(there) if there.is_dir() => Err(Error::new(ErrorKind::IsADirectory, "it is a folder")),
        // Renaming asks nobody whether the file that is replaced may be written to.
        Ok(there) if is_replaced(path, &there) => check_permitted(path, &there),
        Ok(_) => Ok(()),
        Err(error) if error.kind() == ErrorKind::NotFound => check_folder(&destination(path)?),
        Err(error) => Err(error),
    }
}

/// Looks whether files could be written into a folder, by making one there that goes again.
///
/// # Errors
/// When the system refuses.
pub fn check_folder_takes_files(folder: &Path) -> Result<()> {
    open_beside(folder).map(drop).map_err(|error| Error::from(error.kind()))
}

/// What the system says of an error, without its number.
pub fn refusal(error: &Error) -> String {
    let text = error.to_string();
    text.split(" (os error ").next().unwrap_or_default().to_owned()
}

fn check_folder(target: &Path) -> Result<()> {
    if folder_of(target).is_dir() { Ok(()) } else { Err(Error::new(ErrorKind::NotFound, "no such folder")) }
}

/// Where a path leads to, links followed, whether or not anything stands there yet. Two paths to the same
/// file have the same destination.
///
/// # Errors
/// When the path is empty, or its links lead in a circle.
pub fn destination(path: &Path) -> Result<PathBuf> {
    if let Ok(there) = fs::canonicalize(path) {
        return Ok(there);
    }
    let target = end_of_links(path)?;
    let Some(name) = target.file_name() else { return std::path::absolute(target) };
    match fs::canonicalize(folder_of(&target)) {
        Ok(folder) => Ok(folder.join(name)),
        Err(_) => std::path::absolute(target),
    }
}

/// More links one after the other than this lead in a circle.
const MOST_LINKS: usize = 40;

fn end_of_links(path: &Path) -> Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        let Ok(next) = fs::read_link(&path) else { return Ok(path) };
        path = folder_of(&path).join(next);
    }
    Err(Error::other("its links lead in a circle"))
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Whether what stands there gives way to a new file. Streams of this process and other things of the system
/// do not, even where a regular file lies behind them.
fn is_replaced(path: &Path, there: &fs::Metadata) -> bool {
    there.is_file() && !["/dev", "/proc"].iter().any(|folder| path.starts_with(folder))
}

fn check_permitted(path: &Path, there: &fs::Metadata) -> Result<()> {
    if is_read_only(there) {
        return Err(Error::new(ErrorKind::PermissionDenied, "it is read-only"));
    }
    OpenOptions::new().write(true).open(path).map(drop)
}

/// Read-only to its owner. The owner may be one whom the system lets write everywhere.
#[cfg(unix)]
fn is_read_only(there: &fs::Metadata) -> bool {
    use std::os::unix::fs::PermissionsExt as _;
    there.permissions().mode() & 0o200 == 0
}

#[cfg(not(unix))]
fn is_read_only(there: &fs::Metadata) -> bool {
    there.permissions().readonly()
}

fn replace(target: &Path, bytes: &[u8], permissions: Option<fs::Permissions>) -> Result<()> {
    written_beside(folder_of(target), bytes, permissions)?.persist(target)?;
    Ok(())
}

fn written_beside(
    folder: &Path,
    bytes: &[u8],
    permissions: Option<fs::Permissions>,
) -> Result<tempfile::NamedTempFile> {
    // The kind only: the message names the temporary file, which means nothing to anybody.
    let beside = open_beside(folder).map_err(|error| Error::from(error.kind()))?;
    let mut file: &File = beside.as_file();
    file.write_all(bytes)?;
    if let Some(permissions) = permissions {
        file.set_permissions(permissions)?;
    }
    file.sync_all()?;
    Ok(beside)
}

/// A temporary file with the mode that any new file gets here.
#[cfg(unix)]
fn open_beside(folder: &Path) -> Result<tempfile::NamedTempFile> {
    use std::os::unix::fs::PermissionsExt as _;
    tempfile::Builder::new().permissions(fs::Permissions::from_mode(0o666)).tempfile_in(folder)
}

#[cfg(not(unix))]
fn open_beside(folder: &Path) -> Result<tempfile::NamedTempFile> {
    tempfile::NamedTempFile::new_in(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> usize {
        fs::read_dir(folder).unwrap().count()
    }

    #[test]
    fn a_failed_write_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("there");
        fs::create_dir(&path).unwrap();
        assert!(write_whole(&path, b"x").is_err());
        assert_eq!(names(folder.path()), 1);
    }

    #[test]
    fn a_new_file_takes_no_ones_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new");
        write_new(&path, b"first").unwrap();
        assert_eq!(write_new(&path, b"second").unwrap_err().kind(), ErrorKind::AlreadyExists);
        assert_eq!((names(folder.path()), fs::read(&path).unwrap()), (1, b"first".to_vec()));
        assert_eq!(write_new(folder.path(), b"x").unwrap_err().kind(), ErrorKind::AlreadyExists);
        assert!(write_new(Path::new(""), b"x").is_err());
    }

    #[test]
    fn messages_name_no_temporary_file() {
        let error = write_whole(Path::new("no/such/folder/out"), b"x").unwrap_err();
        assert_eq!(error.to_string(), "no such folder");
    }

    #[test]
    fn two_paths_to_one_file_have_one_destination() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| destination(&folder.path().join(name)).unwrap();
        fs::create_dir(folder.path().join("inner")).unwrap();
        assert_eq!(at("new.csv"), at("inner/../new.csv"));
        assert_eq!(at("later/new.csv"), at("later/new.csv"));
        assert_ne!(at("new.csv"), at("inner/new.csv"));
        assert!(write_whole(Path::new(""), b"x").is_err());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_folder_that_takes_no_files_is_told() {
        let folder = tempfile::tempdir().unwrap();
        assert!(check_folder_takes_files(folder.path()).is_ok());
        assert_eq!(names(folder.path()), 0);
        assert!(check_folder_takes_files(Path::new("/proc")).is_err());
    }

    #[cfg(unix)]
    mod unix {
        use std::os::unix::fs::{PermissionsExt as _, symlink};

        use super::*;

        fn mode(path: &Path) -> u32 {
            fs::metadata(path).unwrap().permissions().mode() & 0o777
        }

        #[test]
        fn links_are_followed_and_stay() {
            let folder = tempfile::tempdir().unwrap();
            let [link, file] = ["link", "file"].map(|name| folder.path().join(name));
            symlink("file", &link).unwrap();
            for text in ["dangling", "there"] {
                write_whole(&link, text.as_bytes()).unwrap();
                assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
                assert_eq!(fs::read_to_string(&file).unwrap(), text);
            }
            assert_eq!(destination(&link).unwrap(), destination(&file).unwrap());
            assert_eq!(names(folder.path()), 2);
        }

        #[test]
        fn links_in_a_circle_are_refused() {
            let folder = tempfile::tempdir().unwrap();
            let link = folder.path().join("link");
            symlink("link", &link).unwrap();
            assert!(write_whole(&link, b"x").is_err());
        }

        #[test]
        fn a_file_keeps_its_mode_and_a_new_one_gets_the_usual() {
            let folder = tempfile::tempdir().unwrap();
            let [usual, new, kept] = ["usual", "new", "kept"].map(|name| folder.path().join(name));
            fs::write(&usual, "x").unwrap();
            write_whole(&new, b"x").unwrap();
            assert_eq!(mode(&new), mode(&usual));
            for wanted in [0o600, 0o664, 0o755] {
                fs::write(&kept, "old").unwrap();
                fs::set_permissions(&kept, fs::Permissions::from_mode(wanted)).unwrap();
                write_whole(&kept, b"new").unwrap();
                assert_eq!((mode(&kept), fs::read(&kept).unwrap()), (wanted, b"new".to_vec()));
            }
        }

        #[test]
        fn a_read_only_file_is_refused() {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("kept");
            fs::write(&path, "old").unwrap();
            fs::set_permissions(&path, fs::Permissions::from_mode(0o444)).unwrap();
            assert_eq!(write_whole(&path, b"new").unwrap_err().kind(), ErrorKind::PermissionDenied);
            assert_eq!(fs::read(&path).unwrap(), b"old");
        }

        #[test]
        fn a_pipe_is_written_into() {
            use std::os::unix::fs::FileTypeExt as _;
            let folder = tempfile::tempdir().unwrap();
            let pipe = folder.path().join("pipe");
            let made = std::process::Command::new("mkfifo").arg(&pipe).status();
            assert!(made.unwrap().success());
            let reader = std::thread::spawn({
                let pipe = pipe.clone();
                move || fs::read(pipe).unwrap()
            });
            write_whole(&pipe, b"through").unwrap();
            assert_eq!(reader.join().unwrap(), b"through");
            assert!(fs::metadata(&pipe).unwrap().file_type().is_fifo());
        }
    }
}
