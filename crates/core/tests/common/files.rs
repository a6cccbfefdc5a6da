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

/// Shipped patches that between them have every kind of behaviour: what is tested on all patches only when asked for is
/// tested on these in every run.
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

/// The representative patches.
pub fn representative() -> Vec<PathBuf> {
    REPRESENTATIVE.map(|stem| rooted(&format!("patches/{stem}.json"))).to_vec()
}

/// The patches of the tests, but for the wrong ones.
pub fn of_tests() -> Vec<PathBuf> {
    let mut found = patches_in(&rooted("crates/core/tests/patches"));
    found.retain(|file| !file.starts_with(rooted("crates/core/tests/patches/bad")));
    assert!(found.len() >= 9, "{found:?}");
    found
}

/// Holds a generated file against what it would be now, or writes it anew where that is asked for. `package` is the
/// crate whose tests do so.
pub fn check_fresh(path: &str, fresh: &[u8], package: &str) {
    if std::env::var_os("PATCHCORD_BLESS").is_some() {
        std::fs::write(rooted(path), fresh).unwrap();
    }
    let stored = std::fs::read(rooted(path)).unwrap_or_default();
    assert!(stored == fresh, "{path} is stale: PATCHCORD_BLESS=1 cargo test -p {package} rewrites it");
}

/// A path below the top of the repository, whichever crate the test belongs to.
pub fn rooted(path: &str) -> PathBuf {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().find(|folder| folder.join("crates").is_dir());
    top.unwrap().join(path)
}

/// By name, those of folders within it too.
fn patches_in(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<_> = folder.read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    let found =
        entries.into_iter().flat_map(|path| if path.is_dir() { patches_in(&path) } else { vec![path] });
    found.filter(|file| file.extension().is_some_and(|extension| extension == "json")).collect()
}
