//! The step of the run of a scaled patch: that of the problem, or a shorter one.
//!
//! The step of a problem can be too long for its equations. The run of the patch is then wrong, and can overload at any
//! scale.

use patchcord_core::document::{Diagnostic, format_number};
use patchcord_core::ir::Program;
use patchcord_core::patch::{Patch, Problem};
use patchcord_core::solve::{RunSettings, run};
use patchcord_core::trace::Trace;

use super::error::ScaleError;
use super::inventory::unlimited_circuit;
use crate::findings::codes;
use crate::synthesis::with_step;

/// How often the step is shortened. Each time the run can take ten times as long.
const MAX_CHANGES: usize = 3;
/// Share of a step that is tried after a run that stopped.
const SHARE_AFTER_STOP: f64 = 0.1;

/// The step of the run.
#[derive(Debug, Default)]
pub(super) struct RunStep {
    /// The step in place of that of the problem, in problem seconds.
    shorter: Option<f64>,
    /// How often it was shortened.
    changes: usize,
    /// Whether the last run had steps that are too long, and they may not be shortened any more.
    is_still_too_long: bool,
}

impl RunStep {
    /// A patch with the step.
    ///
    /// # Errors
    /// If the patch cannot be written.
    pub(super) fn applied(&self, patch: Patch) -> Result<Patch, ScaleError> {
        match self.shorter {
            Some(step) => with_step(&patch, step).map_err(ScaleError::Circuit),
            None => Ok(patch),
        }
    }

    /// Runs a patch with its own settings, as the user will run it, up to the first overload. Shortens the step if it is
    /// too long. Returns whether it is shorter.
    ///
    /// # Errors
    /// If the patch cannot be run, and not because of its step.
    pub(super) fn shorten(&mut self, patch: &Patch) -> Result<bool, ScaleError> {
        let trace = match own_run(patch) {
            Err(error) if self.shorten_after(&error, patch) => return Ok(true),
            trace => trace?,
        };
        let may_change = self.changes < MAX_CHANGES;
        self.is_still_too_long = trace.step_warning.is_some() && !may_change;
        match trace.step_warning {
            Some(warning) if may_change => {
                self.change(warning.recommended.min(0.5 * warning.step));
                Ok(true)
            }
            _ => Ok(false),
        }
    }

    /// Shortens the step if a run of a patch stopped with an error that a shorter step may avoid. Returns whether it is
    /// shorter.
    pub(super) fn shorten_after(&mut self, error: &ScaleError, patch: &Patch) -> bool {
        let ScaleError::Run(stopped) = error else { return false };
        let may_help = stopped.error.may_depend_on_step() && self.changes < MAX_CHANGES;
        match &patch.run.step {
            Some(step) if may_help => {
                self.change(SHARE_AFTER_STOP * step.value);
                true
            }
            _ => false,
        }
    }

    /// Sets a shorter step.
    fn change(&mut self, step: f64) {
        self.shorter = Some(step);
        self.changes += 1;
    }

    /// The warning that the patch has another step than the problem, and whether this one is too long too. `None` if it
    /// has the step of the problem.
    pub(super) fn warning(&self, problem: &Problem) -> Option<Diagnostic> {
        let (step, stated) = (self.shorter?, problem.patch.run.step.as_ref()?);
        let message = format!(
            "the step of {} s is too long for these equations: the patch has a step of {} s",
            format_number(stated.value),
            format_number(step)
        );
        let (message, hint) = match self.is_still_too_long {
            true => {
                (message + ", which is too long too", "state a shorter step, or a \"tolerance\" in its place")
            }
            false => (message, "state this step, or a \"tolerance\" in its place"),
        };
        Some(Diagnostic::at(codes::SHORTENED_STEP, stated.span, message).hint(hint))
    }
}

/// The record of a run of a patch with its own settings, with checks of its steps. It ends at the first overload: after
/// it, a run with a step that is too long can take very long.
///
/// # Errors
/// If the patch cannot be wired, compiled or run.
fn own_run(patch: &Patch) -> Result<Trace, ScaleError> {
    let circuit = unlimited_circuit(patch)?;
    let program = Program::new(&circuit).map_err(ScaleError::Circuit)?;
    let settings = RunSettings::of(&circuit).map_err(ScaleError::Settings)?;
    let settings = settings.with_step_checks().with_hold_on_overload();
    run(&program, &settings).map_err(|stopped| ScaleError::Run(Box::new(stopped)))
}

#[cfg(test)]
mod tests;
