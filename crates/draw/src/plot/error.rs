//! The errors of rendering.

use super::Size;

/// The reasons why a picture or drawing cannot be rendered.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlotError {
    /// The extension of the file name is neither `.svg` nor `.png`.
    #[error("unknown picture format of `{file}`: the extension must be .svg or .png")]
    UnknownFormat {
        /// The file name as the user gave it.
        file: String,
    },
    /// The sheet contains no picture.
    #[error("there is no picture to draw")]
    NoPictures,
    /// A side of a picture is shorter than [`Size::MIN_SIDE`] or longer than [`Size::MAX_SIDE`].
    #[error(
        "each side of a picture must have {min} to {max} pixels, got {width} x {height}",
        width = .0.width, height = .0.height, min = Size::MIN_SIDE, max = Size::MAX_SIDE
    )]
    Size(Size),
    /// The scale of a PNG is less than [`Size::MIN_SCALE`] or greater than [`Size::MAX_SCALE`].
    #[error(
        "the scale must be {min} to {max}, got {scale}",
        scale = .0, min = Size::MIN_SCALE, max = Size::MAX_SCALE
    )]
    Scale(f64),
    /// The stacked pictures are higher than [`Size::MAX_SHEET_HEIGHT`].
    #[error(
        "a sheet of {pictures} pictures is higher than {max} pixels; draw fewer or smaller pictures",
        max = Size::MAX_SHEET_HEIGHT
    )]
    TooTall {
        /// The number of pictures of the sheet.
        pictures: usize,
    },
    /// A line drawing exceeds the limits of [`super::Drawing`].
    #[error("a drawing of {width:.0} x {height:.0} pixels cannot be drawn: {limit}")]
    TooLarge {
        /// The width in pixels.
        width: f64,
        /// The height in pixels.
        height: f64,
        /// The limit that is exceeded, as a sentence.
        limit: String,
    },
    /// The range of an axis is empty or not finite, or its number of divisions is out of range.
    #[error("axis `{label}`: {low} to {high} in {divisions} divisions cannot be drawn")]
    Range {
        /// The label of the axis.
        label: String,
        /// The value at its low end.
        low: f64,
        /// The value at its high end.
        high: f64,
        /// Its number of divisions.
        divisions: usize,
    },
    /// The built-in font cannot be read.
    #[error("the built-in font cannot be read: {0}")]
    Font(#[from] ab_glyph::InvalidFont),
    /// The drawing library failed.
    #[error("drawing failed: {0}")]
    Drawing(String),
    /// The PNG encoder failed.
    #[error("writing PNG failed: {0}")]
    Png(#[from] png::EncodingError),
}
