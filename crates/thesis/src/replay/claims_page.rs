//! Formats the examined claims as the page docs/claims.md.
//!
//! The page begins with a summary of the verdicts and of three printed tables. It continues with one section per
//! chapter. Each section has one row per claim, in the order of the ledger.

use super::claim::ClaimVerdict;
use super::examined_claim::ExaminedClaim;

/// Returns the page of all claims in Markdown. `claims` has the order of the ledger: the claims of a chapter are
/// adjacent.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::replay::{ExaminedClaim, claims_page, ledger};
///
/// let claims = ledger()?;
/// let yielding = claims.iter().find(|claim| claim.id == "7-028").ok_or("a claim of the ledger")?;
/// let page = claims_page(&[ExaminedClaim::new(yielding)?]);
/// assert!(page.contains("## Chapter 7: surfaces and friction"));
/// assert!(page.contains("| 132 kgf/mm2 | +0.00 % | reproduced |"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn claims_page(claims: &[ExaminedClaim]) -> String {
    let chapters = claims.chunk_by(|one, next| one.claim.chapter == next.claim.chapter);
    let sections: String = chapters.map(section).collect();
    format!(
        "# Claims of the thesis and our results\n\n\
         This page lists every number and statement of the thesis that can be checked. A row specifies its place \
         (\"eq 31-7\" is equation 31 of chapter 7), the result of its check, and a verdict. *Within* is the \
         tolerance that the text itself states for a printed number: percent, units of the last printed digit \
         (\"digits\"), a difference, or exact.\n\n\
         {}\n{}\n{sections}\n\
         This page is generated from `crates/thesis/src/replay/claims` by \
         `PATCHCORD_BLESS=1 cargo test --tests -- --ignored claims`.\n",
        tally(claims),
        table_cells_summary(claims)
    )
}

/// The tables of the thesis of which every printed cell is a claim.
const TABLES: [&str; 3] = ["Table T9-4", "Table T9-5", "Table T9-6"];

/// Returns one sentence per table: how many printed cells agree with our results within their tolerance, and which do
/// not.
pub(super) fn table_cells_summary(claims: &[ExaminedClaim]) -> String {
    let table = |table: &&str| {
        let cells: Vec<_> =
            claims.iter().filter(|row| row.claim.place == *table && row.claim.value.is_some()).collect();
        let outside = cells.iter().filter(|row| row.outcome.verdict != ClaimVerdict::Reproduced);
        let outside: Vec<_> = outside.map(|row| format!("{} ({})", row.claim.id, row.difference())).collect();
        let exceptions =
            if outside.is_empty() { String::new() } else { format!(", except {}", outside.join(", ")) };
        let (within, all) = (cells.len() - outside.len(), cells.len());
        format!("{table}: {within} of {all} printed cells within two units of their last digit{exceptions}.")
    };
    TABLES.iter().map(table).collect::<Vec<_>>().join(" ")
}

/// Formats the number of claims with each verdict as a table.
fn tally(all: &[ExaminedClaim]) -> String {
    let count = |verdict| all.iter().filter(|row| row.outcome.verdict == verdict).count();
    let rows: String = ClaimVerdict::ALL
        .iter()
        .map(|(_, verdict)| format!("| {verdict} | {} |\n", count(*verdict)))
        .collect();
    format!("| verdict | claims |\n|---|---|\n{rows}| all | {} |\n", all.len())
}

/// Formats the section of one chapter. `rows` is not empty.
fn section(rows: &[ExaminedClaim]) -> String {
    let title = rows[0].claim.chapter;
    let lines: String = rows.iter().map(line).collect();
    format!(
        "\n## {title}\n\n| id | where | says | printed | within | we get | difference | verdict | why |\n{}\n{lines}",
        "|---".repeat(9) + "|"
    )
}

/// Formats one claim as a row of the table. Vertical bars are escaped.
fn line(row: &ExaminedClaim) -> String {
    let (claim, got) = (&row.claim, row.result_text());
    let cells = [
        &claim.id,
        &claim.place,
        &claim.statement,
        &row.printed_text(),
        &claim.tolerance_text,
        got.as_ref(),
        &row.difference(),
        &row.outcome.verdict.to_string(),
        &claim.reason,
    ];
    format!("| {} |\n", cells.map(|cell| cell.replace('|', "\\|")).join(" | "))
}
