//! `patchcord replay`
//!
//! Without a name the command lists the figures. With names it draws them and examines their claims. `all` examines
//! every claim of the ledger and takes minutes.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::thread;

use clap::Args;
use serde::Serialize;

use super::failure::Failure;
use super::files::{FOLDER_OPTION, path_texts, picture_format, written_text};
use super::outputs::Outputs;
use super::progress::ProgressBar;
use super::table::Table;
use super::{print, print_json};
use patchcord::draw::plot::Format;
use patchcord::expr::nearest;
use patchcord::patch::Patch;
use patchcord::thesis::replay::{
    self, Claim, DrawnFigure, ExaminedClaim, Figure, GalleryFigure, NumberTable, figures,
};

#[derive(Args)]
pub(super) struct Arguments {
    /// Figures to reproduce, such as fig-8-24, or all (default: list the figures)
    #[arg(value_name = "ID|all")]
    ids: Vec<String>,
    /// Write the pictures, their patches, and a page with the pictures and the claims into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Draw the figure into this file; the ending of its name selects SVG or PNG
    #[arg(long, value_name = "FILE.svg|png")]
    plot: Option<PathBuf>,
    /// Print one JSON document on standard output, and nothing else there
    #[arg(long)]
    json: bool,
}

/// The files of a figure are written and its text is printed as soon as it is finished. The names of its patches are
/// known only then. All other files are checked at the start.
pub(super) fn replay(arguments: &Arguments) -> Result<(), Failure> {
    let figures = arguments.figures()?;
    if figures.is_empty() {
        return arguments.list();
    }
    FOLDER_OPTION.check(arguments.out.as_deref())?;
    let plot = arguments.plot(&figures)?;
    let writer = Outputs::default();
    writer.prepare(arguments.out.as_deref(), arguments.known_files(&figures))?;
    let claims = arguments.claims(&figures)?;
    let mut files = Vec::new();
    let (drawn, examined) = perform(&figures, &claims, |entry| {
        files.extend(arguments.write_figure(entry, plot.as_ref(), &writer)?);
        if arguments.json { Ok(()) } else { print(&text(entry)) }
    })?;
    let entries: Vec<_> = figures
        .iter()
        .zip(&drawn)
        .map(|(figure, drawn)| GalleryFigure::new(figure, drawn, &examined))
        .collect();
    if let Some(folder) = &arguments.out {
        let page = folder.join(page_name(&figures));
        writer.write(&page, replay::gallery(&entries, &examined).as_bytes())?;
        files.push(page);
    }
    if arguments.json {
        return print_json(&Document::new(&entries, &examined, &files));
    }
    print(&written_text(files.iter()))
}

impl Arguments {
    /// The requested figures, each once, in the order of the thesis.
    fn figures(&self) -> Result<Vec<&'static Figure>, Failure> {
        let is_known = |id: &&String| id.as_str() == "all" || figures().any(|figure| has_name(figure, id));
        if let Some(id) = self.ids.iter().find(|id| !is_known(id)) {
            return Err(unknown_figure(id));
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
        Ok(Some((path.clone(), picture_format(path)?)))
    }

    /// The files whose names are known before the runs: all except the patches.
    fn known_files(&self, figures: &[&Figure]) -> Vec<PathBuf> {
        let pictures = figures.iter().map(|figure| figure.picture());
        let names: Vec<String> = pictures.chain([page_name(figures)]).collect();
        let in_folder = self.out.iter().flat_map(|folder| names.iter().map(move |name| folder.join(name)));
        self.plot.iter().cloned().chain(in_folder).collect()
    }

    /// Writes the pictures and the patches of a figure. `plot` is the file of `--plot`. Returns the paths.
    fn write_figure(
        &self,
        entry: &GalleryFigure<'_>,
        plot: Option<&(PathBuf, Format)>,
        writer: &Outputs,
    ) -> Result<Vec<PathBuf>, Failure> {
        let plot = plot.map(|(path, format)| (path.clone(), Content::Drawn(entry.drawn, *format)));
        let folder = self.out.iter().flat_map(|folder| in_folder(folder, entry));
        let (files, contents): (Vec<_>, Vec<_>) = plot.into_iter().chain(folder).unzip();
        writer.prepare(None, &files)?;
        files.iter().zip(&contents).try_for_each(|(path, content)| content.write(path, writer))?;
        Ok(files)
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
            let listed = figures().map(|figure| {
                let Figure { id, place, title, .. } = *figure;
                ListedFigure { id, place, title }
            });
            return print_json(&ListDocument { ok: true, figures: listed.collect() });
        }
        let mut table = Table::new(["figure", "where", "what it shows"]);
        figures().for_each(|figure| table.row([figure.id, figure.place, figure.title].map(str::to_owned)));
        print(&table.text())
    }
}

/// The failure for a name that no figure has. A file in place of a name gets the figure of its name, if there is one.
fn unknown_figure(id: &str) -> Failure {
    let path = Path::new(id);
    let has_ending = |ending: &OsStr| ["json", "svg", "png", "html"].iter().any(|known| ending == *known);
    if !path.extension().is_some_and(has_ending) {
        let known = figures().map(|figure| figure.id).chain(["all"]);
        let hint = nearest(id, known).map(|near| format!("did you mean \"{near}\"?"));
        let hint = hint.unwrap_or_else(|| "`patchcord replay` lists the figures".to_owned());
        return Failure::usage(format!("there is no figure {id}; {hint}"));
    }
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let hint = match figures().find(|figure| has_name(figure, &stem)) {
        Some(figure) => format!("write {} for \"{}\"", figure.id, figure.title),
        None => "`patchcord replay` lists the figures, and `patchcord run` runs a patch".to_owned(),
    };
    Failure::usage(format!("{id} is a file, where the name of a figure is expected; {hint}"))
}

/// Whether `id` is a name of the figure: fig-8-24, 8.24 or "Fig 8.24".
fn has_name(figure: &Figure, id: &str) -> bool {
    let number = figure.number();
    id == figure.id || id == number || number.strip_prefix("Fig ") == Some(id)
}

/// Draws the figures and examines the claims, with a progress bar. Each finished figure is passed to `finish`.
fn perform(
    figures: &[&'static Figure],
    claims: &[Claim],
    mut finish: impl FnMut(&GalleryFigure<'_>) -> Result<(), Failure>,
) -> Result<(Vec<DrawnFigure>, Vec<ExaminedClaim>), Failure> {
    let bar = ProgressBar::new("replay", "figures and claims");
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let progress = |done, all| bar.done(done, all);
    replay::run_each(figures, claims, threads, progress, |entry| bar.suspend(|| finish(entry)))
}

/// The content of an output file.
enum Content<'a> {
    /// A picture of the figure in a format.
    Drawn(&'a DrawnFigure, Format),
    /// A patch.
    Patch(&'a Patch),
}

impl Content<'_> {
    /// Writes the file.
    fn write(&self, path: &Path, outputs: &Outputs) -> Result<(), Failure> {
        match self {
            Content::Patch(patch) => outputs.write(path, patch.text().as_bytes()),
            Content::Drawn(drawn, format) => {
                let bytes = drawn.render(*format).map_err(|error| Failure::data(error.to_string()))?;
                outputs.write(path, &bytes)
            }
        }
    }
}

/// The files of a figure in the output folder: its picture and its patches. The page refers to them by name.
fn in_folder<'a>(folder: &Path, entry: &GalleryFigure<'a>) -> Vec<(PathBuf, Content<'a>)> {
    let drawn = entry.drawn;
    let picture = (folder.join(entry.figure.picture()), Content::Drawn(drawn, Format::Svg));
    let patches = drawn.patches.iter().map(|patch| (folder.join(patch.file()), Content::Patch(patch)));
    [picture].into_iter().chain(patches).collect()
}

/// The name of the page. Only the page with all figures is index.html, so a page with some does not overwrite it.
fn page_name(drawn: &[&Figure]) -> String {
    match drawn {
        _ if drawn.len() == figures().count() => "index.html".to_owned(),
        [one] => format!("{}.html", one.id),
        _ => "figures.html".to_owned(),
    }
}

/// A figure with its claims as text, and an empty line.
///
/// Heading, settings and reading of the figure, then one line per claim: identifier, statement, printed number,
/// verdict and result.
fn text(entry: &GalleryFigure<'_>) -> String {
    let DrawnFigure { settings, reading, .. } = entry.drawn;
    let mut text = format!("{}\n  {settings}\n  {reading}\n", entry.figure.heading());
    for row in &entry.claims {
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
}

/// The list of figures for `--json`.
#[derive(Serialize)]
struct ListDocument {
    ok: bool,
    figures: Vec<ListedFigure>,
}

/// A figure in the list.
#[derive(Serialize)]
struct ListedFigure {
    id: &'static str,
    #[serde(rename = "where")]
    place: &'static str,
    title: &'static str,
}

/// The result as JSON: the drawn figures, the examined claims and the written files.
#[derive(Serialize)]
struct Document<'a> {
    ok: bool,
    figures: Vec<FigureDocument<'a>>,
    claims: &'a [ExaminedClaim],
    files: Vec<String>,
}

/// A drawn figure. `patches` are the names of files, `claims` those of claims.
#[derive(Serialize)]
struct FigureDocument<'a> {
    id: &'static str,
    number: String,
    #[serde(rename = "where")]
    place: &'static str,
    title: &'static str,
    settings: &'a str,
    reading: &'a str,
    picture: String,
    commands: &'a [String],
    table: Option<TableDocument<'a>>,
    patches: Vec<&'a str>,
    claims: Vec<&'a str>,
}

/// The numbers behind a figure.
#[derive(Serialize)]
struct TableDocument<'a> {
    reason: &'static str,
    head: &'a [String],
    rows: &'a [Vec<String>],
}

impl<'a> Document<'a> {
    /// The document of the drawn figures.
    fn new(drawn: &'a [GalleryFigure<'a>], examined: &'a [ExaminedClaim], files: &[PathBuf]) -> Self {
        Document {
            ok: true,
            figures: drawn.iter().map(FigureDocument::of).collect(),
            claims: examined,
            files: path_texts(files),
        }
    }
}

impl<'a> FigureDocument<'a> {
    fn of(entry: &'a GalleryFigure<'a>) -> Self {
        let (figure, drawn) = (entry.figure, entry.drawn);
        FigureDocument {
            id: figure.id,
            number: figure.number(),
            place: figure.place,
            title: figure.title,
            settings: &drawn.settings,
            reading: &drawn.reading,
            picture: figure.picture(),
            commands: &drawn.commands,
            table: drawn.table.as_ref().map(TableDocument::of),
            patches: drawn.patches.iter().map(Patch::file).collect(),
            claims: entry.claims.iter().map(|row| row.claim.id.as_str()).collect(),
        }
    }
}

impl<'a> TableDocument<'a> {
    fn of(table: &'a NumberTable) -> Self {
        TableDocument { reason: table.reason, head: &table.head, rows: &table.rows }
    }
}
