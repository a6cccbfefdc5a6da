//! The settings of a live run of a patch.

use patchcord_core::circuit::Circuit;
use patchcord_core::solve::{Phase, RunSettings};

use super::DEFAULT_SWEEP;

/// Steps of a sweep if the patch gives no step.
const DEFAULT_STEPS: f64 = 10_000.0;

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
