//! Limits of a comparison, so that no client can use up the computer of its host.
//!
//! Whatever exceeds them is refused with a message. Larger data are for the command `patchcord gap`.

use patchcord_core::patch::Patch;

use crate::command::NamedText;

/// Size of the largest request in bytes. JSON needs two bytes for each line end of the data.
pub const MAX_REQUEST_BYTES: usize = 20_000_000;
/// Largest number of commands of a request.
pub const MAX_COMMANDS: usize = 20;
/// Largest number of characters of the name of a file.
pub const MAX_NAME_CHARACTERS: usize = 1000;
/// Size of the longest text of a patch in bytes.
pub const MAX_PATCH_BYTES: usize = 1_000_000;
/// Largest number of elements and drives of a patch, after macros are expanded.
pub const MAX_ELEMENTS: usize = 2000;
/// Largest number of cells of a data file.
pub const MAX_CELLS: usize = 1_000_000;
/// Largest number of points of a curve in an event. A longer record is drawn by minimum and maximum of each column of
/// the picture.
pub const MAX_CURVE_POINTS: usize = 2000;
/// Largest number of findings that a message lists.
pub const MAX_FINDINGS: usize = 50;

/// Checks the size of a patch before it is read.
///
/// # Errors
/// The message if its name or its text is too long.
pub(crate) fn check_patch_text(patch: &NamedText) -> Result<(), String> {
    check_name(&patch.name)?;
    if patch.text.len() <= MAX_PATCH_BYTES {
        return Ok(());
    }
    let limit = MAX_PATCH_BYTES / 1_000_000;
    Err(format!("the patch has more than {limit} MB: use shorter tables"))
}

/// Checks the size of a patch after its macros were expanded.
///
/// # Errors
/// The message if it has too many elements.
pub(crate) fn check_patch(patch: &Patch) -> Result<(), String> {
    let count = patch.elements.len() + patch.drives.len();
    if count <= MAX_ELEMENTS {
        return Ok(());
    }
    Err(format!(
        "the patch has {count} elements and drives, and a comparison takes {MAX_ELEMENTS}: use patchcord gap"
    ))
}

/// Checks the size of the data before they are read.
///
/// # Errors
/// The message if the name is too long, or if there are too many cells.
pub(crate) fn check_data(data: &NamedText) -> Result<(), String> {
    check_name(&data.name)?;
    // Every cell ends with a comma or with its line.
    let cells = data.text.bytes().filter(|byte| matches!(byte, b',' | b'\n')).count();
    if cells <= MAX_CELLS {
        return Ok(());
    }
    Err(format!(
        "{} has about {cells} cells, and a comparison takes {MAX_CELLS}: remove columns or rows, or use patchcord \
         gap",
        data.name
    ))
}

/// Checks the length of the name of a file.
///
/// # Errors
/// The message if it is too long.
fn check_name(name: &str) -> Result<(), String> {
    match name.chars().nth(MAX_NAME_CHARACTERS) {
        Some(_) => Err(format!("the name of a file has more than {MAX_NAME_CHARACTERS} characters")),
        None => Ok(()),
    }
}
