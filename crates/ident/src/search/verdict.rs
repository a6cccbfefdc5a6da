//! What a search can find out.

/// What was found out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// These effects are missing.
    Named,
    /// One of several is missing, and the data cannot tell which.
    Ambiguous,
    /// The patch explains the data.
    NothingMissing,
    /// Something is missing that the library does not have.
    UnknownEffect,
    /// The data do not bear a judgement.
    CannotJudge,
}

impl Verdict {
    /// Whether effects are named.
    pub fn has_names(self) -> bool {
        matches!(self, Verdict::Named | Verdict::Ambiguous)
    }

    /// The word for it in reports.
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
