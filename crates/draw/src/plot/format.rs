//! The picture file formats.

use std::path::Path;

use super::PlotError;

/// A picture file format.
///
/// # Examples
///
/// ```
/// use patchcord_draw::plot::Format;
///
/// assert_eq!(Format::from_path("run.SVG")?, Format::Svg);
/// assert_eq!(Format::from_path("run.png")?, Format::Png);
/// assert!(Format::from_path("run.pdf").is_err(), "the extension must be .svg or .png");
/// # Ok::<(), patchcord_draw::plot::PlotError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// Scalable vector graphics, UTF-8 text.
    Svg,
    /// A pixel image with 8 bits each for red, green and blue.
    Png,
}

impl Format {
    /// Returns the format for the extension of a file name, in upper or lower case.
    ///
    /// # Errors
    ///
    /// [`PlotError::UnknownFormat`] if the extension is neither `svg` nor `png`.
    pub fn from_path(path: impl AsRef<Path>) -> Result<Format, PlotError> {
        let path = path.as_ref();
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        match extension.to_str() {
            Some("svg") => Ok(Format::Svg),
            Some("png") => Ok(Format::Png),
            _ => Err(PlotError::UnknownFormat { file: path.display().to_string() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extension_decides_in_either_case() {
        let format = |name: &str| Format::from_path(name).ok();
        assert_eq!(format("a/run.svg"), Some(Format::Svg));
        assert_eq!(format("RUN.PNG"), Some(Format::Png));
        assert_eq!(format("svg"), None);
        assert_eq!(format("run.jpeg"), None);
    }

    #[test]
    fn unknown_extension_names_the_known_ones() {
        let message = Format::from_path("run.gif").unwrap_err().to_string();
        assert_eq!(message, "unknown picture format of `run.gif`: the extension must be .svg or .png");
    }
}
