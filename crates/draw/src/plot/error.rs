use super::Size;

/// Why no picture was drawn.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    /// The file name does not end in a known extension.
    #[error("`{file}` names no known picture format; known are .svg and .png")]
    UnknownFormat {
        /// The file name as given.
        file: String,
    },
    /// The sheet is empty.
    #[error("there is no picture to draw")]
    NoPictures,
    /// The size of a picture is outside what can be drawn.
    #[error(
        "a picture of {width} x {height} pixels cannot be drawn; each side must be {least} to {most}",
        width = .0.width, height = .0.height, least = Size::LEAST, most = Size::MOST
    )]
    Size(Size),
    /// The stacked pictures make too tall a sheet.
    #[error("{pictures} pictures stack to more than {most} pixels; draw fewer or smaller ones", most = Size::TALLEST)]
    TooTall {
        /// How many pictures were to be stacked.
        pictures: usize,
    },
    /// A line drawing is larger than can be drawn.
    #[error("a drawing of {width:.0} x {height:.0} pixels cannot be drawn: {limit}")]
    TooLarge {
        /// Pixels across.
        width: f64,
        /// Pixels down.
        height: f64,
        /// What is the most.
        limit: String,
    },
    /// An axis has no finite range, or a number of divisions that cannot be drawn.
    #[error("axis `{label}`: {low} to {high} in {divisions} divisions cannot be drawn")]
    Range {
        /// The label of the axis.
        label: String,
        /// The low end of its range.
        low: f64,
        /// The high end of its range.
        high: f64,
        /// Its number of divisions.
        divisions: usize,
    },
    /// The built-in font could not be read.
    #[error("the built-in font cannot be read: {0}")]
    Font(#[from] ab_glyph::InvalidFont),
    /// Drawing failed.
    #[error("drawing failed: {0}")]
    Drawing(String),
    /// The PNG file could not be put together.
    #[error("writing PNG failed: {0}")]
    Png(#[from] png::EncodingError),
}
