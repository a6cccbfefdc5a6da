//! The settings of a live run of a patch, and the machine that continues another one.

use std::sync::Arc;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::solve::{Phase, RunError, RunSettings};

use super::DEFAULT_SWEEP;
use crate::session::live_machine::{LiveMachine, live_machine};

/// Steps of a sweep if the patch gives no step.
const DEFAULT_STEPS: f64 = 10_000.0;

/// A machine in initial condition, or one that continues the run of another machine.
///
/// # Errors
/// If the times of the patch are not valid, or the voltages cannot be evaluated.
pub(super) fn continued(
    program: &Arc<Program>,
    settings: &RunSettings,
    old: Option<LiveMachine>,
) -> Result<LiveMachine, RunError> {
    let mut machine = live_machine(program, settings)?;
    if let Some(mut old) = old {
        machine.with_dependent_mut(|_, new| {
            old.with_dependent_mut(|_, old| {
                new.plays = old.plays;
                new.run.continue_from(&mut old.run)
            })
        })?;
    }
    Ok(machine)
}

/// The settings of a live run of a patch. A patch without times gets usual ones, so that it can be tried while it is
/// built.
pub(super) fn run_settings(circuit: &Circuit, sweep: Option<f64>) -> RunSettings {
    let plan = circuit.run_plan();
    let usual = || {
        let phases = plan.all_phases();
        let phases = phases.unwrap_or_else(|| vec![Phase::InitialCondition, Phase::operate(DEFAULT_SWEEP)]);
        let settings = RunSettings::from_phases(phases, 1.0);
        let step = plan.step.as_ref().map_or(settings.duration() / DEFAULT_STEPS, |step| step.value);
        settings.with_step(step)
    };
    let settings = RunSettings::of(circuit).unwrap_or_else(|_| usual());
    let settings = match sweep {
        Some(sweep) => settings.with_duration(sweep),
        None => settings,
    };
    let nothing: [String; 0] = [];
    let every = settings.duration();
    settings.with_signals(nothing.clone()).with_sensitivities(nothing).with_sample_interval(every)
}
