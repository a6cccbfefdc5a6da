//! The problems of the tests and their solutions by SciPy. Unit tests and integration tests share this file.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

/// The folders of the problems, relative to the folder of this crate. The second has the problems for users.
const FOLDERS: [&str; 2] = ["tests/systems", "../../problems"];

/// The problems, in the order of their names.
pub(crate) fn problem_files() -> Vec<PathBuf> {
    let entries = FOLDERS.iter().flat_map(|folder| fs::read_dir(folder).unwrap());
    let is_problem = |path: &PathBuf| {
        let name = path.to_string_lossy();
        name.ends_with(".json") && !name.ends_with(".reference.json")
    };
    let mut problems: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).filter(is_problem).collect();
    problems.sort_by(|one, other| one.file_name().cmp(&other.file_name()));
    problems
}

/// The problem with this name.
pub(crate) fn problem_file(name: &str) -> PathBuf {
    let mut paths = FOLDERS.iter().map(|folder| Path::new(folder).join(format!("{name}.json")));
    paths.find(|path| path.is_file()).unwrap_or_else(|| panic!("there is no problem {name}"))
}

/// The solution of a problem by SciPy.
pub(crate) fn reference(problem: &Path) -> Value {
    let name = problem.file_stem().unwrap().to_string_lossy();
    let text = fs::read_to_string(format!("tests/systems/{name}.reference.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}
