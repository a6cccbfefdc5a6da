//! The verdict of a search.

/// The verdict of a search.
///
/// # Examples
///
/// ```
/// use patchcord_ident::Verdict;
///
/// assert_eq!(Verdict::UnknownEffect.as_str(), "unknown-effect");
/// assert!(Verdict::Ambiguous.has_names() && !Verdict::CannotJudge.has_names());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Verdict {
    /// The named effects are missing.
    Named,
    /// One of several effects is missing. The data cannot distinguish them.
    Ambiguous,
    /// The patch explains the data.
    NothingMissing,
    /// An effect is missing that the library does not have.
    UnknownEffect,
    /// The data are inconclusive.
    CannotJudge,
}

impl Verdict {
    /// Whether the verdict names effects.
    pub fn has_names(self) -> bool {
        matches!(self, Verdict::Named | Verdict::Ambiguous)
    }

    /// The value of the key "verdict" in JSON documents, for example "unknown-effect". Scripts read it.
    pub fn as_str(self) -> &'static str {
        match self {
            Verdict::Named => "named",
            Verdict::Ambiguous => "ambiguous",
            Verdict::NothingMissing => "nothing-missing",
            Verdict::UnknownEffect => "unknown-effect",
            Verdict::CannotJudge => "cannot-judge",
        }
    }
}
