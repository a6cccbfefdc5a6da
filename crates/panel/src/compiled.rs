//! From a patch to a program that a machine can run, also with faults that a real machine would not notice.
//!
//! A patch with a cord pulled out has an error. A machine runs nevertheless: an open input is at 0 V. So the panel
//! reports the error and runs a copy of the patch whose open inputs are grounded.

use std::sync::Arc;

use patchcord_core::circuit::Circuit;
use patchcord_core::document::Report;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_equations::{ComparedEquation, Fix, compare_equations, equation_fixes, findings_with_fixes};

/// A patch that a machine can run.
#[derive(Debug)]
pub(crate) struct Compiled {
    /// The circuit, with open inputs grounded.
    pub circuit: Circuit,
    /// Its program.
    pub program: Arc<Program>,
}

/// What the checker reports about a patch, and the patch compiled. The latter is `None` if an error remains after open
/// inputs are grounded. Equations that the wiring does not solve are reported without corrections, which [`advise`] finds.
pub(crate) fn compile(patch: &Patch) -> (Report, Option<Compiled>) {
    match compile_as_it_is(patch) {
        Ok((warnings, compiled)) => {
            (with_equations(warnings, patch, &compiled, |_, _| Vec::new()), Some(compiled))
        }
        Err(report) => {
            let grounded = patch.with_grounded_inputs();
            let compiled = grounded.and_then(|patch| compile_as_it_is(&patch).ok());
            (*report, compiled.map(|(_, compiled)| compiled))
        }
    }
}

/// Compiles a patch without errors. Returns the warnings with it.
///
/// # Errors
/// If the patch has an error.
fn compile_as_it_is(patch: &Patch) -> Result<(Report, Compiled), Box<Report>> {
    let circuit = Circuit::new(patch)?;
    let program = Arc::new(Program::new(&circuit)?);
    Ok((circuit.warnings(), Compiled { circuit, program }))
}

/// What the checker reports about a patch without errors in its wiring, with the corrections that it finds for equations
/// that are not solved. It can take seconds.
pub(crate) fn advise(patch: &Patch) -> Option<Report> {
    let (warnings, compiled) = compile_as_it_is(patch).ok()?;
    let fixes = |compiled: &Compiled, compared: &[ComparedEquation]| {
        equation_fixes(&compiled.circuit, &compiled.program, compared)
    };
    Some(with_equations(warnings, patch, &compiled, fixes))
}

/// A report with the findings about the equations that the patch states.
fn with_equations(
    report: Report,
    patch: &Patch,
    compiled: &Compiled,
    fixes: impl FnOnce(&Compiled, &[ComparedEquation]) -> Vec<Fix>,
) -> Report {
    let compared = compare_equations(&compiled.circuit, &compiled.program);
    let fixes = fixes(compiled, &compared);
    let mut findings = report.findings;
    findings.extend(findings_with_fixes(&compiled.circuit, &compared, &fixes));
    Report::new(patch.file(), patch.text(), findings)
}
