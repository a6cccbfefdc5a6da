//! Which patches there are, and whether generated files are fresh.

use std::path::{Path, PathBuf};

/// Every patch that comes with the program, whatever its folder; effects are parts of patches, and experiments name them.
pub fn shipped() -> Vec<PathBuf> {
    let mut found = patches_in(&rooted("patches"));
    let is_experiment = |file: &Path| file.to_str().unwrap().ends_with(".experiment.json");
    found.retain(|file| !file.starts_with(rooted("patches/effects")) && !is_experiment(file));
    assert!(found.len() >= 25, "{found:?}");
    found
}

/// The patches of the tests, but for the wrong ones.
pub fn of_tests() -> Vec<PathBuf> {
    let mut found = patches_in(&rooted("tests/patches"));
    found.retain(|file| !file.starts_with(rooted("tests/patches/bad")));
    assert!(found.len() >= 9, "{found:?}");
    found
}

/// Holds a generated file against what it would be now, or writes it anew where that is asked for. `test` is the name of the
/// test binary that does so.
pub fn check_fresh(path: &str, fresh: &[u8], test: &str) {
    if std::env::var_os("PATCHCORD_BLESS").is_some() {
        std::fs::write(rooted(path), fresh).unwrap();
    }
    let stored = std::fs::read(rooted(path)).unwrap_or_default();
    assert!(stored == fresh, "{path} is stale: PATCHCORD_BLESS=1 cargo test --test {test} rewrites it");
}

fn rooted(folder: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)
}

/// By name, those of folders within it too.
fn patches_in(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<_> = folder.read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    let found =
        entries.into_iter().flat_map(|path| if path.is_dir() { patches_in(&path) } else { vec![path] });
    found.filter(|file| file.extension().is_some_and(|extension| extension == "json")).collect()
}
