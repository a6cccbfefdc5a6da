//! Experiments that something is wrong with.

use std::fs;
use std::path::{Path, PathBuf};

use patchcord_core::document::Report;
use patchcord_ident::{Experiment, ExperimentError};

/// Where they lie.
pub const FOLDER: &str = "tests/bad";

/// The file of every one, by name.
pub fn bad() -> Vec<PathBuf> {
    let paths = fs::read_dir(FOLDER).unwrap().map(|entry| entry.unwrap().path());
    let mut found: Vec<_> =
        paths.filter(|path| path.extension().is_some_and(|ending| ending == "json")).collect();
    found.sort();
    assert!(found.len() >= 60, "only {} bad experiments are left", found.len());
    found
}

/// Why one is refused, or else its warnings.
pub fn report(path: &Path) -> Report {
    match Experiment::read(path) {
        Ok(experiment) => experiment.warnings,
        Err(ExperimentError::Wrong { experiment, .. }) => *experiment,
        Err(error) => panic!("{}: {error}", path.display()),
    }
}
