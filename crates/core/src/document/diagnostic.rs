//! Diagnostics as data: a code, a position in the text, a message and a hint.
//!
//! Code that finds a fault adds a [`Diagnostic`] to a list and continues, so that one run finds all faults. A
//! [`Report`](super::Report) joins the list with the text and prints it.

use std::ops::Range;

use super::code::Code;

/// A range of bytes in the text of a document.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::Span;
///
/// let formula = Span { start: 10, end: 20 };
/// assert_eq!(formula.subspan(&(2..5)), Span { start: 12, end: 15 });
/// assert_eq!(formula.subspan(&(5..50)), Span { start: 15, end: 20 });
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Span {
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

impl Span {
    /// A unique span for a value that is not in the text. `next` counts these spans; it starts at the end of the text.
    pub(crate) fn beyond_text(next: &mut usize) -> Span {
        let start = *next;
        *next += 1;
        Span { start, end: start + 1 }
    }

    /// A part of this span, specified in bytes from its start. The part is cut off at the end of the span.
    pub fn subspan(self, range: &Range<usize>) -> Span {
        let start = (self.start + range.start).min(self.end);
        Span { start, end: (self.start + range.end).clamp(start, self.end) }
    }
}

/// Whether a diagnostic prevents the patch from running.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Severity {
    /// The patch cannot run.
    Error,
    /// The patch can run, but its result may not be the intended one.
    Warning,
}

impl Severity {
    /// The word in reports and in JSON: "error" or "warning".
    pub fn as_str(self) -> &'static str {
        match self {
            Severity::Error => "error",
            Severity::Warning => "warning",
        }
    }
}

/// A fault of a document, or a warning about it.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::{Code, Diagnostic, Span};
///
/// let span = Span { start: 4, end: 9 };
/// let finding = Diagnostic::at(Code::UNKNOWN_KEY, span, "\"kin\" is not a key of the patch");
/// assert_eq!(finding.advice(), "remove it, or move its text to a \"note\"");
/// let finding = finding.hint("did you mean \"kind\"?");
/// assert_eq!(finding.advice(), "did you mean \"kind\"?");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnostic {
    /// The stable code; docs/diagnostics.md lists all codes.
    pub code: Code,
    /// Position in the text. `None` if the fault is not in the text, as for a wrong `--set`.
    pub span: Option<Span>,
    /// What is wrong, in one sentence without a full stop.
    pub message: String,
    /// What to do about it. `None` if the general advice of the code is sufficient.
    pub hint: Option<String>,
}

impl Diagnostic {
    /// A diagnostic at a position of the text, without a hint.
    pub fn at(code: Code, span: Span, message: impl Into<String>) -> Self {
        Diagnostic { code, span: Some(span), message: message.into(), hint: None }
    }

    /// A diagnostic without a position in the text, such as the one for a wrong `--set`.
    pub fn without_span(code: Code, message: impl Into<String>) -> Self {
        Diagnostic { code, span: None, message: message.into(), hint: None }
    }

    /// The same diagnostic with this hint.
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// The hint, or else the general advice of the code.
    pub fn advice(&self) -> &str {
        self.hint.as_deref().unwrap_or(self.code.advice())
    }

    /// Refers to the reference page of another kind of document if the code's advice refers to that of patches.
    pub fn set_reference_page(&mut self, page: &str) {
        if matches!(self.code, Code::WRONG_TYPE | Code::MISSING_KEY) {
            self.hint.get_or_insert_with(|| format!("{page} describes every key"));
        }
    }

    /// The same diagnostic with this hint. `None` keeps the present hint.
    pub fn maybe_hint(mut self, hint: Option<String>) -> Self {
        self.hint = hint.or(self.hint);
        self
    }
}

/// Whether any of the diagnostics prevents the patch from running.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::{Code, Diagnostic, any_error};
///
/// let warning = Diagnostic::without_span(Code::UNUSED_ELEMENT, "nothing uses the output of A1");
/// let error = Diagnostic::without_span(Code::UNKNOWN_NAME, "there is no parameter K to set");
/// assert!(!any_error(&[warning.clone()]));
/// assert!(any_error(&[warning, error]));
/// ```
pub fn any_error(findings: &[Diagnostic]) -> bool {
    findings.iter().any(|finding| finding.code.severity() == Severity::Error)
}
