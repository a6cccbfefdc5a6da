//! `patchcord replay`
//!
//! Without a name the command lists the figures. With names it draws them and examines their claims. `all` examines
//! every claim of the ledger and takes minutes.

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::thread;

use clap::Args;
use serde_json::{Value, json};

use super::failure::Failure;
use super::files::{distinct_destinations, prepare_outputs, write_file, written_text};
use super::progress::ProgressBar;
use super::table::Table;
use super::{print, print_json};
use patchcord::document::suggestion;
use patchcord::draw::plot::Format;
use patchcord::thesis::replay::{self, Claim, DrawnFigure, ExaminedClaim, Figure, GalleryFigure, figures};

#[derive(Args)]
pub(super) struct Arguments {
    /// Figures to reproduce, such as fig-8-24, or all (default: list the figures)
    #[arg(value_name = "ID|all")]
    ids: Vec<String>,
    /// Write pictures, their patches and a page with pictures and claims into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Draw the figure into this file; the file name selects SVG or PNG
    #[arg(long, value_name = "FILE.svg|png")]
    plot: Option<PathBuf>,
    /// Print one JSON document on standard output, and nothing else there
    #[arg(long)]
    json: bool,
}

/// The JSON form of a failure is selected here.
pub(super) fn replay(arguments: &Arguments) -> Result<(), Failure> {
    execute(arguments).map_err(|failure| failure.with_json_output(arguments.json))
}

/// Runs come before any file is written, because the names of the patches are known only then. Folders are checked at
/// the start.
fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let figures = arguments.figures()?;
    if figures.is_empty() {
        return arguments.list();
    }
    let plot = arguments.plot(&figures)?;
    let files: Vec<_> = plot.iter().map(|(path, _)| path.clone()).collect();
    prepare_outputs(arguments.out.as_deref(), files.iter())?;
    let claims = arguments.claims(&figures)?;
    let (drawn, examined) = perform(&figures, &claims)?;
    let exhibits: Vec<_> = figures
        .iter()
        .zip(&drawn)
        .map(|(figure, drawn)| GalleryFigure::new(figure, drawn, &examined))
        .collect();
    let mut outputs: Vec<_> = plot
        .into_iter()
        .map(|(path, format)| Output { path, content: Content::Drawn(&drawn[0], format) })
        .collect();
    if let Some(folder) = &arguments.out {
        outputs.extend(in_folder(folder, &exhibits, &examined));
    }
    let files: Vec<_> = outputs.iter().map(|output| output.path.clone()).collect();
    distinct_destinations(files.iter())?;
    prepare_outputs(None, files.iter())?;
    outputs.iter().try_for_each(Output::write)?;
    if arguments.json {
        return print_json(&document(&exhibits, &examined, &files));
    }
    print(&text(&exhibits))?;
    print(&written_text(files.iter()))
}

impl Arguments {
    /// The requested figures, each once, in the order of the study.
    fn figures(&self) -> Result<Vec<&'static Figure>, Failure> {
        let known: Vec<&str> = figures().map(|figure| figure.id).chain(["all"]).collect();
        let is_known = |id: &&String| id.as_str() == "all" || figures().any(|figure| has_name(figure, id));
        if let Some(id) = self.ids.iter().find(|id| !is_known(id)) {
            let hint = suggestion(id, &known).unwrap_or_else(|| "patchcord replay lists them".to_owned());
            return Err(Failure::usage(format!("there is no figure {id}; {hint}")));
        }
        let is_requested = |figure: &&Figure| self.ids.iter().any(|id| id == "all" || has_name(figure, id));
        Ok(figures().filter(is_requested).collect())
    }

    /// The file of `--plot` with its format.
    fn plot(&self, figures: &[&Figure]) -> Result<Option<(PathBuf, Format)>, Failure> {
        let Some(path) = &self.plot else { return Ok(None) };
        if figures.len() > 1 {
            let message = "--plot draws only one figure: give --out DIR for several";
            return Err(Failure::usage(message));
        }
        let format = Format::from_path(path).map_err(|error| Failure::usage(error.to_string()))?;
        Ok(Some((path.clone(), format)))
    }

    /// All claims for `all`, otherwise those that concern the requested figures.
    fn claims(&self, figures: &[&Figure]) -> Result<Vec<Claim>, Failure> {
        let mut claims = replay::ledger().map_err(|error| Failure::data(error.to_string()))?;
        if !self.ids.iter().any(|id| id == "all") {
            claims.retain(|claim| figures.iter().any(|figure| figure.is_related_to(claim)));
        }
        Ok(claims)
    }

    /// Lists the figures.
    fn list(&self) -> Result<(), Failure> {
        if self.out.is_some() || self.plot.is_some() {
            let message = "no figure is specified: give a name, such as fig-8-24, or all";
            return Err(Failure::usage(message));
        }
        if self.json {
            let item =
                |figure: &Figure| json!({"id": figure.id, "where": figure.place, "title": figure.title});
            return print_json(&json!({"ok": true, "figures": figures().map(item).collect::<Value>()}));
        }
        let mut table = Table::new(["figure", "where", "what it shows"]);
        figures().for_each(|figure| table.row([figure.id, figure.place, figure.title].map(str::to_owned)));
        print(&table.text())
    }
}

/// Whether `id` is a name of the figure: fig-8-24, 8.24 or "Fig 8.24".
fn has_name(figure: &Figure, id: &str) -> bool {
    let number = figure.number();
    id == figure.id || id == number || number.strip_prefix("Fig ") == Some(id)
}

/// Draws the figures and examines the claims, with a progress bar.
fn perform(
    figures: &[&'static Figure],
    claims: &[Claim],
) -> Result<(Vec<DrawnFigure>, Vec<ExaminedClaim>), Failure> {
    let mut progress = ProgressBar::new("figures and claims");
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let outcome = replay::run_all(figures, claims, threads, |done, all| progress.done(done, all));
    outcome.map_err(|error| Failure::data(error.to_string()))
}

/// A file to be written.
struct Output<'a> {
    /// The path, in the folder of `--out` or as given to `--plot`.
    path: PathBuf,
    /// What is written.
    content: Content<'a>,
}

/// The content of an output file.
enum Content<'a> {
    /// A picture of the figure in a format.
    Drawn(&'a DrawnFigure, Format),
    /// A patch or the page.
    Text(Cow<'a, str>),
}

impl Output<'_> {
    /// Writes the file.
    fn write(&self) -> Result<(), Failure> {
        match &self.content {
            Content::Text(text) => write_file(&self.path, text.as_bytes()),
            Content::Drawn(drawn, format) => {
                let bytes = drawn.render(*format).map_err(|error| Failure::data(error.to_string()))?;
                write_file(&self.path, &bytes)
            }
        }
    }
}

/// The files in the output folder: pictures, patches and the page.
///
/// A figure gives one SVG picture and its patches. The page refers to them by name.
fn in_folder<'a>(
    folder: &Path,
    exhibits: &'a [GalleryFigure<'a>],
    examined: &[ExaminedClaim],
) -> Vec<Output<'a>> {
    let output = |name: &str, content| Output { path: folder.join(name), content };
    let of_exhibit = |exhibit: &'a GalleryFigure<'a>| {
        let picture = output(&exhibit.picture(), Content::Drawn(exhibit.drawn, Format::Svg));
        let patches = exhibit.drawn.patches.iter();
        let patches = patches.map(|patch| output(patch.file(), Content::Text(patch.text().into())));
        [picture].into_iter().chain(patches).collect::<Vec<_>>()
    };
    let page = output(&page_name(exhibits), Content::Text(replay::gallery(exhibits, examined).into()));
    exhibits.iter().flat_map(of_exhibit).chain([page]).collect()
}

/// The name of the page. Only the page with all figures is index.html, so a page with some does not overwrite it.
fn page_name(exhibits: &[GalleryFigure<'_>]) -> String {
    match exhibits {
        _ if exhibits.len() == figures().count() => "index.html".to_owned(),
        [one] => format!("{}.html", one.figure.id),
        _ => "figures.html".to_owned(),
    }
}

/// The figures with their claims as text.
///
/// Heading, settings and reading of each figure, then one line per claim: identifier, statement, printed number,
/// verdict and result.
fn text(exhibits: &[GalleryFigure<'_>]) -> String {
    let figure_text = |exhibit: &GalleryFigure<'_>| {
        let DrawnFigure { settings, reading, .. } = exhibit.drawn;
        let mut text = format!("{}\n  {settings}\n  {reading}\n", exhibit.figure.heading());
        for row in &exhibit.claims {
            let (claim, printed) = (&row.claim, row.printed_text());
            let printed = if printed.is_empty() { printed } else { format!(": {printed}") };
            text += &format!("  {} {}{printed}; {}", claim.id, claim.statement, row.outcome.verdict);
            text += &if row.result_text().is_empty() {
                "\n".to_owned()
            } else {
                format!(", {}\n", row.result_text())
            };
            if !claim.reason.is_empty() {
                text += &format!("      {}\n", claim.reason);
            }
        }
        text + "\n"
    };
    exhibits.iter().map(figure_text).collect()
}

/// The result as JSON.
///
/// Keys: `ok`, `figures`, `claims` with the keys of [`ExaminedClaim::to_json`], `files`. A figure has `id`, `number`,
/// `where`, `title`, `settings`, `reading`, `picture`, `commands`, `table` or null, and the names of its `patches` and
/// `claims`.
fn document(exhibits: &[GalleryFigure<'_>], examined: &[ExaminedClaim], files: &[PathBuf]) -> Value {
    let figure = |exhibit: &GalleryFigure<'_>| {
        let (figure, drawn) = (exhibit.figure, exhibit.drawn);
        json!({
            "id": figure.id,
            "number": figure.number(),
            "where": figure.place,
            "title": figure.title,
            "settings": drawn.settings,
            "reading": drawn.reading,
            "picture": exhibit.picture(),
            "commands": drawn.commands,
            "table": drawn.table.as_ref().map(|table| json!({"reason": table.reason, "head": table.head, "rows": table.rows})),
            "patches": drawn.patches.iter().map(|patch| patch.file()).collect::<Value>(),
            "claims": exhibit.claims.iter().map(|row| row.claim.id.as_str()).collect::<Value>(),
        })
    };
    json!({
        "ok": true,
        "figures": exhibits.iter().map(figure).collect::<Value>(),
        "claims": examined.iter().map(ExaminedClaim::to_json).collect::<Value>(),
        "files": files.iter().map(|path| path.display().to_string()).collect::<Value>(),
    })
}
