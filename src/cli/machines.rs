//! `patchcord machines`

use clap::Args;
use serde_json::{Map, Value, json};

use super::failure::Failure;
use super::{print, print_json};
use patchcord::machines::{ALL, Machine, Part, REFERENCE};

#[derive(Args)]
pub(super) struct Arguments {
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

pub(super) fn machines(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.json {
        return print_json(&ALL.iter().map(|machine| machine_json(machine)).collect());
    }
    let pages: Vec<_> = ALL.iter().map(|machine| page(machine)).collect();
    print(&pages.join("\n"))
}

/// The description of a machine.
fn page(machine: &Machine) -> String {
    let parts = match machine.inventory {
        None => "any number".to_owned(),
        Some(parts) => {
            let counts = parts.iter().map(|(part, count)| format!("{count} {}", part.noun()));
            counts.collect::<Vec<_>>().join(", ")
        }
    };
    format!(
        "{}: {}\n  parts             {parts}\n  summer gains      {}\n  integrator gains  {}\n  source            {}\n",
        machine.name,
        machine.title,
        gains(machine.summer_gains),
        gains(machine.integrator_gains),
        machine.source,
    )
}

/// The available gains of an amplifier's inputs: "x1, x10".
fn gains(gains: &[f64]) -> String {
    if gains.is_empty() {
        return "any".to_owned();
    }
    gains.iter().map(|gain| format!("x{gain}")).collect::<Vec<_>>().join(", ")
}

fn machine_json(machine: &Machine) -> Value {
    let parts: Map<_, _> =
        Part::ALL.iter().map(|part| (part.key().to_owned(), json!(machine.count(*part)))).collect();
    json!({
        "name": machine.name,
        "title": machine.title,
        "source": machine.source,
        "reference": REFERENCE,
        "parts": parts,
        "summer_gains": machine.summer_gains,
        "integrator_gains": machine.integrator_gains,
    })
}
