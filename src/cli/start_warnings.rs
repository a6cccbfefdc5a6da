//! The warnings about the start of a patch, for the commands that check or run it.

use super::failure::eprint_report;
use super::load::problem_check;
use patchcord::circuit::Circuit;
use patchcord::document::{Diagnostic, Report};
use patchcord::ir::Program;
use patchcord::linear;

/// The warnings about the machine in initial condition. Empty if it cannot be set to it: the command reports this error.
pub(super) fn start_warnings(circuit: &Circuit, program: &Program) -> Vec<Diagnostic> {
    linear::start_warnings(circuit, program, || problem_check(circuit, program).ok())
}

/// Prints these warnings to standard error, and adds them to the warnings of the patch.
pub(super) fn report_start_warnings(circuit: &Circuit, program: &Program, warnings: &mut Report) {
    let found = start_warnings(circuit, program);
    eprint_report(&Report::new(&warnings.file, &warnings.text, found.clone()));
    warnings.findings.extend(found);
}
