//! The figures of the study, drawn again: from patches that are run, and from theory.
//!
//! A [`Figure`] is a row of a table: number, place, title, the claims that it bears on, and the function that draws it.
//! Those of a chapter stand in a file. What is [`Drawn`] is a sheet, the settings behind it, one line that reads it, and the
//! patches that were run for it.

mod chapter_2;
mod chapter_4;
mod chapter_7_dry;
mod chapter_7_oil;
mod chapter_7_rest;
mod chapter_7_ridges;
mod chapter_8_circuits;
mod chapter_8_limits;
mod chapter_8_quasi_harmonic;
mod chapter_8_recordings;
mod chapter_9;
mod chapter_9_describing;
mod chapter_9_limit_cycles;
mod chapter_9_simulated;
mod differences;
mod graph;
mod profiles;
mod sketch;

use super::claim::Claim;
use super::recipe::{Problem, Recipe, Replayed};
use super::table::Table;
use graph::Graph;
use patchcord_analysis::instruments::Display;
use patchcord_core::patch::Patch;
use patchcord_draw::plot::{Drawing, Format, Picture, PlotError, Size, Theme, render, render_drawing};

/// A figure of the study.
#[derive(Debug)]
pub struct Figure {
    /// Its name, such as "fig-8-24".
    pub id: &'static str,
    /// Where the text tells of it.
    pub place: &'static str,
    /// What it shows.
    pub title: &'static str,
    /// The claims that it bears on, beside those whose place names it.
    pub claims: &'static [&'static str],
    draw: fn(&Figure) -> Result<Drawn, Problem>,
}

/// A figure that was drawn.
#[derive(Debug)]
pub struct Drawn {
    /// What is to be seen.
    pub sheet: Sheet,
    /// What it was made with, in a line.
    pub settings: String,
    /// What is read off it, in a line.
    pub reading: String,
    /// The patches that were run, or drawn, for it: with its settings, under names that begin with its own.
    pub patches: Vec<Patch>,
    /// What a reader types to get the same, where patches lie beside; empty where it comes from theory.
    pub commands: Vec<String>,
    /// Numbers behind it that want a table.
    pub table: Option<Table>,
}

/// A sweep that a figure is made of, as a reader makes it.
struct Sweep {
    /// Which of the figure's patches.
    which: &'static str,
    recipe: Recipe,
    /// Parameters and their values.
    vary: Vec<(&'static str, String)>,
    measure: &'static str,
}

/// What is to be seen.
#[derive(Debug)]
pub enum Sheet {
    /// Pictures, one below the other.
    Pictures(Vec<Picture>),
    /// A drawing.
    Drawing(Box<Drawing>),
}

/// Why a figure cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[error("{id}: {problem}")]
pub struct FigureError {
    /// Which.
    pub id: &'static str,
    /// Why.
    pub problem: Problem,
}

/// The tables of all chapters.
const TABLES: &[&[Figure]] = &[
    profiles::FIGURES,
    chapter_2::FIGURES,
    chapter_4::FIGURES,
    chapter_7_ridges::FIGURES,
    chapter_7_rest::FIGURES,
    chapter_7_dry::FIGURES,
    chapter_7_oil::FIGURES,
    chapter_8_circuits::FIGURES,
    chapter_8_recordings::FIGURES,
    chapter_8_limits::FIGURES,
    chapter_8_quasi_harmonic::FIGURES,
    chapter_9::FIGURES,
    chapter_9_describing::FIGURES,
    chapter_9_limit_cycles::FIGURES,
    chapter_9_simulated::FIGURES,
    differences::FIGURES,
];

/// The chapters that have figures.
const CHAPTERS: [&str; 5] = ["Chapter 2", "Chapter 4", "Chapter 7", "Chapter 8", "Chapter 9"];

/// All figures, in the order of the study.
pub fn figures() -> impl Iterator<Item = &'static Figure> {
    let mut figures: Vec<_> = TABLES.iter().copied().flatten().collect();
    figures.sort_by_key(|figure| (figure.chapter(), figure.id));
    figures.into_iter()
}

/// A number with its unit, in a prefix that keeps it short.
fn told(value: f64, unit: &str) -> String {
    Display::new(unit, value).text(value)
}

/// A picture with another title.
fn titled(picture: Picture, title: &str) -> Picture {
    Picture { title: title.to_owned(), ..picture }
}

/// Height of one of several pictures of a sheet, and of one alone.
const SMALLER: Size = Size { width: 900, height: 440 };

impl Figure {
    /// Its number as the text prints it, "Fig 8.24" or "T9-2"; those that are not in the text are "D1", "D2".
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

    /// The chapter that it stands in; those that are not in the text stand behind the last.
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

    /// Whether it bears on a claim: it names the claim, or the claim's place names it, or the table that it is drawn from.
    pub fn bears_on(&self, claim: &Claim) -> bool {
        let mut tables = self.place.split([' ', ',']).filter(|word| word.starts_with("T9-"));
        names(&claim.place, &self.number())
            || tables.any(|table| names(&claim.place, table))
            || self.claims.contains(&claim.id.as_str())
    }

    /// "Fig 8.24: system velocity profile".
    pub fn heading(&self) -> String {
        format!("{}: {}", self.number(), self.title)
    }

    /// Makes the runs, or works the theory out, and draws.
    ///
    /// # Errors
    /// What a run or a law of theory refuses.
    pub fn draw(&self) -> Result<Drawn, FigureError> {
        (self.draw)(self).map_err(|problem| FigureError { id: self.id, problem })
    }

    /// A patch for it with a name of its own: that of the figure, or of one of several.
    fn run(&self, recipe: &Recipe, which: &str) -> Result<Replayed, Problem> {
        recipe.run(&self.file(which), &self.heading())
    }

    fn file(&self, which: &str) -> String {
        if which.is_empty() { self.id.to_owned() } else { format!("{}-{which}", self.id) }
    }
}

/// Whether a place names a figure or table, and not one whose number is longer.
fn names(place: &str, number: &str) -> bool {
    let mut found = place.match_indices(number);
    found.any(|(at, _)| !place[at + number.len()..].starts_with(|next: char| next.is_ascii_digit()))
}

impl Drawn {
    /// What one run shows, in the pictures that its patch asks for.
    fn of_run(run: &Replayed, reading: String) -> Result<Drawn, Problem> {
        Drawn::of_runs(&[run], run.pictures()?, run.settings(), reading)
    }

    /// What several runs show.
    fn of_runs(
        runs: &[&Replayed],
        pictures: Vec<Picture>,
        settings: String,
        mut reading: String,
    ) -> Result<Drawn, Problem> {
        for overload in runs.iter().filter_map(|run| run.overloads()) {
            reading += &format!("; {overload}");
        }
        let patches: Vec<_> = runs.iter().map(|run| run.patch().clone()).collect();
        let commands = patches.iter().map(|patch| format!("patchcord run {}", patch.file())).collect();
        Ok(Drawn { sheet: Sheet::Pictures(pictures), settings, reading, patches, commands, table: None })
    }

    /// What sweeps show.
    fn of_sweeps(
        figure: &Figure,
        sweeps: &[Sweep],
        pictures: Vec<Picture>,
        reading: String,
    ) -> Result<Drawn, Problem> {
        let mut drawn = Drawn::of_theory(pictures, "", reading);
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

    /// What theory says.
    fn of_theory(pictures: Vec<Picture>, settings: &str, reading: String) -> Drawn {
        Drawn {
            sheet: Sheet::Pictures(pictures),
            settings: settings.to_owned(),
            reading,
            patches: Vec::new(),
            commands: Vec::new(),
            table: None,
        }
    }

    /// The bytes of a file with the sheet.
    ///
    /// # Errors
    /// What drawing refuses.
    pub fn render(&self, format: Format) -> Result<Vec<u8>, PlotError> {
        match &self.sheet {
            Sheet::Pictures(pictures) => {
                let size = if pictures.len() > 1 { SMALLER } else { Size::default() };
                render(pictures, format, size)
            }
            Sheet::Drawing(drawing) => render_drawing(drawing, format, Theme::Light),
        }
    }
}

/// Numbers with commas between them, as sweeps take them.
fn listed(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(",")
}

/// A figure, drawn once for all tests.
#[cfg(test)]
fn drawn(id: &'static str) -> std::sync::Arc<std::sync::OnceLock<Drawn>> {
    use std::collections::BTreeMap;
    use std::sync::{Arc, Mutex, OnceLock};

    static DRAWN: Mutex<BTreeMap<&str, Arc<OnceLock<Drawn>>>> = Mutex::new(BTreeMap::new());
    let place = Arc::clone(DRAWN.lock().unwrap().entry(id).or_default());
    place.get_or_init(|| figures().find(|figure| figure.id == id).unwrap().draw().unwrap());
    place
}

/// What is read off a figure.
#[cfg(test)]
fn reading(id: &'static str) -> String {
    drawn(id).get().unwrap().reading.clone()
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::replay::ledger;

    #[test]
    fn figures_have_names_of_their_own_in_the_order_of_the_study() {
        let mut seen = HashSet::new();
        assert!(figures().all(|figure| seen.insert(figure.id)));
        assert!(figures().map(|figure| (figure.chapter(), figure.id)).is_sorted());
        let told: Vec<_> =
            figures().filter(|figure| figure.id.ends_with("9-02")).map(Figure::number).collect();
        assert_eq!(told, ["Fig 9.2"]);
    }

    #[test]
    fn figures_name_claims_that_there_are() {
        let claims: HashSet<_> = ledger().unwrap().into_iter().map(|claim| claim.id).collect();
        let unknown: Vec<_> =
            figures().flat_map(|figure| figure.claims).filter(|id| !claims.contains(**id)).collect();
        assert!(unknown.is_empty(), "{unknown:?}");
    }
}
