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
    #[serde(skip_serializing_if = "Option::is_none")]
    equal_scales: Option<bool>,
}

impl PictureEntry {
    /// A picture of the signals `y` against the signal `x`, or against time if `x` is "t".
    pub fn new(title: &str, x: &str, y: impl IntoIterator<Item = impl AsRef<str>>) -> PictureEntry {
        let y = y.into_iter().map(|signal| signal.as_ref().to_owned()).collect();
        PictureEntry { title: title.to_owned(), x: x.to_owned(), y, equal_scales: None }
    }

    /// The same picture without equal scales: each axis has the range of its own values.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::PictureEntry;
    ///
    /// let entry = PictureEntry::new("Velocity profile", "v_i", ["v_o"]).with_own_ranges();
    /// assert_eq!(serde_json::to_value(entry)?["equal_scales"], false);
    /// # Ok::<(), serde_json::Error>(())
    /// ```
    #[must_use]
    pub fn with_own_ranges(self) -> PictureEntry {
        PictureEntry { equal_scales: Some(false), ..self }
    }
}
