//! The ledger as a page: docs/claims.md.

use super::claim::Verdict;
use super::examined::Examined;

/// The page of all claims, as the ledger has them in their order.
pub fn page(claims: &[Examined]) -> String {
    let chapters = claims.chunk_by(|one, next| one.claim.chapter == next.claim.chapter);
    let sections: String = chapters.map(section).collect();
    format!(
        "# What the study says, and what we get\n\n\
         Every number and statement of the study that can be checked stands here with its place (\"eq 31-7\" is equation \
         31 of chapter 7), what the check of it gives, and a verdict. *Within* is how near the printed number is by what the \
         text itself says: percent, units of the last printed digit (\"digits\"), a difference, or exact.\n\n\
         {}\n{}\n{sections}\n\
         This page is written from `crates/thesis/src/replay/claims` by `PATCHCORD_BLESS=1 cargo test -p patchcord-thesis claims`.\n",
        tally(claims),
        cells_of_tables(claims)
    )
}

/// The tables of which every printed cell is a claim.
const TABLES: [&str; 3] = ["Table T9-4", "Table T9-5", "Table T9-6"];

/// How many printed cells of each table come out as near as the text itself says, and which do not.
pub(super) fn cells_of_tables(claims: &[Examined]) -> String {
    let table = |table: &&str| {
        let cells: Vec<_> =
            claims.iter().filter(|row| row.claim.place == *table && row.claim.value.is_some()).collect();
        let beyond = cells.iter().filter(|row| row.outcome.verdict != Verdict::Reproduced);
        let beyond: Vec<_> = beyond.map(|row| format!("{} ({})", row.claim.id, row.difference())).collect();
        let rest = if beyond.is_empty() { String::new() } else { format!(", but for {}", beyond.join(", ")) };
        let (within, all) = (cells.len() - beyond.len(), cells.len());
        format!("{table}: {within} of {all} printed cells within two units of their last digit{rest}.")
    };
    TABLES.iter().map(table).collect::<Vec<_>>().join(" ")
}

/// How many of each verdict there are.
fn tally(all: &[Examined]) -> String {
    let count = |verdict| all.iter().filter(|row| row.outcome.verdict == verdict).count();
    let rows: String =
        Verdict::ALL.iter().map(|(_, verdict)| format!("| {verdict} | {} |\n", count(*verdict))).collect();
    format!("| verdict | claims |\n|---|---|\n{rows}| all | {} |\n", all.len())
}

fn section(rows: &[Examined]) -> String {
    let title = rows[0].claim.chapter;
    let lines: String = rows.iter().map(line).collect();
    format!(
        "\n## {title}\n\n| id | where | says | printed | within | we get | difference | verdict | why |\n{}\n{lines}",
        "|---".repeat(9) + "|"
    )
}

fn line(row: &Examined) -> String {
    let (claim, got) = (&row.claim, row.got());
    let cells = [
        &claim.id,
        &claim.place,
        &claim.says,
        &row.printed(),
        &claim.within_told,
        got.as_ref(),
        &row.difference(),
        &row.outcome.verdict.to_string(),
        &claim.why,
    ];
    format!("| {} |\n", cells.map(|cell| cell.replace('|', "\\|")).join(" | "))
}
