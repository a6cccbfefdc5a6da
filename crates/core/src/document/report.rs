//! Reports: the diagnostics of a document with its text, printed for a terminal or as JSON.

use std::fmt;
use std::ops::Range;

use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet};
use serde::Serialize;

use super::diagnostic::{Diagnostic, Severity, Span};
use super::line_index::LineIndex;
use super::printable::{escape_controls, printable};

/// Length in bytes above which a line is not printed whole. Such lines come from documents without line breaks.
const MAX_LINE_BYTES: usize = 4000;
/// Bytes of a long line that are printed in front of, within and behind a span. The whole fits on a wide terminal.
const EXCERPT_BYTES: usize = 40;

/// All diagnostics of one document, with its text.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::{Code, Diagnostic, Report, Span};
///
/// let text = "{\n  \"kin\": 1\n}";
/// let finding = Diagnostic::at(Code::UNKNOWN_KEY, Span { start: 4, end: 9 }, "no such key");
/// let report = Report::new("a.json", text, vec![finding]);
/// assert_eq!((report.error_count(), report.warning_count()), (1, 0));
/// assert_eq!(report.line_and_column(4), (2, 3));
/// assert!(report.to_string().contains("a.json:2:3"));
/// assert_eq!(report.documents()[0].code, "unknown-key");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Path of the document, as the user wrote it.
    pub file: String,
    /// Text of the document.
    pub text: String,
    /// The diagnostics, in the order of the text. Those without a position are last.
    pub findings: Vec<Diagnostic>,
    /// The lines of the text, for positions in printed reports and in JSON.
    line_index: LineIndex,
}

/// Number of diagnostics that are printed at most. The others are only counted.
const MAX_FINDINGS_SHOWN: usize = 50;

impl Report {
    /// Makes a report on a document and sorts the diagnostics by their position.
    pub fn new(file: &str, text: &str, mut findings: Vec<Diagnostic>) -> Self {
        findings.sort_by_key(|finding| finding.span.map_or(usize::MAX, |span| span.start));
        Report { file: file.to_owned(), text: text.to_owned(), findings, line_index: LineIndex::new(text) }
    }

    /// Whether any diagnostic prevents the patch from running.
    pub fn has_errors(&self) -> bool {
        self.error_count() > 0
    }

    /// Number of errors.
    pub fn error_count(&self) -> usize {
        self.findings.iter().filter(|finding| finding.code.severity() == Severity::Error).count()
    }

    /// Number of warnings.
    pub fn warning_count(&self) -> usize {
        self.findings.len() - self.error_count()
    }

    /// Line and column of a byte of the text. Both count from 1; columns count characters.
    ///
    /// Bytes within a character count as its first byte, and bytes beyond the text as its end.
    pub fn line_and_column(&self, byte: usize) -> (usize, usize) {
        self.line_index.line_and_column(&self.text, floor_char_boundary(&self.text, byte))
    }

    /// The report for a terminal, with the faulty line of each diagnostic. `colour` adds ANSI colours.
    ///
    /// At most 50 diagnostics are printed; a last line counts the others. Control characters of the path and of the
    /// messages become escape sequences of JSON, and the renderer replaces those of the source lines.
    pub fn render(&self, colour: bool) -> String {
        let renderer = if colour { Renderer::styled() } else { Renderer::plain() };
        let shown = self.findings.iter().take(MAX_FINDINGS_SHOWN);
        let shown = shown.map(|finding| renderer.render(&[self.group(finding)]));
        let hidden = self.findings.len().saturating_sub(MAX_FINDINGS_SHOWN);
        let more = (hidden > 0).then(|| format!("and {hidden} more"));
        shown.chain(more).collect::<Vec<_>>().join("\n\n")
    }

    /// One diagnostic with title, source lines and advice.
    fn group<'a>(&'a self, finding: &'a Diagnostic) -> Group<'a> {
        let level = match finding.code.severity() {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
        };
        let title = level.primary_title(printable(&finding.message)).id(finding.code.as_str());
        let mut group = Group::with_title(title);
        if let Some(span) = finding.span {
            group = self.with_source_lines(group, span);
        }
        group.element(Level::HELP.message(printable(finding.advice())))
    }

    /// Adds the lines of a span. If they are longer than [`MAX_LINE_BYTES`], adds an excerpt around its start.
    fn with_source_lines<'a>(&'a self, group: Group<'a>, span: Span) -> Group<'a> {
        let [start, end] = [span.start, span.end].map(|byte| floor_char_boundary(&self.text, byte));
        let first = self.line_index.line(start);
        let from = self.line_index.line_start(first);
        let lines = from..self.line_index.line_end(&self.text, self.line_index.line(end));
        if lines.len() > MAX_LINE_BYTES {
            return self.with_excerpt(group, start..end);
        }
        let annotation = AnnotationKind::Primary.span(start - from..end - from);
        let snippet = Snippet::source(&self.text[lines]).line_start(first + 1);
        group.element(snippet.path(escape_controls(&self.file)).annotation(annotation))
    }

    /// Adds the part of a long line around the start of a span, with "..." where the line is cut.
    fn with_excerpt<'a>(&'a self, group: Group<'a>, span: Range<usize>) -> Group<'a> {
        let (line, column) = self.line_and_column(span.start);
        let whole = self.line_index.line_start(line - 1)..self.line_index.line_end(&self.text, line - 1);
        let boundary = |byte| floor_char_boundary(&self.text, byte);
        let end = span.end.min(boundary(span.start + EXCERPT_BYTES)).min(whole.end).max(span.start);
        let from = boundary(span.start.saturating_sub(EXCERPT_BYTES)).max(whole.start);
        let to = boundary(end + EXCERPT_BYTES).min(whole.end);
        let before = if from > whole.start { "..." } else { "" };
        let after = if to < whole.end { "..." } else { "" };
        let in_excerpt = |byte: usize| byte - from + before.len();
        let annotation = AnnotationKind::Primary.span(in_excerpt(span.start)..in_excerpt(end));
        let excerpt = format!("{before}{}{after}", &self.text[from..to]);
        group
            .element(Origin::path(escape_controls(&self.file)).line(line).char_column(column))
            .element(Snippet::source(excerpt).line_start(line).annotation(annotation))
    }

    /// All diagnostics as JSON objects, for `--json`.
    pub fn documents(&self) -> Vec<DiagnosticDocument> {
        self.findings.iter().map(|finding| self.diagnostic_document(finding)).collect()
    }

    /// One diagnostic with its position in the text.
    fn diagnostic_document(&self, finding: &Diagnostic) -> DiagnosticDocument {
        let position = finding.span.map(|span| self.line_and_column(span.start));
        DiagnosticDocument {
            code: finding.code.as_str(),
            severity: finding.code.severity().as_str(),
            file: self.file.clone(),
            line: position.map(|(line, _)| line),
            column: position.map(|(_, column)| column),
            message: finding.message.clone(),
            hint: finding.advice().to_owned(),
        }
    }
}

/// A diagnostic as a JSON object.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DiagnosticDocument {
    /// The code, such as "unknown-key".
    pub code: &'static str,
    /// "error" or "warning".
    pub severity: &'static str,
    /// The path of the document, as the user wrote it.
    pub file: String,
    /// From 1. `None` if the diagnostic has no position.
    pub line: Option<usize>,
    /// From 1, in characters. `None` if the diagnostic has no position.
    pub column: Option<usize>,
    /// What is wrong.
    pub message: String,
    /// The hint, or else the general advice of the code.
    pub hint: String,
}

/// The last byte up to `byte` at which a character begins, or the end of the text.
fn floor_char_boundary(text: &str, byte: usize) -> usize {
    (0..=byte.min(text.len())).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0)
}

impl fmt::Display for Report {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.render(false))
    }
}

impl std::error::Error for Report {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Code;

    fn report(text: &str, span: Span) -> Report {
        let finding = Diagnostic::at(Code::UNKNOWN_KEY, span, "no such key").hint("look it up");
        Report::new("a.json", text, vec![finding])
    }

    #[test]
    fn lines_and_columns_count_characters_from_one() {
        let report = report("{\n \"µ\": 1\n}", Span { start: 8, end: 9 });
        assert_eq!(report.line_and_column(8), (2, 6));
        assert_eq!(report.line_and_column(0), (1, 1));
        assert_eq!(report.line_and_column(999), (3, 2));
    }

    #[test]
    fn control_characters_of_paths_and_messages_are_escaped() {
        let control = "\u{1b}[31m\u{9b}1m";
        for text in ["[1]".to_owned(), format!("[{}]", " ".repeat(2 * MAX_LINE_BYTES))] {
            let finding = Diagnostic::at(Code::SYNTAX, Span { start: 1, end: 2 }, format!("no {control}"));
            let report = Report::new(&format!("a\n{control}.json"), &text, vec![finding.hint(control)]);
            let shown = report.to_string();
            assert!(shown.chars().all(|letter| letter == '\n' || !letter.is_control()), "{shown:?}");
            assert!(shown.contains("a\\u000a\\u001b[31m\\u009b1m.json:1:2"), "{shown}");
            assert_eq!(shown.matches("\\u001b[31m").count(), 3, "{shown}");
        }
    }

    #[test]
    fn a_span_inside_a_character_does_not_panic() {
        let text = "{\"µµ\": 1}";
        for start in 0..12 {
            report(text, Span { start, end: start + 1 }).render(false);
        }
    }

    #[test]
    fn a_report_shows_line_message_and_hint() {
        let shown = report("{\n  \"kin\": 1\n}", Span { start: 4, end: 9 }).to_string();
        for part in ["unknown-key", "no such key", "a.json:2:3", "\"kin\"", "look it up"] {
            assert!(shown.contains(part), "{part} is missing in\n{shown}");
        }
    }

    /// A report with diagnostics at the first `count` words of a text of words with three letters.
    fn report_at_words(text: &str, count: usize) -> Report {
        let spans = (0..count).map(|at| Span { start: 4 * at, end: 4 * at + 3 });
        let finding = |span| Diagnostic::at(Code::UNKNOWN_KEY, span, "no such key");
        Report::new("a.json", text, spans.map(finding).collect())
    }

    #[test]
    fn a_report_shows_fifty_diagnostics_and_counts_the_others() {
        let text = "abc\n".repeat(20_000);
        let shown = report_at_words(&text, 20_000).to_string();
        assert_eq!(shown.matches("no such key").count(), MAX_FINDINGS_SHOWN);
        assert!(shown.ends_with("\n\nand 19950 more"), "{shown}");
        assert_eq!(report_at_words(&text, 20_000).documents().len(), 20_000);
        assert!(!report_at_words(&text, MAX_FINDINGS_SHOWN).to_string().contains("more"));
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
