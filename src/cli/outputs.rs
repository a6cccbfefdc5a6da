//! The one way in which commands write files.
//!
//! A command states the files that it has read. No output may be one of them, and no two outputs may be one file. Both
//! are checked before the work, together with folders and permissions. Files are written to a temporary name and then
//! renamed, so a reader sees the old file or the complete new one. Pipes and devices are written directly.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::Path;

use super::failure::Failure;
use super::files::path_text;
use super::standard_output_result;
use super::standard_streams::check_output;
use patchcord::output::{
    FileIdentity, PendingFile, STANDARD_OUTPUT, StagedFile, check_appendable, check_folder_writable,
    check_writable, io_reason, remove_leftovers, stage, write_atomic, write_new,
};
use patchcord::patch::Patch;

/// Writes the files of a command, which are never files that the command has read.
#[derive(Default)]
pub(super) struct Outputs {
    /// The files that the command has read.
    inputs: Vec<Input>,
}

/// A file that the command has read.
struct Input {
    /// What it is, for messages: "the patch".
    role: &'static str,
    /// Which file it is.
    identity: FileIdentity,
}

impl Outputs {
    /// The outputs of a command that reads a patch. `path` is that of the patch.
    pub(super) fn of_patch(path: &Path, patch: &Patch) -> Self {
        Outputs::default().reading("the patch", [path]).reading("a table of the patch", patch.table_files())
    }

    /// Adds files or folders that the command has read. `role` says what each of them is.
    pub(super) fn reading<P: AsRef<Path>>(
        mut self,
        role: &'static str,
        paths: impl IntoIterator<Item = P>,
    ) -> Self {
        // Only an empty path and a cycle of links have no identity, and neither can be read.
        let input = |path: P| Some(Input { role, identity: FileIdentity::of(path).ok()? });
        self.inputs.extend(paths.into_iter().filter_map(input));
        self
    }

    /// An error if two outputs are the same file, or if one is a file that the command has read.
    pub(super) fn check<P: AsRef<Path>>(&self, paths: impl IntoIterator<Item = P>) -> Result<(), Failure> {
        self.identities(paths).map(drop)
    }

    /// The identities of outputs, without pipes and devices.
    ///
    /// # Errors
    /// If two are the same file, or if one is a file that the command has read.
    fn identities<P: AsRef<Path>>(
        &self,
        paths: impl IntoIterator<Item = P>,
    ) -> Result<Vec<FileIdentity>, Failure> {
        let mut found: Vec<FileIdentity> = Vec::new();
        for path in paths {
            let path = path.as_ref();
            let Some(identity) = self.identity(path)? else { continue };
            if found.iter().any(|other| other.is_same(&identity)) {
                return Err(Failure::usage(format!("{} would be written twice", path_text(path))));
            }
            found.push(identity);
        }
        Ok(found)
    }

    /// The identity of an output. None for a pipe or a device.
    ///
    /// # Errors
    /// If the path is no file name or is `-`, or if the command has read the file.
    fn identity(&self, path: &Path) -> Result<Option<FileIdentity>, Failure> {
        check_output(path)?;
        if is_stream(path) {
            return Ok(None);
        }
        let shown = path_text(path);
        let identity = FileIdentity::of(path).map_err(|error| {
            Failure::usage(format!("\"{shown}\" is not a file name: {}", io_reason(&error)))
        })?;
        match self.inputs.iter().find(|input| input.identity.is_same(&identity)) {
            Some(Input { role, .. }) => Err(Failure::usage(format!(
                "{shown} is {role} itself: give another name or folder to write to"
            ))),
            None => Ok(Some(identity)),
        }
    }

    /// Creates the folder, and checks before the work that all files can be written. Removes the temporary files that
    /// earlier commands left in the same folders when they were killed.
    ///
    /// # Errors
    /// If two files are the same, if one was read, or if the folder or a file cannot be written.
    pub(super) fn prepare<P: AsRef<Path>>(
        &self,
        folder: Option<&Path>,
        paths: impl IntoIterator<Item = P>,
    ) -> Result<(), Failure> {
        let paths: Vec<P> = paths.into_iter().collect();
        let identities = self.identities(&paths)?;
        if let Some(folder) = folder {
            check_output(folder)?;
            create_folder(folder)?;
            check_folder_writable(folder).map_err(|error| {
                let (folder, reason) = (path_text(folder), io_reason(&error));
                Failure::data(format!("cannot write into the folder {folder}: {reason}"))
            })?;
        }
        remove_leftovers_of(&identities);
        paths.iter().map(AsRef::as_ref).try_for_each(check_file)
    }

    /// Checks before a sweep that rows can be appended to a file.
    ///
    /// # Errors
    /// If the file was read, or if it cannot be written.
    pub(super) fn prepare_append(&self, path: &Path) -> Result<(), Failure> {
        remove_leftovers_of(&self.identities([path])?);
        check_appendable(path).map_err(|error| write_failure(path, &error))
    }

    /// Writes a file completely, or not at all.
    ///
    /// # Errors
    /// If the file was read, or if it cannot be written.
    pub(super) fn write(&self, path: &Path, bytes: &[u8]) -> Result<(), Failure> {
        self.identity(path)?;
        written(path, write_atomic(path, bytes))
    }

    /// Begins a file that is written in parts. [`publish`] ends it.
    ///
    /// # Errors
    /// If the file was read, or if it cannot be written.
    pub(super) fn begin(&self, path: &Path) -> Result<PendingFile, Failure> {
        self.identity(path)?;
        PendingFile::create(path).map_err(|error| write_failure(path, &error))
    }

    /// Writes a file under a temporary name.
    ///
    /// # Errors
    /// If the file was read, or if it cannot be written.
    pub(super) fn stage(&self, path: &Path, bytes: &[u8]) -> Result<StagedFile, Failure> {
        self.identity(path)?;
        stage(path, bytes).map_err(|error| write_failure(path, &error))
    }

    /// Removes a file. False if there is none.
    ///
    /// # Errors
    /// If the file was read, or if it cannot be removed.
    pub(super) fn remove(&self, path: &Path) -> Result<bool, Failure> {
        self.identity(path)?;
        match fs::remove_file(path) {
            Ok(()) => Ok(true),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
            Err(error) => Err(write_failure(path, &error)),
        }
    }
}

/// Begins a second copy of a file that [`Outputs::begin`] has begun, for its parts with changes.
///
/// # Errors
/// If it cannot be written.
pub(super) fn begin_copy(path: &Path) -> io::Result<PendingFile> {
    PendingFile::create(path)
}

/// Ends a file that was written in parts: it appears under its name.
///
/// # Errors
/// If it cannot be written. An existing file is then unchanged.
pub(super) fn publish(path: &Path, file: PendingFile) -> Result<(), Failure> {
    written(path, file.commit())
}

/// The result of writing a file.
fn written(path: &Path, outcome: io::Result<()>) -> Result<(), Failure> {
    if path == Path::new(STANDARD_OUTPUT) {
        return standard_output_result(outcome);
    }
    outcome.map_err(|error| write_failure(path, &error))
}

/// Checks before the work that a file can be written.
fn check_file(path: &Path) -> Result<(), Failure> {
    check_writable(path).map_err(|error| write_failure(path, &error))
}

/// Writes a new file. An existing file is never overwritten.
///
/// # Errors
/// If the file exists or cannot be written.
pub(super) fn write_new_file(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    remove_leftovers_of(FileIdentity::of(path).ok().as_slice());
    write_new(path, bytes).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => Failure::usage(format!(
            "{} already exists: choose another name, or remove it first",
            path_text(path)
        )),
        _ => write_failure(path, &error),
    })
}

/// Removes the temporary files that killed commands left in the folders of these files.
fn remove_leftovers_of(files: &[FileIdentity]) {
    let folders: BTreeSet<&Path> = files.iter().filter_map(FileIdentity::folder).collect();
    folders.into_iter().for_each(remove_leftovers);
}

/// Whether the path is a pipe or a device.
fn is_stream(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|existing| !existing.is_file() && !existing.is_dir())
}

/// Creates a folder and its parents.
fn create_folder(folder: &Path) -> Result<(), Failure> {
    let failure = |error| {
        let why = blocking_file(folder).unwrap_or_else(|| io_reason(&error));
        Failure::data(format!("cannot create the folder {}: {why}", path_text(folder)))
    };
    fs::create_dir_all(folder).map_err(failure)
}

/// A message if the folder or one of its parents is a file.
///
/// The message of the file system would only be "not a directory".
fn blocking_file(folder: &Path) -> Option<String> {
    let file = folder.ancestors().find(|ancestor| ancestor.is_file())?;
    Some(if file == folder {
        "a file with this name exists".to_owned()
    } else {
        format!("{} is a file", path_text(file))
    })
}

/// The failure for a file that cannot be written.
pub(super) fn write_failure(path: &Path, error: &io::Error) -> Failure {
    Failure::data(format!("cannot write {}: {}", path_text(path), io_reason(error)))
}
