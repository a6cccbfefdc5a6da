//! The times of the run of a problem.

use patchcord_core::circuit::Circuit;
use patchcord_core::solve::{RunError, RunSettings};

/// The times of a run in problem seconds.
#[derive(Debug, Clone, Copy)]
pub(super) struct RunTimes {
    /// The length of the run from one initial condition to the next.
    pub duration: f64,
    /// The length of the steps with which the patch will run.
    pub step: f64,
    /// The time between two recorded samples.
    pub every: f64,
}

impl RunTimes {
    /// The times of the run of a circuit.
    ///
    /// # Errors
    /// If the run lacks a time, or a time is not positive.
    pub(super) fn of(circuit: &Circuit) -> Result<Self, RunError> {
        let settings = RunSettings::of(circuit)?;
        settings.check()?;
        Ok(RunTimes { duration: settings.duration(), step: settings.step, every: settings.every })
    }
}
