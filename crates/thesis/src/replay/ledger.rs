//! The ledger as it is written: one CSV file a chapter.

use std::collections::HashSet;

use csv::{ReaderBuilder, StringRecord};

use super::claim::{Claim, Verdict};
use super::finding::{Printed, Within};
use super::given::Given;

/// The files: title, name, text.
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

/// What stands in the first line of every file.
const COLUMNS: [&str; 10] =
    ["id", "where", "says", "value", "unit", "within", "check", "given", "verdict", "why"];

/// What is wrong with a row of the ledger.
#[derive(Debug, thiserror::Error)]
#[error("{file}, line {line}: {problem}")]
pub struct LedgerError {
    /// The file.
    pub file: &'static str,
    /// Its line, from 1.
    pub line: u64,
    /// What is wrong.
    pub problem: String,
}

/// All claims, chapter by chapter.
///
/// # Errors
/// The first row that is wrong.
pub fn ledger() -> Result<Vec<Claim>, LedgerError> {
    let (mut seen, mut claims) = (HashSet::new(), Vec::new());
    for (chapter, file, text) in FILES {
        claims.extend(read(chapter, file, text, &mut seen)?);
    }
    Ok(claims)
}

fn read(
    chapter: &'static str,
    file: &'static str,
    text: &str,
    seen: &mut HashSet<String>,
) -> Result<Vec<Claim>, LedgerError> {
    let mut reader = ReaderBuilder::new().from_reader(text.as_bytes());
    let wrong = |line: u64, problem: String| LedgerError { file, line, problem };
    let head = reader.headers().map_err(|error| wrong(1, error.to_string()))?;
    if head != &StringRecord::from(COLUMNS.as_slice()) {
        return Err(wrong(1, format!("the columns are not {}", COLUMNS.join(","))));
    }
    let mut claims = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| wrong(0, error.to_string()))?;
        let line = record.position().map_or(0, csv::Position::line);
        let claim = claim(chapter, &record).map_err(|problem| wrong(line, problem))?;
        if !seen.insert(claim.id.clone()) {
            return Err(wrong(line, format!("there is a claim {} already", claim.id)));
        }
        claims.push(claim);
    }
    Ok(claims)
}

fn claim(chapter: &'static str, record: &StringRecord) -> Result<Claim, String> {
    let [id, place, says, value, unit, within, check, given, verdict, why] =
        std::array::from_fn(|column| record.get(column).unwrap_or_default().trim());
    if [id, place, says].contains(&"") {
        return Err("id, where and says have to be told".to_owned());
    }
    let claim = Claim {
        chapter,
        id: id.to_owned(),
        place: place.to_owned(),
        says: says.to_owned(),
        value: optional("value", value, Printed::parse)?,
        unit: unit.to_owned(),
        within: optional("within", within, Within::parse)?,
        within_told: within.to_owned(),
        check: (!check.is_empty()).then(|| check.to_owned()),
        given: Given::parse(given).map_err(|error| error.to_string())?,
        verdict: verdict_of(verdict)?,
        why: why.to_owned(),
    };
    consistent(&claim).map(|()| claim)
}

fn optional<T>(column: &str, text: &str, parse: fn(&str) -> Option<T>) -> Result<Option<T>, String> {
    if text.is_empty() {
        return Ok(None);
    }
    parse(text).map(Some).ok_or_else(|| format!("{column} is \"{text}\", which cannot be read"))
}

fn verdict_of(text: &str) -> Result<Verdict, String> {
    let found = Verdict::ALL.iter().find(|(word, _)| *word == text).map(|(_, verdict)| *verdict);
    found.ok_or_else(|| format!("verdict is \"{text}\", which is none"))
}

/// What the columns of a row owe each other.
fn consistent(claim: &Claim) -> Result<(), String> {
    let is_reproduced = claim.verdict == Verdict::Reproduced;
    if claim.value.is_some() != claim.within.is_some() {
        return Err("value and within stand together".to_owned());
    }
    if is_reproduced != claim.why.is_empty() {
        return Err("every verdict but reproduced needs a why, and that one has none".to_owned());
    }
    if claim.check.is_none() && claim.verdict != Verdict::Unknowable {
        return Err("what has no check cannot be known".to_owned());
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
    fn wrong_rows_are_told_with_their_line() {
        let cases = [
            ("1,,says,,,,,,unknowable,lost", "id, where and says have to be told"),
            ("1,2,says,3,,,c,,reproduced,", "value and within stand together"),
            ("1,2,says,three,,1,c,,reproduced,", "value is \"three\", which cannot be read"),
            ("1,2,says,3,,near,c,,reproduced,", "within is \"near\", which cannot be read"),
            ("1,2,says,,,,c,K,reproduced,", "\"K\" is no argument: write name=value"),
            ("1,2,says,,,,c,,fine,", "verdict is \"fine\", which is none"),
            ("1,2,says,,,,c,,differs,", "every verdict but reproduced needs a why, and that one has none"),
            (
                "1,2,says,,,,c,,reproduced,why",
                "every verdict but reproduced needs a why, and that one has none",
            ),
            ("1,2,says,,,,,,differs,why", "what has no check cannot be known"),
        ];
        for (row, problem) in cases {
            assert_eq!(refused(row), format!("f.csv, line 2: {problem}"));
        }
        let twice = "1,2,says,,,,,,unknowable,lost\n1,2,says,,,,,,unknowable,lost";
        assert_eq!(refused(twice), "f.csv, line 3: there is a claim 1 already");
    }

    #[test]
    fn other_columns_are_refused() {
        let error = read("", "f.csv", "id,says\n", &mut HashSet::new()).unwrap_err();
        assert!(error.to_string().contains("the columns are not id,where"));
    }
}
