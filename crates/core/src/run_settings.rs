//! From what a patch asks for to the settings of a run.

use crate::circuit::Circuit;
use crate::document::Extent;
use crate::patch::RunPlan;
use crate::solve::{Backend, RunError, RunSettings, TimeSetting};

impl RunSettings {
    /// What the patch asks for.
    ///
    /// # Errors
    /// When the patch does not say how long to run, or neither with which step nor to which tolerance.
    pub fn of(circuit: &Circuit) -> Result<RunSettings, RunError> {
        RunSettings::new(circuit.run_plan(), circuit)
    }

    /// What a plan asks for; recorded is what the patch records and what its pictures show, derivatives too.
    ///
    /// # Errors
    /// When the plan does not say how long to run, or neither with which step nor to which tolerance.
    pub fn new(plan: &RunPlan, circuit: &Circuit) -> Result<RunSettings, RunError> {
        let Some(phases) = plan.all_phases() else { return Err(missing(plan)) };
        let tolerance = plan.tolerance.as_ref().map(|placed| placed.value);
        let step = match (&plan.step, tolerance) {
            (Some(step), _) => step.value,
            (None, Some(_)) => FIRST_STEP * Extent::of(&phases).longest,
            (None, None) => return Err(missing(plan)),
        };
        Ok(RunSettings {
            phases,
            step,
            tolerance,
            every: plan.every.as_ref().map_or(step, |placed| placed.value),
            hold_on_overload: plan.hold_on_overload,
            lamps: true,
            record: circuit.recorded(),
            sensitivities: circuit.differentiated(),
            backend: Backend::default(),
        })
    }
}

fn missing(plan: &RunPlan) -> RunError {
    let times = [
        (TimeSetting::Duration, plan.duration.is_some()),
        (TimeSetting::Step, plan.step.is_some() || plan.tolerance.is_some()),
    ];
    RunError::Missing(times.iter().filter(|(_, given)| !given).map(|(which, _)| *which).collect())
}

/// Of the run: the first step tried where a plan gives a tolerance only.
const FIRST_STEP: f64 = 1e-3;
