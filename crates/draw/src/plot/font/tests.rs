//! The widths in the table are those of the font, and texts are truncated to them.

use std::fmt::Write as _;

use ab_glyph::{Font as _, FontRef, PxScale, ScaleFont as _};

use super::*;
use crate::plot::outlines::FONT_FILE;

/// The source file with the table.
const TABLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/src/plot/font/advance_widths.rs");

fn font() -> FontRef<'static> {
    FontRef::try_from_slice(FONT_FILE).unwrap()
}

/// The characters of the font, in order.
fn characters(font: &FontRef<'_>) -> impl Iterator<Item = char> {
    ('\0'..=char::MAX).filter(move |letter| font.glyph_id(*letter).0 != 0)
}

/// The runs of consecutive characters of the font with their widths, and the width of other characters.
fn runs(font: &FontRef<'_>) -> (Vec<(char, Vec<u16>)>, u16) {
    let width = |letter: char| font.h_advance_unscaled(font.glyph_id(letter)) as u16;
    let mut runs: Vec<(char, Vec<u16>)> = Vec::new();
    for letter in characters(font) {
        match runs.last_mut() {
            Some((first, widths))
                if u32::from(*first) as usize + widths.len() == u32::from(letter) as usize =>
            {
                widths.push(width(letter));
            }
            _ => runs.push((letter, vec![width(letter)])),
        }
    }
    (runs, width(char::MAX))
}

/// The source file with the table, made from the font.
fn table(font: &FontRef<'_>) -> String {
    let (runs, missing) = runs(font);
    let mut text = format!(
        "//! The advance widths of the built-in font in font units.\n\
         //!\n\
         //! `PATCHCORD_BLESS=1 cargo test -p patchcord-draw font` writes this file.\n\
         \n\
         /// The width of a character that is not in the font.\n\
         pub(super) const MISSING: u16 = {missing};\n\
         \n\
         /// The first of consecutive characters, and the widths of all of them. The runs are in order.\n\
         #[rustfmt::skip]\n\
         pub(super) static RUNS: [(char, &[u16]); {}] = [\n",
        runs.len()
    );
    for (first, widths) in runs {
        writeln!(text, "    ('\\u{{{:x}}}', &[", u32::from(first)).unwrap();
        for row in widths.chunks(16) {
            let row: Vec<String> = row.iter().map(u16::to_string).collect();
            writeln!(text, "        {},", row.join(", ")).unwrap();
        }
        text.push_str("    ]),\n");
    }
    text + "];\n"
}

#[test]
fn the_table_is_that_of_the_font() {
    let fresh = table(&font());
    if std::env::var_os("PATCHCORD_BLESS").is_some() {
        std::fs::write(TABLE, &fresh).unwrap();
    }
    let stored = std::fs::read_to_string(TABLE).unwrap();
    assert!(stored == fresh, "{TABLE} is stale: PATCHCORD_BLESS=1 cargo test -p patchcord-draw rewrites it");
}

#[test]
fn widths_are_those_of_the_font() {
    let font = font();
    let em = font.units_per_em().unwrap();
    let missing = ['\0', '\u{7f}', '\u{4e2d}', '\u{1d6fc}', char::MAX];
    let all: Vec<char> = characters(&font).chain(missing).collect();
    assert!(all.len() > 500, "{}", all.len());
    for size in [7.3_f64, 9.0, 11.5, 12.5, 13.0, 14.0, 18.0] {
        let scaled = font.as_scaled(PxScale::from(size as f32 * font.height_unscaled() / em));
        assert_eq!(line_height(size), scaled.height());
        for letter in &all {
            let expected = f64::from(scaled.h_advance(font.glyph_id(*letter)));
            assert_eq!(width(&letter.to_string(), size), expected, "{letter:?} at {size}");
        }
    }
}

#[test]
fn signs_of_measurement_are_in_the_font() {
    let font = font();
    for sign in "aZ09_,Äéßλ×÷µμΩΔω°·−⁻⁰¹²³⁴⁵⁶⁷⁸⁹₀₁₂→←↑↓≤≥±∞…".chars()
    {
        assert_ne!(font.glyph_id(sign).0, 0, "{sign}");
    }
}

#[test]
fn long_text_is_truncated_to_the_width() {
    let long = "velocity of the drive ".repeat(40);
    let short = truncated(&long, 14.0, 200.0);
    assert!(short.ends_with('…'));
    assert!(width(&short, 14.0) <= 200.0);
    assert_eq!(truncated("v_o", 14.0, 200.0), "v_o");
    let short = truncated_before(", mm/s", &long, 14.0, 200.0);
    assert!(short.ends_with("…, mm/s") && width(&short, 14.0) <= 200.0);
}
