//! Derives the settings of a run from the run plan of a patch.
//!
//! The plan is what the patch says about its run: phases, step, tolerance, recording interval. The settings are
//! complete: every value that the plan leaves out has its default.

use crate::circuit::Circuit;
use crate::document::RunExtent;
use crate::patch::RunPlan;
use crate::solve::{RunError, RunSettings, TimeSetting};

impl RunSettings {
    /// The settings for the patch's own run plan.
    ///
    /// # Errors
    /// If the plan lacks a duration, or if it has neither a step nor a tolerance.
    pub fn of(circuit: &Circuit) -> Result<RunSettings, RunError> {
        RunSettings::new(circuit.run_plan(), circuit)
    }

    /// The settings for a run plan. The run records the signals that the patch records or draws, and their
    /// derivatives.
    ///
    /// # Errors
    /// If the plan lacks a duration, or if it has neither a step nor a tolerance.
    pub fn new(plan: &RunPlan, circuit: &Circuit) -> Result<RunSettings, RunError> {
        let Some(phases) = plan.all_phases() else { return Err(missing(plan)) };
        let tolerance = plan.tolerance.as_ref().map(|placed| placed.value);
        let step = match (&plan.step, tolerance) {
            (Some(step), _) => step.value,
            (None, Some(_)) => FIRST_STEP * RunExtent::of(&phases).longest_repetition,
            (None, None) => return Err(missing(plan)),
        };
        Ok(RunSettings {
            tolerance,
            every: plan.every.as_ref().map_or(step, |placed| placed.value),
            hold_on_overload: plan.hold_on_overload,
            record: circuit.recorded_signals(),
            sensitivities: circuit.sensitivity_parameters(),
            ..RunSettings::from_phases(phases, step)
        })
    }
}

/// The error that names the times that the plan lacks.
fn missing(plan: &RunPlan) -> RunError {
    let times = [
        (TimeSetting::Duration, plan.all_phases().is_some()),
        (TimeSetting::Step, plan.step.is_some() || plan.tolerance.is_some()),
    ];
    RunError::MissingTimes(times.iter().filter(|(_, given)| !given).map(|(which, _)| *which).collect())
}

/// The first step that is tried if a plan has a tolerance but no step, as a share of the longest repetition.
const FIRST_STEP: f64 = 1e-3;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patch::Patch;

    /// The message about the times that a section "run" lacks.
    fn missing_times(run: &str) -> String {
        let elements = r#"{"A": {"kind": "integrator", "in": {"x1": ["A"]}}}"#;
        let text = format!(r#"{{"patchcord": 1, "elements": {elements}, "run": {run}}}"#);
        let circuit = Circuit::new(&Patch::parse("p.json", &text).unwrap()).unwrap();
        RunSettings::of(&circuit).unwrap_err().to_string()
    }

    #[test]
    fn a_message_names_the_times_that_are_missing_and_their_keys() {
        let step = r#"the patch's "run" does not give the step ("step": SECONDS)"#;
        assert_eq!(missing_times(r#"{"phases": [{"operate": 1}]}"#), step);
        assert_eq!(missing_times(r#"{"for": 1}"#), step);
        let length = r#"the patch's "run" does not give the length of the run ("for": SECONDS)"#;
        assert_eq!(missing_times(r#"{"step": 1e-3}"#), length);
        assert_eq!(missing_times("{}"), format!("{length} and the step (\"step\": SECONDS)"));
    }
}
