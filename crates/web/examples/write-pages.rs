//! Writes the pages of the panel, the shipped patches with their data, and the gallery into a folder, for
//! `crates/web/build-site`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::{env, fs, io};

use patchcord_panel::one_file::WORKER_HOST;
use patchcord_panel::pages::PAGES;
use patchcord_panel::patches::{DATA, PATCHES, gallery};

fn main() -> ExitCode {
    let Some(folder) = env::args_os().nth(1).map(PathBuf::from) else {
        eprintln!("write-pages FOLDER");
        return ExitCode::from(2);
    };
    match write_pages(&folder) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("the pages cannot be written to {}: {error}", folder.display());
            ExitCode::FAILURE
        }
    }
}

/// Writes all files. The folder need not exist.
///
/// # Errors
/// If a file cannot be written.
fn write_pages(folder: &Path) -> io::Result<()> {
    for page in PAGES {
        write(&folder.join(page.path), &page.content())?;
    }
    let patches = PATCHES.iter().map(|patch| (patch.path, patch.text));
    for (path, text) in patches.chain(DATA.iter().map(|data| (data.path, data.text))) {
        write(&folder.join("patches").join(path), text)?;
    }
    write(&folder.join("gallery.json"), &format!("{}\n", gallery()))?;
    write(&folder.join("host.json"), &format!("{WORKER_HOST}\n"))
}

/// Writes a file, and makes its folder.
///
/// # Errors
/// If one of them cannot be written.
fn write(file: &Path, text: &str) -> io::Result<()> {
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder)?;
    }
    fs::write(file, text)
}
