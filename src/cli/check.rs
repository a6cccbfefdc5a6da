//! `patchcord check`
//!
//! The check takes no problem time. It reads the patch, compiles it and computes the machine at initial condition, the
//! "problem check" of the period. So overloads at the start, unsolvable loops and missing run settings appear before
//! the first run.

use clap::Args;
use indexmap::IndexMap;
use serde::Serialize;

use super::compared_equations::{EquationDocument, equation_lines};
use super::failure::{Failure, eprint_report};
use super::load::{LoadedPatch, ParameterDocument, PatchArguments, problem_check};
use super::overloads::{OverloadDocument, overload_lines};
use super::requested_checks::{RequestedChecks, RequestedDocument};
use super::start_warnings::start_warnings;
use super::static_check::{StaticReport, TestArguments};
use super::table::{Table, decimals};
use super::times::advice;
use super::{output_in_colour, print, print_coloured, print_json};
use patchcord::circuit::Circuit;
use patchcord::document::{Diagnostic, DiagnosticDocument, Report, escape_controls};
use patchcord::equations::{
    ComparedEquation, audit_scaling, compare_equations, equation_fixes, findings_with_fixes,
};
use patchcord::ir::Program;
use patchcord::linear::{check_size, growth_warning};
use patchcord::patch::{Instance, RunPlan};
use patchcord::solve::{self, BLOCK_SAMPLES, RunError, RunSettings};
use patchcord::trace::Overload;

#[derive(Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    patch: PatchArguments,
    /// Compare the gains of the wiring with the equations and scales (computer gain = input scale x block gain / output
    /// scale)
    #[arg(long)]
    scaling: bool,
    /// Print the voltages at initial condition (problem check), and the derivatives of integrators and lags
    #[arg(long)]
    voltages: bool,
    #[command(flatten)]
    test: TestArguments,
}

/// Tables of voltages and scaling, and the static check, follow the summary on request. Overloads at initial condition
/// do not fail the command.
pub(super) fn check(arguments: &Arguments) -> Result<(), Failure> {
    let LoadedPatch { circuit, program, mut warnings } = arguments.patch.load_unprinted(RunPlan::clone)?;
    let test = arguments.test.run(&circuit, &program)?;
    let compared = compare_equations(&circuit, &program);
    let fixes = equation_fixes(&circuit, &program, &compared);
    let is_audited = arguments.scaling || arguments.patch.json;
    let gains = if is_audited { audit_scaling(&circuit, &program) } else { Vec::new() };
    let test = test.map(|test| StaticReport::new(&circuit, test, &fixes));
    let requested = RequestedChecks { gains, test };
    let findings = findings_with_fixes(&circuit, &compared, &fixes);
    let equations = Report::new(&warnings.file, circuit.patch().text(), findings);
    if equations.has_errors() {
        warnings.findings.extend(equations.findings);
        let report = Report::new(&warnings.file, circuit.patch().text(), warnings.findings);
        return Err(unsolved(arguments, &circuit, &program, &requested, report)?);
    }
    eprint_report(&warnings);
    let mut further = equations.findings;
    let problem = check_problem(&circuit, &program)?;
    further.extend(problem.growth.clone());
    further.extend(start_warnings(&circuit, &program));
    eprint_report(&Report::new(&warnings.file, circuit.patch().text(), further.clone()));
    warnings.findings.extend(further);
    if arguments.patch.json {
        let document = Document::new(&circuit, &program, &warnings, &problem, &compared, &requested);
        return match requested.failure() {
            Some(failure) => Err(failure.with_document(&document)?),
            None => print_json(&document),
        };
    }
    let verdict = requested.verdict(warnings.warning_count());
    print(&summary(&circuit, &program, &compared, &verdict))?;
    print_problem(arguments, &circuit, &program, &problem)?;
    print(&requested.text(arguments.scaling, &circuit))?;
    requested.failure().map_or(Ok(()), Err)
}

/// The failure of a wiring that does not solve its equations. The requested tables are printed before it, or are keys
/// of its document. `report` has the warnings, too.
///
/// # Errors
/// If standard output cannot be written.
fn unsolved(
    arguments: &Arguments,
    circuit: &Circuit,
    program: &Program,
    requested: &RequestedChecks,
    report: Report,
) -> Result<Failure, Failure> {
    let failure = Failure::from(Box::new(report));
    // A machine that cannot be set to initial condition has no voltages. The equations explain more than its error.
    let voltages = check_problem(circuit, program).map(|problem| problem.voltages).unwrap_or_default();
    if arguments.patch.json {
        let document = UnsolvedDocument { voltages: &voltages, requested: requested.document(circuit) };
        return failure.with_document(&document);
    }
    let is_printed = arguments.voltages && !voltages.is_empty();
    let table = if is_printed { format!("\n{}", voltage_table(&voltages)) } else { String::new() };
    print((table + &requested.text(arguments.scaling, circuit)).trim_start_matches('\n'))?;
    Ok(failure)
}

/// Prints the overloads at initial condition, why the patch cannot be run, and the voltages on request.
fn print_problem(
    arguments: &Arguments,
    circuit: &Circuit,
    program: &Program,
    problem: &ProblemCheck,
) -> Result<(), Failure> {
    print_coloured(&overload_lines("", &problem.overloads, output_in_colour()))?;
    if let Some(error) = run_error(circuit, program) {
        print(&format!("cannot be run: {}\n", run_error_text(&error)))?;
    }
    if arguments.voltages {
        print(&format!("\n{}", voltage_table(&problem.voltages)))?;
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
    /// The derivative of an integrator or a lag in volts per machine second. It is 0 at a limit.
    rate: Option<f64>,
}

/// Computes all voltages at initial condition.
///
/// # Errors
/// If the machine cannot be set to initial condition, for example because a loop has no solution.
fn check_problem(circuit: &Circuit, program: &Program) -> Result<ProblemCheck, Failure> {
    let machine = problem_check(circuit, program)?;
    let rates = program.states().into_iter().zip(machine.rates());
    let rates: IndexMap<&str, f64> = rates.map(|(name, rate)| (name, rate / circuit.time_scale())).collect();
    let mut voltages = Vec::new();
    for element in circuit.elements() {
        let volts = machine.voltage(&element.name)?;
        let position = machine.position(&element.name);
        let rate = rates.get(element.name.as_str()).copied();
        let (element, kind) = (element.name.clone(), element.kind.name);
        voltages.push(ElementVoltage { element, kind, volts, position, rate });
    }
    let growth =
        if check_size(program).is_ok() { growth_warning(circuit, &machine.state_space()) } else { None };
    Ok(ProblemCheck { voltages, overloads: machine.overloads(), growth })
}

/// The summary: verdict, machine parts, macros and loops. Lines that do not apply are left out.
fn summary(circuit: &Circuit, program: &Program, compared: &[ComparedEquation], verdict: &str) -> String {
    let patch = circuit.patch();
    let mut text = format!("{}: {verdict}\n", escape_controls(patch.file()));
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

/// The table of voltages, with positions and derivatives if an element has one.
fn voltage_table(voltages: &[ElementVoltage]) -> String {
    let has_position = voltages.iter().any(|entry| entry.position.is_some());
    let has_rate = voltages.iter().any(|entry| entry.rate.is_some());
    let number = |number: f64| decimals(number, 4);
    let row = |first: [String; 3], position: String, rate: String| -> Vec<String> {
        let others = [has_position.then_some(position), has_rate.then_some(rate)];
        first.into_iter().chain(others.into_iter().flatten()).collect()
    };
    let headings = ["element", "kind", "volts"].map(str::to_owned);
    let mut table = Table::with(row(headings, "position".to_owned(), "V/s".to_owned()));
    for entry in voltages {
        let position = entry.position.unwrap_or_default().to_owned();
        let rate = entry.rate.map(number).unwrap_or_default();
        table.row(row([entry.element.clone(), entry.kind.to_owned(), number(entry.volts)], position, rate));
    }
    table.text()
}

/// The result as JSON. It has all tables, whatever the options, and the static check if the options request it.
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
    #[serde(flatten)]
    requested: RequestedDocument<'a>,
}

/// The keys of a document about a wiring that does not solve its equations. `voltages` is empty if the machine cannot be
/// set to initial condition.
#[derive(Serialize)]
struct UnsolvedDocument<'a> {
    voltages: &'a [ElementVoltage],
    #[serde(flatten)]
    requested: RequestedDocument<'a>,
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

impl<'a> Document<'a> {
    /// The document of a patch, its warnings and its problem check.
    fn new(
        circuit: &'a Circuit,
        program: &'a Program,
        warnings: &Report,
        problem: &'a ProblemCheck,
        compared: &[ComparedEquation],
        requested: &'a RequestedChecks,
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
            equations: EquationDocument::all(circuit, compared),
            overloads: OverloadDocument::all(&problem.overloads),
            voltages: &problem.voltages,
            requested: requested.document(circuit),
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
