//! Runs a program and reports the progress of the command.

use std::ops::ControlFlow;

use super::progress::RunProgress;
use super::streamed_tables::StreamedTables;
use patchcord::ir::Program;
use patchcord::solve::{self, RunSettings, StoppedRunError};
use patchcord::trace::Trace;

/// Runs a program whose trace keeps the samples, and reports the progress of the command with this name.
pub(super) fn run_with_progress(
    command: &'static str,
    program: &Program,
    settings: &RunSettings,
) -> Result<Trace, Box<StoppedRunError>> {
    record(command, program, settings, None)
}

/// Runs a program, and reports the progress of the command with this name. If the trace does not keep the samples,
/// `tables` take them.
pub(super) fn record(
    command: &'static str,
    program: &Program,
    settings: &RunSettings,
    mut tables: Option<&mut StreamedTables<'_>>,
) -> Result<Trace, Box<StoppedRunError>> {
    let mut progress = RunProgress::new(command, settings.total_duration());
    let mut show = |time: f64| progress.step(time);
    let mut write = |block: &Trace| match &mut tables {
        Some(tables) => tables.write(block),
        None => ControlFlow::Continue(()),
    };
    solve::run_in_blocks(program, settings, &mut show, &mut write).map_err(Box::new)
}
