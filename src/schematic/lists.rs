//! Lists below a drawing, side by side.

use super::layout::Point;
use super::shapes::{PRINT, SMALL};
use crate::plot::{Align, Ink, Label, Stroke, text_width, text_within};

/// A list with a heading.
#[derive(Debug, Clone, PartialEq)]
pub struct List {
    /// What it lists.
    pub heading: &'static str,
    /// Its rows.
    pub rows: Vec<Row>,
}

/// A row: a name, a value, and more about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// What it is about.
    pub name: String,
    /// A value, or nothing.
    pub value: String,
    /// A formula or a text.
    pub text: String,
}

/// Height of a row, and gaps between the cells of a row and between lists.
const ROW: f64 = 15.0;
const CELL: f64 = 10.0;
const BESIDE: f64 = 32.0;

/// A list longer than this goes on in the next column.
const LONGEST: usize = 14;

/// Texts are cut to this width.
const WIDEST: f64 = 420.0;

impl Row {
    pub(super) fn new(name: &str, value: &str, text: &str) -> Row {
        Row { name: name.to_owned(), value: value.to_owned(), text: text.to_owned() }
    }
}

/// Lists one below the other.
struct Column<'a> {
    parts: Vec<(&'static str, &'a [Row])>,
}

impl Column<'_> {
    /// Rows with headings and the gaps between lists.
    fn rows(&self) -> usize {
        self.parts.iter().map(|(_, rows)| rows.len() + 2).sum()
    }

    fn width(&self) -> f64 {
        let widths = self.parts.iter().map(|(_, rows)| widths(rows).iter().sum::<f64>() + 2.0 * CELL);
        widths.fold(0.0, f64::max)
    }

    fn draw(&self, (left, mut y): Point, marks: &mut Vec<Stroke>) {
        for (heading, rows) in &self.parts {
            marks.push(text(heading, (left, y), PRINT, Ink::Signal));
            y += 2.0;
            for row in *rows {
                y += ROW;
                let mut x = left;
                let inks = [Ink::Line, Ink::Line, Ink::Soft];
                for ((cell, width), ink) in cells(row).iter().zip(widths(rows)).zip(inks) {
                    marks.push(text(cell, (x, y), SMALL, ink));
                    x += width + CELL;
                }
            }
            y += 2.0 * ROW - 2.0;
        }
    }
}

/// Short lists share a column, long ones go on in the next.
fn columns(lists: &[List]) -> Vec<Column<'_>> {
    let parts = lists.iter().flat_map(|list| list.rows.chunks(LONGEST).map(|rows| (list.heading, rows)));
    let mut columns: Vec<Column<'_>> = Vec::new();
    for part in parts {
        match columns.last_mut() {
            Some(column) if column.rows() + part.1.len() <= LONGEST => column.parts.push(part),
            _ => columns.push(Column { parts: vec![part] }),
        }
    }
    columns
}

/// Draws lists from `top` on, in a room of a width; gives the marks and where they end.
pub(super) fn draw(lists: &[List], (left, top): Point, width: f64) -> (Vec<Stroke>, f64) {
    let (mut marks, mut at, mut bottom) = (Vec::new(), (left, top), top);
    for column in columns(lists) {
        let wide = column.width();
        if at.0 > left && at.0 + wide > left + width {
            at = (left, bottom);
        }
        column.draw(at, &mut marks);
        bottom = bottom.max(at.1 + ROW * column.rows() as f64);
        at.0 += wide + BESIDE;
    }
    marks.retain(|mark| !matches!(mark, Stroke::Text(label) if label.text.is_empty()));
    (marks, bottom)
}

fn cells(row: &Row) -> [String; 3] {
    [&row.name, &row.value, &row.text].map(|cell| text_within(cell, SMALL, WIDEST))
}

fn widths(rows: &[Row]) -> [f64; 3] {
    let mut widths = [0.0; 3];
    for row in rows {
        for (width, cell) in widths.iter_mut().zip(cells(row)) {
            *width = f64::max(*width, text_width(&cell, SMALL));
        }
    }
    widths
}

fn text(text: &str, at: Point, size: f64, ink: Ink) -> Stroke {
    Stroke::Text(Label { text: text.to_owned(), at, size, align: Align::Start, ink })
}
