//! Reads the ledger of claims: one CSV file per chapter, compiled into the program.
//!
//! Every file has the same columns. Each row becomes a [`Claim`]. A row is checked for consistency: a number needs a
//! tolerance, a verdict other than "reproduced" needs a reason, and identifiers are unique.

use std::collections::HashSet;

use csv::{ReaderBuilder, StringRecord};

use super::check_arguments::CheckArguments;
use super::claim::{Claim, ClaimVerdict};
use super::finding::{PrintedNumber, Tolerance};

/// The chapters: title, file name and text of the file.
const FILES: &[(&str, &str, &str)] = &[
    ("Chapter 2: the work of others", "chapter_2.csv", include_str!("claims/chapter_2.csv")),
    ("Chapter 3: the system", "chapter_3.csv", include_str!("claims/chapter_3.csv")),
    ("Chapter 4: slideways and drives", "chapter_4.csv", include_str!("claims/chapter_4.csv")),
    ("Chapter 5: wear", "chapter_5.csv", include_str!("claims/chapter_5.csv")),
    ("Chapter 6: lubricants", "chapter_6.csv", include_str!("claims/chapter_6.csv")),
    ("Chapter 7: surfaces and friction", "chapter_7.csv", include_str!("claims/chapter_7.csv")),
    ("Chapter 8: simulation", "chapter_8.csv", include_str!("claims/chapter_8.csv")),
    ("Chapter 9: analysis", "chapter_9.csv", include_str!("claims/chapter_9.csv")),
    ("Chapter 10: conclusions", "chapter_10.csv", include_str!("claims/chapter_10.csv")),
];

/// The columns of every file, in order.
const COLUMNS: [&str; 10] =
    ["id", "where", "says", "value", "unit", "within", "check", "given", "verdict", "why"];

/// An error in a row of the ledger.
#[derive(Debug, thiserror::Error)]
#[error("{file}, line {line}: {problem}")]
pub struct LedgerError {
    /// The name of the file.
    pub file: &'static str,
    /// The line, from 1. It is 0 if the CSV reader cannot locate the error.
    pub line: u64,
    /// The error.
    pub problem: String,
}

/// Returns all claims, chapter by chapter.
///
/// # Errors
/// If a row is wrong. The first such row is reported.
///
/// # Examples
///
/// Claim 7-028: iron of hardness 220 flows at a peak pressure of 132 kgf/mm2.
///
/// ```
/// use patchcord_thesis::replay::{ClaimVerdict, ledger};
///
/// let claims = ledger()?;
/// let yielding = claims.iter().find(|claim| claim.id == "7-028").ok_or("a claim of the ledger")?;
/// assert_eq!((yielding.place.as_str(), yielding.unit.as_str()), ("7.2", "kgf/mm2"));
/// assert_eq!(yielding.examine()?.verdict, ClaimVerdict::Reproduced);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn ledger() -> Result<Vec<Claim>, LedgerError> {
    let (mut seen, mut claims) = (HashSet::new(), Vec::new());
    for (chapter, file, text) in FILES {
        claims.extend(read(chapter, file, text, &mut seen)?);
    }
    Ok(claims)
}

/// Reads one file. `seen` holds the identifiers of the claims so far, over all files.
fn read(
    chapter: &'static str,
    file: &'static str,
    text: &str,
    seen: &mut HashSet<String>,
) -> Result<Vec<Claim>, LedgerError> {
    let mut reader = ReaderBuilder::new().from_reader(text.as_bytes());
    let error_at = |line: u64, problem: String| LedgerError { file, line, problem };
    let head = reader.headers().map_err(|error| error_at(1, error.to_string()))?;
    if head != &StringRecord::from(COLUMNS.as_slice()) {
        return Err(error_at(1, format!("the columns must be {}", COLUMNS.join(","))));
    }
    let mut claims = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| error_at(0, error.to_string()))?;
        let line = record.position().map_or(0, csv::Position::line);
        let claim = claim(chapter, &record).map_err(|problem| error_at(line, problem))?;
        if !seen.insert(claim.id.clone()) {
            return Err(error_at(line, format!("claim {} occurs twice", claim.id)));
        }
        claims.push(claim);
    }
    Ok(claims)
}

/// Converts one row to a claim.
fn claim(chapter: &'static str, record: &StringRecord) -> Result<Claim, String> {
    let [id, place, says, value, unit, within, check, given, verdict, why] =
        std::array::from_fn(|column| record.get(column).unwrap_or_default().trim());
    if [id, place, says].contains(&"") {
        return Err("the columns id, where and says must not be empty".to_owned());
    }
    let claim = Claim {
        chapter,
        id: id.to_owned(),
        place: place.to_owned(),
        statement: says.to_owned(),
        value: optional("value", value, PrintedNumber::parse)?,
        unit: unit.to_owned(),
        tolerance: optional("within", within, Tolerance::parse)?,
        tolerance_text: within.to_owned(),
        check: (!check.is_empty()).then(|| check.to_owned()),
        arguments: CheckArguments::parse(given).map_err(|error| error.to_string())?,
        verdict: verdict_of(verdict)?,
        reason: why.to_owned(),
    };
    consistent(&claim).map(|()| claim)
}

/// Parses a cell that may be empty.
fn optional<T>(column: &str, text: &str, parse: fn(&str) -> Option<T>) -> Result<Option<T>, String> {
    if text.is_empty() {
        return Ok(None);
    }
    parse(text).map(Some).ok_or_else(|| format!("{column} is \"{text}\", which cannot be parsed"))
}

/// Parses a verdict by the word that the files use.
fn verdict_of(text: &str) -> Result<ClaimVerdict, String> {
    let found = ClaimVerdict::ALL.iter().find(|(word, _)| *word == text).map(|(_, verdict)| *verdict);
    found.ok_or_else(|| format!("\"{text}\" is not a verdict"))
}

/// Checks the rules between the columns of a row.
fn consistent(claim: &Claim) -> Result<(), String> {
    let is_reproduced = claim.verdict == ClaimVerdict::Reproduced;
    if claim.value.is_some() != claim.tolerance.is_some() {
        return Err("the columns value and within must be both empty or both filled".to_owned());
    }
    if is_reproduced != claim.reason.is_empty() {
        return Err(
            "the column why must be filled, except if the verdict is reproduced; then it must be empty"
                .to_owned(),
        );
    }
    if claim.check.is_none() && claim.verdict != ClaimVerdict::Unknowable {
        return Err("without a check the verdict must be unknowable".to_owned());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(row: &str) -> String {
        let text = format!("{}\n{row}\n", COLUMNS.join(","));
        read("", "f.csv", &text, &mut HashSet::new()).unwrap_err().to_string()
    }

    #[test]
    fn wrong_rows_are_reported_with_their_line() {
        let cases = [
            ("1,,says,,,,,,unknowable,lost", "the columns id, where and says must not be empty"),
            ("1,2,says,3,,,c,,reproduced,", "the columns value and within must be both empty or both filled"),
            ("1,2,says,three,,1,c,,reproduced,", "value is \"three\", which cannot be parsed"),
            ("1,2,says,3,,near,c,,reproduced,", "within is \"near\", which cannot be parsed"),
            ("1,2,says,,,,c,K,reproduced,", "\"K\" is not an argument: write name=value"),
            ("1,2,says,,,,c,,fine,", "\"fine\" is not a verdict"),
            (
                "1,2,says,,,,c,,differs,",
                "the column why must be filled, except if the verdict is reproduced; then it must be empty",
            ),
            (
                "1,2,says,,,,c,,reproduced,why",
                "the column why must be filled, except if the verdict is reproduced; then it must be empty",
            ),
            ("1,2,says,,,,,,differs,why", "without a check the verdict must be unknowable"),
        ];
        for (row, problem) in cases {
            assert_eq!(refused(row), format!("f.csv, line 2: {problem}"));
        }
        let twice = "1,2,says,,,,,,unknowable,lost\n1,2,says,,,,,,unknowable,lost";
        assert_eq!(refused(twice), "f.csv, line 3: claim 1 occurs twice");
    }

    #[test]
    fn other_columns_are_refused() {
        let error = read("", "f.csv", "id,says\n", &mut HashSet::new()).unwrap_err();
        assert!(error.to_string().contains("the columns must be id,where"));
    }
}
