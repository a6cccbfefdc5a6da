//! `patchcord machines`

use clap::Args;
use indexmap::IndexMap;
use serde::Serialize;

use super::failure::Failure;
use super::{print, print_json};
use patchcord::machines::{ALL, MachineModel, Part, REFERENCE};

#[derive(Args)]
pub(super) struct Arguments {
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

pub(super) fn machines(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.json {
        let documents: Vec<_> = ALL.iter().map(|machine| MachineDocument::of(machine)).collect();
        return print_json(&documents);
    }
    let pages: Vec<_> = ALL.iter().map(|machine| page(machine)).collect();
    print(&pages.join("\n"))
}

/// The description of a machine.
fn page(machine: &MachineModel) -> String {
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

/// A machine for `--json`. `parts` maps the keys of parts to their numbers, null without a limit. `reference` is in
/// volts.
#[derive(Serialize)]
struct MachineDocument {
    name: &'static str,
    title: &'static str,
    source: &'static str,
    reference: f64,
    parts: IndexMap<&'static str, Option<usize>>,
    summer_gains: &'static [f64],
    integrator_gains: &'static [f64],
}

impl MachineDocument {
    /// The document of a machine.
    fn of(machine: &MachineModel) -> Self {
        MachineDocument {
            name: machine.name,
            title: machine.title,
            source: machine.source,
            reference: REFERENCE,
            parts: Part::ALL.iter().map(|part| (part.key(), machine.count(*part))).collect(),
            summer_gains: machine.summer_gains,
            integrator_gains: machine.integrator_gains,
        }
    }
}
