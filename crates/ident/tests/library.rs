//! Libraries with a few of the shipped effects. A search with such a library takes seconds instead of minutes.

use std::fs;
use std::path::Path;

use patchcord_ident::effects::Library;

/// A library that contains only the shipped effects of these names, such as "coulomb-friction".
pub(crate) fn with_effects(effects: &[&str]) -> Library {
    let folder = tempfile::tempdir().unwrap();
    for effect in effects {
        let file = format!("{effect}.json");
        fs::copy(Path::new("../../patches/effects").join(&file), folder.path().join(&file)).unwrap();
    }
    Library::default().with_folder(folder.path()).unwrap()
}
