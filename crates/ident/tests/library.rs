//! A library of a few of the program's effects.

use std::fs;
use std::path::Path;

use patchcord_ident::effects::Library;

pub fn of(effects: &[&str]) -> Library {
    let folder = tempfile::tempdir().unwrap();
    for effect in effects {
        let file = format!("{effect}.json");
        fs::copy(Path::new("../../patches/effects").join(&file), folder.path().join(&file)).unwrap();
    }
    Library::default().and_folder(folder.path()).unwrap()
}
