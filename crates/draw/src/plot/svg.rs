//! The SVG backend.
//!
//! Texts stay texts, so they can be searched and copied. Their width is that of the built-in font only if
//! the viewer has this font; the other families are of similar width.

use std::fmt::Write as _;

use plotters_backend::text_anchor::{HPos, Pos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend as _, FontFamily,
};
use plotters_svg::SVGBackend;

use super::colour::Colour;
use super::layout::Frame;
use super::surface::{Align, Surface, TextStyle, drawing_error, whole_point, whole_points};
use super::{Picture, PlotError, Size, draw};

/// The number of coordinate units per pixel. The drawing library takes whole coordinates only.
const UNITS_PER_PIXEL: u32 = 10;

/// The font families: the built-in font first, then common fonts of similar width.
const FAMILY: &str = "DejaVu Sans, Verdana, Arial, sans-serif";

/// The factor by which the drawing library divides font sizes to get the em size.
const LIBRARY_FONT_FACTOR: f64 = 1.24;

/// The distance, in ems, from the top of top-aligned text to its baseline in the drawing library.
const LIBRARY_ASCENT: f64 = 0.76;

/// Renders pictures one below the other and returns the bytes of an SVG file.
pub(super) fn render_sheet(pictures: &[Picture], size: Size, frame: &Frame) -> Result<Vec<u8>, PlotError> {
    let mut text = String::new();
    let (width, height) = (size.width as usize, size.height as usize * pictures.len());
    open_sheet(&mut text, width, height).map_err(drawing_error)?;
    for (index, picture) in pictures.iter().enumerate() {
        let top = index * (size.height * UNITS_PER_PIXEL) as usize;
        writeln!(text, r#"<g transform="translate(0 {top})">"#).map_err(drawing_error)?;
        text.push_str(&one_picture(picture, size, frame)?);
        text.push_str("</g>\n");
    }
    text.push_str("</svg>\n");
    Ok(text.into_bytes())
}

/// Writes the start of the file. Line joins are round, because mitred joins of noisy traces would
/// have spikes.
fn open_sheet(text: &mut String, width: usize, height: usize) -> std::fmt::Result {
    let units = UNITS_PER_PIXEL as usize;
    writeln!(text, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
    writeln!(
        text,
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {} {}" stroke-linejoin="round" stroke-linecap="round">"#,
        width * units,
        height * units
    )
}

/// Renders a line drawing and returns the bytes of an SVG file.
pub(super) fn render_drawing(
    (width, height): (u32, u32),
    paint: impl FnOnce(&mut dyn Surface) -> Result<(), PlotError>,
) -> Result<Vec<u8>, PlotError> {
    let mut text = String::new();
    open_sheet(&mut text, width as usize, height as usize).map_err(drawing_error)?;
    text.push_str(&paint_text((width, height), 1.0, paint)?);
    text.push_str("</svg>\n");
    Ok(text.into_bytes())
}

/// Returns the SVG text of one picture, without the start and the end of the file.
fn one_picture(picture: &Picture, size: Size, frame: &Frame) -> Result<String, PlotError> {
    paint_text((size.width, size.height), frame.unit, |surface| draw::picture(picture, frame, surface))
}

/// Returns the SVG text of what `paint` draws.
fn paint_text(
    size: (u32, u32),
    unit: f64,
    paint: impl FnOnce(&mut dyn Surface) -> Result<(), PlotError>,
) -> Result<String, PlotError> {
    let mut text = String::new();
    let coordinate_size = (size.0 * UNITS_PER_PIXEL, size.1 * UNITS_PER_PIXEL);
    let mut surface = SvgSurface {
        backend: SVGBackend::with_string(&mut text, coordinate_size),
        scale: unit * f64::from(UNITS_PER_PIXEL),
    };
    paint(&mut surface)?;
    surface.backend.present().map_err(drawing_error)?;
    drop(surface);
    Ok(text)
}

/// A surface that writes SVG elements.
struct SvgSurface<'a> {
    /// The writer of the drawing library. It takes whole coordinate units.
    backend: SVGBackend<'a>,
    /// Coordinate units per picture unit.
    scale: f64,
}

impl Surface for SvgSurface<'_> {
    fn rectangle(&mut self, from: (f64, f64), to: (f64, f64), colour: Colour) -> Result<(), PlotError> {
        let (from, to) = (whole_point(from, self.scale), whole_point(to, self.scale));
        self.backend.draw_rect(from, to, &library_colour(colour), true).map_err(drawing_error)
    }

    fn translucent_line(
        &mut self,
        points: &[(f64, f64)],
        width: f64,
        colour: Colour,
        opacity: f64,
    ) -> Result<(), PlotError> {
        let width = (width * self.scale).round() as u32;
        let colour = BackendColor { alpha: opacity, ..library_colour(colour) };
        let points = whole_points(points, self.scale);
        if let [dot] = points[..] {
            self.backend.draw_circle(dot, width, &colour, true)
        } else {
            self.backend.draw_path(points, &Outline { width, colour })
        }
        .map_err(drawing_error)
    }

    fn area(&mut self, corners: &[(f64, f64)], colour: Colour) -> Result<(), PlotError> {
        let corners = whole_points(corners, self.scale);
        self.backend.fill_polygon(corners, &library_colour(colour)).map_err(drawing_error)
    }

    fn ring(&mut self, centre: (f64, f64), radius: f64, width: f64, colour: Colour) -> Result<(), PlotError> {
        let (radius, width) = ((radius * self.scale).round() as u32, (width * self.scale).round() as u32);
        let centre = whole_point(centre, self.scale);
        let outline = Outline { width, colour: library_colour(colour) };
        self.backend.draw_circle(centre, radius, &outline, false).map_err(drawing_error)
    }

    fn text(&mut self, text: &str, at: (f64, f64), style: TextStyle) -> Result<(), PlotError> {
        let size = style.size * self.scale * LIBRARY_FONT_FACTOR;
        let top = whole_point((at.0, at.1 - style.size * LIBRARY_ASCENT), self.scale);
        self.backend.draw_text(text, &LibraryText { size, style }, top).map_err(drawing_error)
    }
}

/// Returns the colour in terms of the drawing library.
fn library_colour(colour: Colour) -> BackendColor {
    BackendColor { alpha: 1.0, rgb: (colour.0, colour.1, colour.2) }
}

/// A line with a thickness in coordinate units.
struct Outline {
    /// The thickness.
    width: u32,
    /// The colour.
    colour: BackendColor,
}

impl BackendStyle for Outline {
    fn color(&self) -> BackendColor {
        self.colour
    }

    fn stroke_width(&self) -> u32 {
        self.width
    }
}

/// The style of a line of text in terms of the drawing library.
struct LibraryText {
    /// The font size of the library.
    size: f64,
    /// The colour and the alignment.
    style: TextStyle,
}

impl BackendTextStyle for LibraryText {
    type FontError = std::fmt::Error;

    fn color(&self) -> BackendColor {
        library_colour(self.style.colour)
    }

    fn size(&self) -> f64 {
        self.size
    }

    fn anchor(&self) -> Pos {
        Pos::new(horizontal_position(self.style.align), VPos::Top)
    }

    fn family(&self) -> FontFamily<'_> {
        FontFamily::Name(FAMILY)
    }

    /// Only a library backend that paints letters asks for their place. The viewer of an SVG places them.
    fn layout_box(&self, _: &str) -> Result<((i32, i32), (i32, i32)), Self::FontError> {
        Err(std::fmt::Error)
    }

    /// Only a library backend that paints letters asks for their pixels.
    fn draw<E, Paint: FnMut(i32, i32, BackendColor) -> Result<(), E>>(
        &self,
        _: &str,
        _: BackendCoord,
        _: Paint,
    ) -> Result<Result<(), E>, Self::FontError> {
        Err(std::fmt::Error)
    }
}

/// Returns the alignment in terms of the drawing library.
fn horizontal_position(align: Align) -> HPos {
    match align {
        Align::Start => HPos::Left,
        Align::Middle => HPos::Center,
        Align::End => HPos::Right,
    }
}
