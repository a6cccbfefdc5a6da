//! The files that a search for missing effects writes.
//!
//! A later search in the same folder replaces the files of an earlier one and removes those that it does not write.
//! Files that no search has written are never overwritten. The report of the earlier search says which files are its
//! own. While a search replaces files, a marker has their names: so the next search knows them if this one is killed.

use std::path::{Path, PathBuf};

use serde_json::Value;

use super::failure::Failure;
use super::files::path_text;
use super::outputs::{Outputs, write_failure};
use patchcord::document::read_text;
use patchcord::ident::effects::Library;
use patchcord::ident::report::Report;
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
const FILES: [&str; 6] = [AUGMENTED, FITTED, RECOVERED, SEPARATE, REPORT, PAGE];
/// The marker of a search that is replacing files.
const MARKER: &str = ".patchcord-gap-unfinished";
/// The first line of the marker. The names of the files follow, one per line.
const MARKER_HEAD: &str =
    "# A search is replacing these files. If it was killed, the next search replaces them.\n";

/// The output folder.
pub(super) struct Folder<'f> {
    /// The folder, which exists after [`Folder::prepare`].
    folder: &'f Path,
    /// Writes the files.
    outputs: Outputs,
}

/// A file of the output folder: its name and its text.
type NamedText = (&'static str, String);

impl<'f> Folder<'f> {
    /// Creates the folder, and checks before the search that all files can be written.
    ///
    /// # Errors
    /// If a file would overwrite an input or a file that no search wrote, or if the folder or a file cannot be written.
    pub(super) fn prepare(folder: &'f Path, outputs: Outputs) -> Result<Self, Failure> {
        let folder = Folder { folder, outputs };
        let paths = FILES.map(|file| folder.path(file));
        folder.outputs.check(&paths)?;
        folder.check_foreign()?;
        folder.outputs.prepare(Some(folder.folder), &paths)?;
        Ok(folder)
    }

    /// The path of a file in the folder.
    fn path(&self, file: &str) -> PathBuf {
        self.folder.join(file)
    }

    /// The path of a file in the folder as text, for the report.
    fn shown(&self, file: &str) -> String {
        self.path(file).display().to_string()
    }

    /// An error if a file would be overwritten that was not written by a search.
    fn check_foreign(&self) -> Result<(), Failure> {
        let earlier = self.earlier();
        let foreign = FILES.into_iter().filter(|file| !earlier.iter().any(|written| written == file));
        match foreign.map(|file| self.path(file)).find(|path| path.exists()) {
            Some(path) => Err(Failure::usage(format!(
                "{} exists and was not written by a search: give another folder, or remove it",
                path_text(&path)
            ))),
            None => Ok(()),
        }
    }

    /// The names of the files of earlier searches, according to the report of the last one and to the marker of one
    /// that was killed.
    fn earlier(&self) -> Vec<String> {
        let read = |file: &str| read_text(self.path(file)).unwrap_or_default();
        let marker = read(MARKER);
        let names = marker.strip_prefix(MARKER_HEAD).unwrap_or_default().lines().map(str::to_owned);
        names.chain(files_of_report(&read(REPORT))).collect()
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
        let page = report.page(library).map_err(|error| Failure::data(error.to_string()))?;
        let mut texts: Vec<NamedText> = Vec::new();
        let value_of = |file: &'static str, patch: Option<&Patch>| {
            texts.extend(patch.map(|patch| (file, patch.text().to_owned())));
            Ok(patch.map_or(Value::Null, |_| self.shown(file).into()))
        };
        put_patches(report, document, |file| self.shown(file), value_of)?;
        if let Some(csv) = report.discriminating_csv() {
            texts.push((SEPARATE, csv));
            document["separate"]["data"] = self.shown(SEPARATE).into();
        }
        texts.push((REPORT, format!("{document:#}\n")));
        texts.push((PAGE, page));
        self.replace(&texts)
    }

    /// Replaces the files of an earlier search by these. Returns one line per file.
    ///
    /// All files are first written under temporary names. Only then is the marker written, and the files get their
    /// names. So a search that is killed leaves the files of the earlier search, or a marker.
    fn replace(&self, texts: &[NamedText]) -> Result<String, Failure> {
        // The search has taken minutes, in which others may have written files.
        self.check_foreign()?;
        let stage = |(file, text): &NamedText| {
            let path = self.path(file);
            self.outputs.stage(&path, text.as_bytes()).map(|staged| (path, staged))
        };
        let staged = texts.iter().map(stage).collect::<Result<Vec<_>, _>>()?;
        let is_new = |file: &str| texts.iter().any(|(name, _)| *name == file);
        let replaced = FILES.into_iter().filter(|file| is_new(file) || self.path(file).exists());
        let names: String = replaced.map(|file| format!("{file}\n")).collect();
        self.outputs.write(&self.path(MARKER), format!("{MARKER_HEAD}{names}").as_bytes())?;
        for (path, file) in staged {
            file.commit().map_err(|error| write_failure(&path, &error))?;
        }
        let mut lines = String::new();
        for file in FILES {
            lines += &if is_new(file) {
                format!("wrote {}\n", self.shown(file))
            } else {
                self.remove_with_line(file)?
            };
        }
        self.outputs.remove(&self.path(MARKER))?;
        Ok(lines)
    }

    /// Removes a file of an earlier search and returns the line that reports it; empty if there is none.
    fn remove_with_line(&self, file: &str) -> Result<String, Failure> {
        let is_removed = self.outputs.remove(&self.path(file))?;
        let line = format!("removed {}, written by an earlier search\n", self.shown(file));
        Ok(if is_removed { line } else { String::new() })
    }
}

/// The names of the files that a search has written, according to its report. Empty if the text is no report.
fn files_of_report(text: &str) -> Vec<String> {
    let report: Value = serde_json::from_str(text).unwrap_or_default();
    if !report["verdict"].is_string() {
        return Vec::new();
    }
    let paths = [&report["patch"], &report["recovered"], &report["separate"]["data"]];
    let names = paths.into_iter().filter_map(|path| Path::new(path.as_str()?).file_name());
    let names = names.map(|name| name.to_string_lossy().into_owned());
    names.chain([FITTED, REPORT, PAGE].map(str::to_owned)).collect()
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
    mut value_of: impl FnMut(&'static str, Option<&Patch>) -> Result<Value, Failure>,
) -> Result<(), Failure> {
    let augmented = value_of(AUGMENTED, report.augmented(&name(AUGMENTED))?.as_ref())?;
    let fitted = value_of(FITTED, Some(&report.fitted(&name(FITTED))?))?;
    let recovered = value_of(RECOVERED, report.recovered(&name(RECOVERED))?.as_ref())?;
    document["patch"] = if augmented.is_null() { fitted.clone() } else { augmented };
    document["fitted"] = fitted;
    document["recovered"] = recovered;
    Ok(())
}
