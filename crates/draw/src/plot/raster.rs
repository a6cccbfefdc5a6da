use std::f64::consts::TAU;

use plotters::backend::{BitMapBackend, DrawingBackend as _};
use plotters::style::{Color as _, RGBColor};

use super::layout::Frame;
use super::surface::{Lettering, Surface, drawing_error, whole_point, whole_points};
use super::{Picture, PlotError, Size, draw, font::Font};

/// Bytes of red, green and blue.
const CHANNELS: usize = 3;

/// Above this many pixels pictures are drawn less fine, to spare memory.
const LARGE: u32 = 4_000_000;

/// Above this many pixels lines are not smoothed at all.
const VERY_LARGE: u32 = 20_000_000;

/// Edges of a circle drawn as a polygon.
const CIRCLE_EDGES: u32 = 64;

/// The pictures one below the other as the bytes of a PNG file.
pub(super) fn sheet(
    pictures: &[Picture],
    size: Size,
    frame: &Frame,
    font: &Font,
) -> Result<Vec<u8>, PlotError> {
    let mut pixels = Vec::new();
    for picture in pictures {
        pixels.extend(one_picture(picture, size, frame, font)?);
    }
    encode(&pixels, size.width, size.height * pictures.len() as u32)
}

fn encode(pixels: &[u8], width: u32, height: u32) -> Result<Vec<u8>, PlotError> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    // Flat areas, of which a picture mostly consists, pack best as they are.
    encoder.set_compression(png::Compression::Default);
    encoder.set_filter(png::FilterType::NoFilter);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(file)
}

/// The library draws lines without smoothing, so the picture is drawn several
/// times as large as wanted and averaged down.
fn one_picture(picture: &Picture, size: Size, frame: &Frame, font: &Font) -> Result<Vec<u8>, PlotError> {
    painted((size.width, size.height), frame.unit, font, |surface| {
        draw::picture(picture, frame, font, surface)
    })
}

/// A line drawing as the bytes of a PNG file.
pub(super) fn drawing(
    (width, height): (u32, u32),
    font: &Font,
    paint: impl FnOnce(&mut dyn Surface) -> Result<(), PlotError>,
) -> Result<Vec<u8>, PlotError> {
    encode(&painted((width, height), 1.0, font, paint)?, width, height)
}

fn painted(
    size: (u32, u32),
    unit: f64,
    font: &Font,
    paint: impl FnOnce(&mut dyn Surface) -> Result<(), PlotError>,
) -> Result<Vec<u8>, PlotError> {
    let pixels = size.0 * size.1;
    let fineness = [(LARGE, 4), (VERY_LARGE, 2)].iter().find(|(most, _)| pixels <= *most);
    let fineness = fineness.map_or(1, |(_, fineness)| *fineness);
    let (width, height) = (size.0 * fineness, size.1 * fineness);
    let mut fine = vec![0; width as usize * height as usize * CHANNELS];
    let mut surface = RasterSurface {
        backend: BitMapBackend::with_buffer(&mut fine, (width, height)),
        scale: unit * f64::from(fineness),
        font,
    };
    paint(&mut surface)?;
    surface.backend.present().map_err(drawing_error)?;
    drop(surface);
    Ok(averaged(&fine, width as usize, fineness as usize))
}

/// The picture with squares of `side` by `side` pixels made into one.
fn averaged(fine: &[u8], width: usize, side: usize) -> Vec<u8> {
    let row = width * CHANNELS;
    let area = (side * side) as u32;
    let mut pixels = Vec::with_capacity(fine.len() / (side * side));
    for band in fine.chunks_exact(row * side) {
        let mut sums = vec![area / 2; row / side];
        for line in band.chunks_exact(row) {
            add_squares(line, side, &mut sums);
        }
        pixels.extend(sums.into_iter().map(|sum| (sum / area) as u8));
    }
    pixels
}

fn add_squares(line: &[u8], side: usize, sums: &mut [u32]) {
    let squares = line.chunks_exact(side * CHANNELS);
    for (square, sums) in squares.zip(sums.chunks_exact_mut(CHANNELS)) {
        for pixel in square.chunks_exact(CHANNELS) {
            for (sum, value) in sums.iter_mut().zip(pixel) {
                *sum += u32::from(*value);
            }
        }
    }
}

struct RasterSurface<'a> {
    backend: BitMapBackend<'a>,
    scale: f64,
    font: &'a Font,
}

impl RasterSurface<'_> {
    /// The library rounds the corners of thick lines down, which makes their
    /// width depend on the direction; this draws them rounded to the nearest.
    fn thick_segment(
        &mut self,
        from: (i32, i32),
        to: (i32, i32),
        width: f64,
        colour: RGBColor,
    ) -> Result<(), PlotError> {
        let (dx, dy) = (f64::from(to.0 - from.0), f64::from(to.1 - from.1));
        let half = width / 2.0 / dx.hypot(dy);
        let corner = |at: (i32, i32), side: f64| {
            let at = (f64::from(at.0), f64::from(at.1));
            whole_point((at.0 - side * dy * half, at.1 + side * dx * half), 1.0)
        };
        let corners = [corner(from, 1.0), corner(to, 1.0), corner(to, -1.0), corner(from, -1.0)];
        self.backend.fill_polygon(corners, &colour).map_err(drawing_error)
    }

    fn disc(&mut self, at: (i32, i32), diameter: f64, colour: RGBColor) -> Result<(), PlotError> {
        let radius = (diameter / 2.0).round() as u32;
        self.backend.draw_circle(at, radius, &colour, true).map_err(drawing_error)
    }
}

impl Surface for RasterSurface<'_> {
    fn rectangle(&mut self, from: (f64, f64), to: (f64, f64), colour: RGBColor) -> Result<(), PlotError> {
        let (from, to) = (whole_point(from, self.scale), whole_point(to, self.scale));
        self.backend.draw_rect(from, to, &colour, true).map_err(drawing_error)
    }

    fn line(&mut self, points: &[(f64, f64)], width: f64, colour: RGBColor) -> Result<(), PlotError> {
        let width = width * self.scale;
        let points = whole_points(points, self.scale);
        if let [dot] = points[..] {
            return self.disc(dot, 2.0 * width, colour);
        }
        for ends in points.windows(2) {
            self.thick_segment(ends[0], ends[1], width, colour)?;
            self.disc(ends[1], width - 1.0, colour)?;
        }
        Ok(())
    }

    fn area(&mut self, corners: &[(f64, f64)], colour: RGBColor) -> Result<(), PlotError> {
        self.backend.fill_polygon(whole_points(corners, self.scale), &colour).map_err(drawing_error)
    }

    fn ring(
        &mut self,
        centre: (f64, f64),
        radius: f64,
        width: f64,
        colour: RGBColor,
    ) -> Result<(), PlotError> {
        let corner = |edge: u32| {
            let (sin, cos) = (TAU * f64::from(edge) / f64::from(CIRCLE_EDGES)).sin_cos();
            (centre.0 + radius * cos, centre.1 + radius * sin)
        };
        let corners: Vec<_> = (0..=CIRCLE_EDGES).map(corner).collect();
        self.line(&corners, width, colour)
    }

    fn text(&mut self, text: &str, at: (f64, f64), lettering: Lettering) -> Result<(), PlotError> {
        let size = lettering.size * self.scale;
        let shift = lettering.align.shift(self.font.width(text, size));
        let start = (at.0 * self.scale - shift, at.1 * self.scale);
        let mut outcome = Ok(());
        let backend = &mut self.backend;
        self.font.paint(text, size, start, |pixel, cover| {
            let ink = lettering.colour.mix(cover).to_backend_color();
            if let Err(error) = backend.draw_pixel(pixel, ink) {
                outcome = Err(drawing_error(error));
            }
        });
        outcome
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_are_averaged_channel_by_channel() {
        let fine = [
            [0, 10, 255],
            [0, 20, 255],
            [8, 8, 8],
            [8, 8, 8],
            [0, 30, 255],
            [4, 40, 255],
            [8, 8, 8],
            [8, 8, 8],
        ];
        assert_eq!(averaged(fine.as_flattened(), 4, 2), [1, 25, 255, 8, 8, 8]);
    }
}
