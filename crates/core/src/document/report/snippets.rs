//! Diagnostics for a terminal, with the source lines that they are about.

use std::ops::Range;

use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet};

use super::{Report, floor_char_boundary};
use crate::document::diagnostic::{Diagnostic, Severity, Span};
use crate::document::printable::{escape_controls, printable};

/// Length in bytes above which a line is not printed whole. Such lines come from documents without line breaks.
const MAX_LINE_BYTES: usize = 4000;
/// Bytes of a long line that are printed in front of, within and behind a span. The whole fits on a wide terminal.
const EXCERPT_BYTES: usize = 40;

/// The renderer of diagnostics, with ANSI colours or without.
pub(super) fn renderer(colour: bool) -> Renderer {
    if colour { Renderer::styled() } else { Renderer::plain() }
}

/// One diagnostic of a report as text.
pub(super) fn render(report: &Report, finding: &Diagnostic, renderer: &Renderer) -> String {
    renderer.render(&[group(report, finding)])
}

/// One diagnostic with title, source lines and advice.
fn group<'a>(report: &'a Report, finding: &'a Diagnostic) -> Group<'a> {
    let level = match finding.code.severity() {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let title = level.primary_title(printable(&finding.message)).id(finding.code.as_str());
    let mut group = Group::with_title(title);
    if let Some(span) = finding.span {
        group = with_source_lines(report, group, span);
    }
    group.element(Level::HELP.message(printable(finding.advice())))
}

/// Adds the lines of a span. If they are longer than [`MAX_LINE_BYTES`], adds an excerpt around its start.
fn with_source_lines<'a>(report: &'a Report, group: Group<'a>, span: Span) -> Group<'a> {
    let Report { file, text, line_index, .. } = report;
    let [start, end] = [span.start, span.end].map(|byte| floor_char_boundary(text, byte));
    let first = line_index.line(start);
    let from = line_index.line_start(first);
    let lines = from..line_index.line_end(text, line_index.line(end));
    if lines.len() > MAX_LINE_BYTES {
        return with_excerpt(report, group, start..end);
    }
    let annotation = AnnotationKind::Primary.span(start - from..end - from);
    let snippet = Snippet::source(&text[lines]).line_start(first + 1);
    group.element(snippet.path(escape_controls(file)).annotation(annotation))
}

/// Adds the part of a long line around the start of a span, with "..." where the line is cut.
fn with_excerpt<'a>(report: &'a Report, group: Group<'a>, span: Range<usize>) -> Group<'a> {
    let Report { file, text, line_index, .. } = report;
    let (line, column) = report.line_and_column(span.start);
    let whole = line_index.line_start(line - 1)..line_index.line_end(text, line - 1);
    let boundary = |byte| floor_char_boundary(text, byte);
    let end = span.end.min(boundary(span.start + EXCERPT_BYTES)).min(whole.end).max(span.start);
    let from = boundary(span.start.saturating_sub(EXCERPT_BYTES)).max(whole.start);
    let to = boundary(end + EXCERPT_BYTES).min(whole.end);
    let before = if from > whole.start { "..." } else { "" };
    let after = if to < whole.end { "..." } else { "" };
    let in_excerpt = |byte: usize| byte - from + before.len();
    let annotation = AnnotationKind::Primary.span(in_excerpt(span.start)..in_excerpt(end));
    let excerpt = format!("{before}{}{after}", &text[from..to]);
    group
        .element(Origin::path(escape_controls(file)).line(line).char_column(column))
        .element(Snippet::source(excerpt).line_start(line).annotation(annotation))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Code;

    /// The position in a printed report: the rest of the line after the arrow.
    fn position(shown: &str) -> &str {
        let line = shown.lines().find_map(|line| line.trim_start().strip_prefix("--> "));
        line.unwrap_or_else(|| panic!("{shown}"))
    }

    #[test]
    fn control_characters_of_paths_and_messages_are_escaped() {
        let control = "\u{1b}[31m\u{9b}1m";
        for text in ["[1]".to_owned(), format!("[{}]", " ".repeat(2 * MAX_LINE_BYTES))] {
            let finding = Diagnostic::at(Code::SYNTAX, Span { start: 1, end: 2 }, format!("no {control}"));
            let report = Report::new(&format!("a\n{control}.json"), &text, vec![finding.hint(control)]);
            let shown = report.render(false);
            assert!(shown.chars().all(|letter| letter == '\n' || !letter.is_control()), "{shown:?}");
            assert!(shown.contains("a\\u000a\\u001b[31m\\u009b1m.json:1:2"), "{shown}");
            assert_eq!(shown.matches("\\u001b[31m").count(), 3, "{shown}");
        }
    }

    #[test]
    fn a_report_shows_line_message_and_hint() {
        let text = "{\n  \"kin\": 1\n}";
        let finding = Diagnostic::at(Code::UNKNOWN_KEY, Span { start: 4, end: 9 }, "no such key");
        let shown = Report::new("a.json", text, vec![finding.hint("look it up")]).to_string();
        for part in ["unknown-key", "no such key", "a.json:2:3", "\"kin\"", "look it up"] {
            assert!(shown.contains(part), "{part} is missing in\n{shown}");
        }
    }

    #[test]
    fn positions_are_those_of_the_plain_report() {
        let text = format!("{{\n \"µµ\": 1,\n}}{}", "µ".repeat(MAX_LINE_BYTES));
        for start in [0, 4, 9, 11, 16, 2000] {
            let finding = Diagnostic::at(Code::UNKNOWN_KEY, Span { start, end: start + 1 }, "no such key");
            let report = Report::new("a.json", &text, vec![finding]);
            assert_eq!(position(&report.render(false)), position(&report.plain()), "{start}");
        }
    }

    #[test]
    fn a_long_line_is_shown_only_around_the_diagnostic() {
        let text = "µbc ".repeat(3_000_000);
        let start = 5 * 1_000_000;
        let finding = Diagnostic::at(Code::UNKNOWN_KEY, Span { start, end: start + 4 }, "no such key");
        let report = Report::new("a.json", &text, vec![finding; 20_000]);
        let shown = report.to_string();
        assert!(shown.contains("a.json:1:4000001\n"), "{shown}");
        assert!(shown.contains("...µbc µbc") && shown.contains(" ^^^"), "{shown}");
        assert!(shown.lines().all(|line| line.len() < 200), "{shown}");
        assert_eq!(report.documents()[19_999].column, Some(4_000_001));
    }
}
