//! Claims with what became of them.

use std::borrow::Cow;

use serde_json::{Value, json};

use super::checks::CheckError;
use super::claim::{Claim, Outcome};
use super::finding::Finding;

/// A claim with what became of it.
#[derive(Debug, Clone)]
pub struct Examined {
    /// The claim.
    pub claim: Claim,
    /// What became of it.
    pub outcome: Outcome,
}

impl Examined {
    /// A claim and what becomes of it.
    ///
    /// # Errors
    /// Where it cannot be examined.
    pub fn of(claim: &Claim) -> Result<Self, CheckError> {
        Ok(Examined { outcome: claim.examine()?, claim: claim.clone() })
    }

    /// The number as printed, with its unit; empty for a statement.
    pub fn printed(&self) -> String {
        let printed = self.claim.value.as_ref().map_or("", |value| value.text.as_str());
        if printed.is_empty() { String::new() } else { with_unit(printed, &self.claim.unit) }
    }

    /// What was found, in words.
    pub fn got(&self) -> Cow<'_, str> {
        match &self.outcome.finding {
            None => Cow::Borrowed(""),
            Some(Finding::Number(number)) => Cow::Owned(with_unit(&told(*number), &self.claim.unit)),
            Some(Finding::Truth { found, .. } | Finding::Shape { found, .. }) => Cow::Borrowed(found),
        }
    }

    /// How far the number found is from the printed one, in percent of that; empty where there is none.
    pub fn difference(&self) -> String {
        match (&self.claim.value, &self.outcome.finding) {
            (Some(printed), Some(Finding::Number(got))) if printed.number != 0.0 => {
                let percent = 100.0 * (got / printed.number - 1.0);
                // Rounding must not leave a sign before 0.
                let percent = if percent.abs() < 0.005 { 0.0 } else { percent };
                format!("{percent:+.2} %")
            }
            _ => String::new(),
        }
    }

    /// All of it, for programs.
    pub fn to_json(&self) -> Value {
        let claim = &self.claim;
        json!({
            "id": claim.id,
            "where": claim.place,
            "says": claim.says,
            "printed": self.printed(),
            "within": claim.within_told,
            "got": self.got(),
            "difference": self.difference(),
            "verdict": self.outcome.verdict.to_string(),
            "why": claim.why,
        })
    }
}

fn with_unit(number: &str, unit: &str) -> String {
    format!("{number} {unit}").trim_end().to_owned()
}

/// A number to five digits, with a power of ten where it is very large or small.
fn told(number: f64) -> String {
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
            assert_eq!(told(number), text);
        }
    }
}
