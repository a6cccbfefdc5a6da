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
mod chapter_8_recordings;
mod chapter_9;
mod chapter_9_describing;
mod chapter_9_limit_cycles;
mod chapter_9_simulated;
mod graph;
mod profiles;
mod sketch;

use super::claim::Claim;
use super::recipe::{Problem, Recipe, Replayed};
use crate::instruments::Display;
use crate::patch::Patch;
use crate::plot::{Drawing, Format, Picture, PlotError, Size, Theme, render, render_drawing};

use graph::Graph;

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
    chapter_9::FIGURES,
    chapter_9_describing::FIGURES,
    chapter_9_limit_cycles::FIGURES,
    chapter_9_simulated::FIGURES,
];

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
    /// Its number as the text prints it, "Fig 8.24" or "T9-2".
    pub fn number(&self) -> String {
        let numbers: Vec<_> =
            self.id.split('-').skip(1).map(|number| number.trim_start_matches('0')).collect();
        match self.id.starts_with("table") {
            true => format!("T{}", numbers.join("-")),
            false => format!("Fig {}", numbers.join(".")),
        }
    }

    /// The chapter that it stands in.
    pub fn chapter(&self) -> &'static str {
        self.id.split('-').nth(1).unwrap_or_default()
    }

    /// Whether it bears on a claim: it names the claim, or the claim's place names it.
    pub fn bears_on(&self, claim: &Claim) -> bool {
        let number = self.number();
        let is_named = claim
            .place
            .match_indices(&number)
            .any(|(at, _)| !claim.place[at + number.len()..].starts_with(|next: char| next.is_ascii_digit()));
        is_named || self.claims.contains(&claim.id.as_str())
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
        let patches = runs.iter().map(|run| run.patch().clone()).collect();
        Ok(Drawn { sheet: Sheet::Pictures(pictures), settings, reading, patches })
    }

    /// What theory says.
    fn of_theory(pictures: Vec<Picture>, settings: &str, reading: String) -> Drawn {
        Drawn {
            sheet: Sheet::Pictures(pictures),
            settings: settings.to_owned(),
            reading,
            patches: Vec::new(),
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

/// What is read off a figure.
#[cfg(test)]
fn reading(id: &str) -> String {
    figures().find(|figure| figure.id == id).unwrap().draw().unwrap().reading
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

    /// Chapter 8 is made of runs, and drawn by the tests of the command.
    #[test]
    fn figures_of_theory_are_drawn_and_read() {
        for figure in figures().filter(|figure| figure.chapter() != "8") {
            let drawn = figure.draw().unwrap();
            let told = format!("{} {}", drawn.settings, drawn.reading);
            assert!(!drawn.reading.is_empty() && !told.contains("NaN") && !told.contains("inf"), "{told}");
            assert!(drawn.render(Format::Svg).unwrap().len() > 1000, "{}", figure.id);
        }
    }

    #[test]
    fn figures_name_claims_that_there_are() {
        let claims: HashSet<_> = ledger().unwrap().into_iter().map(|claim| claim.id).collect();
        let unknown: Vec<_> =
            figures().flat_map(|figure| figure.claims).filter(|id| !claims.contains(**id)).collect();
        assert!(unknown.is_empty(), "{unknown:?}");
    }
}
