//! Reports: the diagnostics of a document with its text, printed for a terminal, for a page or as JSON.

#[cfg(feature = "snippets")]
mod snippets;

use std::fmt;

use serde::Serialize;

use super::diagnostic::{Diagnostic, Severity};
use super::line_index::LineIndex;
use super::printable::{escape_controls, printable};

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
    #[cfg(feature = "snippets")]
    pub fn render(&self, colour: bool) -> String {
        let renderer = snippets::renderer(colour);
        self.joined(|finding| snippets::render(self, finding, &renderer))
    }

    /// The report without the faulty lines, for a place without columns such as a page: the message, the position and
    /// the advice of each diagnostic.
    ///
    /// At most 50 diagnostics are printed; a last line counts the others. Control characters become escape sequences of
    /// JSON.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::Patch;
    ///
    /// let report = Patch::parse("p.json", "{\"patchcord\": 1,}").unwrap_err();
    /// let text = report.plain();
    /// assert!(text.starts_with("error[syntax]: "));
    /// assert!(text.ends_with("\n --> p.json:1:16\n  = help: remove the last comma"));
    /// ```
    pub fn plain(&self) -> String {
        self.joined(|finding| self.plain_finding(finding))
    }

    /// Joins the texts of the first [`MAX_FINDINGS_SHOWN`] diagnostics and the number of the others.
    fn joined(&self, text: impl Fn(&Diagnostic) -> String) -> String {
        let shown = self.findings.iter().take(MAX_FINDINGS_SHOWN).map(text);
        let hidden = self.findings.len().saturating_sub(MAX_FINDINGS_SHOWN);
        let more = (hidden > 0).then(|| format!("and {hidden} more"));
        shown.chain(more).collect::<Vec<_>>().join("\n\n")
    }

    /// One diagnostic in the form of [`Report::plain`].
    fn plain_finding(&self, finding: &Diagnostic) -> String {
        let position = finding.span.map(|span| {
            let (line, column) = self.line_and_column(span.start);
            format!("\n --> {}:{line}:{column}", escape_controls(&self.file))
        });
        format!(
            "{}[{}]: {}{}\n  = help: {}",
            finding.code.severity().as_str(),
            finding.code.as_str(),
            printable(&finding.message),
            position.unwrap_or_default(),
            printable(finding.advice())
        )
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

/// The text for a terminal without colours, or the plain text if this crate has no source lines in reports.
impl fmt::Display for Report {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        #[cfg(feature = "snippets")]
        let text = self.render(false);
        #[cfg(not(feature = "snippets"))]
        let text = self.plain();
        formatter.write_str(&text)
    }
}

impl std::error::Error for Report {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Code, Span};

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
    fn a_plain_report_has_message_position_and_advice() {
        let mut report = report("{\n  \"kin\": 1\n}", Span { start: 4, end: 9 });
        let fault = "error[unknown-key]: no such key\n --> a.json:2:3\n  = help: look it up";
        assert_eq!(report.plain(), fault);
        report
            .findings
            .push(Diagnostic::without_span(Code::UNUSED_ELEMENT, "nothing uses A1").hint("remove it"));
        let warning = "warning[unused-element]: nothing uses A1\n  = help: remove it";
        assert_eq!(report.plain(), format!("{fault}\n\n{warning}"));
        assert_eq!(Report::new("a.json", "", Vec::new()).plain(), "");
    }

    #[test]
    fn a_plain_report_has_no_control_characters() {
        let control = "\u{1b}[31m\u{9b}1m";
        let finding = Diagnostic::at(Code::SYNTAX, Span { start: 1, end: 2 }, format!("no {control}"));
        let shown = Report::new(&format!("a\n{control}.json"), "[1]", vec![finding.hint(control)]).plain();
        assert!(shown.chars().all(|letter| letter == '\n' || !letter.is_control()), "{shown:?}");
        assert!(shown.contains(" --> a\\u000a\\u001b[31m\\u009b1m.json:1:2\n"), "{shown}");
        assert_eq!(shown.matches("\\u001b[31m").count(), 3, "{shown}");
    }

    #[test]
    fn a_span_inside_a_character_does_not_panic() {
        let text = "{\"µµ\": 1}";
        for start in 0..12 {
            let report = report(text, Span { start, end: start + 1 });
            assert!(!report.to_string().is_empty() && !report.plain().is_empty());
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
        let report = report_at_words(&text, 20_000);
        for shown in [report.to_string(), report.plain()] {
            assert_eq!(shown.matches("no such key").count(), MAX_FINDINGS_SHOWN);
            assert!(shown.ends_with("\n\nand 19950 more"), "{shown}");
        }
        assert_eq!(report.documents().len(), 20_000);
        let all = report_at_words(&text, MAX_FINDINGS_SHOWN);
        assert!(!all.to_string().contains("more") && !all.plain().contains("more"));
    }
}
