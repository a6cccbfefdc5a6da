//! The files that a search for missing effects writes.
//!
//! A later search in the same folder replaces the files of an earlier one and removes those that it does not write.
//! Files that no search has written are never overwritten; the report of the earlier search says which files are its
//! own.

use std::path::Path;
use std::{fs, io};

use serde_json::Value;

use super::failure::Failure;
use super::files::{check_distinct_from, path_text, prepare_outputs, write_failure, write_file};
use patchcord::ident::effects::Library;
use patchcord::ident::report::Report;
use patchcord::ident::{Experiment, table_files};
use patchcord::patch::Patch;

/// The patch with the missing effects.
const AUGMENTED: &str = "augmented.json";
/// The patch with fitted parameters.
const FITTED: &str = "fitted.json";
/// The patch with the unknown effect as a curve.
const RECOVERED: &str = "recovered.json";
/// The report as JSON. It also identifies the files of an earlier search.
const REPORT: &str = "report.json";
/// The report as a page.
const PAGE: &str = "report.html";
/// The drive that distinguishes two effects.
const SEPARATE: &str = "separate.csv";
/// All names that a search may write.
const FILES: [&str; 6] = [AUGMENTED, FITTED, RECOVERED, REPORT, PAGE, SEPARATE];

/// The output folder.
pub(super) struct Folder<'f> {
    /// The folder, which exists after [`Folder::prepare`].
    folder: &'f Path,
}

impl<'f> Folder<'f> {
    /// Creates the folder, and checks before the search that all files can be written.
    ///
    /// # Errors
    /// If a file would overwrite an input or a file that no search wrote, or if the folder or a file cannot be written.
    pub(super) fn prepare(folder: &'f Path, experiment: &Experiment) -> Result<Self, Failure> {
        let paths = FILES.map(|file| folder.join(file));
        check_distinct_from("the experiment", Path::new(&experiment.file), paths.iter())?;
        check_distinct_from("the patch", Path::new(experiment.patch.file()), paths.iter())?;
        experiment.files.iter().try_for_each(|file| check_distinct_from("a record", file, paths.iter()))?;
        let tables = table_files(&experiment.patch);
        tables.iter().try_for_each(|file| check_distinct_from("a table of the patch", file, paths.iter()))?;
        let folder = Folder { folder };
        folder.check_foreign()?;
        prepare_outputs(Some(folder.folder), paths.iter())?;
        Ok(folder)
    }

    /// An error if a file would be overwritten that was not written by a search.
    fn check_foreign(&self) -> Result<(), Failure> {
        let earlier = self.earlier();
        let foreign = FILES.into_iter().filter(|file| !earlier.iter().any(|written| written == file));
        match foreign.map(|file| self.folder.join(file)).find(|path| path.exists()) {
            Some(path) => Err(Failure::usage(format!(
                "{} exists and was not written by a search: give another folder, or remove it",
                path_text(&path)
            ))),
            None => Ok(()),
        }
    }

    /// The names of the files of an earlier search, according to its report.
    fn earlier(&self) -> Vec<String> {
        let text = fs::read_to_string(self.folder.join(REPORT)).unwrap_or_default();
        let report: Value = serde_json::from_str(&text).unwrap_or_default();
        if !report["verdict"].is_string() {
            return Vec::new();
        }
        let paths = [&report["patch"], &report["recovered"], &report["separate"]["data"]];
        let names = paths.into_iter().filter_map(|path| Path::new(path.as_str()?).file_name());
        let names = names.map(|name| name.to_string_lossy().into_owned());
        names.chain([FITTED, REPORT, PAGE].map(str::to_owned)).collect()
    }

    /// Writes all files and enters their paths in the document. Removes files of an earlier search that this one does
    /// not write, because they would be mistaken for its results. Returns one line per file.
    ///
    /// # Errors
    /// If the page cannot be made, or if a file cannot be written or removed.
    pub(super) fn write(
        &self,
        report: &Report<'_>,
        library: &Library,
        document: &mut Value,
    ) -> Result<String, Failure> {
        let mut lines = String::new();
        let mut update = |file: &str, text: Option<&str>| {
            let path = self.folder.join(file);
            lines += &match text {
                Some(text) => write_with_line(&path, text.as_bytes())?,
                None => remove_with_line(&path)?,
            };
            Ok::<_, Failure>(text.map_or(Value::Null, |_| path.display().to_string().into()))
        };
        let page = report.page(library).map_err(|error| Failure::data(error.to_string()))?;
        let name = |file: &str| self.folder.join(file).display().to_string();
        put_patches(report, document, name, |file, patch| update(file, patch.map(Patch::text)))?;
        let separate = update(SEPARATE, report.discriminating_csv().as_deref())?;
        if !separate.is_null() {
            document["separate"]["data"] = separate;
        }
        lines += &write_with_line(&self.folder.join(REPORT), format!("{document:#}\n").as_bytes())?;
        lines += &write_with_line(&self.folder.join(PAGE), page.as_bytes())?;
        Ok(lines)
    }
}

/// Enters the patches themselves in the document of a search without an output folder.
pub(super) fn embed(report: &Report<'_>, document: &mut Value) -> Result<(), Failure> {
    let document_of = |patch: Option<&Patch>| patch.map_or(Value::Null, |patch| patch.value().clone());
    put_patches(report, document, str::to_owned, |_, patch| Ok(document_of(patch)))
}

/// Enters a value for each patch of a search in the document. `name` maps a file name to the name of the patch, and
/// `value_of` makes the value from the file name and the patch, if there is one.
///
/// Keys: `patch` is the patch with the named effects, or the fitted one; `fitted`; `recovered`, which may be null.
fn put_patches(
    report: &Report<'_>,
    document: &mut Value,
    name: impl Fn(&str) -> String,
    mut value_of: impl FnMut(&str, Option<&Patch>) -> Result<Value, Failure>,
) -> Result<(), Failure> {
    let augmented = value_of(AUGMENTED, report.augmented(&name(AUGMENTED))?.as_ref())?;
    let fitted = value_of(FITTED, Some(&report.fitted(&name(FITTED))?))?;
    let recovered = value_of(RECOVERED, report.recovered(&name(RECOVERED))?.as_ref())?;
    document["patch"] = if augmented.is_null() { fitted.clone() } else { augmented };
    document["fitted"] = fitted;
    document["recovered"] = recovered;
    Ok(())
}

/// Writes a file and returns the line that reports it.
fn write_with_line(path: &Path, bytes: &[u8]) -> Result<String, Failure> {
    write_file(path, bytes)?;
    Ok(format!("wrote {}\n", path_text(path)))
}

/// Removes a file of an earlier search and returns the line that reports it; empty if there is none.
fn remove_with_line(path: &Path) -> Result<String, Failure> {
    match fs::remove_file(path) {
        Ok(()) => Ok(format!("removed {}, written by an earlier search\n", path_text(path))),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(String::new()),
        Err(error) => Err(write_failure(path, &error)),
    }
}
