//! Lists below a drawing, in columns.
//!
//! Long texts are wrapped. The lists are then divided into the lowest columns that fit into the width.

use super::heading::wrap;
use super::layout::Point;
use super::shapes::{PRINT, SMALL};
use crate::plot::{Align, Ink, Label, Primitive, text_width, truncate_text};

/// A list of settings, drives, signals or notes.
#[derive(Debug, Clone, PartialEq)]
pub struct List {
    /// The heading, such as "Settings".
    pub heading: &'static str,
    /// The rows.
    pub rows: Vec<ListRow>,
}

/// A row of a list.
#[derive(Debug, Clone, PartialEq)]
pub struct ListRow {
    /// The name of the element or signal.
    pub name: String,
    /// A value with its unit; may be empty.
    pub value: String,
    /// A formula or a note; may be empty.
    pub text: String,
}

/// The height of a line.
const LINE_HEIGHT: f64 = 15.0;
/// The gap between the cells of a row.
const CELL_GAP: f64 = 10.0;
/// The gap between columns of lists.
const COLUMN_GAP: f64 = 32.0;

/// The minimum number of lines of a column before the lists are divided further.
const MIN_LINES: usize = 10;

/// The maximum width of names, as a share of the width of the sheet.
const MAX_NAME_SHARE: f64 = 0.35;
/// The maximum width of values, as a share of the width of the sheet.
const MAX_VALUE_SHARE: f64 = 0.25;

/// The maximum width of a text; longer texts are wrapped.
const MAX_TEXT_WIDTH: f64 = 420.0;

impl ListRow {
    /// Returns a row; `value` and `text` may be empty.
    pub(super) fn new(name: &str, value: &str, text: &str) -> ListRow {
        ListRow { name: name.to_owned(), value: value.to_owned(), text: text.to_owned() }
    }
}

/// The wrapped lines of a row: of its name, its value and its text.
type ListEntry = [Vec<String>; 3];

/// A list or a part of it.
#[derive(Clone, Copy)]
struct ListPart<'a> {
    /// The heading. Each part of a divided list repeats it.
    heading: &'static str,
    /// The rows of this part.
    entries: &'a [ListEntry],
}

impl ListPart<'_> {
    /// Returns the number of lines of all rows, without the heading.
    fn lines(&self) -> usize {
        self.entries.iter().map(lines).sum()
    }

    /// Returns the widths of the widest name, value and text.
    fn widths(&self) -> [f64; 3] {
        [0, 1, 2].map(|cell| {
            let texts = self.entries.iter().flat_map(|entry| &entry[cell]);
            texts.map(|text| text_width(text, SMALL)).fold(0.0, f64::max)
        })
    }

    /// Returns the width of the part, with the gaps between its cells.
    fn width(&self) -> f64 {
        self.widths().iter().sum::<f64>() + 2.0 * CELL_GAP
    }

    /// Draws the heading with its baseline at `top`, and the rows below it.
    fn draw(&self, (left, top): Point, primitives: &mut Vec<Primitive>) {
        primitives.push(text(self.heading, (left, top), PRINT, Ink::Signal));
        let mut y = top + 2.0;
        for entry in self.entries {
            let mut x = left;
            let inks = [Ink::Line, Ink::Line, Ink::Soft];
            for ((cell, width), ink) in entry.iter().zip(self.widths()).zip(inks) {
                let line = |(row, line): (usize, &String)| {
                    text(line, (x, y + LINE_HEIGHT * (row + 1) as f64), SMALL, ink)
                };
                primitives.extend(cell.iter().enumerate().map(line));
                x += width + CELL_GAP;
            }
            y += LINE_HEIGHT * lines(entry) as f64;
        }
    }
}

/// Returns the number of lines of a row, which is that of its longest cell.
fn lines(entry: &ListEntry) -> usize {
    entry.iter().map(Vec::len).max().unwrap_or(0)
}

/// Parts of lists, one below the other.
type ListColumn<'a> = Vec<ListPart<'a>>;

/// Returns the height of a column in lines, with headings and gaps.
fn height(column: &ListColumn<'_>) -> usize {
    column.iter().map(|part| part.lines() + 2).sum()
}

/// Returns the wrapped rows of a list for a sheet of this width.
fn entries(list: &List, width: f64) -> Vec<ListEntry> {
    let names = |row: &ListRow| truncate_text(&row.name, SMALL, MAX_NAME_SHARE * width);
    let values = |row: &ListRow| truncate_text(&row.value, SMALL, MAX_VALUE_SHARE * width);
    let widest = |cell: &dyn Fn(&ListRow) -> String| {
        list.rows.iter().map(|row| text_width(&cell(row), SMALL)).fold(0.0, f64::max)
    };
    let max_width = MAX_TEXT_WIDTH.min(width - widest(&names) - widest(&values) - 2.0 * CELL_GAP);
    list.rows
        .iter()
        .map(|row| [vec![names(row)], vec![values(row)], wrap(&row.text, SMALL, max_width)])
        .collect()
}

/// Divides lists into columns of about `max_lines` lines.
///
/// Short lists share a column. Long lists are divided into equal pieces.
fn columns<'a>(lists: &[ListPart<'a>], max_lines: usize) -> Vec<ListColumn<'a>> {
    let mut columns: Vec<ListColumn<'_>> = Vec::new();
    for part in lists.iter().flat_map(|list| pieces(*list, max_lines)) {
        match columns.last_mut() {
            Some(column) if height(column) + part.lines() <= max_lines => column.push(part),
            _ => columns.push(vec![part]),
        }
    }
    columns
}

/// Divides a list into parts with equal numbers of rows and about `max_lines` lines.
fn pieces<'a>(list: ListPart<'a>, max_lines: usize) -> Vec<ListPart<'a>> {
    let pieces = list.lines().div_ceil(max_lines);
    let rows = list.entries.len().div_ceil(pieces);
    list.entries.chunks(rows).map(|entries| ListPart { entries, ..list }).collect()
}

/// Returns the lowest columns that fit next to each other into a width.
fn fit_columns<'a>(lists: &[ListPart<'a>], width: f64) -> Vec<ListColumn<'a>> {
    let all: usize = lists.iter().map(|list| list.lines() + 2).sum();
    let fits = |columns: &Vec<ListColumn<'_>>| {
        columns.iter().map(|column| column_width(column) + COLUMN_GAP).sum::<f64>() - COLUMN_GAP <= width
    };
    let columns = (MIN_LINES..all).map(|max_lines| columns(lists, max_lines)).find(fits);
    columns.unwrap_or_else(|| vec![lists.to_vec()])
}

/// Returns the width of the widest part of a column.
fn column_width(column: &ListColumn<'_>) -> f64 {
    column.iter().map(ListPart::width).fold(0.0, f64::max)
}

/// Draws lists below `top` within a width. Returns the primitives and the lower edge of the lists.
pub(super) fn draw(lists: &[List], (left, top): Point, width: f64) -> (Vec<Primitive>, f64) {
    let wrapped_lists: Vec<_> = lists.iter().map(|list| (list.heading, entries(list, width))).collect();
    let parts: Vec<_> =
        wrapped_lists.iter().map(|(heading, entries)| ListPart { heading, entries }).collect();
    let (mut primitives, mut x, mut bottom) = (Vec::new(), left, top);
    for column in fit_columns(&parts, width) {
        let mut y = top;
        for part in &column {
            part.draw((x, y), &mut primitives);
            y += LINE_HEIGHT * (part.lines() + 2) as f64;
        }
        bottom = bottom.max(y);
        x += column_width(&column) + COLUMN_GAP;
    }
    primitives.retain(|primitive| primitive.label().is_none_or(|label| !label.text.is_empty()));
    (primitives, bottom)
}

/// Returns a text that starts at a point.
fn text(text: &str, at: Point, size: f64, ink: Ink) -> Primitive {
    Primitive::Text(Label::new(text, at, size, Align::Start, ink))
}
