//! `patchcord check`
//!
//! The check runs no time. It reads the patch, compiles it and computes the machine at initial condition, the "problem
//! check" of the period. So overloads at the start, unsolvable loops and missing run settings appear before the first
//! run.

use clap::Args;
use indexmap::IndexMap;
use serde_json::{Value, json};

use super::failure::{Failure, plural};
use super::load::{LoadedPatch, PatchArguments, parameters_json, problem_check};
use super::overloads::{overload_json, overload_text};
use super::table::Table;
use super::times::advice;
use super::{print, print_json};
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
    /// Print the check of amplitude scaling (computer gain = input scale x block gain / output scale)
    #[arg(long)]
    scaling: bool,
    /// Print the voltages at initial condition (problem check)
    #[arg(long)]
    voltages: bool,
}

/// Tables of voltages and scaling follow the summary on request. Overloads at initial condition do not fail the
/// command.
pub(super) fn check(arguments: &Arguments) -> Result<(), Failure> {
    let LoadedPatch { circuit, program } = arguments.patch.load()?;
    let problem = check_problem(&circuit, &program)
        .map_err(|failure| failure.with_json_output(arguments.patch.json))?;
    if arguments.patch.json {
        return print_json(&document(&circuit, &program, &problem));
    }
    print(&summary(&circuit, &program, &problem.overloads))?;
    if arguments.voltages {
        print(&format!("\n{}", voltage_table(&problem.voltages)))?;
    }
    if arguments.scaling {
        print(&format!("\n{}", scaling_table(&circuit.scaling())))?;
    }
    Ok(())
}

/// The result of the problem check: the machine at initial condition.
///
/// Voltages are in the order of the elements of the circuit.
struct ProblemCheck {
    /// The output voltages of all elements and drives.
    voltages: Vec<ElementVoltage>,
    /// The overloads at initial condition.
    overloads: Vec<Overload>,
}

/// The voltage of an element at initial condition.
struct ElementVoltage {
    /// The name of the element.
    element: String,
    /// The kind of the element, such as "summer".
    kind: &'static str,
    /// The voltage of its output.
    volts: f64,
    /// The position of a relay or switch.
    position: Option<&'static str>,
}

/// Computes all voltages at initial condition.
///
/// # Errors
/// If the machine cannot be set to initial condition, for example because a loop has no solution.
fn check_problem(circuit: &Circuit, program: &Program) -> Result<ProblemCheck, Failure> {
    let machine = problem_check(circuit, program)?;
    let mut voltages = Vec::new();
    for element in circuit.elements() {
        let volts = machine.voltage(&element.name)?;
        let position = machine.position(&element.name);
        let (element, kind) = (element.name.clone(), element.kind.name);
        voltages.push(ElementVoltage { element, kind, volts, position });
    }
    Ok(ProblemCheck { voltages, overloads: machine.overloads() })
}

/// The summary: warnings, machine parts, macros, loops, overloads, and why a run is impossible.
///
/// Lines that do not apply are left out. The last line, "cannot be run: ...", concerns a run without options.
fn summary(circuit: &Circuit, program: &Program, overloads: &[Overload]) -> String {
    let patch = circuit.patch();
    let mut text = format!("{}: {}\n", patch.file(), verdict(circuit.warnings().warning_count()));
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
        text += &format!("{}\n", overload_text(order, overload));
    }
    if let Some(error) = run_error(circuit, program) {
        text += &format!("cannot be run: {}\n", run_error_text(&error));
    }
    text
}

/// The error of a run as the patch specifies it; None if it can be run.
///
/// A patch without run settings is valid, because options can specify them.
fn run_error(circuit: &Circuit, program: &Program) -> Option<RunError> {
    RunSettings::of(circuit).and_then(|settings| solve::check(program, &settings)).err()
}

/// The message of an error, with the option of `patchcord run` that helps.
fn run_error_text(error: &RunError) -> String {
    match advice(error) {
        Some(advice) => format!("{error}; with `patchcord run`, {advice}"),
        None => error.to_string(),
    }
}

/// The macros that are used, with their instances.
///
/// Macros without an instance are left out. The order is that of the document.
fn instances(circuit: &Circuit) -> Vec<(&str, Vec<(&str, &Instance)>)> {
    let patch = circuit.patch();
    let mut of: IndexMap<&str, Vec<_>> =
        patch.macros.keys().map(|name| (name.as_str(), Vec::new())).collect();
    for (name, instance) in &patch.instances {
        of[instance.macro_name.as_str()].push((name.as_str(), instance));
    }
    of.into_iter().filter(|(_, instances)| !instances.is_empty()).collect()
}

/// Errors never reach this function: a patch with errors is not loaded.
fn verdict(warnings: usize) -> String {
    match warnings {
        0 => "nothing wrong".to_owned(),
        some => format!("no errors, {}", plural(some as u64, "warning")),
    }
}

/// The table of voltages, with positions if an element has one.
fn voltage_table(voltages: &[ElementVoltage]) -> String {
    let heading = if voltages.iter().any(|read| read.position.is_some()) { "position" } else { "" };
    let mut table = Table::new(["element", "kind", "volts", heading]);
    for read in voltages {
        let position = read.position.unwrap_or_default().to_owned();
        table.row([read.element.clone(), read.kind.to_owned(), format!("{:.4}", read.volts + 0.0), position]);
    }
    table.text()
}

/// The table of amplitude scaling.
///
/// The computer gain should be input scale x block gain / output scale. The last two columns are empty for elements
/// whose block gain the patch does not specify.
fn scaling_table(rows: &[ScalingRow]) -> String {
    let headings = [
        "element",
        "from",
        "to",
        "computer gain",
        "block gain",
        "unit",
        "block",
        "required gain",
        "difference",
    ];
    let mut table = Table::new(headings);
    for row in rows {
        table.row([
            row.element.clone(),
            row.input.clone(),
            row.output.clone(),
            format!("{:.6}", row.computer_gain),
            format!("{:.6e}", row.block_gain),
            row.unit.clone(),
            row.block.clone().unwrap_or_default(),
            row.expected_gain.map(|wanted| format!("{wanted:.6}")).unwrap_or_default(),
            row.relative_error()
                .map(|difference| format!("{:.2} %", 100.0 * difference + 0.0))
                .unwrap_or_default(),
        ]);
    }
    table.text()
}

/// The result as JSON.
///
/// Keys: `ok`, `patch`, `title`, `machine`, `diagnostics`, `parameters`, `parts` (`part`, `used`, `owned`), `macros`,
/// `loops` (lists of names), `cannot_be_run` (`code` and `error`, or null), `overloads`, `voltages`, `scaling`. It has
/// all tables, whatever the options.
fn document(circuit: &Circuit, program: &Program, problem: &ProblemCheck) -> Value {
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
        "cannot_be_run": run_error(circuit, program)
            .map(|error| json!({"code": error.code(), "error": run_error_text(&error)})),
        "overloads": problem.overloads.iter().map(overload_json).collect::<Value>(),
        "voltages": problem.voltages.iter().map(|read| json!({
            "element": read.element, "kind": read.kind, "volts": read.volts, "position": read.position,
        })).collect::<Value>(),
        "scaling": circuit.scaling().iter().map(row_json).collect::<Value>(),
    })
}

/// `inputs` maps ports to driving outputs, null for an open port. `outputs` maps ports to elements. `elements` are the
/// names of its members.
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

/// Scales are physical units per volt. `difference` is relative; it is null without a wanted gain.
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
        "wanted_computer_gain": row.expected_gain,
        "difference": row.relative_error(),
    })
}
