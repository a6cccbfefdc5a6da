//! The page that shows figures beside their claims: one HTML file, with the pictures beside it.

use super::claim::Verdict;
use super::differences::READ_WITH;
use super::examined::Examined;
use super::figures::{Drawn, Figure};
use super::page::cells_of_tables;
use super::table::Table;
use patchcord_core::patch::Patch;
use patchcord_draw::html::{self, escaped};

/// A figure as it is shown.
#[derive(Debug)]
pub struct Exhibit<'a> {
    /// The figure.
    pub figure: &'static Figure,
    /// What was drawn of it.
    pub drawn: &'a Drawn,
    /// The claims that it bears on.
    pub claims: Vec<&'a Examined>,
}

impl<'a> Exhibit<'a> {
    /// A figure with the claims, of all of them, that it names or whose place names it.
    pub fn new(figure: &'static Figure, drawn: &'a Drawn, claims: &'a [Examined]) -> Self {
        let bears_on = |row: &&Examined| figure.bears_on(&row.claim);
        Exhibit { figure, drawn, claims: claims.iter().filter(bears_on).collect() }
    }

    /// The name of its picture's file.
    pub fn picture(&self) -> String {
        format!("{}.svg", self.figure.id)
    }
}

/// The page of these figures; the claims that none of them bears on stand at its end.
pub fn gallery(exhibits: &[Exhibit<'_>], claims: &[Examined]) -> String {
    let sections: String = exhibits
        .chunk_by(|one, next| one.figure.chapter() == next.figure.chapter())
        .map(|exhibits| chapter(exhibits))
        .collect();
    let shown = |row: &&Examined| exhibits.iter().any(|exhibit| exhibit.figure.bears_on(&row.claim));
    let rest: Vec<_> = claims.iter().filter(|row| !shown(row)).collect();
    let (contents, tally) = (contents(exhibits), tally(claims));
    let body = format!(
        "<header>\n<h1>The study, replayed</h1>\n\
         <p>Figures of the study, drawn again from patches that were run and from its theory, each beside what the text \
         claims of it and what we get: {} of them. A patch named under a picture lies beside this page, with the command that \
         makes the same run.</p>\n{tally}</header>\n{contents}<main>\n{sections}{}</main>\n",
        exhibits.len(),
        others(&rest),
    );
    html::page("The study, replayed", &body)
}

fn contents(exhibits: &[Exhibit<'_>]) -> String {
    let chapters = exhibits.chunk_by(|one, next| one.figure.chapter() == next.figure.chapter());
    let line = |exhibits: &[Exhibit<'_>]| {
        let link = |exhibit: &Exhibit<'_>| {
            let (id, number) = (exhibit.figure.id, exhibit.figure.number());
            let title = escaped(exhibit.figure.title);
            format!("<a href=\"#{id}\" title=\"{title}\">{}</a>", number.trim_start_matches("Fig "))
        };
        let links: Vec<_> = exhibits.iter().map(link).collect();
        format!("<p><b>{}</b> {}</p>\n", exhibits[0].figure.chapter(), links.join(" "))
    };
    format!("<nav>\n{}</nav>\n", chapters.map(line).collect::<String>())
}

fn chapter(exhibits: &[Exhibit<'_>]) -> String {
    let sections: String = exhibits.iter().map(section).collect();
    format!("<h2>{}</h2>\n{sections}", exhibits[0].figure.chapter())
}

fn section(exhibit: &Exhibit<'_>) -> String {
    let (figure, drawn) = (exhibit.figure, exhibit.drawn);
    let (id, heading) = (figure.id, escaped(&figure.heading()));
    let commands: Vec<_> = drawn.commands.iter().map(|command| linked(command, &drawn.patches)).collect();
    let commands = if commands.is_empty() { "from theory".to_owned() } else { commands.join("<br>") };
    let numbers = drawn.table.as_ref().map(numbers).unwrap_or_default();
    format!(
        "<section id=\"{id}\">\n<h3>{heading} <small>{}</small></h3>\n<p class=\"reading\">{}</p>\n\
         <div class=\"pair\">\n<figure><a href=\"{id}.svg\"><img src=\"{id}.svg\" alt=\"{heading}\" loading=\"lazy\"></a>\n\
         <figcaption>{}<br><code>{commands}</code></figcaption>{numbers}</figure>\n{}</div>\n</section>\n",
        escaped(figure.place),
        escaped(&drawn.reading),
        escaped(&drawn.settings),
        table(&exhibit.claims),
    )
}

/// Why a figure is as it is, and the numbers behind it, folded up.
fn numbers(table: &Table) -> String {
    let line = |cells: &[String], tag: &str| {
        let cells: String = cells.iter().map(|cell| format!("<{tag}>{}", escaped(cell))).collect();
        format!("<tr>{cells}</tr>\n")
    };
    let rows: String = table.rows.iter().map(|row| line(row, "td")).collect();
    format!(
        "<p>{}</p>\n<details><summary>{} rows of numbers</summary><p>{}</p>\n<table>\n{}{rows}</table></details>\n",
        escaped(table.reason),
        table.rows.len(),
        escaped(READ_WITH),
        line(&table.head, "th")
    )
}

/// A command, with links to the patches that lie beside the page.
fn linked(command: &str, patches: &[Patch]) -> String {
    let word = |word: &str| match patches.iter().any(|patch| patch.file() == word) {
        true => format!("<a href=\"{0}\">{0}</a>", escaped(word)),
        false => escaped(word),
    };
    command.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

/// More claims than these are folded up.
const MOST_SHOWN: usize = 12;

fn table(claims: &[&Examined]) -> String {
    if claims.is_empty() {
        return "<div class=\"claims\"><p>The text claims nothing of it that can be checked.</p></div>\n"
            .to_owned();
    }
    let rows: String = claims.iter().map(|row| line(row)).collect();
    let table =
        format!("<table>\n<tr><th>id<th>the text says<th>printed<th>we get<th>verdict</tr>\n{rows}</table>");
    match claims.len() {
        0..=MOST_SHOWN => format!("<div class=\"claims\">{table}</div>\n"),
        count => format!(
            "<div class=\"claims\"><details><summary>{count} claims: {}</summary>{table}</details></div>\n",
            verdicts(claims.iter().copied())
        ),
    }
}

fn line(row: &Examined) -> String {
    let claim = &row.claim;
    let difference = row.difference();
    let got = escaped(&row.got());
    let got = if difference.is_empty() { got } else { format!("{got} <small>{difference}</small>") };
    let why =
        if claim.why.is_empty() { String::new() } else { format!("<br><i>{}</i>", escaped(&claim.why)) };
    format!(
        "<tr><td title=\"{}\">{}<td>{}{why}<td>{}<td>{got}<td class=\"{}\">{}</tr>\n",
        escaped(&claim.place),
        escaped(&claim.id),
        escaped(&claim.says),
        escaped(&row.printed()),
        row.outcome.verdict.word(),
        row.outcome.verdict,
    )
}

/// The claims that no figure bears on, chapter by chapter.
fn others(claims: &[&Examined]) -> String {
    if claims.is_empty() {
        return String::new();
    }
    let chapters = claims.chunk_by(|one, next| one.claim.chapter == next.claim.chapter);
    let folded = chapters.map(|rows| {
        let rest = format!("{} claims: {}", rows.len(), verdicts(rows.iter().copied()));
        let lines: String = rows.iter().map(|row| line(row)).collect();
        format!(
            "<details><summary>{}, {rest}</summary><table>\n\
             <tr><th>id<th>the text says<th>printed<th>we get<th>verdict</tr>\n{lines}</table></details>\n",
            escaped(rows[0].claim.chapter)
        )
    });
    format!("<h2>Claims that no figure shows</h2>\n{}", folded.collect::<String>())
}

/// How many of each verdict there are.
fn verdicts<'a>(claims: impl Iterator<Item = &'a Examined> + Clone) -> String {
    let told = Verdict::ALL.iter().filter_map(|(_, verdict)| {
        let count = claims.clone().filter(|row| row.outcome.verdict == *verdict).count();
        (count > 0).then(|| format!("{count} {verdict}"))
    });
    told.collect::<Vec<_>>().join(", ")
}

fn tally(claims: &[Examined]) -> String {
    let boxes = Verdict::ALL.iter().map(|(word, verdict)| {
        let count = claims.iter().filter(|row| row.outcome.verdict == *verdict).count();
        format!("<span class=\"{word}\">{count} {verdict}</span> ")
    });
    format!(
        "<p class=\"tally\">{} claims: {}</p>\n<p>{}</p>\n",
        claims.len(),
        boxes.collect::<String>(),
        escaped(&cells_of_tables(claims))
    )
}
