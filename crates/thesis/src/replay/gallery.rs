//! Formats the gallery: one HTML page that shows figures with their claims. Pictures and patches are separate files
//! in the same folder.
//!
//! The page begins with a summary and a table of contents. It continues with one section per figure: picture,
//! settings, commands, numbers and claims. It ends with the claims that belong to no figure.

use super::claim::ClaimVerdict;
use super::claims_page::table_cells_summary;
use super::differences_page::READING_NOTE;
use super::examined_claim::ExaminedClaim;
use super::figures::{DrawnFigure, Figure};
use super::number_table::NumberTable;
use maud::{Markup, html};
use patchcord_core::patch::Patch;

/// A figure with everything that its section of the page shows.
#[derive(Debug)]
pub struct GalleryFigure<'a> {
    /// The figure.
    pub figure: &'static Figure,
    /// The drawn figure.
    pub drawn: &'a DrawnFigure,
    /// The claims that the figure illustrates, in the order of the ledger.
    pub claims: Vec<&'a ExaminedClaim>,
}

impl<'a> GalleryFigure<'a> {
    /// Collects the claims that belong to a figure: those that it names, and those whose place names it. `claims` are
    /// all claims.
    pub fn new(
        figure: &'static Figure,
        drawn: &'a DrawnFigure,
        claims: impl IntoIterator<Item = &'a ExaminedClaim>,
    ) -> Self {
        let claims = claims.into_iter().filter(|row| figure.is_related_to(&row.claim)).collect();
        GalleryFigure { figure, drawn, claims }
    }
}

/// Returns the page of these figures. Claims that belong to none of them are at its end.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::replay::{GalleryFigure, figures, gallery};
///
/// let figure = figures().find(|figure| figure.id == "fig-2-02").ok_or("a figure of the thesis")?;
/// let drawn = figure.draw()?;
/// let entry = GalleryFigure::new(figure, &drawn, &[]);
/// assert_eq!(entry.figure.picture(), "fig-2-02.svg");
/// assert!(gallery(&[entry], &[]).contains("Fig 2.2: size of stick-slip by sliding velocity"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn gallery(entries: &[GalleryFigure<'_>], claims: &[ExaminedClaim]) -> String {
    let shown = |row: &&ExaminedClaim| entries.iter().any(|entry| entry.figure.is_related_to(&row.claim));
    let remaining: Vec<_> = claims.iter().filter(|row| !shown(row)).collect();
    let body = html! {
        (header(entries.len(), claims))
        (contents(entries))
        main {
            @for entries in chapters(entries) { (chapter(entries)) }
            (remaining_claims(&remaining))
        }
        "\n"
    };
    patchcord_draw::html::page("The thesis, replayed", body)
}

/// Formats the introduction and the summary of all verdicts.
fn header(figure_count: usize, claims: &[ExaminedClaim]) -> Markup {
    html! {
        header {
            h1 { "The thesis, replayed" }
            p {
                "This page shows " (figure_count) " figures of the thesis, drawn again from runs of patches and from \
                theory. Next to each figure are the claims of the text and our results. The patches that are named \
                under a picture are in the folder of this page. The command under the picture repeats the run."
            }
            "\n"
            (tally(claims))
        }
        "\n"
    }
}

/// Groups figures by their chapter. No group is empty.
fn chapters<'e, 'a>(entries: &'e [GalleryFigure<'a>]) -> impl Iterator<Item = &'e [GalleryFigure<'a>]> {
    entries.chunk_by(|one, next| one.figure.chapter() == next.figure.chapter())
}

/// Formats the table of contents, with a line per chapter and a link per figure.
fn contents(entries: &[GalleryFigure<'_>]) -> Markup {
    html! {
        nav {
            @for entries in chapters(entries) {
                p {
                    b { (entries[0].figure.chapter()) }
                    @for entry in entries { " " (link(entry.figure)) }
                }
                "\n"
            }
        }
        "\n"
    }
}

/// Formats the link to the section of a figure.
fn link(figure: &Figure) -> Markup {
    let number = figure.number();
    html! {
        a href={ "#" (figure.id) } title=(figure.title) { (number.trim_start_matches("Fig ")) }
    }
}

/// Formats the sections of one chapter. `entries` is not empty.
fn chapter(entries: &[GalleryFigure<'_>]) -> Markup {
    html! {
        h2 { (entries[0].figure.chapter()) }
        "\n"
        @for entry in entries { (section(entry)) }
    }
}

/// Formats the section of one figure.
fn section(entry: &GalleryFigure<'_>) -> Markup {
    let figure = entry.figure;
    html! {
        section #(figure.id) {
            h3 { (figure.heading()) " " small { (figure.place) } }
            p.reading { (entry.drawn.reading) }
            "\n"
            div.pair { (picture(entry)) (table(&entry.claims)) }
        }
        "\n"
    }
}

/// Formats the picture of a figure with its settings, its commands and its numbers.
fn picture(entry: &GalleryFigure<'_>) -> Markup {
    let (file, drawn) = (entry.figure.picture(), entry.drawn);
    html! {
        figure {
            a href=(file) { img src=(file) alt=(entry.figure.heading()) loading="lazy"; }
            figcaption { (drawn.settings) br; code { (commands(drawn)) } }
            @if let Some(table) = &drawn.table { (numbers(table)) }
        }
        "\n"
    }
}

/// Formats the commands of a figure, one per line.
fn commands(drawn: &DrawnFigure) -> Markup {
    html! {
        @if drawn.commands.is_empty() { "from theory" }
        @for (index, command) in drawn.commands.iter().enumerate() {
            @if index > 0 { br; }
            (linked_command(command, &drawn.patches))
        }
    }
}

/// Formats the explanation of a figure, and its table of numbers, which is folded.
fn numbers(table: &NumberTable) -> Markup {
    html! {
        p { (table.reason) }
        "\n"
        details {
            summary { (table.rows.len()) " rows of numbers" }
            p { (READING_NOTE) }
            "\n"
            table {
                tr { @for cell in &table.head { th { (cell) } } }
                "\n"
                @for row in &table.rows { tr { @for cell in row { td { (cell) } } } "\n" }
            }
        }
        "\n"
    }
}

/// Formats a command. Names of patches become links to their files.
fn linked_command(command: &str, patches: &[Patch]) -> Markup {
    html! {
        @for (index, word) in command.split(' ').enumerate() {
            @if index > 0 { " " }
            @if patches.iter().any(|patch| patch.file() == word) {
                a href=(word) { (word) }
            } @else {
                (word)
            }
        }
    }
}

/// A table with more claims than this is folded.
const MAX_UNFOLDED_CLAIMS: usize = 12;

/// Formats the claims of a figure as a table.
fn table(claims: &[&ExaminedClaim]) -> Markup {
    html! {
        div.claims {
            @match claims.len() {
                0 => p { "The text makes no claim about this figure that can be checked." },
                1..=MAX_UNFOLDED_CLAIMS => (claim_table(claims)),
                count => details {
                    summary { (count) " claims: " (verdicts(claims.iter().copied())) }
                    (claim_table(claims))
                },
            }
        }
        "\n"
    }
}

/// Formats claims as a table, with one row per claim.
fn claim_table(claims: &[&ExaminedClaim]) -> Markup {
    html! {
        table {
            tr { th { "id" } th { "the text says" } th { "printed" } th { "we get" } th { "verdict" } }
            "\n"
            @for row in claims { (claim_row(row)) }
        }
    }
}

/// Formats one claim as a row of a table.
fn claim_row(row: &ExaminedClaim) -> Markup {
    let (claim, difference, verdict) = (&row.claim, row.difference(), row.outcome.verdict);
    html! {
        tr {
            td title=(claim.place) { (claim.id) }
            td {
                (claim.statement)
                @if !claim.reason.is_empty() { br; i { (claim.reason) } }
            }
            td { (row.printed_text()) }
            td {
                (row.result_text())
                @if !difference.is_empty() { " " small { (difference) } }
            }
            td.(verdict.ledger_word()) { (verdict) }
        }
        "\n"
    }
}

/// Formats the claims that belong to no figure, chapter by chapter.
fn remaining_claims(claims: &[&ExaminedClaim]) -> Markup {
    html! {
        @if !claims.is_empty() { h2 { "Claims without a figure" } "\n" }
        @for rows in claims.chunk_by(|one, next| one.claim.chapter == next.claim.chapter) {
            details {
                summary { (rows[0].claim.chapter) ", " (rows.len()) " claims: " (verdicts(rows.iter().copied())) }
                (claim_table(rows))
            }
            "\n"
        }
    }
}

/// Lists the number of claims with each verdict: "3 reproduced, 1 differs". Verdicts without claims are omitted.
fn verdicts<'a>(claims: impl Iterator<Item = &'a ExaminedClaim> + Clone) -> String {
    let counts = ClaimVerdict::ALL.iter().filter_map(|(_, verdict)| {
        let count = claims.clone().filter(|row| row.outcome.verdict == *verdict).count();
        (count > 0).then(|| format!("{count} {verdict}"))
    });
    counts.collect::<Vec<_>>().join(", ")
}

/// Formats the summary of all verdicts.
fn tally(claims: &[ExaminedClaim]) -> Markup {
    let count = |verdict: ClaimVerdict| claims.iter().filter(|row| row.outcome.verdict == verdict).count();
    html! {
        p.tally {
            (claims.len()) " claims: "
            @for (word, verdict) in ClaimVerdict::ALL { span.(word) { (count(verdict)) " " (verdict) } " " }
        }
        "\n"
        p { (table_cells_summary(claims)) }
        "\n"
    }
}
