//! `patchcord elements`
//!
//! Everything is generated from the table of elements (`REGISTRY`): the catalogue, the page of one element, the JSON
//! document, the schema and the Markdown reference.

use clap::Args;
use serde::Serialize;

use super::failure::Failure;
use super::table::Table;
use super::{print, print_json};
use patchcord::document::suggestion;
use patchcord::elements::{Family, Input, Kind, KindPage, REGISTRY, Setting, kind_advice, reference_page};
use patchcord::patch::json_schema;

#[derive(Args)]
pub(super) struct Arguments {
    /// Describe this element or drive
    name: Option<String>,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
    /// Print the JSON Schema of patch documents, generated from the table of elements
    #[arg(long, conflicts_with_all = ["name", "json"])]
    schema: bool,
    /// Print every page as one Markdown document
    #[arg(long, conflicts_with_all = ["name", "json", "schema"])]
    markdown: bool,
}

/// An unknown name is an error in the command line, with the most similar name as a hint.
pub(super) fn elements(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.schema {
        return print_json(&json_schema());
    }
    if arguments.markdown {
        return print(&reference_page());
    }
    let kinds = match &arguments.name {
        None => REGISTRY.to_vec(),
        Some(name) => vec![find(name)?],
    };
    if arguments.json {
        let documents: Vec<_> = kinds.iter().map(|kind| KindDocument::of(kind)).collect();
        return print_json(&documents);
    }
    match (&arguments.name, kinds.as_slice()) {
        (Some(_), [kind]) => print(&text(&KindPage::of(kind))),
        _ => print(&catalogue(&kinds)),
    }
}

/// The element or drive with this name.
fn find(name: &str) -> Result<&'static Kind, Failure> {
    let found = REGISTRY.iter().copied().find(|kind| kind.name == name);
    found.ok_or_else(|| {
        let advice =
            [Family::Computing, Family::Drive].into_iter().find_map(|family| kind_advice(family, name));
        let known: Vec<_> = REGISTRY.iter().map(|kind| kind.name).collect();
        let hint = advice.map(str::to_owned).or_else(|| suggestion(name, &known)).unwrap_or_default();
        Failure::usage(format!("there is no element or drive \"{name}\"; {hint}"))
    })
}

/// The table of elements and drives.
fn catalogue(kinds: &[&Kind]) -> String {
    let mut table = Table::new(["kind", "in", "what it is"]);
    for kind in kinds {
        table.row([kind.name.to_owned(), kind.family.section().to_owned(), kind.summary.to_owned()]);
    }
    format!("{}\n`patchcord elements NAME` describes one of them.\n", table.text())
}

/// The page of an element as text.
fn text(page: &KindPage) -> String {
    let mut text = format!("{}: {}\n\n", page.name, page.summary);
    for (what, fact) in &page.facts {
        text += &format!("{what:<10}{fact}\n");
    }
    let tables = [
        Table::from_rows(KindPage::INPUTS, &page.inputs),
        Table::from_rows(KindPage::SETTINGS, &page.settings),
    ];
    for table in tables {
        if !table.is_empty() {
            text += &format!("\n{table}");
        }
    }
    text
}

/// An element or drive for `--json`. `section` is that of patches. Without a name, the command prints a list of such
/// objects.
#[derive(Serialize)]
struct KindDocument {
    name: &'static str,
    section: &'static str,
    summary: &'static str,
    law: &'static str,
    overload: &'static str,
    modes: &'static str,
    source: &'static str,
    symbol: &'static str,
    parts: Vec<PartDocument>,
    inputs: Vec<InputDocument>,
    settings: Vec<SettingDocument>,
}

/// A part of a machine that an element uses. `with` names the input or setting that needs it; it may be empty.
#[derive(Serialize)]
struct PartDocument {
    part: &'static str,
    count: usize,
    with: &'static str,
}

/// An input of an element.
#[derive(Serialize)]
struct InputDocument {
    name: &'static str,
    cords: String,
    required: bool,
    description: &'static str,
}

/// A setting of an element. Range and default are texts, because a default can be a formula.
#[derive(Serialize)]
struct SettingDocument {
    name: &'static str,
    unit: &'static str,
    default: String,
    range: String,
    description: &'static str,
}

impl KindDocument {
    /// The document of an element or drive.
    fn of(kind: &Kind) -> Self {
        let parts = kind.parts.iter();
        KindDocument {
            name: kind.name,
            section: kind.family.section(),
            summary: kind.summary,
            law: kind.law,
            overload: kind.overload,
            modes: kind.modes,
            source: kind.source,
            symbol: kind.symbol,
            parts: parts
                .map(|part| PartDocument { part: part.part.key(), count: part.count, with: part.with })
                .collect(),
            inputs: kind.inputs.iter().map(InputDocument::of).collect(),
            settings: kind.settings.iter().map(SettingDocument::of).collect(),
        }
    }
}

impl InputDocument {
    fn of(input: &Input) -> Self {
        let Input { name, required, description, .. } = *input;
        InputDocument { name, cords: input.cords_text(), required, description }
    }
}

impl SettingDocument {
    fn of(setting: &Setting) -> Self {
        SettingDocument {
            name: setting.name,
            unit: setting.unit(),
            default: setting.default_text(),
            range: setting.range_text(),
            description: setting.description,
        }
    }
}
