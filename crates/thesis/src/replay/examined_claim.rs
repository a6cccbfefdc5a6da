//! A claim together with its result, and the texts that pages and JSON documents print of it.

use std::borrow::Cow;

use serde_json::{Value, json};

use super::checks::CheckError;
use super::claim::{Claim, ClaimOutcome};
use super::finding::Finding;

/// A claim with its result.
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
        let printed = self.claim.value.as_ref().map_or("", |value| value.text.as_str());
        if printed.is_empty() { String::new() } else { with_unit(printed, &self.claim.unit) }
    }

    /// Returns the result as text: a number with its unit, or the words of the check. It is empty if the claim has no
    /// check.
    pub fn result_text(&self) -> Cow<'_, str> {
        match &self.outcome.finding {
            None => Cow::Borrowed(""),
            Some(Finding::Number(number)) => Cow::Owned(with_unit(&format_number(*number), &self.claim.unit)),
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

    /// Returns the claim and its result as a JSON object.
    pub fn to_json(&self) -> Value {
        let claim = &self.claim;
        json!({
            "id": claim.id,
            "where": claim.place,
            "says": claim.statement,
            "printed": self.printed_text(),
            "within": claim.tolerance_text,
            "got": self.result_text(),
            "difference": self.difference(),
            "verdict": self.outcome.verdict.to_string(),
            "why": claim.reason,
        })
    }
}

/// Appends a unit, if there is one.
fn with_unit(number: &str, unit: &str) -> String {
    format!("{number} {unit}").trim_end().to_owned()
}

/// Formats a number with five significant digits. Very small and very large numbers get a power of ten.
fn format_number(number: f64) -> String {
    let short: f64 = format!("{number:.4e}").parse().unwrap_or(number);
    match short.abs() {
        0.0 => "0".to_owned(),
        1e-4..1e7 => short.to_string(),
        _ => format!("{short:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_five_digits() {
        let cases = [
            (0.0, "0"),
            (0.126_254, "0.12625"),
            (-45.000_01, "-45"),
            (1.234_56e-7, "1.2346e-7"),
            (2e9, "2e9"),
        ];
        for (number, text) in cases {
            assert_eq!(format_number(number), text);
        }
    }
}
