//! The machine at an instant that an option chooses.

use super::failure::Failure;
use super::load::{Loaded, problem_check};
use super::progress::Progress;
use patchcord::circuit::Circuit;
use patchcord::document::{Placed, Span};
use patchcord::patch::RunPlan;
use patchcord::solve::{self, Machine, RunError, RunSettings};

/// The option that chooses an instant, for messages.
pub(super) struct InstantOption(pub &'static str);

/// A machine at an instant.
pub(super) struct Reached<'p> {
    pub machine: Machine<'p>,
    /// When: "at initial condition", "at t = 2 s".
    pub told: String,
}

/// Clocks that differ by less than this share are the same.
const SAME: f64 = 1e-9;

/// A time from 0 s on.
pub(super) fn instant(text: &str) -> Result<f64, String> {
    let seconds: f64 = text.parse().map_err(|_| format!("\"{text}\" is not a number of seconds"))?;
    if seconds >= 0.0 && seconds.is_finite() {
        Ok(seconds)
    } else {
        Err("a time from 0 s on is wanted".to_owned())
    }
}

impl InstantOption {
    /// The machine in initial condition, or after so many seconds of the run.
    pub fn machine<'l>(&self, loaded: &'l Loaded, seconds: f64) -> Result<Reached<'l>, Failure> {
        let Loaded { circuit, program } = loaded;
        if seconds == 0.0 {
            let machine = problem_check(circuit, program)?;
            return Ok(Reached { machine, told: "at initial condition".to_owned() });
        }
        let settings = self.run_until(circuit.run_plan(), seconds, circuit)?;
        let mut progress = Progress::new(seconds);
        let reached = solve::machine_after(program, &settings, seconds, &mut |time| {
            if let Some(progress) = &mut progress {
                progress.step(time);
            }
        });
        let (machine, clock) = reached.map_err(|error| self.refused(&error))?;
        let told = self.told(circuit, &machine, clock, seconds)?;
        Ok(Reached { machine, told })
    }

    /// The run's phases; without any, one initial condition and so many seconds. Nothing is recorded.
    fn run_until(&self, plan: &RunPlan, seconds: f64, circuit: &Circuit) -> Result<RunSettings, Failure> {
        let duration = Some(Placed { value: seconds, span: Span::default() });
        let is_plain = plan.phases.is_empty();
        let plan = if is_plain { RunPlan { duration, ..plan.clone() } } else { plan.clone() };
        let settings = RunSettings::new(&plan, circuit).map_err(|error| self.refused(&error))?;
        let settings = if is_plain { settings.lasting(seconds) } else { settings };
        let (every, record, sensitivities) = (settings.duration(), vec![], vec![]);
        let settings = RunSettings { every, record, sensitivities, ..settings };
        settings.check().map_err(|error| self.refused(&error))?;
        Ok(settings)
    }

    /// When the machine stands as it does: after so many seconds, unless the run ended before.
    fn told(
        &self,
        circuit: &Circuit,
        machine: &Machine<'_>,
        clock: f64,
        seconds: f64,
    ) -> Result<String, Failure> {
        let is_reached = clock >= seconds * (1.0 - SAME);
        match (is_reached, circuit.run_plan()) {
            (true, plan) if plan.phases.is_empty() => Ok(format!("at t = {seconds} s")),
            (true, _) => Ok(format!("after {seconds} s of the run")),
            (false, plan) if plan.hold_on_overload && machine.is_overloaded() => {
                Ok(format!("at t = {:.6} s, held by an overload", machine.time()))
            }
            _ => Err(Failure::usage(format!(
                "the run ends after {clock:.6} s: ask {} for an earlier time",
                self.0
            ))),
        }
    }

    /// What the error says, and what helps.
    fn refused(&self, error: &RunError) -> Failure {
        let advice = match error {
            RunError::Missing(_) => {
                ": write {\"step\": SECONDS} there to come to the voltages of a later time".to_owned()
            }
            RunError::LongerThanRun { .. } => format!(": ask {} for a later time", self.0),
            RunError::TooManySteps { .. } => format!(": ask {} for an earlier time", self.0),
            _ => String::new(),
        };
        let message = format!("{error}{advice}");
        let failure = if advice.is_empty() { Failure::data(message) } else { Failure::usage(message) };
        failure.with("code", error.code().into())
    }
}
