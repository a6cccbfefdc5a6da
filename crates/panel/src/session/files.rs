//! Reads a patch in a file below the folder of the host.
//!
//! The name of the file comes from a page, so it may lead anywhere. [`TableAccess`] decides whether it may be read.

use std::io::ErrorKind;
use std::path::Path;

use patchcord_core::document::{DocumentError, read_text};
use patchcord_core::patch::{Patch, TableAccess};

use super::{SessionOptions, table_access};
use crate::document::{Document, Refusal};
use crate::limits;

/// The ending of the names of patches.
const ENDING: &str = ".json";

/// Reads the patch in a file. `name` is its path from the folder of the host. A session looks for tables in that folder
/// only. So the points of tables of a patch in a folder below become a part of its text.
///
/// # Errors
/// If the host permits no files, if the name does not end in ".json" or leads out of the folder, or if the file is not a
/// patch within the limits. If a table in a folder below cannot be read.
pub(super) fn read(options: &SessionOptions, name: &str) -> Result<Document, Refusal> {
    let Some(folder) = &options.folder else {
        return Err(Refusal::new("this panel reads no files: open the patch with \"Open\""));
    };
    if !name.ends_with(ENDING) {
        return Err(Refusal::new(format!("{name} is not opened: the name of a patch must end in {ENDING}")));
    }
    let access = table_access(options);
    let parent = Path::new(name).parent().and_then(Path::to_str).unwrap_or_default();
    // A link elsewhere may lead back to a file in the folder. Its tables would be elsewhere, too.
    let (Some(path), Some(parent)) = (access.permitted(name), access.permitted(parent)) else {
        let message = format!("{name} is not below the folder of the panel: open it with \"Open\"");
        return Err(Refusal::new(message));
    };
    let text = read_text(&path).map_err(|error| unreadable(name, &error))?;
    let file = path.file_name().unwrap_or_default().display().to_string();
    let text = if parent == *folder { text } else { text_with_tables(&parent, &file, &text)? };
    Document::open(&file, &text, &access)
}

/// The text of a patch with the points of its tables, which are below a folder.
///
/// # Errors
/// If the text is not a patch or too long, or if a table cannot be read.
fn text_with_tables(folder: &Path, file: &str, text: &str) -> Result<String, Refusal> {
    limits::check_text(text).map_err(Refusal::new)?;
    let patch = Patch::parse_with(TableAccess::Below(folder.to_owned()), file, text);
    let text = patch.and_then(|patch| patch.text_with_tables());
    text.map_err(|report| Refusal::new(report.plain()))
}

/// The refusal of a file that cannot be read.
fn unreadable(name: &str, error: &DocumentError) -> Refusal {
    match error {
        DocumentError::File { source, .. } if source.kind() == ErrorKind::NotFound => {
            Refusal::new(format!("there is no file {name} in the folder of the panel: check the name"))
        }
        DocumentError::Text(report) => Refusal::new(report.plain()),
        error => Refusal::new(error.to_string()),
    }
}
