//! The files that a search leaves in a folder.

use std::path::Path;
use std::{fs, io};

use serde_json::Value;

use super::failure::Failure;
use super::files::{check_not, prepare, put, unwritable};
use patchcord::ident::effects::Library;
use patchcord::ident::report::Report;
use patchcord::ident::{Experiment, table_files};
use patchcord::patch::Patch;

const AUGMENTED: &str = "augmented.json";
const FITTED: &str = "fitted.json";
const RECOVERED: &str = "recovered.json";
const REPORT: &str = "report.json";
const PAGE: &str = "report.html";
const SEPARATE: &str = "separate.csv";
const FILES: [&str; 6] = [AUGMENTED, FITTED, RECOVERED, REPORT, PAGE, SEPARATE];

/// Where they go.
pub(super) struct Folder<'f> {
    folder: &'f Path,
}

impl<'f> Folder<'f> {
    /// Makes the folder; tells before the search what cannot be written to, and what of the experiment would be written over.
    pub fn prepare(folder: &'f Path, experiment: &Experiment) -> Result<Self, Failure> {
        let paths = FILES.map(|file| folder.join(file));
        check_not("the experiment", Path::new(&experiment.file), paths.iter())?;
        check_not("the patch", Path::new(experiment.patch.file()), paths.iter())?;
        experiment.files.iter().try_for_each(|file| check_not("a record", file, paths.iter()))?;
        let tables = table_files(&experiment.patch);
        tables.iter().try_for_each(|file| check_not("a table of the patch", file, paths.iter()))?;
        let folder = Folder { folder };
        folder.check_foreign()?;
        prepare(Some(folder.folder), paths.iter())?;
        Ok(folder)
    }

    /// Refuses to write over what no search has left.
    fn check_foreign(&self) -> Result<(), Failure> {
        let earlier = self.earlier();
        let foreign = FILES.into_iter().filter(|file| !earlier.iter().any(|own| own == file));
        match foreign.map(|file| self.folder.join(file)).find(|path| path.exists()) {
            Some(path) => Err(Failure::usage(format!(
                "{} is there already, and no search has left it: give another folder, or take it away",
                path.display()
            ))),
            None => Ok(()),
        }
    }

    /// The names of the files that an earlier search left, by its report.
    fn earlier(&self) -> Vec<String> {
        let text = fs::read_to_string(self.folder.join(REPORT)).unwrap_or_default();
        let report: Value = serde_json::from_str(&text).unwrap_or_default();
        if !report["verdict"].is_string() {
            return Vec::new();
        }
        let told = [&report["patch"], &report["recovered"], &report["separate"]["data"]];
        let names = told.into_iter().filter_map(|path| Path::new(path.as_str()?).file_name());
        let names = names.map(|name| name.to_string_lossy().into_owned());
        names.chain([FITTED, REPORT, PAGE].map(str::to_owned)).collect()
    }

    /// Writes them, and puts into the document where they are. What an earlier search left that this one has nothing of
    /// goes: it would be taken for what this one found. Gives back what was done, a line each.
    pub fn write(
        &self,
        report: &Report<'_>,
        library: &Library,
        document: &mut Value,
    ) -> Result<String, Failure> {
        let mut done = String::new();
        let mut left = |file: &str, text: Option<&str>| {
            let path = self.folder.join(file);
            done += &match text {
                Some(text) => wrote(&path, text.as_bytes())?,
                None => removed(&path)?,
            };
            Ok::<_, Failure>(text.map_or(Value::Null, |_| path.display().to_string().into()))
        };
        let page = report.page(library).map_err(|error| Failure::data(error.to_string()))?;
        let name = |file: &str| self.folder.join(file).display().to_string();
        put_patches(report, document, name, |file, patch| left(file, patch.map(Patch::text)))?;
        let separate = left(SEPARATE, report.discriminating_csv().as_deref())?;
        if !separate.is_null() {
            document["separate"]["data"] = separate;
        }
        done += &wrote(&self.folder.join(REPORT), format!("{document:#}\n").as_bytes())?;
        done += &wrote(&self.folder.join(PAGE), page.as_bytes())?;
        Ok(done)
    }
}

/// Puts the patches themselves into the document of a search whose files are not asked for.
pub(super) fn embed(report: &Report<'_>, document: &mut Value) -> Result<(), Failure> {
    let itself = |patch: Option<&Patch>| patch.map_or(Value::Null, |patch| patch.value().clone());
    put_patches(report, document, str::to_owned, |_, patch| Ok(itself(patch)))
}

/// Puts into the document what stands for each patch of a search; `name` is that of its file.
fn put_patches(
    report: &Report<'_>,
    document: &mut Value,
    name: impl Fn(&str) -> String,
    mut what: impl FnMut(&str, Option<&Patch>) -> Result<Value, Failure>,
) -> Result<(), Failure> {
    let augmented = what(AUGMENTED, report.augmented(&name(AUGMENTED))?.as_ref())?;
    let fitted = what(FITTED, Some(&report.fitted(&name(FITTED))?))?;
    let recovered = what(RECOVERED, report.recovered(&name(RECOVERED))?.as_ref())?;
    document["patch"] = if augmented.is_null() { fitted.clone() } else { augmented };
    document["fitted"] = fitted;
    document["recovered"] = recovered;
    Ok(())
}

fn wrote(path: &Path, bytes: &[u8]) -> Result<String, Failure> {
    put(path, bytes)?;
    Ok(format!("wrote {}\n", path.display()))
}

/// Removes what an earlier search left.
fn removed(path: &Path) -> Result<String, Failure> {
    match fs::remove_file(path) {
        Ok(()) => Ok(format!("removed {}, which an earlier search had left\n", path.display())),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(String::new()),
        Err(error) => Err(unwritable(path, &error)),
    }
}
