use std::sync::OnceLock;

use ab_glyph::{Font as _, FontRef, PxScale, ScaleFont as _, point};

use super::PlotError;

/// DejaVu Sans, reduced to the letters and signs that pictures use.
static FONT_FILE: &[u8] = include_bytes!("font/DejaVuSans-subset.ttf");

const ELLIPSIS: char = '…';

/// The built-in font. Sizes are those of the em square.
pub(super) struct Font(FontRef<'static>);

impl Font {
    pub(super) fn load() -> Result<Font, PlotError> {
        Ok(Font(FontRef::try_from_slice(FONT_FILE)?))
    }

    /// The font, read once for as many questions as there are.
    pub(super) fn shared() -> Result<&'static Font, PlotError> {
        static FONT: OnceLock<Font> = OnceLock::new();
        if let Some(font) = FONT.get() {
            return Ok(font);
        }
        let font = Font::load()?;
        Ok(FONT.get_or_init(|| font))
    }

    /// How wide a line of text is.
    pub(super) fn width(&self, text: &str, size: f64) -> f64 {
        let font = self.0.as_scaled(self.scale(size));
        text.chars().map(|letter| f64::from(font.h_advance(font.glyph_id(letter)))).sum()
    }

    /// The text as one plain line, or as much of its beginning as the room allows.
    pub(super) fn shortened(&self, text: &str, size: f64, room: f64) -> String {
        let text = plain(text);
        if self.width(&text, size) <= room {
            return text;
        }
        let room = room - self.width(&ELLIPSIS.to_string(), size);
        let mut used = 0.0;
        let fits = |letter: &char| {
            used += self.width(letter.encode_utf8(&mut [0; 4]), size);
            used <= room
        };
        let beginning: String = text.chars().take_while(fits).collect();
        format!("{}{ELLIPSIS}", beginning.trim_end())
    }

    /// Like [`Font::shortened`], but what is lost comes before the ending.
    pub(super) fn shortened_before(&self, ending: &str, text: &str, size: f64, room: f64) -> String {
        let beginning = self.shortened(text, size, room - self.width(ending, size));
        self.shortened(&format!("{beginning}{ending}"), size, room)
    }

    /// Hands every pixel a line of text touches, and how much of the pixel it
    /// covers, to `paint`. The line starts at `start`, which is on the baseline.
    pub(super) fn paint(
        &self,
        text: &str,
        size: f64,
        start: (f64, f64),
        mut paint: impl FnMut((i32, i32), f64),
    ) {
        let scale = self.scale(size);
        let font = self.0.as_scaled(scale);
        let mut pen = point(start.0 as f32, start.1 as f32);
        for letter in text.chars() {
            let id = font.glyph_id(letter);
            let glyph = id.with_scale_and_position(scale, pen);
            pen.x += font.h_advance(id);
            if let Some(outline) = font.outline_glyph(glyph) {
                let corner = outline.px_bounds().min;
                outline.draw(|x, y, cover| {
                    let pixel = (corner.x as i32 + x as i32, corner.y as i32 + y as i32);
                    paint(pixel, f64::from(cover));
                });
            }
        }
    }

    fn scale(&self, size: f64) -> PxScale {
        let em = self.0.units_per_em().unwrap_or(1.0);
        PxScale::from(size as f32 * self.0.height_unscaled() / em)
    }
}

/// The text with a blank for every sign that is not to be printed, some of
/// which an SVG file must not hold.
pub(super) fn plain(text: &str) -> String {
    let unprintable = |letter: char| letter.is_control() || matches!(letter, '\u{fffe}' | '\u{ffff}');
    text.replace(unprintable, " ")
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
    fn long_text_is_cut_to_the_room() {
        let font = Font::load().unwrap();
        let long = "velocity of the drive ".repeat(40);
        let cut = font.shortened(&long, 14.0, 200.0);
        assert!(cut.ends_with('…'));
        assert!(font.width(&cut, 14.0) <= 200.0);
        assert_eq!(font.shortened("v_o", 14.0, 200.0), "v_o");
        let cut = font.shortened_before(", mm/s", &long, 14.0, 200.0);
        assert!(cut.ends_with("…, mm/s") && font.width(&cut, 14.0) <= 200.0);
    }

    #[test]
    fn letters_stand_on_the_baseline() {
        let font = Font::load().unwrap();
        let mut lowest = i32::MIN;
        font.paint("H", 20.0, (3.0, 50.0), |(_, y), cover| {
            if cover > 0.5 {
                lowest = lowest.max(y);
            }
        });
        assert_eq!(lowest, 49);
    }
}
