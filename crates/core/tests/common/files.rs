//! The patch files of the repository, and the check that generated files are up to date.

use std::path::{Path, PathBuf};

/// Every shipped patch of every folder. Effects and experiments are other documents and are left out.
pub(crate) fn shipped_files() -> Vec<PathBuf> {
    let mut files = json_files_in(&repository_path("patches"));
    let is_experiment = |file: &Path| file.to_str().unwrap().ends_with(".experiment.json");
    files.retain(|file| !file.starts_with(repository_path("patches/effects")) && !is_experiment(file));
    assert!(files.len() >= 25, "{files:?}");
    files
}

/// Shipped patches that together show every kind of behaviour. Slow tests use all patches; the usual tests use these.
const REPRESENTATIVE: [&str; 9] = [
    "lessons/bouncing-ball",
    "lessons/lorenz",
    "lessons/mathieu",
    "lessons/relay-thermostat",
    "lessons/square-root-and-division",
    "others/singh",
    "thesis/fig-8-04",
    "thesis/fig-8-15",
    "thesis/fig-8-16",
];

/// The files of the representative patches.
pub(crate) fn representative_files() -> Vec<PathBuf> {
    REPRESENTATIVE.map(|stem| repository_path(&format!("patches/{stem}.json"))).to_vec()
}

/// The valid patches of crates/core/tests/patches.
pub(crate) fn test_patch_files() -> Vec<PathBuf> {
    let mut files = json_files_in(&repository_path("crates/core/tests/patches"));
    files.retain(|file| !file.starts_with(repository_path("crates/core/tests/patches/bad")));
    assert!(files.len() >= 9, "{files:?}");
    files
}

/// Asserts that a generated file has the contents `fresh`, or writes it if PATCHCORD_BLESS is set. The message names
/// `package`, the crate whose tests write the file.
pub(crate) fn assert_up_to_date(path: &str, fresh: &[u8], package: &str) {
    if std::env::var_os("PATCHCORD_BLESS").is_some() {
        std::fs::write(repository_path(path), fresh).unwrap();
    }
    let stored = std::fs::read(repository_path(path)).unwrap_or_default();
    assert!(stored == fresh, "{path} is stale: PATCHCORD_BLESS=1 cargo test -p {package} rewrites it");
}

/// A path relative to the root of the repository. It is the same for the tests of every crate.
pub(crate) fn repository_path(path: &str) -> PathBuf {
    let root =
        Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().find(|folder| folder.join("crates").is_dir());
    root.unwrap().join(path)
}

/// The JSON files of a folder and its subfolders, sorted by name.
pub(crate) fn json_files_in(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<_> = folder.read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    let files =
        entries.into_iter().flat_map(|path| if path.is_dir() { json_files_in(&path) } else { vec![path] });
    files.filter(|file| file.extension().is_some_and(|extension| extension == "json")).collect()
}
