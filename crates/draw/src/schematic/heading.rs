//! Title and small print above a drawing.

use super::layout::Point;
use super::shapes::PRINT;
use crate::plot::{Align, Ink, Label, Stroke, text_width, text_within};

/// A title and lines of small print.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Heading {
    title: String,
    lines: Vec<String>,
}

/// A sheet is not narrower, so that texts have room, nor is it made wider than this for its title.
const NARROWEST: f64 = 640.0;
const TITLE_ROOM: f64 = 960.0;

const TITLE: f64 = 17.0;
const TITLE_ROW: f64 = 24.0;
const ROW: f64 = 15.0;

/// Room between the heading and what it stands above.
const BELOW: f64 = 12.0;

/// A text takes no more lines.
const MOST_LINES: usize = 3;

/// The width of a sheet: that of its drawing, and wide enough for the title.
pub(crate) fn width(drawing: f64, title: &str) -> f64 {
    drawing.max(text_width(title, TITLE).clamp(NARROWEST, TITLE_ROOM)).ceil()
}

impl Heading {
    pub fn new(title: &str, notes: &[&str], room: f64) -> Heading {
        let notes = notes.iter().filter(|note| !note.is_empty());
        Heading {
            title: text_within(title, TITLE, room),
            lines: notes.flat_map(|note| wrapped(note, PRINT, room)).collect(),
        }
    }

    /// The same with words behind the small print, whose last line is cut where they have no room: they take no line of
    /// their own, so that nothing moves for them.
    pub fn with(mut self, words: &str, room: f64) -> Heading {
        if !words.is_empty() {
            let words = format!("; {words}");
            let last = self.lines.pop().unwrap_or_default();
            self.lines.push(text_within(&last, PRINT, room - text_width(&words, PRINT)) + &words);
        }
        self
    }

    pub fn height(&self) -> f64 {
        let title = if self.title.is_empty() { 0.0 } else { TITLE_ROW };
        title + ROW * self.lines.len() as f64 + BELOW
    }

    pub fn draw(&self, (left, top): Point) -> Vec<Stroke> {
        let text = |text: &str, y, size, ink| {
            Stroke::Text(Label { text: text.to_owned(), at: (left, y), size, align: Align::Start, ink })
        };
        let mut y = top - 8.0;
        let mut marks = Vec::new();
        if !self.title.is_empty() {
            y += TITLE_ROW - 6.0;
            marks.push(text(&self.title, y, TITLE, Ink::Line));
        }
        for line in &self.lines {
            y += ROW;
            marks.push(text(line, y, PRINT, Ink::Soft));
        }
        marks
    }
}

/// A text broken into lines between its words; what does not go into the last one is cut.
pub(super) fn wrapped(text: &str, size: f64, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let is_full = lines.len() == MOST_LINES;
        match lines.last_mut() {
            Some(line) if is_full || text_width(&format!("{line} {word}"), size) <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines.iter().map(|line| text_within(line, size, room)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_notes_go_on_in_the_next_line_and_are_cut_in_the_last() {
        let lines = wrapped(&"velocity of the drive ".repeat(40), PRINT, 300.0);
        assert_eq!(lines.len(), MOST_LINES);
        assert!(lines.iter().all(|line| text_width(line, PRINT) <= 300.0));
        assert!(lines[2].ends_with('…') && !lines[0].contains('…'));
        assert_eq!(wrapped("short", PRINT, 300.0), ["short"]);
    }

    #[test]
    fn words_behind_the_small_print_take_no_line() {
        for note in ["short", "just about as long as there is room for"] {
            let bare = Heading::new("title", &[note], 240.0);
            let told = bare.clone().with("voltages at t = 1 s", 240.0);
            assert_eq!(told.height(), bare.height());
            let last = told.lines.last().unwrap();
            assert!(last.ends_with("; voltages at t = 1 s") && text_width(last, PRINT) <= 240.0, "{last}");
        }
    }
}
