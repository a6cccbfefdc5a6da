//! Where the files of an experiment are: in a folder, or in memory.

use std::fs;
use std::path::{Path, PathBuf};

use patchcord_core::document::csv_table::{self, ColumnSelector, CsvFault, CsvTable};
use patchcord_core::document::{DocumentError, suggestion};
use patchcord_core::patch::Patch;

/// Files of an experiment that are in memory, such as those that a browser has read.
///
/// # Examples
///
/// ```
/// use patchcord_core::patch::Patch;
/// use patchcord_ident::{Experiment, GivenFiles};
///
/// let folder = "../../examples/05_missing_effect";
/// let patch = Patch::read(format!("{folder}/spring.json"))?;
/// let measured = std::fs::read_to_string(format!("{folder}/measured.csv"))?;
/// let files = GivenFiles { patch: &patch, data: &[("measured.csv", measured.as_str())] };
/// let text = r#"{"patch": "spring.json", "data": "measured.csv", "outputs": {"x": "x"}, "fit": ["k"]}"#;
/// let experiment = Experiment::parse_given(&files, "spring.experiment.json", text)?;
/// assert_eq!(experiment.fit, ["k"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct GivenFiles<'a> {
    /// The patch. The key "patch" of the experiment only gives its name.
    pub patch: &'a Patch,
    /// The data files: the name as in the experiment, and the content.
    pub data: &'a [(&'a str, &'a str)],
}

/// Where the files that an experiment names are.
#[derive(Debug, Clone, Copy)]
pub(crate) enum FileSource<'a> {
    /// In this folder, to which their paths are relative.
    Folder(&'a Path),
    /// In memory.
    Given(&'a GivenFiles<'a>),
}

impl FileSource<'_> {
    /// Returns the path of a file from the caller's folder, for messages and results. It is the name of a given file.
    pub(crate) fn path(self, name: &str) -> PathBuf {
        match self {
            FileSource::Folder(folder) => folder.join(name),
            FileSource::Given(_) => PathBuf::from(name),
        }
    }

    /// Returns a path that is the same for two names of one file.
    pub(crate) fn canonical_path(self, name: &str) -> PathBuf {
        let path = self.path(name);
        match self {
            FileSource::Folder(_) => fs::canonicalize(&path).unwrap_or(path),
            FileSource::Given(_) => path,
        }
    }

    /// Reads the patch with a name.
    ///
    /// # Errors
    /// If the file cannot be read or is not a patch.
    pub(crate) fn patch(self, name: &str) -> Result<Patch, DocumentError> {
        match self {
            FileSource::Folder(folder) => Patch::read(folder.join(name)),
            FileSource::Given(files) => Ok(files.patch.clone()),
        }
    }

    /// Reads the selected columns of the data file with a name.
    ///
    /// # Errors
    /// The faults of the file, at most ten.
    pub(crate) fn table(
        self,
        name: &str,
        selectors: &[ColumnSelector<'_>],
    ) -> Result<CsvTable, Vec<CsvFault>> {
        match self {
            FileSource::Folder(folder) => csv_table::read(folder.join(name), selectors),
            FileSource::Given(files) => match files.data.iter().find(|(given, _)| *given == name) {
                Some((_, text)) => csv_table::parse(name, text, selectors),
                None => Err(vec![files.missing(name)]),
            },
        }
    }
}

impl GivenFiles<'_> {
    /// The fault of a name that no data file has.
    fn missing(&self, name: &str) -> CsvFault {
        let known: Vec<&str> = self.data.iter().map(|(given, _)| *given).collect();
        let no_files = || "no data file is given".to_owned();
        CsvFault::new(format!("there is no file {name}"), suggestion(name, &known).unwrap_or_else(no_files))
    }
}
