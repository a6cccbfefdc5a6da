//! `patchcord elements`

use clap::Args;
use serde_json::{Value, json};

use super::failure::Failure;
use super::table::Table;
use super::{say, say_json};
use patchcord::document::suggestion;
use patchcord::elements::{Kind, Page, REGISTRY, reference_page};
use patchcord::patch::json_schema;

#[derive(Args)]
pub(super) struct Arguments {
    /// Tell all about this one
    name: Option<String>,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
    /// Print the JSON Schema of patch documents, made from the table of elements
    #[arg(long, conflicts_with_all = ["name", "json"])]
    schema: bool,
    /// Print every page as one Markdown document
    #[arg(long, conflicts_with_all = ["name", "json", "schema"])]
    markdown: bool,
}

pub(super) fn elements(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.schema {
        return say_json(&json_schema());
    }
    if arguments.markdown {
        return say(&reference_page());
    }
    let kinds = match &arguments.name {
        None => REGISTRY.to_vec(),
        Some(name) => vec![find(name).map_err(|failure| failure.told_as_json(arguments.json))?],
    };
    if arguments.json {
        return say_json(&kinds.iter().map(|kind| kind_json(kind)).collect());
    }
    match (&arguments.name, kinds.as_slice()) {
        (Some(_), [kind]) => say(&text(&Page::of(kind))),
        _ => say(&catalogue(&kinds)),
    }
}

fn find(name: &str) -> Result<&'static Kind, Failure> {
    let found = REGISTRY.iter().copied().find(|kind| kind.name == name);
    found.ok_or_else(|| {
        let known: Vec<_> = REGISTRY.iter().map(|kind| kind.name).collect();
        let hint = suggestion(name, &known).unwrap_or_default();
        Failure::usage(format!("there is no element or drive \"{name}\"; {hint}"))
    })
}

fn catalogue(kinds: &[&Kind]) -> String {
    let mut table = Table::new(["kind", "in", "what it is"]);
    for kind in kinds {
        table.row([kind.name.to_owned(), kind.family.section().to_owned(), kind.summary.to_owned()]);
    }
    format!("{}\n`patchcord elements NAME` tells all about one.\n", table.text())
}

fn text(page: &Page) -> String {
    let mut text = format!("{}: {}\n\n", page.name, page.summary);
    for (what, told) in &page.facts {
        text += &format!("{what:<10}{told}\n");
    }
    for table in [Table::told(Page::INPUTS, &page.inputs), Table::told(Page::SETTINGS, &page.settings)] {
        if !table.is_empty() {
            text += &format!("\n{table}");
        }
    }
    text
}

fn kind_json(kind: &Kind) -> Value {
    json!({
        "name": kind.name,
        "section": kind.family.section(),
        "summary": kind.summary,
        "law": kind.law,
        "overload": kind.overload,
        "modes": kind.modes,
        "source": kind.source,
        "symbol": kind.symbol,
        "parts": kind.parts.iter().map(|takes| json!({
            "part": takes.part.key(), "count": takes.count, "with": takes.with,
        })).collect::<Value>(),
        "inputs": kind.inputs.iter().map(|input| json!({
            "name": input.name,
            "cords": input.cords_told(),
            "required": input.required,
            "description": input.description,
        })).collect::<Value>(),
        "settings": kind.settings.iter().map(|setting| json!({
            "name": setting.name,
            "unit": setting.unit(),
            "default": setting.default_told(),
            "range": setting.range_told(),
            "description": setting.description,
        })).collect::<Value>(),
    })
}
