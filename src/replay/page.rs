//! The ledger as a page: docs/claims.md.

use super::checks::CheckError;
use super::claim::{Claim, Outcome, Verdict};
use super::finding::Finding;
use super::ledger::Chapter;

/// A claim with what became of it.
type Examined<'c> = (&'c Claim, Outcome);

/// The page of all claims, as it follows from running every check.
///
/// # Errors
/// The first claim that cannot be examined, with its id.
pub fn page(chapters: &[Chapter]) -> Result<String, (String, CheckError)> {
    let mut sections = Vec::new();
    for chapter in chapters {
        let examine = |claim| examined(claim).map_err(|error| (claim.id.clone(), error));
        let rows = chapter.claims.iter().map(examine).collect::<Result<Vec<_>, _>>()?;
        sections.push((chapter.title, rows));
    }
    let all: Vec<_> = sections.iter().flat_map(|(_, rows)| rows).collect();
    let chapters: String = sections.iter().map(|(title, rows)| section(title, rows)).collect();
    Ok(format!(
        "# What the study says, and what we get\n\n\
         Every number and statement of the study that can be checked stands here with its place (\"eq 31-7\" is equation \
         31 of chapter 7), what the check of it gives, and a verdict. *Within* is how near the printed number is by what the \
         text itself says: percent, units of the last printed digit (\"digits\"), a difference, or exact.\n\n\
         {}{chapters}\n\
         This page is written from `src/replay/claims` by `PATCHCORD_BLESS=1 cargo test --test docs`.\n",
        tally(&all)
    ))
}

fn examined(claim: &Claim) -> Result<Examined<'_>, CheckError> {
    Ok((claim, claim.examine()?))
}

/// How many of each verdict there are.
fn tally(all: &[&Examined<'_>]) -> String {
    let count = |verdict| all.iter().filter(|(_, outcome)| outcome.verdict == verdict).count();
    let rows: String =
        Verdict::ALL.iter().map(|(_, verdict)| format!("| {verdict} | {} |\n", count(*verdict))).collect();
    format!("| verdict | claims |\n|---|---|\n{rows}| all | {} |\n", all.len())
}

fn section(title: &str, rows: &[Examined<'_>]) -> String {
    let lines: String = rows.iter().map(|(claim, outcome)| line(claim, outcome)).collect();
    format!(
        "\n## {title}\n\n| id | where | says | printed | within | we get | difference | verdict | why |\n{}\n{lines}",
        "|---".repeat(9) + "|"
    )
}

fn line(claim: &Claim, outcome: &Outcome) -> String {
    let printed =
        claim.value.as_ref().map_or(String::new(), |value| format!("{} {}", value.text, claim.unit));
    let cells = [
        &claim.id,
        &claim.place,
        &claim.says,
        printed.trim_end(),
        &claim.within_told,
        &got(claim, outcome),
        &difference(claim, outcome),
        &outcome.verdict.to_string(),
        &claim.why,
    ];
    format!("| {} |\n", cells.map(|cell| cell.replace('|', "\\|")).join(" | "))
}

/// What was found, in words.
fn got(claim: &Claim, outcome: &Outcome) -> String {
    match &outcome.finding {
        None => String::new(),
        Some(Finding::Number(number)) => format!("{} {}", told(*number), claim.unit).trim_end().to_owned(),
        Some(Finding::Truth { found, .. } | Finding::Shape { found, .. }) => found.clone(),
    }
}

/// How far the number found is from the printed one, in percent of that.
fn difference(claim: &Claim, outcome: &Outcome) -> String {
    match (&claim.value, &outcome.finding) {
        (Some(printed), Some(Finding::Number(got))) if printed.number != 0.0 => {
            let percent = 100.0 * (got / printed.number - 1.0);
            // Rounding must not leave a sign before 0.
            let percent = if percent.abs() < 0.005 { 0.0 } else { percent };
            format!("{percent:+.2} %")
        }
        _ => String::new(),
    }
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
