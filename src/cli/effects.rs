//! `patchcord effects`
//!
//! The command lists the effects of the library, or describes one. A folder of effects is checked completely, so
//! `patchcord effects --effects DIR` tests the files of that folder.

use std::path::{Path, PathBuf};

use clap::Args;
use indexmap::IndexMap;
use serde::Serialize;

use super::failure::Failure;
use super::table::Table;
use super::{eprint, print, print_json};
use patchcord::document::suggestion;
use patchcord::ident::effects::{Effect, EffectParameter, Form, Library};
use patchcord::ident::report::effect_page::{EffectPage, library_markdown};

#[derive(Args)]
pub(super) struct Arguments {
    /// Describe this effect
    name: Option<String>,
    /// Also use the effects of this folder: one in each .json file
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
    let library = effect_library(arguments.effects.as_deref())?;
    if arguments.markdown {
        return print(&library_markdown(&library));
    }
    let found = match &arguments.name {
        None => library.iter().collect(),
        Some(name) => vec![find(&library, name)?],
    };
    if arguments.json {
        let documents: Vec<_> = found.iter().map(|effect| EffectDocument::of(effect)).collect();
        return print_json(&documents);
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
        let mut attachments: Vec<_> = effect.forms.iter().map(|form| form.attachment.word()).collect();
        attachments.dedup();
        table.row([effect.name.clone(), attachments.join(", "), effect.law.clone()]);
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

/// An effect for `--json`. `aliases` maps the names of effects to conditions.
#[derive(Serialize)]
struct EffectDocument<'a> {
    name: &'a str,
    title: &'a str,
    law: &'a str,
    physics: &'a str,
    source: &'a str,
    excitation: &'a str,
    aliases: IndexMap<&'a str, &'a str>,
    parameters: Vec<ParameterDocument<'a>>,
    forms: Vec<FormDocument<'a>>,
}

/// A parameter of an effect. The range is in reaches. `none` is the value without effect, in reaches.
#[derive(Serialize)]
struct ParameterDocument<'a> {
    name: &'a str,
    reach: &'a str,
    range: [f64; 2],
    #[serde(rename = "none")]
    null_value: Option<f64>,
    description: &'a str,
}

/// A form of an effect.
#[derive(Serialize)]
struct FormDocument<'a> {
    #[serde(rename = "at")]
    attachment: &'static str,
    reads: Vec<&'static str>,
    gives: Vec<&'static str>,
    parameters: &'a [String],
    note: &'a str,
}

impl<'a> EffectDocument<'a> {
    /// The document of an effect.
    fn of(effect: &'a Effect) -> Self {
        let aliases = effect.aliases.iter();
        let parameters = effect.parameters.iter();
        EffectDocument {
            name: &effect.name,
            title: &effect.title,
            law: &effect.law,
            physics: &effect.physics,
            source: &effect.source,
            excitation: &effect.excitation,
            aliases: aliases.map(|(name, condition)| (name.as_str(), condition.as_str())).collect(),
            parameters: parameters.map(ParameterDocument::of).collect(),
            forms: effect.forms.iter().map(FormDocument::of).collect(),
        }
    }
}

impl<'a> ParameterDocument<'a> {
    fn of((name, parameter): (&'a String, &'a EffectParameter)) -> Self {
        ParameterDocument {
            name,
            reach: parameter.reach.text(),
            range: parameter.range,
            null_value: parameter.null_value,
            description: &parameter.description,
        }
    }
}

impl<'a> FormDocument<'a> {
    fn of(form: &'a Form) -> Self {
        FormDocument {
            attachment: form.attachment.word(),
            reads: form.reads.iter().map(|role| role.word()).collect(),
            gives: form.gives.iter().map(|(role, _)| role.word()).collect(),
            parameters: &form.parameters,
            note: &form.note,
        }
    }
}
