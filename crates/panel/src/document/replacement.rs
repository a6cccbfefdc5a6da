//! Replaces the text of the patch by another one.

use super::cords::is_end_of;
use super::{Document, Edited, Refusal, parsed};

/// Replaces the whole text. Loose cords stay if the new patch has the jack in which their other end is.
///
/// # Errors
/// If the text is not a patch at all, or above the limits. The message is the plain report.
pub(super) fn replace(document: &Document, text: &str) -> Result<Edited, Refusal> {
    let patch = parsed(document.patch.file(), text, document.patch.table_access())?;
    let mut loose = document.loose.clone();
    loose.retain(|cord| is_end_of(&patch, &cord.end));
    Ok(Edited { loose: Some(loose), ..Edited::patch(patch, "replace the text of the patch".to_owned()) })
}
