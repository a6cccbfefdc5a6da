//! A claim together with its result, and the texts that pages and JSON documents print of it.

use std::borrow::Cow;

use serde::{Serialize, Serializer};

use super::checks::CheckError;
use super::claim::{Claim, ClaimOutcome};
use super::finding::Finding;
use patchcord_core::document::unit_suffix;
use patchcord_expr::format_significant;

/// Significant digits of a computed number in the texts of a claim.
const RESULT_DIGITS: usize = 5;

/// A claim with its result.
///
/// It serialises as an object of texts with the keys `id`, `where`, `says`, `printed`, `within`, `got`, `difference`,
/// `verdict` and `why`.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::replay::{ExaminedClaim, ledger};
///
/// let claims = ledger()?;
/// let yielding = claims.iter().find(|claim| claim.id == "7-028").ok_or("a claim of the ledger")?;
/// let examined = ExaminedClaim::new(yielding)?;
/// assert_eq!(examined.printed_text(), "132 kgf/mm2");
/// assert_eq!(examined.result_text(), "132 kgf/mm2");
/// assert_eq!(examined.difference(), "+0.00 %");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ExaminedClaim {
    /// The claim, as the ledger states it.
    pub claim: Claim,
    /// The finding and the verdict.
    pub outcome: ClaimOutcome,
}

impl ExaminedClaim {
    /// Examines a claim.
    ///
    /// # Errors
    /// If its check cannot compute a finding.
    pub fn new(claim: &Claim) -> Result<Self, CheckError> {
        Ok(ExaminedClaim { outcome: claim.examine()?, claim: claim.clone() })
    }

    /// Returns the printed number with its unit; empty if the claim is a statement.
    pub fn printed_text(&self) -> String {
        let printed = self.claim.value.as_ref();
        printed.map_or_else(String::new, |printed| printed.text.clone() + &unit_suffix(&self.claim.unit))
    }

    /// Returns the result as text: a number with its unit, or the words of the check. It is empty if the claim has no
    /// check.
    pub fn result_text(&self) -> Cow<'_, str> {
        match &self.outcome.finding {
            None => Cow::Borrowed(""),
            Some(Finding::Number(number)) => {
                Cow::Owned(format_significant(*number, RESULT_DIGITS) + &unit_suffix(&self.claim.unit))
            }
            Some(Finding::Truth { found, .. } | Finding::Shape { found, .. }) => Cow::Borrowed(found),
        }
    }

    /// Returns the difference between computed and printed number, in percent of the printed one: "+1.25 %". It is
    /// empty if one of them is missing, or if the printed number is 0.
    pub fn difference(&self) -> String {
        match (&self.claim.value, &self.outcome.finding) {
            (Some(printed), Some(Finding::Number(got))) if printed.number != 0.0 => {
                let percent = 100.0 * (got / printed.number - 1.0);
                // Without this, a small negative number would be printed as -0.00.
                let percent = if percent.abs() < 0.005 { 0.0 } else { percent };
                format!("{percent:+.2} %")
            }
            _ => String::new(),
        }
    }
}

/// The JSON form of a claim with its result. All values are texts for readers.
#[derive(Serialize)]
struct ClaimSummary<'a> {
    id: &'a str,
    r#where: &'a str,
    says: &'a str,
    printed: String,
    within: &'a str,
    got: Cow<'a, str>,
    difference: String,
    verdict: String,
    why: &'a str,
}

impl Serialize for ExaminedClaim {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let claim = &self.claim;
        let summary = ClaimSummary {
            id: &claim.id,
            r#where: &claim.place,
            says: &claim.statement,
            printed: self.printed_text(),
            within: &claim.tolerance_text,
            got: self.result_text(),
            difference: self.difference(),
            verdict: self.outcome.verdict.to_string(),
            why: &claim.reason,
        };
        summary.serialize(serializer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replay::ledger;

    #[test]
    fn json_has_the_texts_of_the_page() {
        let claims = ledger().unwrap();
        let yielding = claims.iter().find(|claim| claim.id == "7-028").unwrap();
        let document = serde_json::to_value(ExaminedClaim::new(yielding).unwrap()).unwrap();
        let keys: Vec<_> = document.as_object().unwrap().keys().map(String::as_str).collect();
        let expected = ["id", "where", "says", "printed", "within", "got", "difference", "verdict", "why"];
        assert_eq!(keys, expected);
        assert_eq!((&document["got"], &document["verdict"]), (&"132 kgf/mm2".into(), &"reproduced".into()));
    }
}
