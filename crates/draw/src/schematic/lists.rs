//! Lists below a drawing, side by side.

use super::heading::wrapped;
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

/// Height of a line, and gaps between the cells of a row and between lists.
const ROW: f64 = 15.0;
const CELL: f64 = 10.0;
const BESIDE: f64 = 32.0;

/// Columns have no fewer lines than this where there is room for higher ones.
const LEAST: usize = 10;

/// Shares of the sheet's width that names and values are cut to.
const NAMES: f64 = 0.35;
const VALUES: f64 = 0.25;

/// Texts go on in the next line at this width.
const WIDEST: f64 = 420.0;

impl Row {
    pub(super) fn new(name: &str, value: &str, text: &str) -> Row {
        Row { name: name.to_owned(), value: value.to_owned(), text: text.to_owned() }
    }
}

/// A row as it is written: the lines of its name, of its value and of its text.
type Entry = [Vec<String>; 3];

/// A list or a piece of it.
#[derive(Clone, Copy)]
struct Part<'a> {
    heading: &'static str,
    entries: &'a [Entry],
}

impl Part<'_> {
    fn lines(&self) -> usize {
        self.entries.iter().map(lines).sum()
    }

    fn widths(&self) -> [f64; 3] {
        [0, 1, 2].map(|cell| {
            let texts = self.entries.iter().flat_map(|entry| &entry[cell]);
            texts.map(|text| text_width(text, SMALL)).fold(0.0, f64::max)
        })
    }

    fn width(&self) -> f64 {
        self.widths().iter().sum::<f64>() + 2.0 * CELL
    }

    fn draw(&self, (left, top): Point, marks: &mut Vec<Stroke>) {
        marks.push(text(self.heading, (left, top), PRINT, Ink::Signal));
        let mut y = top + 2.0;
        for entry in self.entries {
            let mut x = left;
            let inks = [Ink::Line, Ink::Line, Ink::Soft];
            for ((cell, width), ink) in entry.iter().zip(self.widths()).zip(inks) {
                let line =
                    |(row, line): (usize, &String)| text(line, (x, y + ROW * (row + 1) as f64), SMALL, ink);
                marks.extend(cell.iter().enumerate().map(line));
                x += width + CELL;
            }
            y += ROW * lines(entry) as f64;
        }
    }
}

fn lines(entry: &Entry) -> usize {
    entry.iter().map(Vec::len).max().unwrap_or(0)
}

/// Lists one below the other.
type Column<'a> = Vec<Part<'a>>;

/// Lines with headings and the gaps between lists.
fn height(column: &Column<'_>) -> usize {
    column.iter().map(|part| part.lines() + 2).sum()
}

/// The rows of a list in a sheet of a width: long texts go on in the next line.
fn entries(list: &List, width: f64) -> Vec<Entry> {
    let names = |row: &Row| text_within(&row.name, SMALL, NAMES * width);
    let values = |row: &Row| text_within(&row.value, SMALL, VALUES * width);
    let widest = |cell: &dyn Fn(&Row) -> String| {
        list.rows.iter().map(|row| text_width(&cell(row), SMALL)).fold(0.0, f64::max)
    };
    let room = WIDEST.min(width - widest(&names) - widest(&values) - 2.0 * CELL);
    list.rows
        .iter()
        .map(|row| [vec![names(row)], vec![values(row)], wrapped(&row.text, SMALL, room)])
        .collect()
}

/// Columns of about so many lines: short lists share one, long ones go on in the next in equal pieces.
fn columns<'a>(lists: &[Part<'a>], most: usize) -> Vec<Column<'a>> {
    let mut columns: Vec<Column<'_>> = Vec::new();
    for part in lists.iter().flat_map(|list| pieces(*list, most)) {
        match columns.last_mut() {
            Some(column) if height(column) + part.lines() <= most => column.push(part),
            _ => columns.push(vec![part]),
        }
    }
    columns
}

fn pieces<'a>(list: Part<'a>, most: usize) -> Vec<Part<'a>> {
    let pieces = list.lines().div_ceil(most);
    let rows = list.entries.len().div_ceil(pieces);
    list.entries.chunks(rows).map(|entries| Part { entries, ..list }).collect()
}

/// The lowest columns that stand side by side in a width.
fn fitting<'a>(lists: &[Part<'a>], width: f64) -> Vec<Column<'a>> {
    let all: usize = lists.iter().map(|list| list.lines() + 2).sum();
    let fits = |columns: &Vec<Column<'_>>| {
        columns.iter().map(|column| wide(column) + BESIDE).sum::<f64>() - BESIDE <= width
    };
    let columns = (LEAST..all).map(|most| columns(lists, most)).find(fits);
    columns.unwrap_or_else(|| vec![lists.to_vec()])
}

fn wide(column: &Column<'_>) -> f64 {
    column.iter().map(Part::width).fold(0.0, f64::max)
}

/// Draws lists from `top` on, in a room of a width; gives the marks and where they end.
pub(super) fn draw(lists: &[List], (left, top): Point, width: f64) -> (Vec<Stroke>, f64) {
    let written: Vec<_> = lists.iter().map(|list| (list.heading, entries(list, width))).collect();
    let parts: Vec<_> = written.iter().map(|(heading, entries)| Part { heading, entries }).collect();
    let (mut marks, mut x, mut bottom) = (Vec::new(), left, top);
    for column in fitting(&parts, width) {
        let mut y = top;
        for part in &column {
            part.draw((x, y), &mut marks);
            y += ROW * (part.lines() + 2) as f64;
        }
        bottom = bottom.max(y);
        x += wide(&column) + BESIDE;
    }
    marks.retain(|mark| !matches!(mark, Stroke::Text(label) if label.text.is_empty()));
    (marks, bottom)
}

fn text(text: &str, at: Point, size: f64, ink: Ink) -> Stroke {
    Stroke::Text(Label { text: text.to_owned(), at, size, align: Align::Start, ink })
}
