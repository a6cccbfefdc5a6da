//! The invalid experiments in `tests/bad` and their reports.
//!
//! Each file is named after the diagnostic code that it must get. Its expected report is the `.txt` file of the same
//! name.

use std::fs;
use std::path::{Path, PathBuf};

use patchcord_core::document::Report;
use patchcord_ident::{Experiment, ExperimentError};

/// Folder of the experiments, relative to the package.
pub(crate) const FOLDER: &str = "tests/bad";

/// The paths of all bad experiments, in the order of their names.
pub(crate) fn experiments() -> Vec<PathBuf> {
    let paths = fs::read_dir(FOLDER).unwrap().map(|entry| entry.unwrap().path());
    let mut experiments: Vec<_> =
        paths.filter(|path| path.extension().is_some_and(|extension| extension == "json")).collect();
    experiments.sort();
    assert!(experiments.len() >= 60, "{FOLDER} has only {} experiments", experiments.len());
    experiments
}

/// The errors of an invalid experiment, or the warnings of one that is only doubtful.
///
/// Panics if a file of the experiment cannot be read.
pub(crate) fn report(path: &Path) -> Report {
    match Experiment::read(path) {
        Ok(experiment) => experiment.warnings,
        Err(ExperimentError::Invalid { experiment, .. }) => *experiment,
        Err(error) => panic!("{}: {error}", path.display()),
    }
}
