//! `patchcord effects`
//!
//! The command lists the effects of the library, or describes one. A folder of effects is checked completely, so
//! `patchcord effects --effects DIR` tests the files of that folder.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Map, Value, json};

use super::failure::Failure;
use super::table::Table;
use super::{eprint, print, print_json};
use patchcord::document::suggestion;
use patchcord::ident::effects::{Effect, Library};
use patchcord::ident::report::effect_page::{EffectPage, library_markdown};

#[derive(Args)]
pub(super) struct Arguments {
    /// Describe this effect
    name: Option<String>,
    /// Add the effects in this folder: every .json file in it
    #[arg(long, value_name = "DIR")]
    effects: Option<PathBuf>,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
    /// Print every page as one Markdown document
    #[arg(long, conflicts_with_all = ["name", "json"])]
    markdown: bool,
}

/// Notes on replaced effects go to standard error.
pub(super) fn effects(arguments: &Arguments) -> Result<(), Failure> {
    let library = effect_library(arguments.effects.as_deref())
        .map_err(|failure| failure.with_json_output(arguments.json))?;
    if arguments.markdown {
        return print(&library_markdown(&library));
    }
    let found = match &arguments.name {
        None => library.iter().collect(),
        Some(name) => {
            vec![find(&library, name).map_err(|failure| failure.with_json_output(arguments.json))?]
        }
    };
    if arguments.json {
        return print_json(&found.iter().map(|effect| document(effect)).collect());
    }
    match (&arguments.name, found.as_slice()) {
        (Some(_), [effect]) => print(&text(&EffectPage::of(effect))),
        _ => print(&catalogue(&found)),
    }
}

/// The built-in effects, and those of a folder.
pub(super) fn effect_library(folder: Option<&Path>) -> Result<Library, Failure> {
    let library = Library::shipped();
    match folder {
        None => Ok(library),
        Some(folder) => Ok(library.with_folder(folder).inspect(print_notes)?),
    }
}

/// Prints the notes on the effects of a folder to standard error.
fn print_notes(library: &Library) {
    library.notes().iter().for_each(|note| eprint(&format!("note: {note}")));
}

/// The effect with this name.
fn find<'l>(library: &'l Library, name: &str) -> Result<&'l Effect, Failure> {
    library.get(name).ok_or_else(|| {
        let known: Vec<_> = library.iter().map(|effect| effect.name.as_str()).collect();
        let hint = suggestion(name, &known).unwrap_or_default();
        Failure::usage(format!("there is no effect \"{name}\"; {hint}"))
    })
}

/// The table of effects.
fn catalogue(effects: &[&Effect]) -> String {
    let mut table = Table::new(["effect", "at", "law"]);
    for effect in effects {
        let mut places: Vec<_> = effect.forms.iter().map(|form| form.attachment.word()).collect();
        places.dedup();
        table.row([effect.name.clone(), places.join(", "), effect.law.clone()]);
    }
    format!("{}\n`patchcord effects NAME` describes one of them.\n", table.text())
}

/// The page of an effect as text.
fn text(page: &EffectPage) -> String {
    let mut text = format!("{}: {}\n\n{}\n\n", page.name, page.title, page.physics);
    for (what, fact) in &page.facts {
        text += &format!("{what:<8}{fact}\n");
    }
    let tables = [
        Table::from_rows(EffectPage::PARAMETERS, &page.parameters),
        Table::from_rows(EffectPage::FORMS, &page.forms),
        Table::from_rows(EffectPage::ALIASES, &page.aliases),
    ];
    for table in tables.iter().filter(|table| !table.is_empty()) {
        text += &format!("\n{table}");
    }
    text
}

/// The page of an effect as JSON.
///
/// Keys: `name`, `title`, `law`, `physics`, `source`, `excitation`, `aliases` (name to condition), `parameters`
/// (`name`, `reach`, `range`, `none`, `description`) and `forms` (`at`, `reads`, `gives`, `parameters`, `note`). `none`
/// is the value without effect, in reaches.
fn document(effect: &Effect) -> Value {
    let page = EffectPage::of(effect);
    let parameters = effect.parameters.iter().map(|(name, own)| {
        json!({
            "name": name, "reach": own.reach.text(), "range": own.range, "none": own.null_value, "description": own.description,
        })
    });
    let forms = effect.forms.iter().map(|form| {
        let reads: Vec<_> = form.reads.iter().map(|reads| reads.word()).collect();
        let gives: Vec<_> = form.gives.iter().map(|(gives, _)| gives.word()).collect();
        json!({"at": form.attachment.word(), "reads": reads, "gives": gives, "parameters": form.parameters, "note": form.note})
    });
    let aliases = effect.aliases.iter().map(|(name, when)| (name.clone(), json!(when)));
    json!({
        "name": page.name, "title": page.title, "law": effect.law, "physics": page.physics, "source": effect.source,
        "excitation": effect.excitation, "aliases": aliases.collect::<Map<_, _>>(),
        "parameters": parameters.collect::<Vec<_>>(), "forms": forms.collect::<Vec<_>>(),
    })
}
