//! `patchcord effects`

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Map, Value, json};

use super::failure::Failure;
use super::table::Table;
use super::{say, say_json, tell};
use patchcord::document::suggestion;
use patchcord::ident::effects::{Effect, Library};
use patchcord::ident::report::effect_page::{Page, library_markdown};

#[derive(Args)]
pub(super) struct Arguments {
    /// Tell all about this one
    name: Option<String>,
    /// Take the effects of this folder as well: every .json file in it
    #[arg(long, value_name = "DIR")]
    effects: Option<PathBuf>,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
    /// Print every page as one Markdown document
    #[arg(long, conflicts_with_all = ["name", "json"])]
    markdown: bool,
}

pub(super) fn effects(arguments: &Arguments) -> Result<(), Failure> {
    let library =
        known(arguments.effects.as_deref()).map_err(|failure| failure.told_as_json(arguments.json))?;
    if arguments.markdown {
        return say(&library_markdown(&library));
    }
    let found = match &arguments.name {
        None => library.iter().collect(),
        Some(name) => vec![find(&library, name).map_err(|failure| failure.told_as_json(arguments.json))?],
    };
    if arguments.json {
        return say_json(&found.iter().map(|effect| document(effect)).collect());
    }
    match (&arguments.name, found.as_slice()) {
        (Some(_), [effect]) => say(&text(&Page::of(effect))),
        _ => say(&catalogue(&found)),
    }
}

/// The effects of the program, and those of a folder.
pub(super) fn known(folder: Option<&Path>) -> Result<Library, Failure> {
    let library = Library::shipped();
    match folder {
        None => Ok(library),
        Some(folder) => Ok(library.and_folder(folder).inspect(tell_notes)?),
    }
}

/// Says on standard error what is odd about the effects of a folder.
fn tell_notes(library: &Library) {
    library.notes().iter().for_each(|note| tell(&format!("note: {note}")));
}

fn find<'l>(library: &'l Library, name: &str) -> Result<&'l Effect, Failure> {
    library.get(name).ok_or_else(|| {
        let known: Vec<_> = library.iter().map(|effect| effect.name.as_str()).collect();
        let hint = suggestion(name, &known).unwrap_or_default();
        Failure::usage(format!("there is no effect \"{name}\"; {hint}"))
    })
}

fn catalogue(effects: &[&Effect]) -> String {
    let mut table = Table::new(["effect", "at", "law"]);
    for effect in effects {
        let mut places: Vec<_> = effect.forms.iter().map(|form| form.at.word()).collect();
        places.dedup();
        table.row([effect.name.clone(), places.join(", "), effect.law.clone()]);
    }
    format!("{}\n`patchcord effects NAME` tells all about one.\n", table.text())
}

fn text(page: &Page) -> String {
    let mut text = format!("{}: {}\n\n{}\n\n", page.name, page.title, page.physics);
    for (what, told) in &page.facts {
        text += &format!("{what:<8}{told}\n");
    }
    let tables = [
        Table::told(Page::PARAMETERS, &page.parameters),
        Table::told(Page::FORMS, &page.forms),
        Table::told(Page::ALIASES, &page.aliases),
    ];
    for table in tables.iter().filter(|table| !table.is_empty()) {
        text += &format!("\n{table}");
    }
    text
}

fn document(effect: &Effect) -> Value {
    let page = Page::of(effect);
    let parameters = effect.parameters.iter().map(|(name, own)| {
        json!({
            "name": name, "reach": own.reach.text(), "range": own.range, "none": own.none, "description": own.description,
        })
    });
    let forms = effect.forms.iter().map(|form| {
        let reads: Vec<_> = form.reads.iter().map(|reads| reads.word()).collect();
        let gives: Vec<_> = form.gives.iter().map(|(gives, _)| gives.word()).collect();
        json!({"at": form.at.word(), "reads": reads, "gives": gives, "parameters": form.parameters, "note": form.note})
    });
    let aliases = effect.aliases.iter().map(|(name, when)| (name.clone(), json!(when)));
    json!({
        "name": page.name, "title": page.title, "law": effect.law, "physics": page.physics, "source": effect.source,
        "excitation": effect.excitation, "aliases": aliases.collect::<Map<_, _>>(),
        "parameters": parameters.collect::<Vec<_>>(), "forms": forms.collect::<Vec<_>>(),
    })
}
