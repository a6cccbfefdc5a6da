//! The outlines of texts in the built-in font, for pictures of pixels.

use ab_glyph::{Font as _, FontRef, OutlineCurve, Point, PxScale, ScaleFont as _, point};

use super::{PlotError, font};

/// DejaVu Sans, reduced to the characters that pictures use. Its licence is in `font/LICENSE.txt`.
pub(super) static FONT_FILE: &[u8] = include_bytes!("font/DejaVuSans-subset.ttf");

/// The outlines of the letters of the built-in font.
pub(super) struct Outlines(FontRef<'static>);

impl Outlines {
    /// Parses the font.
    pub(super) fn load() -> Result<Outlines, PlotError> {
        Ok(Outlines(FontRef::try_from_slice(FONT_FILE)?))
    }

    /// Returns the outlines of a line of text at an em size as closed curves. `start` is the start of the baseline.
    pub(super) fn of_text(&self, text: &str, size: f64, start: (f64, f64)) -> Vec<OutlineCurve> {
        // The scale of the font library is the line height in pixels.
        let font = self.0.as_scaled(PxScale::from(font::line_height(size)));
        let (factor, mut pen) = (font.scale_factor(), point(start.0 as f32, start.1 as f32));
        let mut curves = Vec::new();
        for letter in text.chars() {
            let id = font.glyph_id(letter);
            // The y axis of the font points up.
            let position =
                |at: Point| point(pen.x + at.x * factor.horizontal, pen.y - at.y * factor.vertical);
            let outline = self.0.outline(id).map_or(Vec::new(), |outline| outline.curves);
            curves.extend(outline.into_iter().map(|curve| match curve {
                OutlineCurve::Line(from, to) => OutlineCurve::Line(position(from), position(to)),
                OutlineCurve::Quad(from, by, to) => {
                    OutlineCurve::Quad(position(from), position(by), position(to))
                }
                OutlineCurve::Cubic(from, one, two, to) => {
                    OutlineCurve::Cubic(position(from), position(one), position(two), position(to))
                }
            }));
            pen.x += font.h_advance(id);
        }
        curves
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_end_at_the_baseline() {
        let outlines = Outlines::load().unwrap();
        let height = |curve: OutlineCurve| match curve {
            OutlineCurve::Line(_, to) | OutlineCurve::Quad(.., to) | OutlineCurve::Cubic(.., to) => to.y,
        };
        let curves = outlines.of_text("H", 20.0, (3.0, 50.0));
        assert_eq!(curves.into_iter().map(height).fold(f32::MIN, f32::max), 50.0);
    }
}
