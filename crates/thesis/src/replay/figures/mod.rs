//! The figures of the thesis, drawn again from runs of patches and from theory.
//!
//! A [`Figure`] is a row of a table: identifier, place in the text, title, claims, and the function that draws it.
//! The figures of a chapter are in one or several files. The result is a [`DrawnFigure`]: a sheet, a line of
//! settings, a line that states what can be read from the figure, and the patches that were run.
//!
//! A figure whose numbers come from runs names the patches and the commands that repeat them. A figure of theory has
//! neither. The line that states what can be read is computed together with the figure, and tests compare some of these
//! lines with the text of the thesis.

mod chapter_2;
mod chapter_4;
mod chapter_7_dry;
mod chapter_7_oil;
mod chapter_7_ranges;
mod chapter_7_rest;
mod chapter_7_ridges;
mod chapter_7_stiffening;
mod chapter_7_wedge;
mod chapter_8_circuits;
mod chapter_8_limits;
mod chapter_8_profiles;
mod chapter_8_quasi_harmonic;
mod chapter_8_recordings;
mod chapter_9_describing;
mod chapter_9_limit_cycles;
mod chapter_9_oils;
mod chapter_9_simulated;
mod chapter_9_stability;
mod differences;
mod differences_stiffness;
mod graph;
mod profiles;
mod sketch;

use super::claim::Claim;
use super::number_table::NumberTable;
use super::recipe::{BoxError, Recipe};
use super::run_record::ReplayedRun;
use graph::Graph;
use patchcord_core::patch::Patch;
use patchcord_draw::plot::{Drawing, Format, Picture, PlotError, Size, Theme, render, render_drawing};

/// A figure of the thesis, or a figure on a difference from it.
#[derive(Debug)]
pub struct Figure {
    /// Its identifier, such as "fig-8-24", "table-9-2" or "difference-1".
    pub id: &'static str,
    /// The place in the text: sections, equations and tables.
    pub place: &'static str,
    /// Its title.
    pub title: &'static str,
    /// Identifiers of claims that it illustrates. Claims whose place names the figure are added automatically.
    pub claims: &'static [&'static str],
    /// Makes the runs or computes the theory, and draws.
    draw: fn(&Figure) -> Result<DrawnFigure, BoxError>,
}

/// A drawn figure.
///
/// # Examples
///
/// A figure of theory has no patches and no commands:
///
/// ```
/// use patchcord_thesis::replay::figures;
///
/// let figure = figures().find(|figure| figure.id == "fig-2-02").ok_or("a figure of the thesis")?;
/// let drawn = figure.draw()?;
/// assert!(drawn.reading.contains("21.54, 2.14, 0.10 mm/s"));
/// assert!(drawn.patches.is_empty() && drawn.commands.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct DrawnFigure {
    /// The pictures or the drawing.
    pub sheet: Sheet,
    /// The settings, in one line.
    pub settings: String,
    /// What can be read from it, in one line with numbers.
    pub reading: String,
    /// The patches that were run or drawn for it. They contain its settings. Their names begin with the identifier of
    /// the figure.
    pub patches: Vec<Patch>,
    /// The commands that repeat the runs in a folder with the patches. Empty if the figure comes from theory.
    pub commands: Vec<String>,
    /// A table of the numbers behind it, for the page of differences.
    pub table: Option<NumberTable>,
}

/// The sweep behind a figure, from which the command line for a reader is made.
struct SweepCommand {
    /// The suffix of its patch; empty if the figure has only one patch.
    which: &'static str,
    /// The circuit and its settings.
    recipe: Recipe,
    /// Parameters that are varied, with their values separated by commas.
    vary: Vec<(&'static str, String)>,
    /// The measure that the sweep reads.
    measure: &'static str,
}

/// The graphical content of a figure.
#[derive(Debug)]
#[non_exhaustive]
pub enum Sheet {
    /// Pictures with axes, one below the other.
    Pictures(Vec<Picture>),
    /// A drawing without axes: a circuit, a sketch or a table.
    Drawing(Box<Drawing>),
}

/// The reason why a figure cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[error("{id}: {problem}")]
pub struct FigureError {
    /// The identifier of the figure.
    pub id: &'static str,
    /// The error.
    pub problem: BoxError,
}

/// The tables of figures of all chapters.
const TABLES: &[&[Figure]] = &[
    profiles::FIGURES,
    chapter_2::FIGURES,
    chapter_4::FIGURES,
    chapter_7_ridges::FIGURES,
    chapter_7_ranges::FIGURES,
    chapter_7_rest::FIGURES,
    chapter_7_dry::FIGURES,
    chapter_7_stiffening::FIGURES,
    chapter_7_wedge::FIGURES,
    chapter_7_oil::FIGURES,
    chapter_8_circuits::FIGURES,
    chapter_8_recordings::FIGURES,
    chapter_8_profiles::FIGURES,
    chapter_8_limits::FIGURES,
    chapter_8_quasi_harmonic::FIGURES,
    chapter_9_stability::FIGURES,
    chapter_9_oils::FIGURES,
    chapter_9_describing::FIGURES,
    chapter_9_limit_cycles::FIGURES,
    chapter_9_simulated::FIGURES,
    differences::FIGURES,
    differences_stiffness::FIGURES,
];

/// The chapters that have figures. A figure belongs to the chapter of the first number in its identifier.
const CHAPTERS: [&str; 5] = ["Chapter 2", "Chapter 4", "Chapter 7", "Chapter 8", "Chapter 9"];

/// Returns all figures in the order of the thesis. The figures on differences are last.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::replay::figures;
///
/// let profile = figures().find(|figure| figure.id == "fig-8-24").ok_or("a figure of the thesis")?;
/// assert_eq!((profile.number().as_str(), profile.chapter()), ("Fig 8.24", "Chapter 8"));
/// assert_eq!(profile.heading(), "Fig 8.24: system velocity profile");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn figures() -> impl Iterator<Item = &'static Figure> {
    let mut figures: Vec<_> = TABLES.iter().copied().flatten().collect();
    figures.sort_by_key(|figure| (figure.chapter(), figure.id));
    figures.into_iter()
}

/// Replaces the title of a picture.
fn with_title(picture: Picture, title: &str) -> Picture {
    Picture { title: title.to_owned(), ..picture }
}

/// The size of each picture if a sheet has several.
const STACKED_SIZE: Size = Size { width: 900, height: 440 };

impl Figure {
    /// Returns its number as the text prints it, "Fig 8.24" or "T9-2". Figures on differences are "D1", "D2".
    pub fn number(&self) -> String {
        let mut parts = self.id.split('-').map(|number| number.trim_start_matches('0'));
        let kind = parts.next();
        let numbers: Vec<_> = parts.collect();
        match kind {
            Some("table") => format!("T{}", numbers.join("-")),
            Some("difference") => format!("D{}", numbers.join("-")),
            _ => format!("Fig {}", numbers.join(".")),
        }
    }

    /// Returns the file name of its picture in a gallery.
    pub fn picture(&self) -> String {
        format!("{}.svg", self.id)
    }

    /// Returns the title of its chapter. Figures on differences have their own title, which sorts after the chapters.
    pub fn chapter(&self) -> &'static str {
        match self.id.split_once('-') {
            Some(("difference", _)) => "What the differences depend on",
            _ => CHAPTERS
                .iter()
                .find(|chapter| self.id.split('-').nth(1) == chapter.strip_prefix("Chapter "))
                .copied()
                .unwrap_or_default(),
        }
    }

    /// Returns whether it illustrates a claim. It does if it names the claim, if the place of the claim names the
    /// figure, or if both places name the same table of chapter 9.
    pub fn is_related_to(&self, claim: &Claim) -> bool {
        let mut tables = self.place.split([' ', ',']).filter(|word| word.starts_with("T9-"));
        mentions(&claim.place, &self.number())
            || tables.any(|table| mentions(&claim.place, table))
            || self.claims.contains(&claim.id.as_str())
    }

    /// Returns its heading, such as "Fig 8.24: system velocity profile".
    pub fn heading(&self) -> String {
        format!("{}: {}", self.number(), self.title)
    }

    /// Makes the runs or computes the theory, and draws.
    ///
    /// # Errors
    /// If a run fails, or if a law of theory does not hold for its arguments.
    pub fn draw(&self) -> Result<DrawnFigure, FigureError> {
        (self.draw)(self).map_err(|problem| FigureError { id: self.id, problem })
    }

    /// Runs a recipe under the name of the figure, with the suffix `which` if the figure has several patches.
    fn run(&self, recipe: &Recipe, which: &str) -> Result<ReplayedRun, BoxError> {
        recipe.run_for_pictures(&self.file(which), &self.heading())
    }

    /// Returns the name of a patch: the identifier of the figure, with a suffix if `which` is not empty.
    fn file(&self, which: &str) -> String {
        if which.is_empty() { self.id.to_owned() } else { format!("{}-{which}", self.id) }
    }
}

/// Returns whether a place names a figure or table. "Fig 8.2" is not named by "Fig 8.24".
fn mentions(place: &str, number: &str) -> bool {
    let mut found = place.match_indices(number);
    found.any(|(at, _)| !place[at + number.len()..].starts_with(|next: char| next.is_ascii_digit()))
}

impl DrawnFigure {
    /// Makes a figure of one run, with the pictures that its patch specifies.
    fn from_run(run: &ReplayedRun, reading: String) -> Result<DrawnFigure, BoxError> {
        DrawnFigure::from_runs(&[run], run.pictures()?, run.settings(), reading)
    }

    /// Makes a figure of several runs. Overloads are appended to the reading.
    fn from_runs(
        runs: &[&ReplayedRun],
        pictures: Vec<Picture>,
        settings: String,
        mut reading: String,
    ) -> Result<DrawnFigure, BoxError> {
        for overload in runs.iter().filter_map(|run| run.record.overload_text()) {
            reading += &format!("; {overload}");
        }
        let patches: Vec<_> = runs.iter().map(|run| run.patch().clone()).collect();
        let commands = patches.iter().map(|patch| format!("patchcord run {}", patch.file())).collect();
        Ok(DrawnFigure {
            sheet: Sheet::Pictures(pictures),
            settings,
            reading,
            patches,
            commands,
            table: None,
        })
    }

    /// Makes a figure of sweeps. Settings are those of the last sweep.
    fn from_sweeps(
        figure: &Figure,
        sweeps: &[SweepCommand],
        pictures: Vec<Picture>,
        reading: String,
    ) -> Result<DrawnFigure, BoxError> {
        let mut drawn = DrawnFigure::from_theory(pictures, "", reading);
        for sweep in sweeps {
            let patch = sweep.recipe.patch(&figure.file(sweep.which), &figure.heading())?;
            let vary: Vec<_> =
                sweep.vary.iter().map(|(name, values)| format!("--vary {name}={values}")).collect();
            let (file, vary) = (patch.file(), vary.join(" "));
            drawn.commands.push(format!("patchcord sweep {file} {vary} --measure {}", sweep.measure));
            let varied: Vec<_> = sweep.vary.iter().map(|(name, _)| *name).chain(["v_turn"]).collect();
            drawn.settings = format!(
                "{}, {} varied",
                sweep.recipe.settings(&varied)?,
                varied[..varied.len() - 1].join(" and ")
            );
            drawn.patches.push(patch);
        }
        Ok(drawn)
    }

    /// Makes a figure of theory, without patches and commands.
    fn from_theory(pictures: Vec<Picture>, settings: &str, reading: String) -> DrawnFigure {
        DrawnFigure {
            sheet: Sheet::Pictures(pictures),
            settings: settings.to_owned(),
            reading,
            patches: Vec::new(),
            commands: Vec::new(),
            table: None,
        }
    }

    /// Renders the sheet as the bytes of a file.
    ///
    /// # Errors
    /// If the pictures cannot be drawn in this format.
    pub fn render(&self, format: Format) -> Result<Vec<u8>, PlotError> {
        match &self.sheet {
            Sheet::Pictures(pictures) => {
                let size = if pictures.len() > 1 { STACKED_SIZE } else { Size::default() };
                render(pictures, format, size)
            }
            Sheet::Drawing(drawing) => render_drawing(drawing, format, Theme::Light),
        }
    }
}

/// Formats numbers with commas between them, as `patchcord sweep` reads them.
fn comma_separated(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests;
