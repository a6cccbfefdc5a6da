//! `patchcord panel --export`: the panel with a patch as one file.
//!
//! The command has no WebAssembly. So it takes the page from the folder that `crates/web/build-site` makes, and puts
//! the patch into it.

use std::env;
use std::path::{Path, PathBuf};

use patchcord_panel::limits::MAX_PATCH_BYTES;
use patchcord_panel::one_file::{ONE_FILE, with_patch};
use patchcord_server::GivenPatch;

use super::failure::Failure;
use super::files::{path_text, written_text};
use super::outputs::Outputs;
use super::print;
use super::standard_streams::is_dash;
use patchcord::document::read_text;
use patchcord::patch::{Patch, TableAccess};

/// What is exported.
pub(super) struct Export<'a> {
    /// The file to write.
    pub file: &'a PathBuf,
    /// The folder with the page, if the command line has one.
    pub site: Option<&'a Path>,
    /// The patch with which the panel begins, and the path of its file.
    pub patch: Option<(&'a Path, GivenPatch)>,
    /// The folder below which tables of the patch are read.
    pub folder: PathBuf,
}

/// Writes the page, with the patch if there is one.
pub(super) fn export(export: &Export<'_>) -> Result<(), Failure> {
    check_name(export.file)?;
    let source = page_file(export.site)?;
    let mut page = read_text(&source)?;
    let mut outputs = Outputs::default().reading("the page to export", [&source]);
    if let Some((path, given)) = &export.patch {
        let (text, tables) = text_with_tables(path, given, &export.folder)?;
        // Standard input may be a file.
        let file = if is_dash(path) { Path::new("/dev/stdin") } else { *path };
        outputs = outputs.reading("the patch", [file]).reading("a table of the patch", tables);
        page = with_patch(&page, &given.name, &text).ok_or_else(|| no_place(&source))?;
    }
    outputs.prepare(None, [export.file])?;
    outputs.write(export.file, page.as_bytes())?;
    print(&format!("{}A browser opens it without a network.\n", written_text([export.file].into_iter())))
}

/// Checks the ending of the file. Browsers show another file as text, and a patch would be overwritten by mistake.
///
/// # Errors
/// A usage error if it is another one.
fn check_name(file: &Path) -> Result<(), Failure> {
    if file.extension().is_some_and(|ending| ending == "html") {
        return Ok(());
    }
    let file = path_text(file);
    Err(Failure::usage(format!("the name of a page must end in .html, such as {file}.html")))
}

/// The page without a patch.
///
/// # Errors
/// A usage error if it is not in the folder, or in none of the folders in which it is looked for.
fn page_file(site: Option<&Path>) -> Result<PathBuf, Failure> {
    let folders = site.map_or_else(default_folders, |folder| vec![folder.to_owned()]);
    if let Some(file) = folders.iter().map(|folder| folder.join(ONE_FILE)).find(|file| file.is_file()) {
        return Ok(file);
    }
    let folders: Vec<String> = folders.iter().map(|folder| path_text(folder)).collect();
    Err(Failure::usage(format!(
        "{ONE_FILE} is not in {}: make the folder with crates/web/build-site, or name another with --site",
        folders.join(" or ")
    )))
}

/// The folder `site` next to the command, and that of a build, which has the command in `debug` or `release`.
fn default_folders() -> Vec<PathBuf> {
    let command = env::current_exe().unwrap_or_default();
    command.ancestors().skip(1).take(2).map(|folder| folder.join("site")).collect()
}

/// The text of the patch with the points of its tables, and the files that they were read from. A text that is no patch
/// stays as it is: the page lists its faults.
///
/// # Errors
/// If a table cannot be read, or if the panel opens no text of this length.
fn text_with_tables(
    path: &Path,
    given: &GivenPatch,
    folder: &Path,
) -> Result<(String, Vec<PathBuf>), Failure> {
    let file = if is_dash(path) { given.name.clone() } else { path.display().to_string() };
    let access = TableAccess::Below(folder.to_owned());
    let (text, tables) = match Patch::parse_with(access, &file, &given.text) {
        Ok(patch) => (patch.text_with_tables()?, patch.table_files().to_vec()),
        Err(_) => (given.text.clone(), Vec::new()),
    };
    if text.len() > MAX_PATCH_BYTES {
        let limit = MAX_PATCH_BYTES / 1_000_000;
        return Err(Failure::data(format!(
            "the patch with the points of its tables is larger than {limit} MB, too large for the panel"
        )));
    }
    Ok((text, tables))
}

/// The failure for a page that has no place for a patch.
fn no_place(file: &Path) -> Failure {
    Failure::data(format!(
        "{} has a patch already, or is of another version of patchcord: make its folder again with \
         crates/web/build-site",
        path_text(file)
    ))
}
