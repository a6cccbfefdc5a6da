//! A claim, and what becomes of it.

use std::fmt;

use super::checks::{self, CheckError};
use super::finding::{Finding, Printed, Within};
use super::given::Given;

/// What becomes of a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// We get what is said, as near as the text itself says.
    Reproduced,
    /// We get the shape of what is said: the order, the sign, the rise.
    Shape,
    /// We get something else.
    Differs,
    /// The scan lost what it would take to tell.
    Unknowable,
}

impl Verdict {
    /// All of them, best first, with the words that ledgers use.
    pub const ALL: [(&str, Verdict); 4] = [
        ("reproduced", Verdict::Reproduced),
        ("shape", Verdict::Shape),
        ("differs", Verdict::Differs),
        ("unknowable", Verdict::Unknowable),
    ];

    /// The word that ledgers use.
    pub fn word(self) -> &'static str {
        Verdict::ALL.iter().find(|(_, verdict)| *verdict == self).map_or("", |(word, _)| word)
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Verdict::Reproduced => "reproduced",
            Verdict::Shape => "reproduced in shape",
            Verdict::Differs => "differs",
            Verdict::Unknowable => "cannot be known from the scan",
        })
    }
}

/// A number or statement of the study that can be checked: a row of the ledger.
#[derive(Debug, Clone)]
pub struct Claim {
    /// The title of its chapter.
    pub chapter: &'static str,
    /// Its name, such as "7-031".
    pub id: String,
    /// Where it stands, such as "7.2, eq 31-7".
    pub place: String,
    /// What it says, in a few words of our own.
    pub says: String,
    /// The printed number; none for a statement.
    pub value: Option<Printed>,
    /// The unit of the number.
    pub unit: String,
    /// How near the text says that the number is; stands with a number only.
    pub within: Option<Within>,
    /// The same as written.
    pub within_told: String,
    /// The name of the check that decides it; none where nothing can.
    pub check: Option<String>,
    /// What the check is given.
    pub given: Given,
    /// The verdict that is expected.
    pub verdict: Verdict,
    /// Why it is not reproduced; empty where it is.
    pub why: String,
}

/// What becomes of a claim when it is examined.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// What the check found; none where there is no check.
    pub finding: Option<Finding>,
    /// What follows from it.
    pub verdict: Verdict,
}

impl Claim {
    /// Runs the check and tells what follows from what it finds.
    ///
    /// # Errors
    /// Where the check is not known, takes other arguments, or finds nothing.
    pub fn examine(&self) -> Result<Outcome, CheckError> {
        let finding = match &self.check {
            Some(name) => Some(checks::run(name, &self.given)?),
            None => None,
        };
        let verdict = finding.as_ref().map_or(Verdict::Unknowable, |finding| self.judge(finding));
        Ok(Outcome { finding, verdict })
    }

    /// What follows from a finding. A number with no printed one to stand beside decides nothing.
    fn judge(&self, finding: &Finding) -> Verdict {
        let (holds, best) = match finding {
            Finding::Truth { holds, .. } => (*holds, Verdict::Reproduced),
            Finding::Shape { holds, .. } => (*holds, Verdict::Shape),
            Finding::Number(got) => match (&self.value, &self.within) {
                (Some(printed), Some(within)) => (within.holds(*got, printed), Verdict::Reproduced),
                _ => return Verdict::Unknowable,
            },
        };
        if holds { best } else { Verdict::Differs }
    }
}
