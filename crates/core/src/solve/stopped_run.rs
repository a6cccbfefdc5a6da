//! The error of a run that stopped: the reason, and the record up to it.

use super::error::RunError;
use crate::trace::Trace;

/// A run that stopped before its end, with the record up to the error.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, run};
///
/// // dx/dt = -x, from 50 V
/// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
/// let patch = PatchBuilder::new("decay").element("A1", decay).run(1.0, 1e-3).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let program = Program::new(&circuit)?;
/// let stopped = run(&program, &RunSettings::of(&circuit)?.with_step(5.0)).unwrap_err();
/// assert_eq!(stopped.error.code(), "longer-than-run");
/// assert_eq!(stopped.to_string(), "the step is 5 s, longer than the run of 1 s");
/// // The run did not begin.
/// assert!(stopped.trace.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{error}")]
pub struct StoppedRunError {
    /// The reason why the run stopped.
    pub error: RunError,
    /// The samples, repetitions and phases before the error; empty if the run did not begin.
    pub trace: Box<Trace>,
}

impl From<RunError> for StoppedRunError {
    fn from(error: RunError) -> Self {
        StoppedRunError { error, trace: Box::default() }
    }
}
