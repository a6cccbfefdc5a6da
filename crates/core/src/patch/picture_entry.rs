//! A picture, as a patch document writes it.

use serde::Serialize;

/// An entry of the section "pictures" of a patch document.
///
/// # Examples
///
/// ```
/// use patchcord_core::patch::PictureEntry;
///
/// let entry = PictureEntry::new("Position", "t", ["x"]);
/// assert_eq!(serde_json::to_value(entry)?["y"][0], "x");
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PictureEntry {
    title: String,
    x: String,
    y: Vec<String>,
}

impl PictureEntry {
    /// A picture of the signals `y` against the signal `x`, or against time if `x` is "t".
    pub fn new(title: &str, x: &str, y: impl IntoIterator<Item = impl AsRef<str>>) -> PictureEntry {
        let y = y.into_iter().map(|signal| signal.as_ref().to_owned()).collect();
        PictureEntry { title: title.to_owned(), x: x.to_owned(), y }
    }
}
