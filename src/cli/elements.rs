//! `patchcord elements`

use clap::Args;
use serde_json::{Value, json};

use super::failure::Failure;
use super::table::Table;
use super::{say, say_json};
use patchcord::elements::{Default, Family, Input, Jacks, Kind, Measure, REGISTRY, Setting};
use patchcord::patch::{json_schema, suggestion};

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
}

pub(super) fn elements(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.schema {
        return say_json(&json_schema());
    }
    let kinds = match &arguments.name {
        None => REGISTRY.to_vec(),
        Some(name) => vec![find(name).map_err(|failure| failure.told_as_json(arguments.json))?],
    };
    if arguments.json {
        return say_json(&kinds.iter().map(|kind| kind_json(kind)).collect());
    }
    match (&arguments.name, kinds.as_slice()) {
        (Some(_), [kind]) => say(&page(kind)),
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
        table.row([kind.name.to_owned(), section(kind.family).to_owned(), kind.summary.to_owned()]);
    }
    format!("{}\n`patchcord elements NAME` tells all about one.\n", table.text())
}

/// The section of a document where a family stands.
fn section(family: Family) -> &'static str {
    match family {
        Family::Computing => "elements",
        Family::Drive => "drives",
        Family::Reference => "cords",
    }
}

fn page(kind: &Kind) -> String {
    let mut text = format!("{}: {}\n\n", kind.name, kind.summary);
    text += &format!("law       {}\noverload  {}\nmodes     {}\n", kind.law, kind.overload, kind.modes);
    text += &format!("source    {}\n", kind.source);
    if !kind.parts.is_empty() {
        text += &format!("parts     {}\n", parts(kind).join(", "));
    }
    let mut inputs = Table::new(["input", "cords", "what it is for"]);
    for input in kind.inputs {
        inputs.row([jack(input), cords(input), input.description.to_owned()]);
    }
    let mut settings = Table::new(["setting", "unit", "default", "range", "what it does"]);
    for setting in kind.settings {
        settings.row([
            setting.name.to_owned(),
            setting.unit().to_owned(),
            default(setting),
            range(setting),
            setting.description.to_owned(),
        ]);
    }
    for table in [inputs.text(), settings.text()] {
        if !table.is_empty() {
            text += &format!("\n{table}");
        }
    }
    text
}

fn parts(kind: &Kind) -> Vec<String> {
    let told = kind.parts.iter().map(|takes| {
        let with = if takes.with.is_empty() { String::new() } else { format!(" with \"{}\"", takes.with) };
        format!("{}{with}", takes.part.counted(takes.count))
    });
    told.collect()
}

fn jack(input: &Input) -> String {
    if input.jacks == Jacks::Gains {
        format!("{}1, {}10, ...", input.name, input.name)
    } else {
        input.name.to_owned()
    }
}

fn cords(input: &Input) -> String {
    let count = match input.jacks {
        Jacks::One => "1".to_owned(),
        Jacks::Exactly(count) => count.to_string(),
        Jacks::Any | Jacks::Gains => "any number".to_owned(),
    };
    if input.required { count } else { format!("{count}, or none") }
}

fn default(setting: &Setting) -> String {
    match (setting.default, setting.measure) {
        (Default::Required, _) => "must be given".to_owned(),
        (Default::Absent, _) => "none".to_owned(),
        (Default::Number(number), Measure::Flag) => (number != 0.0).to_string(),
        (Default::Number(number), _) => number.to_string(),
    }
}

fn range(setting: &Setting) -> String {
    match setting.measure {
        Measure::Flag => String::new(),
        Measure::Choice(words) => words.join(", "),
        _ => match setting.range {
            (f64::MIN, f64::MAX) => "any".to_owned(),
            (low, f64::MAX) => format!("{low} or more"),
            (low, high) => format!("{low} ... {high}"),
        },
    }
}

fn kind_json(kind: &Kind) -> Value {
    json!({
        "name": kind.name,
        "section": section(kind.family),
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
            "cords": cords(input),
            "required": input.required,
            "description": input.description,
        })).collect::<Value>(),
        "settings": kind.settings.iter().map(|setting| json!({
            "name": setting.name,
            "unit": setting.unit(),
            "default": default(setting),
            "range": range(setting),
            "description": setting.description,
        })).collect::<Value>(),
    })
}
