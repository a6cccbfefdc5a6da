//! Options that all commands on patches share, and reading a patch.
//!
//! Every command on a patch prints documents with the same first keys: `ok`, `patch`, `title`, `diagnostics` and
//! `parameters`.

use std::io;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::failure::{Failure, eprint_report};
use super::numbers::{in_declared_units, setting};
use super::outputs::Outputs;
use super::standard_streams::{STANDARD_INPUT_NAME, is_dash};
use patchcord::circuit::Circuit;
use patchcord::document::{DiagnosticDocument, Report, TypedNumber, escape_controls};
use patchcord::instruments::parameter_line;
use patchcord::ir::Program;
use patchcord::patch::{Patch, RunPlan};
use patchcord::solve::{Machine, RunError};

// No doc comment: clap would use it as the description of every command.
#[derive(Args)]
pub(super) struct PatchArguments {
    /// Patch file (JSON); - reads standard input
    pub patch: PathBuf,
    /// Set a parameter, such as VcL=2.54mm/s. A number without a unit is in the unit that the patch declares. May be
    /// given several times
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = setting)]
    pub set: Vec<(String, TypedNumber)>,
    /// Print one JSON document on standard output, and nothing else there
    #[arg(long)]
    pub json: bool,
}

/// A patch that is ready to run.
pub(super) struct LoadedPatch {
    /// The wired patch with the parameters of `--set`.
    pub circuit: Circuit,
    /// The same, compiled.
    pub program: Program,
    /// The warnings about the patch and the length of the run.
    pub warnings: Report,
}

impl PatchArguments {
    /// Reads and compiles the patch, and prints warnings to standard error.
    ///
    /// # Errors
    /// If the patch cannot be read, has a fault, or has no such parameter.
    pub(super) fn load(&self) -> Result<LoadedPatch, Failure> {
        self.load_for(RunPlan::clone)
    }

    /// Like [`load`](Self::load), for a run with another plan. `plan` makes it from the plan of the patch.
    ///
    /// # Errors
    /// Those of [`load`](Self::load).
    pub(super) fn load_for(&self, plan: impl FnOnce(&RunPlan) -> RunPlan) -> Result<LoadedPatch, Failure> {
        let loaded = self.load_unprinted(plan)?;
        eprint_report(&loaded.warnings);
        Ok(loaded)
    }

    /// Like [`load_for`](Self::load_for), without printing: the caller adds further findings to the warnings.
    ///
    /// # Errors
    /// Those of [`load`](Self::load).
    pub(super) fn load_unprinted(
        &self,
        plan: impl FnOnce(&RunPlan) -> RunPlan,
    ) -> Result<LoadedPatch, Failure> {
        let (circuit, program) = self.read()?;
        let warnings = circuit.warnings_for(&plan(circuit.run_plan()));
        Ok(LoadedPatch { circuit, program, warnings })
    }

    /// The outputs of a command that reads this patch, which `circuit` has.
    pub(super) fn outputs(&self, circuit: &Circuit) -> Outputs {
        // Standard input may be a file.
        let file = if is_dash(&self.patch) { Path::new("/dev/stdin") } else { self.patch.as_path() };
        Outputs::of_patch(file, circuit.patch())
    }

    /// Reads, wires and compiles, without printing.
    fn read(&self) -> Result<(Circuit, Program), Failure> {
        let patch = match is_dash(&self.patch) {
            true => Patch::read_from(io::stdin().lock(), STANDARD_INPUT_NAME)?,
            false => Patch::read(&self.patch)?,
        };
        let circuit = Circuit::with_parameters(&patch, in_declared_units(&self.set, &patch)?)?;
        let program = Program::new(&circuit)?;
        Ok((circuit, program))
    }
}

/// The title of the patch of a circuit, or the name of its file if it has none.
pub(super) fn title(circuit: &Circuit) -> String {
    title_of(circuit.patch())
}

/// The title of a patch, or the name of its file if it has none.
pub(super) fn title_of(patch: &Patch) -> String {
    if patch.title.trim().is_empty() { escape_controls(patch.file()) } else { patch.title.clone() }
}

/// The lines above the results of a patch: its title, the parameters if it has any, and an empty line.
pub(super) fn heading(circuit: &Circuit) -> String {
    let (title, parameters) = (title(circuit), parameter_line(circuit));
    if parameters.is_empty() { format!("{title}\n\n") } else { format!("{title}\n{parameters}\n\n") }
}

/// A parameter for `--json`, with its value in the declared unit.
#[derive(Serialize)]
pub(super) struct ParameterDocument<'c> {
    name: &'c str,
    value: f64,
    unit: &'c str,
    description: &'c str,
}

impl<'c> ParameterDocument<'c> {
    /// All parameters of a circuit.
    pub(super) fn all(circuit: &'c Circuit) -> Vec<Self> {
        let parameters = circuit.parameters().map(|(name, parameter, value)| ParameterDocument {
            name,
            value,
            unit: parameter.unit.text(),
            description: &parameter.description,
        });
        parameters.collect()
    }
}

/// The `--json` document of a command on a patch: keys about the patch, then those of the command.
#[derive(Serialize)]
pub(super) struct PatchDocument<'c, T> {
    ok: bool,
    patch: &'c str,
    title: &'c str,
    diagnostics: Vec<DiagnosticDocument>,
    parameters: Vec<ParameterDocument<'c>>,
    #[serde(flatten)]
    more: T,
}

impl<'c, T: Serialize> PatchDocument<'c, T> {
    /// The document of a successful command. `more` has the keys of the command.
    pub(super) fn new(circuit: &'c Circuit, warnings: &Report, more: T) -> Self {
        PatchDocument {
            ok: true,
            patch: circuit.patch().file(),
            title: &circuit.patch().title,
            diagnostics: warnings.documents(),
            parameters: ParameterDocument::all(circuit),
            more,
        }
    }
}

/// The step for the problem check of a patch without one. It does not affect the result, but delay lines and lags
/// need it.
const DEFAULT_STEP: f64 = 1e-4;

/// The machine at initial condition.
pub(super) fn problem_check<'p>(circuit: &Circuit, program: &'p Program) -> Result<Machine<'p>, RunError> {
    match &circuit.run_plan().step {
        Some(step) => Machine::new(program, step.value),
        None => machine_with_short_step(program),
    }
}

/// The machine with a step that is shorter than every delay and lag.
fn machine_with_short_step(program: &Program) -> Result<Machine<'_>, RunError> {
    let mut step = DEFAULT_STEP;
    loop {
        match Machine::new(program, step) {
            Err(RunError::DelayTooShort { delay: time, .. } | RunError::LagTooShort { time, .. })
                if 0.0 < time && time < step =>
            {
                step = time
            }
            outcome => return outcome,
        }
    }
}
