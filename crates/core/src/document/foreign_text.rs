//! Recognises common texts that are not JSON: CSV tables, pages and pictures, and numbers with commas or several
//! points.

use super::code::Code;
use super::diagnostic::{Diagnostic, Span};
use super::typed_number::without_separators;

/// The diagnostic for a text in another format. `None` for a text that may be meant as JSON.
pub(super) fn other_format(text: &str) -> Option<Diagnostic> {
    if let Some(header) = csv_header(text) {
        return Some(Diagnostic::at(Code::SYNTAX, header, "this is a CSV table, not JSON").hint(CSV_HINT));
    }
    let start = text.len() - text.trim_start().len();
    let noun = markup_noun(&text[start..])?;
    let message = format!("this is {noun}, not JSON");
    Some(Diagnostic::at(Code::SYNTAX, Span { start, end: start + 1 }, message).hint(MARKUP_HINT))
}

/// The hint for a CSV table in place of a document.
const CSV_HINT: &str = "give the JSON file that names the table: a patch names it in a drive, such as \"points\": \
                        {\"csv\": \"FILE\"}, and an experiment under \"data\"";

/// The hint for a page or a picture in place of a document.
const MARKUP_HINT: &str = "give a JSON file: a patch begins with {\"patchcord\": 1, ...; pages and pictures are \
                           output only";

/// The format of a text of markup, with its article. `None` for a text that does not begin with "<".
fn markup_noun(text: &str) -> Option<&'static str> {
    let start = text.get(..MARKUP_START_BYTES).unwrap_or(text).to_lowercase();
    let has = |word: &str| start.contains(word);
    match start.starts_with('<') {
        true if has("<!doctype html") || has("<html") => Some("an HTML page"),
        true if has("<svg") => Some("an SVG picture"),
        true => Some("an XML document"),
        false => None,
    }
}

/// Number of bytes at the beginning of a text of markup that show its format.
const MARKUP_START_BYTES: usize = 500;

/// Position of the line of names, if a text is a CSV table. `None` for other texts.
///
/// A table has a line of names with a separator, and numbers in the next line. Blank lines and lines that start with
/// `#` do not count.
fn csv_header(text: &str) -> Option<Span> {
    let mut next_start = 0;
    let lines = text.split_inclusive('\n').map(|line| {
        let start = next_start;
        next_start += line.len();
        Span { start, end: start + line.trim_end().len() }
    });
    let line_text = |line: Span| &text[line.start..line.end];
    let mut rows = lines.filter(|line| !line_text(*line).is_empty() && !line_text(*line).starts_with('#'));
    let (header, first_row) = (rows.next()?, rows.next()?);
    let names = line_text(header);
    let separator = [';', '\t', ','].into_iter().find(|separator| names.contains(*separator))?;
    let is_number = |field: &str| field.trim().replace(',', ".").parse::<f64>().is_ok();
    let has_number = line_text(first_row).split(separator).any(is_number);
    (has_number && !names.contains(['{', '[', ':'])).then_some(header)
}

/// The diagnostic for a number with a comma in an object, such as 3,5, or with several points, such as 45.000.000.
/// `None` if there is none at byte `at`. `separators` are the signs that can be part of the number.
///
/// The parser reads a comma, or a second point, as the end of the number, and stops at byte `at`: at the digit after
/// the comma, or at the point. In an object no number can follow a comma. In a list a comma separates items, so it is
/// not part of a number with several points.
pub(super) fn number_with_separators(text: &str, at: usize, separators: &str) -> Option<Diagnostic> {
    let (before, after) = text.split_at_checked(at)?;
    let is_part = |letter: char| letter.is_ascii_digit() || letter == '-' || separators.contains(letter);
    let start = before.trim_end_matches(is_part).len();
    let is_part_or_exponent = |letter: char| is_part(letter) || "+eE".contains(letter);
    let end = at + after.find(|letter: char| !is_part_or_exponent(letter)).unwrap_or(after.len());
    let number = text[start..end].trim_end_matches(',');
    let advised = without_separators(number)?;
    let fault = if number.contains(',') { "a comma" } else { "several points" };
    let message = format!("not JSON: the number {number} has {fault}");
    let span = Span { start, end: start + number.len() };
    Some(Diagnostic::at(Code::SYNTAX, span, message).hint(format!("write {advised}")))
}

#[cfg(test)]
mod tests {
    use crate::document::tree::parse;

    #[test]
    fn a_csv_table_is_recognised() {
        for text in ["t,x\n0,1\n", "# t: s\n\nt;x\n0,5;1", "time\tforce\r\n0\t-1e3\r\n"] {
            let error = parse(text).unwrap_err();
            assert_eq!(error.message, "this is a CSV table, not JSON", "{text}");
            let header = error.span.unwrap();
            assert!(["t,x", "t;x", "time\tforce"].contains(&&text[header.start..header.end]), "{header:?}");
        }
        for text in ["{a: 1,\n2}", "[1,\n2", "t,x", "x,y\nthe others,too", "\"a\": 1,\n2,3"] {
            assert!(parse(text).unwrap_err().message.starts_with("not JSON"), "{text}");
        }
    }

    #[test]
    fn pages_and_pictures_are_recognised() {
        let cases = [
            ("<!DOCTYPE html>\n<html></html>", "this is an HTML page, not JSON"),
            ("\n <html>", "this is an HTML page, not JSON"),
            ("<?xml version=\"1.0\"?><svg></svg>", "this is an SVG picture, not JSON"),
            ("<a/>", "this is an XML document, not JSON"),
        ];
        for (text, expected) in cases {
            assert_eq!(parse(text).unwrap_err().message, expected, "{text}");
        }
    }

    #[test]
    fn commas_and_several_points_in_a_number_are_named() {
        let cases = [
            ("{\"a\": 3,5, \"b\": 1}", "3,5", "write 3.5"),
            ("{\"a\":-0,05}", "-0,05", "write -0.05"),
            ("{\"a\": 1,5e3}", "1,5e3", "write 1.5e3"),
            ("{\"a\": 45,000,000}", "45,000,000", "write 45000000"),
            ("{\"a\": 1,500,\n\"b\": 2}", "1,500", "write 1500 or 1.500"),
        ];
        for (text, number, hint) in cases {
            let error = parse(text).unwrap_err();
            let span = error.span.unwrap();
            assert_eq!(&text[span.start..span.end], number, "{text}");
            assert_eq!(error.message, format!("not JSON: the number {number} has a comma"));
            assert_eq!(error.hint.as_deref(), Some(hint));
        }
        for text in ["{\"a\": [1, 45.000.000]}", "[45.000.000,5]", "[1,45.000.000]"] {
            let error = parse(text).unwrap_err();
            assert_eq!(error.message, "not JSON: the number 45.000.000 has several points", "{text}");
            assert_eq!(error.hint.as_deref(), Some("write 45000000"), "{text}");
        }
        for text in ["{\"a\": 1, b: 2}", "{\"a\": 1, 5}", "{\"a\": 1,\n5}"] {
            assert!(parse(text).unwrap_err().message.starts_with("not JSON: Expected"), "{text}");
        }
    }
}
