//! `patchcord check`
//!
//! The check takes no problem time. It reads the patch, compiles it and computes the machine at initial condition, the
//! "problem check" of the period. So overloads at the start, unsolvable loops and missing run settings appear before
//! the first run.

use clap::Args;
use indexmap::IndexMap;
use serde::Serialize;

use super::failure::{Failure, eprint_report};
use super::load::{LoadedPatch, ParameterDocument, PatchArguments, problem_check};
use super::overloads::{OverloadDocument, overload_lines};
use super::start_warnings::start_warnings;
use super::table::Table;
use super::times::advice;
use super::{output_in_colour, print, print_coloured, print_json};
use patchcord::circuit::{Circuit, ScalingRow};
use patchcord::document::{Diagnostic, DiagnosticDocument, Report, escape_controls, plural};
use patchcord::equations::{Agreement, ComparedEquation, compare_equations, equation_findings};
use patchcord::ir::Program;
use patchcord::linear::{check_size, growth_warning};
use patchcord::patch::Instance;
use patchcord::solve::{self, BLOCK_SAMPLES, RunError, RunSettings};
use patchcord::trace::Overload;

#[derive(Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    patch: PatchArguments,
    /// Compare the gains of the wiring with the scales (computer gain = input scale x block gain / output scale)
    #[arg(long)]
    scaling: bool,
    /// Print the voltages at initial condition (problem check)
    #[arg(long)]
    voltages: bool,
}

/// Tables of voltages and scaling follow the summary on request. Overloads at initial condition do not fail the
/// command.
pub(super) fn check(arguments: &Arguments) -> Result<(), Failure> {
    let LoadedPatch { circuit, program, mut warnings } = arguments.patch.load()?;
    let compared = compare_equations(&circuit, &program);
    let mut further = check_equations(&circuit, &program, &compared)?;
    let problem = check_problem(&circuit, &program)?;
    further.extend(problem.growth.clone());
    further.extend(start_warnings(&circuit, &program));
    eprint_report(&Report::new(&warnings.file, circuit.patch().text(), further.clone()));
    warnings.findings.extend(further);
    if arguments.patch.json {
        let equations = EquationDocument::all(&circuit, &compared);
        return print_json(&Document::new(&circuit, &program, &warnings, &problem, equations));
    }
    print(&summary(&circuit, &program, &compared, &warnings))?;
    print_coloured(&overload_lines("", &problem.overloads, output_in_colour()))?;
    if let Some(error) = run_error(&circuit, &program) {
        print(&format!("cannot be run: {}\n", run_error_text(&error)))?;
    }
    if arguments.voltages {
        print(&format!("\n{}", voltage_table(&problem.voltages)))?;
    }
    if arguments.scaling {
        print(&format!("\n{}", scaling_table(&circuit.scaling())))?;
    }
    Ok(())
}

/// Compares the wiring with the equations that the patch states. Returns the warnings about them.
///
/// # Errors
/// If the wiring does not solve an equation. The report lists the changes that correct it.
fn check_equations(
    circuit: &Circuit,
    program: &Program,
    compared: &[ComparedEquation],
) -> Result<Vec<Diagnostic>, Failure> {
    let patch = circuit.patch();
    let report = Report::new(patch.file(), patch.text(), equation_findings(circuit, program, compared));
    if report.has_errors() { Err(Box::new(report).into()) } else { Ok(report.findings) }
}

/// A line about the equations of a patch, and one for each that holds under a condition.
fn equation_lines(circuit: &Circuit, compared: &[ComparedEquation]) -> String {
    let solved =
        compared.iter().filter(|compared| !matches!(compared.agreement, Agreement::Undecided(_))).count();
    let mut text = match (solved, compared.len()) {
        (_, 0) => return String::new(),
        (1, 1) => "the wiring solves its equation\n".to_owned(),
        (solved, all) if solved == all => format!("the wiring solves its {all} equations\n"),
        (solved, all) => {
            format!("the wiring solves {solved} of its {all} equations; the others are not compared\n")
        }
    };
    for compared in compared {
        if let Agreement::SolvedIf(conditions) = &compared.agreement {
            let equation = circuit.equations()[compared.index].value.text();
            text += &format!("  {equation}  if {}\n", conditions.join(" and "));
        }
    }
    text
}

/// The result of the problem check: the machine at initial condition.
///
/// Voltages are in the order of the elements of the circuit.
struct ProblemCheck {
    /// The output voltages of all elements and drives.
    voltages: Vec<ElementVoltage>,
    /// The overloads at initial condition.
    overloads: Vec<Overload>,
    /// The warning about a loop that amplifies deviations.
    growth: Option<Diagnostic>,
}

/// The voltage of an element at initial condition.
#[derive(Serialize)]
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
    let growth =
        if check_size(program).is_ok() { growth_warning(circuit, &machine.state_space()) } else { None };
    Ok(ProblemCheck { voltages, overloads: machine.overloads(), growth })
}

/// The summary: warnings, machine parts, macros and loops. Lines that do not apply are left out.
fn summary(circuit: &Circuit, program: &Program, compared: &[ComparedEquation], warnings: &Report) -> String {
    let patch = circuit.patch();
    let mut text = format!("{}: {}\n", escape_controls(patch.file()), verdict(warnings.warning_count()));
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
    text + &equation_lines(circuit, compared)
}

/// The error of a run as the patch specifies it; None if it can be run.
///
/// A patch without run settings is valid, because options can specify them. The line concerns a run without options.
fn run_error(circuit: &Circuit, program: &Program) -> Option<RunError> {
    // Without options `patchcord run` draws no pictures, so it does not keep the samples.
    let settings = RunSettings::of(circuit).map(|settings| settings.with_blocks(BLOCK_SAMPLES));
    settings.and_then(|settings| solve::check(program, &settings)).err()
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

/// The verdict of the check. A patch with errors is not loaded, so there are only warnings.
fn verdict(warnings: usize) -> String {
    match warnings {
        0 => "nothing wrong".to_owned(),
        some => format!("no errors, {}", plural(some as u64, "warning")),
    }
}

/// The table of voltages, with positions if an element has one.
fn voltage_table(voltages: &[ElementVoltage]) -> String {
    let heading = if voltages.iter().any(|entry| entry.position.is_some()) { "position" } else { "" };
    let mut table = Table::new(["element", "kind", "volts", heading]);
    for entry in voltages {
        let position = entry.position.unwrap_or_default().to_owned();
        let volts = format!("{:.4}", entry.volts + 0.0);
        table.row([entry.element.clone(), entry.kind.to_owned(), volts, position]);
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
            row.expected_gain.map(|gain| format!("{gain:.6}")).unwrap_or_default(),
            row.relative_error()
                .map(|difference| format!("{:.2} %", 100.0 * difference + 0.0))
                .unwrap_or_default(),
        ]);
    }
    table.text()
}

/// The result as JSON. It has all tables, whatever the options.
#[derive(Serialize)]
struct Document<'a> {
    ok: bool,
    patch: &'a str,
    title: &'a str,
    machine: &'static str,
    diagnostics: Vec<DiagnosticDocument>,
    parameters: Vec<ParameterDocument<'a>>,
    parts: Vec<PartDocument>,
    macros: Vec<MacroDocument<'a>>,
    /// The names of the members of each loop without an integrator.
    loops: Vec<&'a [String]>,
    /// Why a run without options is impossible; None if it is possible.
    cannot_be_run: Option<RunErrorDocument>,
    equations: Vec<EquationDocument<'a>>,
    overloads: Vec<OverloadDocument<'a>>,
    voltages: &'a [ElementVoltage],
    scaling: Vec<ScalingDocument>,
}

/// A stated equation and whether the wiring solves it.
#[derive(Serialize)]
struct EquationDocument<'a> {
    text: &'a str,
    /// "always", "within the range of a network", "for the present parameters" or "not compared".
    solved: &'static str,
    /// The conditions of the range, or the names of the parameters; the reason if it is not compared.
    details: Vec<String>,
}

impl<'a> EquationDocument<'a> {
    /// All stated equations of a circuit.
    fn all(circuit: &'a Circuit, compared: &[ComparedEquation]) -> Vec<Self> {
        let document = |compared: &ComparedEquation| {
            let (solved, details) = match &compared.agreement {
                Agreement::SolvedIf(conditions) => ("within the range of a network", conditions.clone()),
                Agreement::SolvedAt(parameters) => ("for the present parameters", parameters.clone()),
                Agreement::Undecided(reason) => ("not compared", vec![reason.clone()]),
                _ => ("always", Vec::new()),
            };
            EquationDocument { text: circuit.equations()[compared.index].value.text(), solved, details }
        };
        compared.iter().map(document).collect()
    }
}

/// A kind of part of the machine: how many the patch uses, and how many the machine has. `owned` is null without a
/// limit.
#[derive(Serialize)]
struct PartDocument {
    part: &'static str,
    used: usize,
    owned: Option<usize>,
}

/// A macro with its instances.
#[derive(Serialize)]
struct MacroDocument<'a> {
    #[serde(rename = "macro")]
    name: &'a str,
    instances: Vec<InstanceDocument<'a>>,
}

/// An instance of a macro. `inputs` maps ports to driving outputs, null for an open port. `outputs` maps ports to
/// elements.
#[derive(Serialize)]
struct InstanceDocument<'a> {
    name: &'a str,
    inputs: IndexMap<&'a str, Option<&'a str>>,
    outputs: IndexMap<&'a str, &'a str>,
    elements: &'a [String],
}

/// The code and the message of a run error.
#[derive(Serialize)]
struct RunErrorDocument {
    code: &'static str,
    error: String,
}

/// A row of the audit of amplitude scaling. Scales are physical units per volt. `difference` is relative; it is null
/// without a required gain.
#[derive(Serialize)]
struct ScalingDocument {
    element: String,
    input: String,
    output: String,
    computer_gain: f64,
    input_scale: f64,
    output_scale: f64,
    block_gain: f64,
    unit: String,
    block: Option<String>,
    #[serde(rename = "wanted_computer_gain")]
    expected_gain: Option<f64>,
    difference: Option<f64>,
}

impl<'a> Document<'a> {
    /// The document of a patch, its warnings and its problem check.
    fn new(
        circuit: &'a Circuit,
        program: &'a Program,
        warnings: &Report,
        problem: &'a ProblemCheck,
        equations: Vec<EquationDocument<'a>>,
    ) -> Self {
        let (patch, machine) = (circuit.patch(), circuit.machine());
        let parts = circuit.parts().iter().map(|(part, used)| PartDocument {
            part: part.key(),
            used: *used,
            owned: machine.count(*part),
        });
        let cannot_be_run = run_error(circuit, program)
            .map(|error| RunErrorDocument { code: error.code(), error: run_error_text(&error) });
        Document {
            ok: true,
            patch: patch.file(),
            title: &patch.title,
            machine: machine.name,
            diagnostics: warnings.documents(),
            parameters: ParameterDocument::all(circuit),
            parts: parts.collect(),
            macros: instances(circuit).into_iter().map(MacroDocument::of).collect(),
            loops: program.loops().iter().map(|entry| entry.members.as_slice()).collect(),
            cannot_be_run,
            equations,
            overloads: OverloadDocument::all(&problem.overloads),
            voltages: &problem.voltages,
            scaling: circuit.scaling().into_iter().map(ScalingDocument::of).collect(),
        }
    }
}

impl<'a> MacroDocument<'a> {
    fn of((name, instances): (&'a str, Vec<(&'a str, &'a Instance)>)) -> Self {
        MacroDocument { name, instances: instances.into_iter().map(InstanceDocument::of).collect() }
    }
}

impl<'a> InstanceDocument<'a> {
    fn of((name, instance): (&'a str, &'a Instance)) -> Self {
        let inputs = instance.inputs.iter();
        let outputs = instance.outputs.iter();
        InstanceDocument {
            name,
            inputs: inputs.map(|(port, input)| (port.as_str(), input.driver.as_deref())).collect(),
            outputs: outputs.map(|(port, element)| (port.as_str(), element.as_str())).collect(),
            elements: &instance.members,
        }
    }
}

impl ScalingDocument {
    fn of(row: ScalingRow) -> Self {
        let difference = row.relative_error();
        ScalingDocument {
            element: row.element,
            input: row.input,
            output: row.output,
            computer_gain: row.computer_gain,
            input_scale: row.input_scale,
            output_scale: row.output_scale,
            block_gain: row.block_gain,
            unit: row.unit,
            block: row.block,
            expected_gain: row.expected_gain,
            difference,
        }
    }
}
