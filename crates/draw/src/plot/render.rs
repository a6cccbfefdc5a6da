//! Renders a sheet of scope pictures.

use super::layout::Frame;
use super::{Axis, Drawing, Format, Picture, PlotError, raster, svg};

/// The size of one picture in pixels.
///
/// # Examples
///
/// ```
/// use patchcord_draw::plot::{Axis, Format, Picture, PlotError, Size, render};
///
/// assert_eq!(Size::default(), Size { width: 900, height: 560 });
/// let axis = || Axis::fit("x", "", [0.0, 1.0], 10);
/// let picture = Picture::new("", axis(), axis());
/// let small = Size { width: 100, height: 100 };
/// assert!(matches!(render(&[picture], Format::Svg, small), Err(PlotError::Size(_))));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size {
    /// The width, from [`Size::MIN_SIDE`] to [`Size::MAX_SIDE`].
    pub width: u32,
    /// The height, from [`Size::MIN_SIDE`] to [`Size::MAX_SIDE`].
    pub height: u32,
}

impl Size {
    /// The minimum length of a side; a smaller picture has no space for its numbers and texts.
    pub const MIN_SIDE: u32 = 240;
    /// The maximum length of a side of a picture.
    pub const MAX_SIDE: u32 = 4000;
    /// The maximum height of a sheet of pictures.
    pub const MAX_SHEET_HEIGHT: u32 = 60_000;
    /// The minimum of the pixels of a PNG file per pixel of this size.
    pub const MIN_SCALE: f64 = 0.25;
    /// The maximum of the pixels of a PNG file per pixel of this size.
    pub const MAX_SCALE: f64 = 10.0;

    /// Returns the size with both sides multiplied by a factor.
    fn scaled(self, scale: f64) -> Size {
        let side = |length: u32| (f64::from(length) * scale).round() as u32;
        Size { width: side(self.width), height: side(self.height) }
    }
}

impl Default for Size {
    fn default() -> Size {
        Size { width: 900, height: 560 }
    }
}

/// Renders pictures one below the other, each of the given size, and returns the bytes of the file.
///
/// Equal pictures give equal bytes. Long traces are thinned to the resolution of the picture. Lines
/// are clipped at the edge of the screen. Texts that are too long end in an ellipsis.
///
/// # Errors
///
/// * [`PlotError::NoPictures`] if there is no picture.
/// * [`PlotError::Size`] or [`PlotError::TooTall`] if the limits of [`Size`] are exceeded.
/// * [`PlotError::Range`] if the ends of an axis are equal or not finite, or if its number of divisions
///   is not 1 to [`Axis::MAX_DIVISIONS`].
/// * [`PlotError::Font`], [`PlotError::Drawing`] or [`PlotError::Png`] if a library fails.
///
/// # Examples
///
/// ```
/// use patchcord_draw::plot::{Axis, Channel, Format, Picture, PlotError, Size, render};
///
/// let axis = |label: &str, divisions: usize| Axis::fit(label, "mm", [0.0, 8.0], divisions);
/// let channels = vec![Channel::line("y", vec![(0.0, 0.0), (8.0, 8.0)])];
/// let picture = Picture { channels, ..Picture::new("Line", axis("x", 10), axis("y", 8)) };
///
/// let png = render(&[picture], Format::Png, Size { width: 320, height: 240 })?;
/// assert!(png.starts_with(b"\x89PNG"));
/// assert!(matches!(render(&[], Format::Svg, Size::default()), Err(PlotError::NoPictures)));
/// # Ok::<(), PlotError>(())
/// ```
pub fn render(pictures: &[Picture], format: Format, size: Size) -> Result<Vec<u8>, PlotError> {
    render_scaled(pictures, format, size, 1.0)
}

/// Renders pictures like [`render()`]; a PNG file has `scale` times as many pixels per side.
///
/// The layout and the relative size of texts do not depend on `scale`. An SVG file has no pixels, so `scale` does not
/// change it.
///
/// # Errors
///
/// As for [`render()`]. Also [`PlotError::Scale`] if `scale` is not [`Size::MIN_SCALE`] to [`Size::MAX_SCALE`], and
/// [`PlotError::TooLarge`] if a PNG has more than [`Drawing::MAX_PNG_PIXELS`].
///
/// # Examples
///
/// ```
/// use patchcord_draw::plot::{Axis, Format, Picture, PlotError, Size, render_scaled};
///
/// let axis = || Axis::fit("x", "", [0.0, 1.0], 10);
/// let (pictures, size) = ([Picture::new("", axis(), axis())], Size { width: 320, height: 240 });
/// let fine = render_scaled(&pictures, Format::Png, size, 2.0)?;
/// assert_eq!(fine[16..24], [0_u8, 0, 2, 128, 0, 0, 1, 224], "640 x 480 pixels");
/// # Ok::<(), PlotError>(())
/// ```
pub fn render_scaled(
    pictures: &[Picture],
    format: Format,
    size: Size,
    scale: f64,
) -> Result<Vec<u8>, PlotError> {
    check_sheet(pictures.len(), format, size, scale)?;
    pictures.iter().flat_map(Picture::axes).try_for_each(check_axis)?;
    let frame = Frame::for_pictures(pictures, size);
    match format {
        Format::Svg => svg::render_sheet(pictures, size, &frame),
        Format::Png => raster::render_sheet(pictures, size.scaled(scale), &frame.magnified(scale)),
    }
}

/// Checks whether a sheet with this number of pictures can be rendered, before there are any pictures.
///
/// # Errors
///
/// The errors of [`render_scaled()`] that concern the number of pictures, the size and the scale.
///
/// # Examples
///
/// ```
/// use patchcord_draw::plot::{Format, Size, check_sheet};
///
/// assert!(check_sheet(4, Format::Png, Size::default(), 2.0).is_ok());
/// assert!(check_sheet(40, Format::Png, Size::default(), 10.0).is_err(), "too many pixels");
/// ```
pub fn check_sheet(pictures: usize, format: Format, size: Size, scale: f64) -> Result<(), PlotError> {
    check_size(size, pictures)?;
    if !(Size::MIN_SCALE..=Size::MAX_SCALE).contains(&scale) {
        return Err(PlotError::Scale(scale));
    }
    let pixels = size.scaled(scale);
    let (width, height) = (f64::from(pixels.width), f64::from(pixels.height) * pictures as f64);
    if format == Format::Png && width * height > Drawing::MAX_PNG_PIXELS {
        return Err(PlotError::TooLarge { width, height, limit: Drawing::pixel_limit() });
    }
    Ok(())
}

/// Checks the size of a picture and the number of pictures.
fn check_size(size: Size, pictures: usize) -> Result<(), PlotError> {
    let permitted = Size::MIN_SIDE..=Size::MAX_SIDE;
    if pictures == 0 {
        Err(PlotError::NoPictures)
    } else if !permitted.contains(&size.width) || !permitted.contains(&size.height) {
        Err(PlotError::Size(size))
    } else if pictures > (Size::MAX_SHEET_HEIGHT / size.height) as usize {
        Err(PlotError::TooTall { pictures })
    } else {
        Ok(())
    }
}

/// Checks that an axis can be drawn.
fn check_axis(axis: &Axis) -> Result<(), PlotError> {
    if axis.is_drawable() {
        return Ok(());
    }
    Err(PlotError::Range {
        label: axis.label.clone(),
        low: axis.low,
        high: axis.high,
        divisions: axis.divisions,
    })
}

#[cfg(test)]
mod tests;
