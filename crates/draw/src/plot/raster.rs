//! The PNG backend.
//!
//! Everything is drawn with antialiasing into one pixmap per picture. Texts are filled outlines of the
//! built-in font, so the file does not depend on installed fonts. The pixels of all pictures form one
//! image.

use ab_glyph::OutlineCurve;
use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Rect, Stroke, Transform,
};

use super::colour::Colour;
use super::layout::Frame;
use super::outlines::Outlines;
use super::surface::{Surface, TextStyle, drawing_error};
use super::{Picture, PlotError, Size, draw, font};

/// Renders pictures one below the other and returns the bytes of a PNG file.
pub(super) fn render_sheet(pictures: &[Picture], size: Size, frame: &Frame) -> Result<Vec<u8>, PlotError> {
    let outlines = Outlines::load()?;
    let mut pixels = Vec::new();
    for picture in pictures {
        pixels.extend(one_picture(picture, size, frame, &outlines)?);
    }
    encode(&pixels, size.width, size.height * pictures.len() as u32)
}

/// Renders a line drawing and returns the bytes of a PNG file.
pub(super) fn render_drawing(
    (width, height): (u32, u32),
    paint: impl FnOnce(&mut dyn Surface) -> Result<(), PlotError>,
) -> Result<Vec<u8>, PlotError> {
    encode(&paint_pixels((width, height), 1.0, &Outlines::load()?, paint)?, width, height)
}

/// Returns the bytes of a PNG file. `pixels` are red, green and blue of each pixel, row by row.
fn encode(pixels: &[u8], width: u32, height: u32) -> Result<Vec<u8>, PlotError> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    // A picture consists mostly of flat areas, which compress best without a filter.
    encoder.set_compression(png::Compression::Default);
    encoder.set_filter(png::FilterType::NoFilter);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(file)
}

/// Returns the pixels of one picture.
fn one_picture(
    picture: &Picture,
    size: Size,
    frame: &Frame,
    outlines: &Outlines,
) -> Result<Vec<u8>, PlotError> {
    paint_pixels((size.width, size.height), frame.unit, outlines, |surface| {
        draw::picture(picture, frame, surface)
    })
}

/// Returns what `paint` draws on a white page: red, green and blue of each pixel, row by row.
fn paint_pixels(
    (width, height): (u32, u32),
    unit: f64,
    outlines: &Outlines,
    paint: impl FnOnce(&mut dyn Surface) -> Result<(), PlotError>,
) -> Result<Vec<u8>, PlotError> {
    let mut pixels = Pixmap::new(width, height).ok_or_else(|| drawing_error("the picture has no pixels"))?;
    pixels.fill(Color::WHITE);
    let mut surface = RasterSurface { pixels, scale: unit as f32, outlines };
    paint(&mut surface)?;
    Ok(surface.pixels.pixels().iter().flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect())
}

/// A surface that draws into pixels.
struct RasterSurface<'a> {
    /// The pixels drawn so far.
    pixels: Pixmap,
    /// Pixels per picture unit.
    scale: f32,
    /// The outlines of the letters.
    outlines: &'a Outlines,
}

impl RasterSurface<'_> {
    /// Returns the transformation from picture units to pixels.
    fn transform(&self) -> Transform {
        Transform::from_scale(self.scale, self.scale)
    }

    /// Fills a path; nothing is drawn without a path.
    fn fill(&mut self, path: Option<Path>, paint: &Paint<'_>) {
        if let Some(path) = path {
            self.pixels.fill_path(&path, paint, FillRule::Winding, self.transform(), None);
        }
    }

    /// Draws a line along a path, with round joins and ends; nothing is drawn without a path.
    fn stroke(&mut self, path: Option<Path>, width: f64, paint: &Paint<'_>) {
        let (line_cap, line_join) = (LineCap::Round, LineJoin::Round);
        let stroke = Stroke { width: width as f32, line_cap, line_join, ..Stroke::default() };
        if let Some(path) = path {
            self.pixels.stroke_path(&path, paint, &stroke, self.transform(), None);
        }
    }
}

/// Returns an opaque paint of a colour.
fn ink(colour: Colour) -> Paint<'static> {
    translucent_ink(colour, 1.0)
}

/// Returns a paint of a colour with an opacity from 0 to 1.
fn translucent_ink(colour: Colour, opacity: f64) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(colour.0, colour.1, colour.2, (opacity * f64::from(u8::MAX)).round() as u8);
    paint
}

/// Returns the path through some points; `None` if there are too few.
fn polyline(points: &[(f64, f64)], is_closed: bool) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (index, (x, y)) in points.iter().enumerate() {
        match index {
            0 => path.move_to(*x as f32, *y as f32),
            _ => path.line_to(*x as f32, *y as f32),
        }
    }
    if is_closed {
        path.close();
    }
    path.finish()
}

/// Returns the path of the outlines of letters.
fn glyph_path(curves: &[OutlineCurve]) -> Option<Path> {
    let (mut path, mut end) = (PathBuilder::new(), None);
    for curve in curves {
        let (OutlineCurve::Line(from, to)
        | OutlineCurve::Quad(from, _, to)
        | OutlineCurve::Cubic(from, .., to)) = *curve;
        if end != Some(from) {
            path.move_to(from.x, from.y);
        }
        end = Some(to);
        match curve {
            OutlineCurve::Line(..) => path.line_to(to.x, to.y),
            OutlineCurve::Quad(_, by, _) => path.quad_to(by.x, by.y, to.x, to.y),
            OutlineCurve::Cubic(_, one, two, _) => path.cubic_to(one.x, one.y, two.x, two.y, to.x, to.y),
        }
    }
    path.finish()
}

impl Surface for RasterSurface<'_> {
    fn rectangle(&mut self, from: (f64, f64), to: (f64, f64), colour: Colour) -> Result<(), PlotError> {
        let rectangle = Rect::from_ltrb(from.0 as f32, from.1 as f32, to.0 as f32, to.1 as f32);
        self.fill(rectangle.map(PathBuilder::from_rect), &ink(colour));
        Ok(())
    }

    fn translucent_line(
        &mut self,
        points: &[(f64, f64)],
        width: f64,
        colour: Colour,
        opacity: f64,
    ) -> Result<(), PlotError> {
        let (Some(first), paint) = (points.first(), translucent_ink(colour, opacity)) else { return Ok(()) };
        if points.iter().all(|point| point == first) {
            self.fill(PathBuilder::from_circle(first.0 as f32, first.1 as f32, width as f32), &paint);
        } else {
            self.stroke(polyline(points, false), width, &paint);
        }
        Ok(())
    }

    fn area(&mut self, corners: &[(f64, f64)], colour: Colour) -> Result<(), PlotError> {
        self.fill(polyline(corners, true), &ink(colour));
        Ok(())
    }

    fn ring(&mut self, centre: (f64, f64), radius: f64, width: f64, colour: Colour) -> Result<(), PlotError> {
        let circle = PathBuilder::from_circle(centre.0 as f32, centre.1 as f32, radius as f32);
        self.stroke(circle, width, &ink(colour));
        Ok(())
    }

    fn text(&mut self, text: &str, at: (f64, f64), style: TextStyle) -> Result<(), PlotError> {
        let start = at.0 - style.align.shift(font::width(text, style.size));
        let curves = self.outlines.of_text(text, style.size, (start, at.1));
        self.fill(glyph_path(&curves), &ink(style.colour));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::Align;

    const BLACK: Colour = Colour(0, 0, 0);

    /// Returns the red channel of an image that is 8 pixels wide and 4 pixels high.
    fn painted(paint: impl FnOnce(&mut dyn Surface) -> Result<(), PlotError>) -> Vec<u8> {
        let outlines = Outlines::load().unwrap();
        paint_pixels((8, 4), 2.0, &outlines, paint).unwrap().into_iter().step_by(3).collect()
    }

    #[test]
    fn an_area_covers_its_pixels() {
        let corners = [(1.0, 0.5), (3.0, 0.5), (3.0, 1.5), (1.0, 1.5)];
        let red = painted(|surface| surface.area(&corners, BLACK));
        let row = [255, 255, 0, 0, 0, 0, 255, 255];
        assert_eq!(red, [[255; 8], row, row, [255; 8]].concat());
        assert_eq!(painted(|surface| surface.rectangle((1.0, 0.5), (3.0, 1.5), BLACK)), red);
    }

    #[test]
    fn a_pixel_that_is_half_covered_is_grey() {
        let red = painted(|surface| surface.rectangle((0.0, 0.0), (4.0, 0.25), BLACK));
        assert!(red[..8].iter().all(|value| (126..=129).contains(value)), "{red:?}");
    }

    #[test]
    fn a_line_without_length_is_a_disc() {
        let red = painted(|surface| surface.line(&[(2.0, 1.0), (2.0, 1.0)], 1.0, BLACK));
        assert_eq!((red[8 + 3], red[8 + 4], red[0]), (0, 0, 255));
        assert_eq!(painted(|surface| surface.line(&[], 1.0, BLACK)), [255; 32]);
    }

    #[test]
    fn strokes_with_an_opacity_add_up_where_they_overlap() {
        let points = [(0.0, 1.0), (4.0, 1.0)];
        let red = painted(|surface| surface.translucent_line(&points, 2.0, BLACK, 0.5));
        assert!((126..=129).contains(&red[8 + 4]), "{red:?}");
        let red = painted(|surface| {
            surface.translucent_line(&points, 2.0, BLACK, 0.5)?;
            surface.translucent_line(&points, 2.0, BLACK, 0.5)
        });
        assert!((62..=66).contains(&red[8 + 4]), "{red:?}");
    }

    #[test]
    fn text_is_painted_above_its_baseline() {
        let style = TextStyle { size: 4.0, colour: BLACK, align: Align::Middle };
        let red = painted(|surface| surface.text("H", (2.0, 2.0), style));
        assert!(red.iter().any(|value| *value < 128));
        let below = painted(|surface| surface.text("H", (2.0, 0.0), style));
        assert_eq!(below, [255; 32]);
    }
}
