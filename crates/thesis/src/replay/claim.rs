//! A claim of the thesis, and the verdict on it.
//!
//! A claim is examined in two steps. Its check computes a finding. The finding is then compared with the printed
//! number or statement, which gives the verdict. The ledger states the expected verdict, and a test compares both.

use std::fmt;

use super::check_arguments::CheckArguments;
use super::checks::{self, CheckError};
use super::finding::{Finding, PrintedNumber, Tolerance};

/// The verdict on a claim.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::replay::ClaimVerdict;
///
/// assert_eq!(ClaimVerdict::Shape.ledger_word(), "shape");
/// assert_eq!(ClaimVerdict::Shape.to_string(), "reproduced in shape");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ClaimVerdict {
    /// Our result agrees with the text within the tolerance that the text itself states.
    Reproduced,
    /// Our result has the stated shape: the order, the sign or the trend. Sizes are not compared.
    Shape,
    /// Our result disagrees with the text.
    Differs,
    /// The scan lost the information that a check would need.
    Unknowable,
}

impl ClaimVerdict {
    /// All verdicts, best first, each with the word that the ledger files use.
    pub const ALL: [(&str, ClaimVerdict); 4] = [
        ("reproduced", ClaimVerdict::Reproduced),
        ("shape", ClaimVerdict::Shape),
        ("differs", ClaimVerdict::Differs),
        ("unknowable", ClaimVerdict::Unknowable),
    ];

    /// Returns the word that the ledger files use, such as "shape". The long form for readers is `Display`.
    pub fn ledger_word(self) -> &'static str {
        ClaimVerdict::ALL.iter().find(|(_, verdict)| *verdict == self).map_or("", |(word, _)| word)
    }
}

impl fmt::Display for ClaimVerdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            ClaimVerdict::Reproduced => "reproduced",
            ClaimVerdict::Shape => "reproduced in shape",
            ClaimVerdict::Differs => "differs",
            ClaimVerdict::Unknowable => "cannot be known from the scan",
        })
    }
}

/// A number or statement of the thesis that can be checked: one row of the ledger.
#[derive(Debug, Clone)]
pub struct Claim {
    /// The title of its chapter, such as "Chapter 7: surfaces and friction".
    pub chapter: &'static str,
    /// Its identifier, such as "7-031.a". Identifiers are unique over all chapters.
    pub id: String,
    /// The place in the text, such as "7.2, eq 31-7".
    pub place: String,
    /// The statement in a few words of ours, not quoted from the text.
    pub statement: String,
    /// The printed number. `None` if the claim is a statement.
    pub value: Option<PrintedNumber>,
    /// The unit of the number; empty if it has none.
    pub unit: String,
    /// The tolerance that the text states for its number. `None` if the claim is a statement.
    pub tolerance: Option<Tolerance>,
    /// The tolerance as it is written in the ledger, such as "2 digits".
    pub tolerance_text: String,
    /// The name of the check that decides the claim. `None` if no check is possible.
    pub check: Option<String>,
    /// The arguments of the check.
    pub arguments: CheckArguments,
    /// The expected verdict. A test fails if the check gives another one.
    pub verdict: ClaimVerdict,
    /// The reason for a verdict other than "reproduced"; empty if the claim is reproduced.
    pub reason: String,
}

/// The result of examining a claim.
#[derive(Debug, Clone, PartialEq)]
pub struct ClaimOutcome {
    /// The finding of the check. `None` if the claim has no check.
    pub finding: Option<Finding>,
    /// The verdict that follows from the finding.
    pub verdict: ClaimVerdict,
}

impl Claim {
    /// Runs the check and derives the verdict from its finding.
    ///
    /// # Errors
    /// If there is no check of that name, if its arguments are wrong, or if it cannot compute a finding.
    pub fn examine(&self) -> Result<ClaimOutcome, CheckError> {
        let finding = match &self.check {
            Some(name) => Some(checks::run(name, &self.arguments)?),
            None => None,
        };
        let verdict = finding.as_ref().map_or(ClaimVerdict::Unknowable, |finding| self.judge(finding));
        Ok(ClaimOutcome { finding, verdict })
    }

    /// Derives the verdict from a finding. A number without a printed number to compare with is
    /// [`ClaimVerdict::Unknowable`].
    fn judge(&self, finding: &Finding) -> ClaimVerdict {
        let (holds, best) = match finding {
            Finding::Truth { holds, .. } => (*holds, ClaimVerdict::Reproduced),
            Finding::Shape { holds, .. } => (*holds, ClaimVerdict::Shape),
            Finding::Number(got) => match (&self.value, &self.tolerance) {
                (Some(printed), Some(tolerance)) => {
                    (tolerance.accepts(*got, printed), ClaimVerdict::Reproduced)
                }
                _ => return ClaimVerdict::Unknowable,
            },
        };
        if holds { best } else { ClaimVerdict::Differs }
    }
}
