//! The reasons why a problem cannot be scaled.

use patchcord_core::circuit::Circuit;
use patchcord_core::document::{Diagnostic, Report};
use patchcord_core::patch::{Patch, Problem};
use patchcord_core::solve::{RunError, StoppedRunError};

/// The reason why a problem cannot be scaled.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ScaleError {
    /// The problem has faults, or it cannot be solved on the machine. The positions are those of its text.
    #[error(transparent)]
    Problem(Box<Report>),
    /// The circuit of the problem cannot be computed, for example because a loop has several solutions. The positions
    /// are those of the built patch. [`scale_problem`](super::scale_problem) returns these faults as those of the problem.
    #[error("the circuit of the problem cannot be computed:\n{0}")]
    Circuit(Box<Report>),
    /// The settings of the run are invalid.
    #[error("the circuit of the problem cannot be run: {0}")]
    Settings(RunError),
    /// A run of the circuit had to stop.
    #[error("the run of the scaled patch stopped: {0}")]
    Run(Box<StoppedRunError>),
}

impl ScaleError {
    /// Faults of a problem, with the text of the problem and the warnings about it.
    pub(super) fn of_problem(problem: &Problem, circuit: &Circuit, faults: Vec<Diagnostic>) -> Self {
        let patch: &Patch = &problem.patch;
        let findings = faults.into_iter().chain(circuit.warnings().findings).collect();
        ScaleError::Problem(Box::new(Report::new(patch.file(), patch.text(), findings)))
    }
}
