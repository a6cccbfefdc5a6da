//! `patchcord check`

use clap::Args;
use indexmap::IndexMap;
use serde_json::{Value, json};

use super::failure::{Failure, plural};
use super::load::{Loaded, PatchArguments, parameters_json, problem_check};
use super::overloads::{overload_json, overload_told};
use super::table::Table;
use super::times::advice;
use super::{say, say_json};
use patchcord::circuit::{Circuit, ScalingRow};
use patchcord::document::Report;
use patchcord::ir::Program;
use patchcord::patch::Instance;
use patchcord::solve::{self, RunError, RunSettings};
use patchcord::trace::Overload;

#[derive(Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    patch: PatchArguments,
    /// Print the audit of amplitude scaling (computer gain = input scale x block gain / output scale)
    #[arg(long)]
    scaling: bool,
    /// Print the voltages in initial condition (problem check)
    #[arg(long)]
    voltages: bool,
}

pub(super) fn check(arguments: &Arguments) -> Result<(), Failure> {
    let Loaded { circuit, program } = arguments.patch.load()?;
    let statics =
        statics(&circuit, &program).map_err(|failure| failure.told_as_json(arguments.patch.json))?;
    if arguments.patch.json {
        return say_json(&document(&circuit, &program, &statics));
    }
    say(&summary(&circuit, &program, &statics.overloads))?;
    if arguments.voltages {
        say(&format!("\n{}", voltage_table(&statics.voltages)))?;
    }
    if arguments.scaling {
        say(&format!("\n{}", scaling_table(&circuit.scaling())))?;
    }
    Ok(())
}

/// What the problem check shows.
struct Statics {
    voltages: Vec<Static>,
    /// The lamps that are lit.
    overloads: Vec<Overload>,
}

/// A voltage of the problem check.
struct Static {
    element: String,
    kind: &'static str,
    volts: f64,
    position: Option<&'static str>,
}

fn statics(circuit: &Circuit, program: &Program) -> Result<Statics, Failure> {
    let machine = problem_check(circuit, program)?;
    let mut voltages = Vec::new();
    for element in circuit.elements() {
        let volts = machine.voltage(&element.name)?;
        let position = machine.position(&element.name);
        voltages.push(Static { element: element.name.clone(), kind: element.kind.name, volts, position });
    }
    Ok(Statics { voltages, overloads: machine.overloads() })
}

fn summary(circuit: &Circuit, program: &Program, overloads: &[Overload]) -> String {
    let patch = circuit.patch();
    let mut text = format!("{}: {}\n", patch.file(), verdict(circuit.warnings().warnings()));
    if !patch.title.is_empty() {
        text += &format!("{}\n", patch.title);
    }
    let machine = circuit.machine();
    let parts = circuit.parts().iter().map(|(part, used)| match machine.count(*part) {
        Some(owned) => format!("{used} of {owned} {}", part.noun()),
        None => part.counted(*used),
    });
    let named = if machine.inventory.is_some() { "" } else { " machine" };
    text += &format!("on the {}{named}: {}\n", machine.name, parts.collect::<Vec<_>>().join(", "));
    for (name, instances) in instances(circuit) {
        let names: Vec<_> = instances.iter().map(|(name, _)| *name).collect();
        text += &format!("macro {name}: {}\n", names.join(", "));
    }
    for entry in program.loops() {
        text += &format!("loop without an integrator, one solution: {}\n", entry.members.join(", "));
    }
    for (order, overload) in overloads.iter().enumerate() {
        text += &format!("{}\n", overload_told(order, overload));
    }
    if let Some(error) = unready(circuit, program) {
        text += &format!("cannot be run as it stands: {}\n", what_run_needs(&error));
    }
    text
}

/// What a run as the patch asks for it would be refused for.
fn unready(circuit: &Circuit, program: &Program) -> Option<RunError> {
    RunSettings::of(circuit).and_then(|settings| solve::check(program, &settings)).err()
}

/// What an error says, and which option of another command helps.
fn what_run_needs(error: &RunError) -> String {
    match advice(error) {
        Some(advice) => format!("{error}; to `patchcord run` {advice}"),
        None => error.to_string(),
    }
}

/// The macros that are used, with their instances.
fn instances(circuit: &Circuit) -> Vec<(&str, Vec<(&str, &Instance)>)> {
    let patch = circuit.patch();
    let mut of: IndexMap<&str, Vec<_>> =
        patch.macros.keys().map(|name| (name.as_str(), Vec::new())).collect();
    for (name, instance) in &patch.instances {
        of[instance.of.as_str()].push((name.as_str(), instance));
    }
    of.into_iter().filter(|(_, instances)| !instances.is_empty()).collect()
}

fn verdict(warnings: usize) -> String {
    match warnings {
        0 => "nothing wrong".to_owned(),
        some => format!("no errors, {}", plural(some as u64, "warning")),
    }
}

fn voltage_table(voltages: &[Static]) -> String {
    let heading = if voltages.iter().any(|read| read.position.is_some()) { "position" } else { "" };
    let mut table = Table::new(["element", "kind", "volts", heading]);
    for read in voltages {
        let position = read.position.unwrap_or_default().to_owned();
        table.row([read.element.clone(), read.kind.to_owned(), format!("{:.4}", read.volts + 0.0), position]);
    }
    table.text()
}

fn scaling_table(rows: &[ScalingRow]) -> String {
    let mut table =
        Table::new(["at", "from", "to", "computer gain", "block", "unit", "is", "asked for", "difference"]);
    for row in rows {
        table.row([
            row.element.clone(),
            row.input.clone(),
            row.output.clone(),
            format!("{:.6}", row.computer_gain),
            format!("{:.6e}", row.block_gain),
            row.unit.clone(),
            row.block.clone().unwrap_or_default(),
            row.wanted.map(|wanted| format!("{wanted:.6}")).unwrap_or_default(),
            row.difference()
                .map(|difference| format!("{:.2} %", 100.0 * difference + 0.0))
                .unwrap_or_default(),
        ]);
    }
    table.text()
}

fn document(circuit: &Circuit, program: &Program, statics: &Statics) -> Value {
    let warnings: Report = circuit.warnings();
    json!({
        "ok": true,
        "patch": circuit.patch().file(),
        "title": circuit.patch().title,
        "machine": circuit.machine().name,
        "diagnostics": warnings.to_json(),
        "parameters": parameters_json(circuit),
        "parts": circuit.parts().iter().map(|(part, used)| json!({
            "part": part.key(), "used": used, "owned": circuit.machine().count(*part),
        })).collect::<Value>(),
        "macros": instances(circuit).iter().map(|(name, instances)| json!({
            "macro": name,
            "instances": instances.iter().map(|(name, instance)| instance_json(name, instance)).collect::<Value>(),
        })).collect::<Value>(),
        "loops": program.loops().iter().map(|entry| json!(entry.members)).collect::<Value>(),
        "cannot_be_run": unready(circuit, program)
            .map(|error| json!({"code": error.code(), "error": what_run_needs(&error)})),
        "overloads": statics.overloads.iter().map(overload_json).collect::<Value>(),
        "voltages": statics.voltages.iter().map(|read| json!({
            "element": read.element, "kind": read.kind, "volts": read.volts, "position": read.position,
        })).collect::<Value>(),
        "scaling": circuit.scaling().iter().map(row_json).collect::<Value>(),
    })
}

fn instance_json(name: &str, instance: &Instance) -> Value {
    let inputs = instance.inputs.iter().map(|(port, inlet)| (port.clone(), json!(inlet.driver)));
    let outputs = instance.outputs.iter().map(|(port, element)| (port.clone(), json!(element)));
    json!({
        "name": name,
        "inputs": Value::Object(inputs.collect()),
        "outputs": Value::Object(outputs.collect()),
        "elements": instance.members,
    })
}

fn row_json(row: &ScalingRow) -> Value {
    json!({
        "element": row.element,
        "input": row.input,
        "output": row.output,
        "computer_gain": row.computer_gain,
        "input_scale": row.input_scale,
        "output_scale": row.output_scale,
        "block_gain": row.block_gain,
        "unit": row.unit,
        "block": row.block,
        "wanted_computer_gain": row.wanted,
        "difference": row.difference(),
    })
}
