//! The error type of the parser of units.

use std::ops::Range;

/// The error of a unit text that cannot be parsed.
///
/// # Examples
///
/// ```
/// use patchcord_expr::Unit;
///
/// let error = Unit::parse("N sec/m").unwrap_err();
/// assert_eq!(error.to_string(), "sec is not a known unit");
/// assert_eq!(error.range, 2..5);
/// assert_eq!(error.hint.as_deref(), Some("did you mean s?"));
/// ```
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct UnitError {
    /// The bytes of the unit text that are at fault. The range is empty, at the end of the text, if
    /// something is missing.
    pub range: Range<usize>,
    /// The cause of the error, as a sentence without a full stop.
    pub message: String,
    /// What to write instead; `None` if there is no good guess.
    pub hint: Option<String>,
}

impl UnitError {
    /// Makes an error at these bytes, without a hint.
    pub(super) fn new(range: Range<usize>, message: impl Into<String>) -> Self {
        Self { range, message: message.into(), hint: None }
    }

    /// Returns the error with this hint.
    pub(super) fn with_hint(self, hint: impl Into<String>) -> Self {
        Self { hint: Some(hint.into()), ..self }
    }
}
