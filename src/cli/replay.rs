//! `patchcord replay`

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::thread;

use clap::Args;
use serde_json::{Value, json};

use super::failure::Failure;
use super::files::{places, prepare, put, written};
use super::progress::Bar;
use super::table::Table;
use super::{say, say_json};
use patchcord::document::suggestion;
use patchcord::draw::plot::Format;
use patchcord::thesis::replay::{self, Claim, Drawn, Examined, Exhibit, Figure, figures};

#[derive(Args)]
pub(super) struct Arguments {
    /// The figures, such as fig-8-24, or all; without any they are listed
    #[arg(value_name = "ID|all")]
    ids: Vec<String>,
    /// Write pictures, the patches that were run for them, and a page that shows them beside their claims into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Draw the figure into this file; SVG or PNG by its name
    #[arg(long, value_name = "FILE.svg|png")]
    plot: Option<PathBuf>,
    /// Print one JSON document and nothing else
    #[arg(long)]
    json: bool,
}

pub(super) fn replay(arguments: &Arguments) -> Result<(), Failure> {
    carry_out(arguments).map_err(|failure| failure.told_as_json(arguments.json))
}

fn carry_out(arguments: &Arguments) -> Result<(), Failure> {
    let figures = arguments.figures()?;
    if figures.is_empty() {
        return arguments.list();
    }
    let plot = arguments.plot(&figures)?;
    let files: Vec<_> = plot.iter().map(|(path, _)| path.clone()).collect();
    prepare(arguments.out.as_deref(), files.iter())?;
    let claims = arguments.claims(&figures)?;
    let (drawn, examined) = performed(&figures, &claims)?;
    let exhibits: Vec<_> =
        figures.iter().zip(&drawn).map(|(figure, drawn)| Exhibit::new(figure, drawn, &examined)).collect();
    let mut outputs: Vec<_> = plot
        .into_iter()
        .map(|(path, format)| Output { path, content: Content::Drawn(&drawn[0], format) })
        .collect();
    if let Some(folder) = &arguments.out {
        outputs.extend(in_folder(folder, &exhibits, &examined));
    }
    let files: Vec<_> = outputs.iter().map(|output| output.path.clone()).collect();
    places(files.iter())?;
    prepare(None, files.iter())?;
    outputs.iter().try_for_each(Output::write)?;
    if arguments.json {
        return say_json(&document(&exhibits, &examined, &files));
    }
    say(&told(&exhibits))?;
    say(&written(files.iter()))
}

impl Arguments {
    /// The figures asked for, each once, in the order of the study.
    fn figures(&self) -> Result<Vec<&'static Figure>, Failure> {
        let known: Vec<&str> = figures().map(|figure| figure.id).chain(["all"]).collect();
        let is_known = |id: &&String| id.as_str() == "all" || figures().any(|figure| goes_by(figure, id));
        if let Some(id) = self.ids.iter().find(|id| !is_known(id)) {
            let hint = suggestion(id, &known).unwrap_or_else(|| "patchcord replay lists them".to_owned());
            return Err(Failure::usage(format!("there is no figure {id}; {hint}")));
        }
        let is_asked = |figure: &&Figure| self.ids.iter().any(|id| id == "all" || goes_by(figure, id));
        Ok(figures().filter(is_asked).collect())
    }

    fn plot(&self, figures: &[&Figure]) -> Result<Option<(PathBuf, Format)>, Failure> {
        let Some(path) = &self.plot else { return Ok(None) };
        if figures.len() > 1 {
            let message = "--plot draws one figure: give --out DIR for several";
            return Err(Failure::usage(message));
        }
        let format = Format::from_path(path).map_err(|error| Failure::usage(error.to_string()))?;
        Ok(Some((path.clone(), format)))
    }

    /// All claims with all figures; else those that the figures bear on.
    fn claims(&self, figures: &[&Figure]) -> Result<Vec<Claim>, Failure> {
        let mut claims = replay::ledger().map_err(|error| Failure::data(error.to_string()))?;
        if !self.ids.iter().any(|id| id == "all") {
            claims.retain(|claim| figures.iter().any(|figure| figure.bears_on(claim)));
        }
        Ok(claims)
    }

    /// What there is to be drawn.
    fn list(&self) -> Result<(), Failure> {
        if self.out.is_some() || self.plot.is_some() {
            let message = "which figure? give its name, such as fig-8-24, or all";
            return Err(Failure::usage(message));
        }
        if self.json {
            let told =
                |figure: &Figure| json!({"id": figure.id, "where": figure.place, "title": figure.title});
            return say_json(&json!({"ok": true, "figures": figures().map(told).collect::<Value>()}));
        }
        let mut table = Table::new(["figure", "where", "what it shows"]);
        figures().for_each(|figure| table.row([figure.id, figure.place, figure.title].map(str::to_owned)));
        say(&table.text())
    }
}

/// Whether this is what a figure is called: fig-8-24, 8.24 or "Fig 8.24".
fn goes_by(figure: &Figure, id: &str) -> bool {
    let number = figure.number();
    id == figure.id || id == number || number.strip_prefix("Fig ") == Some(id)
}

fn performed(figures: &[&'static Figure], claims: &[Claim]) -> Result<(Vec<Drawn>, Vec<Examined>), Failure> {
    let mut progress = Bar::new("figures and claims");
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let outcome = replay::perform(figures, claims, threads, |done, all| {
        if let Some(progress) = &mut progress {
            progress.done(done, all);
        }
    });
    outcome.map_err(|error| Failure::data(error.to_string()))
}

/// A file to be written.
struct Output<'a> {
    path: PathBuf,
    content: Content<'a>,
}

/// What stands in it.
enum Content<'a> {
    Drawn(&'a Drawn, Format),
    Text(Cow<'a, str>),
}

impl Output<'_> {
    fn write(&self) -> Result<(), Failure> {
        match &self.content {
            Content::Text(text) => put(&self.path, text.as_bytes()),
            Content::Drawn(drawn, format) => {
                let bytes = drawn.render(*format).map_err(|error| Failure::data(error.to_string()))?;
                put(&self.path, &bytes)
            }
        }
    }
}

/// Pictures, patches and the page, as they are written into a folder.
fn in_folder<'a>(folder: &Path, exhibits: &'a [Exhibit<'a>], examined: &[Examined]) -> Vec<Output<'a>> {
    let output = |name: &str, content| Output { path: folder.join(name), content };
    let of_exhibit = |exhibit: &'a Exhibit<'a>| {
        let picture = output(&exhibit.picture(), Content::Drawn(exhibit.drawn, Format::Svg));
        let patches = exhibit.drawn.patches.iter();
        let patches = patches.map(|patch| output(patch.file(), Content::Text(patch.text().into())));
        [picture].into_iter().chain(patches).collect::<Vec<_>>()
    };
    let page = output(&page_name(exhibits), Content::Text(replay::gallery(exhibits, examined).into()));
    exhibits.iter().flat_map(of_exhibit).chain([page]).collect()
}

/// A page of some figures does not take the place of that of all.
fn page_name(exhibits: &[Exhibit<'_>]) -> String {
    match exhibits {
        _ if exhibits.len() == figures().count() => "index.html".to_owned(),
        [one] => format!("{}.html", one.figure.id),
        _ => "figures.html".to_owned(),
    }
}

/// Figures with their claims, a few lines each.
fn told(exhibits: &[Exhibit<'_>]) -> String {
    let told = |exhibit: &Exhibit<'_>| {
        let Drawn { settings, reading, .. } = exhibit.drawn;
        let mut text = format!("{}\n  {settings}\n  {reading}\n", exhibit.figure.heading());
        for row in &exhibit.claims {
            let (claim, printed) = (&row.claim, row.printed());
            let printed = if printed.is_empty() { printed } else { format!(": {printed}") };
            text += &format!("  {} {}{printed}; {}", claim.id, claim.says, row.outcome.verdict);
            text += &if row.got().is_empty() { "\n".to_owned() } else { format!(", {}\n", row.got()) };
            if !claim.why.is_empty() {
                text += &format!("      {}\n", claim.why);
            }
        }
        text + "\n"
    };
    exhibits.iter().map(told).collect()
}

fn document(exhibits: &[Exhibit<'_>], examined: &[Examined], files: &[PathBuf]) -> Value {
    let figure = |exhibit: &Exhibit<'_>| {
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
        "claims": examined.iter().map(Examined::to_json).collect::<Value>(),
        "files": files.iter().map(|path| path.display().to_string()).collect::<Value>(),
    })
}
