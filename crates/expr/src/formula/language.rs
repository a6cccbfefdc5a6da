//! The two languages that the parser reads: formulas and equations.

/// A language of the parser.
///
/// An equation is written like a formula. It also has one `=`, primes for derivatives, `(0)` for initial
/// values, products without a sign and a few more functions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Language {
    /// A formula, such as `2 * K * position`.
    Formula,
    /// An equation, such as `m x'' = -k x`.
    Equation,
}

impl Language {
    /// Returns what a text in this language is called, with the article.
    pub(super) fn noun(self) -> &'static str {
        match self {
            Self::Formula => "a formula",
            Self::Equation => "an equation",
        }
    }

    /// Returns the message about a text without a sign.
    pub(super) fn empty_message(self) -> &'static str {
        match self {
            Self::Formula => "the formula is empty",
            Self::Equation => "the equation is empty",
        }
    }

    /// Returns the message about too many levels of nesting, and what to do about it.
    pub(super) fn nesting_message(self) -> (&'static str, &'static str) {
        match self {
            Self::Formula => ("the formula is nested too deeply", "define a part of it as a parameter"),
            Self::Equation => {
                ("the equation is nested too deeply", "define a part of it by an equation of its own")
            }
        }
    }
}
