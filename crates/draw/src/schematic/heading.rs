//! The title and the notes above a drawing.

use super::layout::Point;
use super::shapes::PRINT;
use crate::plot::{Align, Ink, Label, Primitive, text_width, truncate_text};

/// A title and lines of notes in small print.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Heading {
    /// The title, truncated to the width of the sheet; may be empty.
    title: String,
    /// The lines of the notes, wrapped to the width of the sheet.
    lines: Vec<String>,
}

/// The minimum width of a sheet, so that texts fit.
const MIN_WIDTH: f64 = 640.0;
/// The maximum width to which a sheet is widened for its title.
const MAX_TITLE_WIDTH: f64 = 960.0;

/// The em size of the title.
const TITLE: f64 = 17.0;
/// The height of the row of the title.
const TITLE_ROW: f64 = 24.0;
/// The height of a line of notes.
const ROW: f64 = 15.0;

/// The gap between the heading and the drawing.
const BOTTOM_GAP: f64 = 12.0;

/// The maximum number of lines of a text.
const MAX_LINES: usize = 3;

/// Returns the width of a sheet: at least that of its drawing, and wide enough for the title.
pub(crate) fn width(drawing: f64, title: &str) -> f64 {
    drawing.max(text_width(title, TITLE).clamp(MIN_WIDTH, MAX_TITLE_WIDTH)).ceil()
}

impl Heading {
    /// Returns a heading for a sheet of width `max_width`. Empty notes are omitted.
    pub(super) fn new(title: &str, notes: &[&str], max_width: f64) -> Heading {
        let notes = notes.iter().filter(|note| !note.is_empty());
        Heading {
            title: truncate_text(title, TITLE, max_width),
            lines: notes.flat_map(|note| wrap(note, PRINT, max_width)).collect(),
        }
    }

    /// Appends a text to the last line of the notes.
    ///
    /// The line is truncated if necessary. The text never adds a line, so sheets with and without it
    /// have the same layout.
    pub(super) fn with_suffix(mut self, suffix: &str, max_width: f64) -> Heading {
        if !suffix.is_empty() {
            let suffix = format!("; {suffix}");
            let last = self.lines.pop().unwrap_or_default();
            self.lines.push(truncate_text(&last, PRINT, max_width - text_width(&suffix, PRINT)) + &suffix);
        }
        self
    }

    /// Returns the height with the gap to the drawing.
    pub(super) fn height(&self) -> f64 {
        let title = if self.title.is_empty() { 0.0 } else { TITLE_ROW };
        title + ROW * self.lines.len() as f64 + BOTTOM_GAP
    }

    /// Draws the heading with its upper left corner at a point.
    pub(super) fn draw(&self, (left, top): Point) -> Vec<Primitive> {
        let text =
            |text: &str, y, size, ink| Primitive::Text(Label::new(text, (left, y), size, Align::Start, ink));
        let mut y = top - 8.0;
        let mut primitives = Vec::new();
        if !self.title.is_empty() {
            y += TITLE_ROW - 6.0;
            primitives.push(text(&self.title, y, TITLE, Ink::Line));
        }
        for line in &self.lines {
            y += ROW;
            primitives.push(text(line, y, PRINT, Ink::Soft));
        }
        primitives
    }
}

/// Wraps a text between words into at most [`MAX_LINES`] lines; the last one is truncated if
/// necessary.
pub(super) fn wrap(text: &str, size: f64, max_width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let is_full = lines.len() == MAX_LINES;
        match lines.last_mut() {
            Some(line) if is_full || text_width(&format!("{line} {word}"), size) <= max_width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines.iter().map(|line| truncate_text(line, size, max_width)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_notes_are_wrapped_and_truncated() {
        let lines = wrap(&"velocity of the drive ".repeat(40), PRINT, 300.0);
        assert_eq!(lines.len(), MAX_LINES);
        assert!(lines.iter().all(|line| text_width(line, PRINT) <= 300.0));
        assert!(lines[2].ends_with('…') && !lines[0].contains('…'));
        assert_eq!(wrap("short", PRINT, 300.0), ["short"]);
    }

    #[test]
    fn the_suffix_adds_no_line() {
        for note in ["short", "a note that is about as wide as the sheet"] {
            let bare = Heading::new("title", &[note], 240.0);
            let extended = bare.clone().with_suffix("voltages at t = 1 s", 240.0);
            assert_eq!(extended.height(), bare.height());
            let last = extended.lines.last().unwrap();
            assert!(last.ends_with("; voltages at t = 1 s") && text_width(last, PRINT) <= 240.0, "{last}");
        }
    }
}
