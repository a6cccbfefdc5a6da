//! The error type that the parser, the evaluation and the unit check of formulas share.

use std::ops::Range;

/// The error of a formula that cannot be parsed, evaluated or given a unit.
///
/// # Examples
///
/// ```
/// use patchcord_expr::Formula;
///
/// let error = Formula::parse("2 (a + b)").unwrap_err();
/// assert_eq!(error.to_string(), "an operator is missing before (");
/// assert_eq!(error.range, 2..3);
/// assert_eq!(error.hint.as_deref(), Some("a product is written with *"));
/// ```
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct FormulaError {
    /// The bytes of the formula text that are at fault. The range is empty at the place where
    /// something is missing.
    pub range: Range<usize>,
    /// The cause of the error, as a sentence without a full stop.
    pub message: String,
    /// What to write instead; `None` if there is no good guess.
    pub hint: Option<String>,
}

impl FormulaError {
    /// Makes an error at these bytes, without a hint.
    pub(super) fn new(range: Range<usize>, message: impl Into<String>) -> Self {
        Self { range, message: message.into(), hint: None }
    }

    /// Returns the error with this hint in place of its own.
    pub(super) fn with_hint(self, hint: impl Into<String>) -> Self {
        self.with_hint_if(Some(hint.into()))
    }

    /// Returns the error with this hint. `None` removes the hint.
    pub(super) fn with_hint_if(self, hint: Option<String>) -> Self {
        Self { hint, ..self }
    }
}
