//! What a reader is told of an effect: its page on the terminal and its part of docs/effects.md.

use crate::effects::{Effect, Form, Library, Start};
use patchcord_core::elements::markdown_table as table;

/// An effect's page in words, for a terminal or a document to lay out.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// Its name.
    pub name: String,
    /// What people call it.
    pub title: String,
    /// Its physics in a sentence.
    pub physics: String,
    /// What is said of it as a whole: law, source, what data must hold.
    pub facts: Vec<(&'static str, String)>,
    /// A row a parameter, under [`Page::PARAMETERS`].
    pub parameters: Vec<[String; 5]>,
    /// A row a form, under [`Page::FORMS`].
    pub forms: Vec<[String; 5]>,
    /// A row an alias, under [`Page::ALIASES`].
    pub aliases: Vec<[String; 2]>,
}

impl Page {
    /// Headings of the parameters.
    pub const PARAMETERS: [&str; 5] = ["parameter", "in", "range", "begins at", "what it is"];
    /// Headings of the forms.
    pub const FORMS: [&str; 5] = ["at", "reads", "gives", "parameters", "which"];
    /// Headings of the aliases.
    pub const ALIASES: [&str; 2] = ["the same as", "when"];

    /// The page of an effect.
    pub fn of(effect: &Effect) -> Self {
        let parameter = |(name, own): (&String, &crate::effects::EffectParameter)| {
            let start = match &own.start {
                Start::Values(values) => values.iter().map(f64::to_string).collect::<Vec<_>>().join(", "),
                Start::Spectrum => "what is left is full of".to_owned(),
                Start::Highest => "the highest value".to_owned(),
                Start::Lowest => "the lowest value".to_owned(),
            };
            let range = format!("{} ... {}", own.range[0], own.range[1]);
            [name.clone(), own.reach.text().to_owned(), range, start, own.description.clone()]
        };
        let facts = [("law", &effect.law), ("needs", &effect.excitation), ("source", &effect.source)];
        Page {
            name: effect.name.clone(),
            title: effect.title.clone(),
            physics: effect.physics.clone(),
            facts: facts.map(|(what, text)| (what, text.clone())).to_vec(),
            parameters: effect.parameters.iter().map(parameter).collect(),
            forms: effect.forms.iter().map(form_row).collect(),
            aliases: effect.aliases.iter().map(|(name, when)| [name.clone(), when.clone()]).collect(),
        }
    }

    /// The page as a section of a Markdown document.
    pub fn markdown(&self) -> String {
        let facts: String = self.facts.iter().map(|(what, text)| format!("* {what}: {text}\n")).collect();
        let tables = [
            table(Self::PARAMETERS, &self.parameters),
            table(Self::FORMS, &self.forms),
            table(Self::ALIASES, &self.aliases),
        ];
        format!("### {}\n\n{}. {}\n\n{facts}{}", self.name, self.title, self.physics, tables.concat())
    }
}

fn form_row(form: &Form) -> [String; 5] {
    let words = |words: Vec<&str>| words.join(", ");
    [
        form.at.word().to_owned(),
        words(form.reads.iter().map(|reads| reads.word()).collect()),
        words(form.gives.iter().map(|(gives, _)| gives.word()).collect()),
        form.parameters.join(", "),
        form.note.clone(),
    ]
}

/// Every effect of a library as one Markdown document: docs/effects.md.
pub fn library_markdown(library: &Library) -> String {
    let pages: Vec<_> = library.iter().map(|effect| Page::of(effect).markdown()).collect();
    format!("{HEAD}\n{}", pages.join("\n"))
}

const HEAD: &str = "\
# Missing effects

What a patch may lack, as fragments that can be wired into it: `patchcord effects` lists them, `patchcord effects NAME` tells
of one. Each is a file in `patches/effects`; a folder of your own joins them with `--effects DIR` ([effect-format.md](effect-format.md)).

A fragment attaches where the dimensions fit. `motion` is the input of an integrator that gives a velocity, `store` of one
that gives something else, `sum` of either; `total` lies between all that drives an integrator and the integrator, once for each cord;
`drive` and `level` are cords of a drive and of a friction level. Fragments read `own`, what the integrator gives, `position`, its time
integral, `load`, a force, `force`, one that is no drive, or `in`, what came through the cord. They give to the sum (`add`, `subtract`), to the brake of the integrator,
which is true friction, to another junction (`add_to_next`), or on through the cord (`out`).

Parameters are measured in what is largest at the place: `sum` stands for the largest force, `own` for the largest
velocity or level, `signal` for that of the cord, `sample` and `record` for the times from sample to sample and of the whole record. Range and beginnings are multiples
of that.
";
