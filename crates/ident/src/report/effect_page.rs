//! The reference page of an effect, for the terminal and for docs/effects.md.
//!
//! The terminal prints the page of one effect, and docs/effects.md has the pages of all effects of the library. Both
//! use the same rows and headings, so that they cannot differ. The JSON output of `patchcord effects` has the same
//! facts with other keys.

use crate::effects::{Effect, EffectParameter, Form, Library, StartRule};
use patchcord_core::elements::markdown_table as table;

/// The reference page of an effect. The terminal and the documentation lay it out.
///
/// # Examples
///
/// ```
/// use patchcord_ident::Library;
/// use patchcord_ident::report::effect_page::EffectPage;
///
/// let library = Library::shipped();
/// let page = EffectPage::of(library.get("viscous-friction").ok_or("a shipped effect")?);
/// assert_eq!(page.facts[0], ("law", "F = c v".to_owned()));
/// assert_eq!(page.parameters[0][..2], ["c", "sum / own"]);
/// assert!(page.markdown().starts_with("### viscous-friction\n"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct EffectPage {
    /// Name of the effect.
    pub name: String,
    /// Common name of the effect.
    pub title: String,
    /// Its physics in a sentence.
    pub physics: String,
    /// Facts with their headings: the law, the data that the effect needs, and the source.
    pub facts: Vec<(&'static str, String)>,
    /// One row per parameter, with the headings [`EffectPage::PARAMETERS`].
    pub parameters: Vec<[String; 5]>,
    /// One row per form, with the headings [`EffectPage::FORMS`].
    pub forms: Vec<[String; 5]>,
    /// One row per alias, with the headings [`EffectPage::ALIASES`].
    pub aliases: Vec<[String; 2]>,
}

impl EffectPage {
    /// Headings of the parameters.
    pub const PARAMETERS: [&str; 5] = ["parameter", "unit", "range", "starts", "description"];
    /// Headings of the forms.
    pub const FORMS: [&str; 5] = ["at", "reads", "gives", "parameters", "description"];
    /// Headings of the aliases.
    pub const ALIASES: [&str; 2] = ["the same as", "when"];

    /// The page of an effect.
    ///
    /// Ranges and starts are in reaches, not in units: their sizes depend on the patch.
    pub fn of(effect: &Effect) -> Self {
        let parameter_row = |(name, parameter): (&String, &EffectParameter)| {
            let start = match &parameter.start {
                StartRule::Values(values) => values.iter().map(f64::to_string).collect::<Vec<_>>().join(", "),
                StartRule::Spectrum => "frequencies of the residual".to_owned(),
                StartRule::Highest => "the highest value".to_owned(),
                StartRule::Lowest => "the lowest value".to_owned(),
            };
            let range = format!("{} ... {}", parameter.range[0], parameter.range[1]);
            [name.clone(), parameter.reach.text().to_owned(), range, start, parameter.description.clone()]
        };
        let facts = [("law", &effect.law), ("needs", &effect.excitation), ("source", &effect.source)];
        EffectPage {
            name: effect.name.clone(),
            title: effect.title.clone(),
            physics: effect.physics.clone(),
            facts: facts.map(|(heading, text)| (heading, text.clone())).to_vec(),
            parameters: effect.parameters.iter().map(parameter_row).collect(),
            forms: effect.forms.iter().map(form_row).collect(),
            aliases: effect.aliases.iter().map(|(name, when)| [name.clone(), when.clone()]).collect(),
        }
    }

    /// The page as a section of a Markdown document.
    pub fn markdown(&self) -> String {
        let facts: String =
            self.facts.iter().map(|(heading, text)| format!("* {heading}: {text}\n")).collect();
        let tables = [
            table(Self::PARAMETERS, &self.parameters),
            table(Self::FORMS, &self.forms),
            table(Self::ALIASES, &self.aliases),
        ];
        format!("### {}\n\n{}. {}\n\n{facts}{}", self.name, self.title, self.physics, tables.concat())
    }
}

/// The table row of a form.
///
/// Words are those of the document of an effect: `at`, `reads`, `gives`.
fn form_row(form: &Form) -> [String; 5] {
    let list = |words: Vec<&str>| words.join(", ");
    [
        form.attachment.word().to_owned(),
        list(form.reads.iter().map(|reads| reads.word()).collect()),
        list(form.gives.iter().map(|(gives, _)| gives.word()).collect()),
        form.parameters.join(", "),
        form.note.clone(),
    ]
}

/// All effects of a library as one Markdown document, for docs/effects.md.
pub fn library_markdown(library: &Library) -> String {
    let pages: Vec<_> = library.iter().map(|effect| EffectPage::of(effect).markdown()).collect();
    format!("{HEAD}\n{}", pages.join("\n"))
}

/// The introduction of docs/effects.md.
const HEAD: &str = "\
# Missing effects

An effect is a circuit fragment that can be wired into a patch. `patchcord effects` lists all effects, and `patchcord effects NAME`
prints one. Each effect is a file in `patches/effects`. Option `--effects DIR` adds the effects of a folder
([effect-format.md](effect-format.md)).

A fragment attaches only where the dimensions fit. The column `at` names the site:

* `motion`: the input of an integrator whose output is a velocity
* `store`: the input of an integrator whose output is another quantity
* `sum`: the input of either kind of integrator
* `total`: between an integrator and the sum of all its inputs; a form of this kind is tried once for each cord
* `drive`: the cord of a drive
* `level`: the cord of a friction level

The column `reads` names the inputs of the fragment: `own` is the output of the integrator, `position` its time integral, `load` a
force, `force` a force that is not a drive, and `in` the signal of the cord.

The column `gives` names the outputs: to the sum (`add`, `subtract`), to the brake of the integrator, which is dry friction, to another
junction (`add_to_next`), or back into the cord (`out`).

Ranges and starts of parameters are multiples of the unit in the table. `sum` is the largest force at the site, `own` the largest
velocity or level, `signal` the largest value in the cord, `sample` the sampling interval, and `record` the length of the record.
";
