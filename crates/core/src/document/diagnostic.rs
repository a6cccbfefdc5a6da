//! What is wrong with a patch, as data: a code, a place in the file, a message and a hint.

use std::fmt;
use std::ops::Range;

use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet};
use serde_json::{Value, json};

use super::code::Code;
use super::places::Places;
use patchcord_expr::nearest;

/// A stretch of the document's text, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Span {
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

impl Span {
    /// A span that no other part has, for a part that is not in the text. `next` counts these spans; it begins behind the
    /// text.
    pub(crate) fn beyond_text(next: &mut usize) -> Span {
        let start = *next;
        *next += 1;
        Span { start, end: start + 1 }
    }

    /// A part of this span, given in bytes from its start; never leaves it.
    pub fn part(self, range: &Range<usize>) -> Span {
        let start = (self.start + range.start).min(self.end);
        Span { start, end: (self.start + range.end).clamp(start, self.end) }
    }
}

/// Whether a finding stops the patch from running.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// The patch cannot be run.
    Error,
    /// The patch runs, but the reader should know.
    Warning,
}

impl Severity {
    /// The word used in reports.
    pub fn as_str(self) -> &'static str {
        match self {
            Severity::Error => "error",
            Severity::Warning => "warning",
        }
    }
}

/// One finding about a patch.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnostic {
    /// Stable code; docs/diagnostics.md lists them all.
    pub code: Code,
    /// Where in the text it stands, where it stands anywhere.
    pub span: Option<Span>,
    /// What is wrong, in one sentence.
    pub message: String,
    /// What to do about it here, where more can be said than the code's advice.
    pub hint: Option<String>,
}

impl Diagnostic {
    /// A finding at a place of the text.
    pub fn at(code: Code, span: Span, message: impl Into<String>) -> Self {
        Diagnostic { code, span: Some(span), message: message.into(), hint: None }
    }

    /// A finding that has no place in the text, such as a wrong `--set`.
    pub fn nowhere(code: Code, message: impl Into<String>) -> Self {
        Diagnostic { code, span: None, message: message.into(), hint: None }
    }

    /// The same finding with advice.
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// What to do about it.
    pub fn advice(&self) -> &str {
        self.hint.as_deref().unwrap_or(self.code.advice())
    }

    /// Points to the page of another kind of document, where the code's advice points to that of patches.
    pub fn point_to(&mut self, page: &str) {
        if matches!(self.code, Code::WrongType | Code::MissingKey) {
            self.hint.get_or_insert_with(|| format!("{page} shows what stands under each key"));
        }
    }

    /// The same finding with advice where there is any.
    pub fn maybe_hint(mut self, hint: Option<String>) -> Self {
        self.hint = hint.or(self.hint);
        self
    }
}

/// Lines with more bytes than this are shown in part.
const LONGEST_SHOWN: usize = 4000;
/// Bytes shown before, inside and after a span in a long line.
const PART_SHOWN: usize = 40;

/// All findings about one document, with the text they speak of.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// The document's file name, as the reader wrote it.
    pub file: String,
    /// The document's text.
    pub text: String,
    /// The findings, in the order of the text.
    pub findings: Vec<Diagnostic>,
    places: Places,
}

/// More findings than this are not shown but counted.
const MOST_SHOWN: usize = 50;

impl Report {
    /// A report on a document; findings are put into the order of the text.
    pub fn new(file: &str, text: &str, mut findings: Vec<Diagnostic>) -> Self {
        findings.sort_by_key(|finding| finding.span.map_or(usize::MAX, |span| span.start));
        Report { file: file.to_owned(), text: text.to_owned(), findings, places: Places::of(text) }
    }

    /// Whether anything stops the patch from running.
    pub fn has_errors(&self) -> bool {
        self.errors() > 0
    }

    /// Number of findings that stop the patch.
    pub fn errors(&self) -> usize {
        self.findings.iter().filter(|finding| finding.code.severity() == Severity::Error).count()
    }

    /// Number of findings that do not.
    pub fn warnings(&self) -> usize {
        self.findings.len() - self.errors()
    }

    /// Line and column (both from 1, columns in characters) of a byte of the text.
    pub fn line_and_column(&self, byte: usize) -> (usize, usize) {
        self.places.line_and_column(&self.text, floor_char_boundary(&self.text, byte))
    }

    /// The report as a terminal shows it, with the guilty line of each finding: the first 50, and how many more
    /// there are.
    pub fn render(&self, colour: bool) -> String {
        let renderer = if colour { Renderer::styled() } else { Renderer::plain() };
        let shown = self.findings.iter().take(MOST_SHOWN);
        let shown = shown.map(|finding| renderer.render(&[self.group(finding)]));
        let left = self.findings.len().saturating_sub(MOST_SHOWN);
        let more = (left > 0).then(|| format!("and {left} more"));
        shown.chain(more).collect::<Vec<_>>().join("\n\n")
    }

    fn group<'a>(&'a self, finding: &'a Diagnostic) -> Group<'a> {
        let level = match finding.code.severity() {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
        };
        let title = level.primary_title(&finding.message).id(finding.code.as_str());
        let mut group = Group::with_title(title);
        if let Some(span) = finding.span {
            group = self.shown(group, span);
        }
        group.element(Level::HELP.message(finding.advice()))
    }

    /// Adds the lines of a span; where these are long, what stands around its beginning.
    fn shown<'a>(&'a self, group: Group<'a>, span: Span) -> Group<'a> {
        let [start, end] = [span.start, span.end].map(|byte| floor_char_boundary(&self.text, byte));
        let first = self.places.line(start);
        let from = self.places.line_start(first);
        let lines = from..self.places.line_end(&self.text, self.places.line(end));
        if lines.len() > LONGEST_SHOWN {
            return self.shown_in_part(group, start..end);
        }
        let place = AnnotationKind::Primary.span(start - from..end - from);
        let snippet = Snippet::source(&self.text[lines]).line_start(first + 1);
        group.element(snippet.path(&self.file).annotation(place))
    }

    fn shown_in_part<'a>(&'a self, group: Group<'a>, span: Range<usize>) -> Group<'a> {
        let (line, column) = self.line_and_column(span.start);
        let whole = self.places.line_start(line - 1)..self.places.line_end(&self.text, line - 1);
        let boundary = |byte| floor_char_boundary(&self.text, byte);
        let end = span.end.min(boundary(span.start + PART_SHOWN)).min(whole.end).max(span.start);
        let from = boundary(span.start.saturating_sub(PART_SHOWN)).max(whole.start);
        let to = boundary(end + PART_SHOWN).min(whole.end);
        let before = if from > whole.start { "..." } else { "" };
        let after = if to < whole.end { "..." } else { "" };
        let moved = |byte: usize| byte - from + before.len();
        let place = AnnotationKind::Primary.span(moved(span.start)..moved(end));
        let part = format!("{before}{}{after}", &self.text[from..to]);
        group
            .element(Origin::path(&self.file).line(line).char_column(column))
            .element(Snippet::source(part).line_start(line).annotation(place))
    }

    /// The findings for `--json`: a list of code, severity, line, column, message and hint.
    pub fn to_json(&self) -> Value {
        self.findings.iter().map(|finding| self.finding_to_json(finding)).collect()
    }

    fn finding_to_json(&self, finding: &Diagnostic) -> Value {
        let place = finding.span.map(|span| self.line_and_column(span.start));
        json!({
            "code": finding.code.as_str(),
            "severity": finding.code.severity().as_str(),
            "file": self.file,
            "line": place.map(|place| place.0),
            "column": place.map(|place| place.1),
            "message": finding.message,
            "hint": finding.advice(),
        })
    }
}

fn floor_char_boundary(text: &str, byte: usize) -> usize {
    (0..=byte.min(text.len())).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0)
}

impl fmt::Display for Report {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.render(false))
    }
}

impl std::error::Error for Report {}

/// A number as messages show it: no more than six significant digits.
pub fn told(value: f64) -> String {
    let short: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    match short.abs() {
        0.0 => "0".to_owned(),
        1e-4..1e7 => short.to_string(),
        _ => format!("{short:e}"),
    }
}

/// A unit as it stands behind a number: nothing for a pure one.
pub fn behind(unit: &str) -> String {
    if unit.is_empty() || unit == "1" { String::new() } else { format!(" {unit}") }
}

/// What is wrong with a value that misses its range, in words that follow it.
pub fn outside(value: f64, (low, high): (f64, f64), unit: &str) -> String {
    let unit = behind(unit);
    // What is allowed for rounding is not told.
    let plain = |bound: f64| told(if bound.abs() < 1e3 { (bound * 1e9).round() / 1e9 } else { bound });
    match high {
        _ if !value.is_finite() => "and must be a finite number".to_owned(),
        f64::MAX => format!("below {}{unit}", plain(low)),
        _ => format!("outside {} ... {}{unit}", plain(low), plain(high)),
    }
}

/// Whether any finding stops the patch.
pub fn any_error(findings: &[Diagnostic]) -> bool {
    findings.iter().any(|finding| finding.code.severity() == Severity::Error)
}

/// More known names than this are not listed.
const MOST_LISTED: usize = 10;

/// "did you mean" for a mistyped name, or else what is known, ten names at most.
pub fn suggestion(name: &str, known: &[&str]) -> Option<String> {
    if let Some(near) = nearest(name, known.iter().copied()) {
        return Some(format!("did you mean \"{near}\"?"));
    }
    let listed = known.iter().take(MOST_LISTED).copied();
    let more = (known.len() > MOST_LISTED).then_some("...");
    let listed: Vec<_> = listed.chain(more).collect();
    (!known.is_empty()).then(|| format!("known here: {}", listed.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(text: &str, span: Span) -> Report {
        let finding = Diagnostic::at(Code::UnknownKey, span, "no such key").hint("look it up");
        Report::new("a.json", text, vec![finding])
    }

    #[test]
    fn places_count_characters_from_one() {
        let report = report("{\n \"µ\": 1\n}", Span { start: 8, end: 9 });
        assert_eq!(report.line_and_column(8), (2, 6));
        assert_eq!(report.line_and_column(0), (1, 1));
        assert_eq!(report.line_and_column(999), (3, 2));
    }

    #[test]
    fn a_span_inside_a_letter_does_not_panic() {
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

    /// Findings at every word of a text.
    fn many(text: &str, count: usize) -> Report {
        let spans = (0..count).map(|at| Span { start: 4 * at, end: 4 * at + 3 });
        let finding = |span| Diagnostic::at(Code::UnknownKey, span, "no such key");
        Report::new("a.json", text, spans.map(finding).collect())
    }

    #[test]
    fn fifty_findings_are_shown_and_the_others_counted() {
        let text = "abc\n".repeat(20_000);
        let shown = many(&text, 20_000).to_string();
        assert_eq!(shown.matches("no such key").count(), MOST_SHOWN);
        assert!(shown.ends_with("\n\nand 19950 more"), "{shown}");
        assert_eq!(many(&text, 20_000).to_json().as_array().unwrap().len(), 20_000);
        assert!(!many(&text, MOST_SHOWN).to_string().contains("more"));
    }

    #[test]
    fn of_a_long_line_the_part_around_the_finding_is_shown() {
        let text = "µbc ".repeat(3_000_000);
        let start = 5 * 1_000_000;
        let finding = Diagnostic::at(Code::UnknownKey, Span { start, end: start + 4 }, "no such key");
        let report = Report::new("a.json", &text, vec![finding; 20_000]);
        let shown = report.to_string();
        assert!(shown.contains("a.json:1:4000001\n"), "{shown}");
        assert!(shown.contains("...µbc µbc") && shown.contains(" ^^^"), "{shown}");
        assert!(shown.lines().all(|line| line.len() < 200), "{shown}");
        assert_eq!(report.to_json()[19_999]["column"], 4_000_001);
    }

    #[test]
    fn numbers_are_told_shortly() {
        let numbers = [(1.2, "1.2"), (-0.0, "0"), (1.0 / 3.0, "0.333333"), (45e6, "4.5e7"), (1e-9, "1e-9")];
        for (value, shown) in numbers {
            assert_eq!(told(value), shown);
        }
    }

    #[test]
    fn a_near_name_is_offered_or_else_all() {
        assert_eq!(suggestion("sumer", &["summer", "pot"]).unwrap(), "did you mean \"summer\"?");
        assert_eq!(suggestion("relay", &["summer", "pot"]).unwrap(), "known here: summer, pot");
        let many = ["a"; 11];
        assert!(suggestion("relay", &many[..10]).unwrap().ends_with("a, a"));
        assert!(suggestion("relay", &many).unwrap().ends_with("a, a, ..."));
    }
}
