//! Random changes of data files at the level of cells and lines, and of any file at the level of bytes.

use super::edge_values::{CELLS, LINES};
use super::number_text::{changed_number, edge_number};
use crate::common::mutated::mutated;
use crate::common::random::SplitMix64;

/// A data file with one to three changes of its cells and lines, and sometimes of its bytes.
pub(crate) fn damaged_csv(bytes: &[u8], random: &mut SplitMix64) -> Vec<u8> {
    let text = String::from_utf8_lossy(bytes).into_owned();
    let mut lines: Vec<String> = text.split('\n').map(str::to_owned).collect();
    for _ in 0..1 + random.below(3) {
        change_lines(&mut lines, random);
    }
    let text = lines.join("\n");
    if random.below(8) == 0 { damaged_bytes(&text, random) } else { text.into_bytes() }
}

/// Changes a cell, a line, or a column of a data file. A line remains.
fn change_lines(lines: &mut Vec<String>, random: &mut SplitMix64) {
    let (index, other) = (random.below(lines.len()), random.below(lines.len()));
    match random.below(11) {
        0..5 => lines[index] = with_changed_cell(&lines[index], random),
        5 => lines.insert(index, lines[other].clone()),
        6 if lines.len() > 1 => drop(lines.remove(index)),
        7 => lines.swap(index, other),
        8 => lines.insert(index, (*random.pick(&LINES)).to_owned()),
        9 => lines.truncate(index + 1),
        _ => scale_column(lines, random.below(4), 10f64.powi(random.below(25) as i32 - 12)),
    }
}

/// The line with one cell changed or removed.
fn with_changed_cell(line: &str, random: &mut SplitMix64) -> String {
    let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
    let index = random.below(cells.len());
    match random.below(4) {
        0 => cells[index] = (*random.pick(&CELLS)).to_owned(),
        1 => cells[index] = edge_number(random),
        2 => cells[index] = changed_number(&cells[index], random),
        _ => drop(cells.remove(index)),
    }
    cells.join(",")
}

/// Multiplies the numbers of a column.
fn scale_column(lines: &mut [String], column: usize, factor: f64) {
    for line in lines {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        let number = cells.get(column).and_then(|cell| cell.parse::<f64>().ok());
        if let Some(number) = number {
            cells[column] = format!("{:?}", number * factor);
            *line = cells.join(",");
        }
    }
}

/// A text with damaged tokens and bytes. It may not be UTF-8 any more, or be cut off.
pub(crate) fn damaged_bytes(text: &str, random: &mut SplitMix64) -> Vec<u8> {
    let mut bytes = mutated(text, random).into_bytes();
    let index = random.below(bytes.len() + 1);
    match random.below(8) {
        0 => bytes.truncate(index),
        1 => bytes.insert(index, *random.pick(&[0, 0x80, 0xc0, 0xed, 0xf4, 0xfe, 0xff])),
        2 => drop(bytes.splice(..0, *random.pick(&[*b"\xef\xbb\xbf", *b"\xff\xfe ", *b"\n\0\t"]))),
        3 => bytes = with_line_ends(&bytes, random.choose(&["\r\n", "\r", ""])),
        4 => bytes.extend(*random.pick(&[*b"\n\n", *b"{}", *b"//", *b",}"])),
        _ => (),
    }
    bytes
}

/// The text with other line ends.
fn with_line_ends(bytes: &[u8], line_end: &str) -> Vec<u8> {
    String::from_utf8_lossy(bytes).replace('\n', line_end).into_bytes()
}
