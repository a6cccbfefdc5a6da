//! Options that all commands on patches share, and the way from a file to a program.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::failure::{Failure, tell_report};
use patchcord::circuit::Circuit;
use patchcord::ir::Program;
use patchcord::patch::Patch;
use patchcord::solve::{Machine, RunError};

/// The patch and its parameters.
#[derive(Args)]
pub(super) struct PatchArguments {
    /// Patch file (JSON)
    pub patch: PathBuf,
    /// Set a parameter, in the unit that the patch declares for it; may be given several times
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = setting)]
    pub set: Vec<(String, f64)>,
    /// Print one JSON document on standard output, and nothing else there
    #[arg(long)]
    pub json: bool,
}

/// NAME=VALUE, as `--set` takes it.
pub(super) fn setting(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE, such as VcL=2.54e-3")?;
    let number: f64 = value.trim().parse().map_err(|_| format!("\"{value}\" is not a number"))?;
    if !number.is_finite() {
        return Err(format!("{value} is not a finite number"));
    }
    Ok((name.trim().to_owned(), number))
}

/// A patch that can be run.
pub(super) struct Loaded {
    pub circuit: Circuit,
    pub program: Program,
}

impl PatchArguments {
    /// Reads and checks the patch; warnings go to standard error.
    pub fn load(&self) -> Result<Loaded, Failure> {
        let loaded = self.checked().map_err(|failure| failure.told_as_json(self.json))?;
        tell_report(&loaded.circuit.warnings());
        Ok(loaded)
    }

    fn checked(&self) -> Result<Loaded, Failure> {
        let patch = Patch::read(&self.patch)?;
        let circuit = Circuit::new(&patch, &self.set)?;
        let program = Program::new(&circuit)?;
        Ok(Loaded { circuit, program })
    }
}

/// The parameters for `--json`.
pub(super) fn parameters_json(circuit: &Circuit) -> Value {
    let told = circuit.parameters().map(|(name, parameter, value)| {
        json!({"name": name, "value": value, "unit": parameter.unit.text(), "description": parameter.description})
    });
    told.collect()
}

/// The `--json` document of what was made of a patch: of which one, and then `more`.
pub(super) fn document(circuit: &Circuit, more: Value) -> Value {
    let mut document = json!({
        "ok": true,
        "patch": circuit.patch().file(),
        "title": circuit.patch().title,
        "diagnostics": circuit.warnings().to_json(),
        "parameters": parameters_json(circuit),
    });
    if let (Value::Object(document), Value::Object(more)) = (&mut document, more) {
        document.extend(more);
    }
    document
}

/// The step plays no part in initial condition, but delay lines and lags want one.
const ANY_STEP: f64 = 1e-4;

/// The machine in initial condition.
pub(super) fn problem_check<'p>(circuit: &Circuit, program: &'p Program) -> Result<Machine<'p>, RunError> {
    match &circuit.run_plan().step {
        Some(step) => Machine::new(program, step.value),
        None => with_any_step(program),
    }
}

/// A machine with a step that no delay and no lag is too short for.
fn with_any_step(program: &Program) -> Result<Machine<'_>, RunError> {
    let mut step = ANY_STEP;
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
