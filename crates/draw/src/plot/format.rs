use std::path::Path;

use super::PlotError;

/// The kinds of picture file that can be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Scalable drawing, UTF-8 text.
    Svg,
    /// Pixels, 8 bits each of red, green and blue.
    Png,
}

impl Format {
    /// The format a file name asks for by its extension, in either case.
    ///
    /// # Errors
    ///
    /// [`PlotError::UnknownFormat`] when the extension is neither `svg` nor `png`.
    pub fn from_path(path: &Path) -> Result<Format, PlotError> {
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
        let format = |name: &str| Format::from_path(Path::new(name)).ok();
        assert_eq!(format("a/run.svg"), Some(Format::Svg));
        assert_eq!(format("RUN.PNG"), Some(Format::Png));
        assert_eq!(format("svg"), None);
        assert_eq!(format("run.jpeg"), None);
    }

    #[test]
    fn unknown_extension_names_the_known_ones() {
        let message = Format::from_path(Path::new("run.gif")).unwrap_err().to_string();
        assert!(message.contains("run.gif"));
        assert!(message.contains(".svg") && message.contains(".png"));
    }
}
