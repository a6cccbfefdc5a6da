//! The built-in font: widths, truncation and outlines of texts.

use std::sync::OnceLock;

use ab_glyph::{Font as _, FontRef, OutlineCurve, Point, PxScale, ScaleFont as _, point};

use super::PlotError;

/// DejaVu Sans, reduced to the characters that pictures use. Its licence is in `font/LICENSE.txt`.
static FONT_FILE: &[u8] = include_bytes!("font/DejaVuSans-subset.ttf");

/// The end of a truncated text.
const ELLIPSIS: char = '…';

/// The built-in font. All sizes are em sizes.
pub(super) struct Font(FontRef<'static>);

impl Font {
    /// Parses the font.
    pub(super) fn load() -> Result<Font, PlotError> {
        Ok(Font(FontRef::try_from_slice(FONT_FILE)?))
    }

    /// Returns the font; it is parsed on the first call only.
    pub(super) fn shared() -> Result<&'static Font, PlotError> {
        static FONT: OnceLock<Font> = OnceLock::new();
        if let Some(font) = FONT.get() {
            return Ok(font);
        }
        let font = Font::load()?;
        Ok(FONT.get_or_init(|| font))
    }

    /// Returns the width of a line of text.
    pub(super) fn width(&self, text: &str, size: f64) -> f64 {
        let font = self.0.as_scaled(self.scale(size));
        text.chars().map(|letter| f64::from(font.h_advance(font.glyph_id(letter)))).sum()
    }

    /// Returns the text as one printable line, truncated to a maximum width.
    ///
    /// A truncated text ends in an ellipsis.
    pub(super) fn truncated(&self, text: &str, size: f64, max_width: f64) -> String {
        let text = printable(text);
        if self.width(&text, size) <= max_width {
            return text;
        }
        let max_width = max_width - self.width(&ELLIPSIS.to_string(), size);
        let mut used = 0.0;
        let fits = |letter: &char| {
            used += self.width(letter.encode_utf8(&mut [0; 4]), size);
            used <= max_width
        };
        let beginning: String = text.chars().take_while(fits).collect();
        format!("{}{ELLIPSIS}", beginning.trim_end())
    }

    /// Returns the text followed by `ending`. If both do not fit, the text is truncated, not the ending.
    pub(super) fn truncated_before(&self, ending: &str, text: &str, size: f64, max_width: f64) -> String {
        let beginning = self.truncated(text, size, max_width - self.width(ending, size));
        self.truncated(&format!("{beginning}{ending}"), size, max_width)
    }

    /// Returns the outlines of a line of text as closed curves. `start` is the start of the baseline.
    pub(super) fn outlines(&self, text: &str, size: f64, start: (f64, f64)) -> Vec<OutlineCurve> {
        let font = self.0.as_scaled(self.scale(size));
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

    /// Converts an em size to the scale of the font library, which is the line height in pixels.
    fn scale(&self, size: f64) -> PxScale {
        let em = self.0.units_per_em().unwrap_or(1.0);
        PxScale::from(size as f32 * self.0.height_unscaled() / em)
    }
}

/// Replaces every hyphen of a number by a minus sign, which is as wide as a plus sign.
pub(crate) fn with_minus_sign(number: &str) -> String {
    number.replace('-', "−")
}

/// Replaces characters that cannot be printed by blanks. Some of them are not permitted in SVG.
pub(super) fn printable(text: &str) -> String {
    let is_unprintable = |letter: char| letter.is_control() || matches!(letter, '\u{fffe}' | '\u{ffff}');
    text.replace(is_unprintable, " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_of_measurement_are_in_the_font() {
        let font = Font::load().unwrap();
        for sign in "aZ09_,Äéßλ×÷µμΩΔω°·−⁻⁰¹²³⁴⁵⁶⁷⁸⁹₀₁₂→←↑↓≤≥±∞…".chars()
        {
            assert_ne!(font.0.glyph_id(sign).0, 0, "{sign}");
        }
    }

    #[test]
    fn long_text_is_truncated_to_the_width() {
        let font = Font::load().unwrap();
        let long = "velocity of the drive ".repeat(40);
        let short = font.truncated(&long, 14.0, 200.0);
        assert!(short.ends_with('…'));
        assert!(font.width(&short, 14.0) <= 200.0);
        assert_eq!(font.truncated("v_o", 14.0, 200.0), "v_o");
        let short = font.truncated_before(", mm/s", &long, 14.0, 200.0);
        assert!(short.ends_with("…, mm/s") && font.width(&short, 14.0) <= 200.0);
    }

    #[test]
    fn letters_end_at_the_baseline() {
        let font = Font::load().unwrap();
        let height = |curve: OutlineCurve| match curve {
            OutlineCurve::Line(_, to) | OutlineCurve::Quad(.., to) | OutlineCurve::Cubic(.., to) => to.y,
        };
        let lowest = font.outlines("H", 20.0, (3.0, 50.0)).into_iter().map(height).fold(f32::MIN, f32::max);
        assert_eq!(lowest, 50.0);
    }
}
