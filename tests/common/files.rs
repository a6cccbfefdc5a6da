//! Which patches there are.

use std::path::{Path, PathBuf};

/// Every patch that comes with the program, whatever its folder.
pub fn shipped() -> Vec<PathBuf> {
    let found = patches_in(&rooted("patches"));
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
