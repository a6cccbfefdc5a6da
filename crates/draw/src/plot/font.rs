//! The built-in font: widths and truncation of texts.
//!
//! Widths come from a table, so that a program that only lays texts out does not contain the font file.

mod advance_widths;

use advance_widths::{MISSING, RUNS};

/// Font units per em.
const UNITS_PER_EM: f32 = 2048.0;

/// Font units from the lowest descender to the highest ascender.
const LINE_HEIGHT: f32 = 2384.0;

/// The end of a truncated text.
const ELLIPSIS: char = '…';

/// Returns the height of a line of text at an em size.
pub(super) fn line_height(size: f64) -> f32 {
    size as f32 * LINE_HEIGHT / UNITS_PER_EM
}

/// Returns the width of a line of text at an em size.
pub(super) fn width(text: &str, size: f64) -> f64 {
    // Rounded like the advances between the outlines of letters, which the font library scales by the line height.
    let factor = line_height(size) / LINE_HEIGHT;
    text.chars().map(|letter| f64::from(factor * f32::from(advance_width(letter)))).sum()
}

/// Returns the advance width of a character in font units. Characters that are not in the font have that of a box.
fn advance_width(letter: char) -> u16 {
    let runs_up_to_letter = RUNS.partition_point(|(first, _)| *first <= letter);
    let width = runs_up_to_letter.checked_sub(1).and_then(|run| {
        let (first, widths) = RUNS[run];
        widths.get((u32::from(letter) - u32::from(first)) as usize).copied()
    });
    width.unwrap_or(MISSING)
}

/// Returns the text as one printable line, truncated to a maximum width.
///
/// A truncated text ends in an ellipsis.
pub(super) fn truncated(text: &str, size: f64, max_width: f64) -> String {
    let text = printable(text);
    if width(&text, size) <= max_width {
        return text;
    }
    let max_width = max_width - width(&ELLIPSIS.to_string(), size);
    let mut used = 0.0;
    let fits = |letter: &char| {
        used += width(letter.encode_utf8(&mut [0; 4]), size);
        used <= max_width
    };
    let beginning: String = text.chars().take_while(fits).collect();
    format!("{}{ELLIPSIS}", beginning.trim_end())
}

/// Returns the text followed by `ending`. If both do not fit, the text is truncated, not the ending.
pub(super) fn truncated_before(ending: &str, text: &str, size: f64, max_width: f64) -> String {
    let beginning = truncated(text, size, max_width - width(ending, size));
    truncated(&format!("{beginning}{ending}"), size, max_width)
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
mod tests;
