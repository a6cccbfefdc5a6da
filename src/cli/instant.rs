//! The machine at a time of the run that an option selects.

use super::failure::Failure;
use super::load::{LoadedPatch, problem_check};
use super::numbers::number_in;
use super::progress::RunProgress;
use patchcord::circuit::Circuit;
use patchcord::document::{Placed, Span, format_number};
use patchcord::patch::RunPlan;
use patchcord::solve::{self, Machine, RunError, RunSettings};

/// The option that selects the time, for messages.
pub(super) struct InstantOption {
    /// The name of the command.
    pub command: &'static str,
    /// The name of the option.
    pub option: &'static str,
}

/// A machine at the selected time.
pub(super) struct OperatingPoint<'p> {
    pub machine: Machine<'p>,
    /// The time in words: "at initial condition", "at t = 2 s".
    pub description: String,
}

/// Tolerance for comparing times, as a fraction.
const TIME_TOLERANCE: f64 = 1e-9;

/// Parses a time that is not negative.
pub(super) fn instant(text: &str) -> Result<f64, String> {
    let seconds = number_in("s", text)?;
    if seconds >= 0.0 { Ok(seconds) } else { Err("must be a time of at least 0 s".to_owned()) }
}

impl InstantOption {
    /// The machine at initial condition, or after this many seconds of the run.
    ///
    /// # Errors
    /// If the initial condition has no solution, if a time of the phases is wrong, or if the run stops before.
    pub(super) fn machine<'l>(
        &self,
        loaded: &'l LoadedPatch,
        seconds: f64,
    ) -> Result<OperatingPoint<'l>, Failure> {
        let LoadedPatch { circuit, program, .. } = loaded;
        if seconds == 0.0 {
            let machine = problem_check(circuit, program)?;
            return Ok(OperatingPoint { machine, description: "at initial condition".to_owned() });
        }
        let settings = self.run_until(circuit.run_plan(), seconds, circuit)?;
        let mut progress = RunProgress::new(self.command, seconds);
        let reached = solve::machine_after(program, &settings, seconds, &mut |time| progress.step(time));
        let (machine, clock) = reached.map_err(|error| self.failure(&error))?;
        let description = self.description(circuit, &machine, clock, seconds)?;
        Ok(OperatingPoint { machine, description })
    }

    /// The settings of a run with the phases of the patch that records nothing. Without phases: one initial condition,
    /// then `seconds` of operate.
    fn run_until(&self, plan: &RunPlan, seconds: f64, circuit: &Circuit) -> Result<RunSettings, Failure> {
        let duration = Some(Placed { value: seconds, span: Span::default() });
        let is_plain = plan.phases.is_empty();
        let plan = if is_plain { RunPlan { duration, ..plan.clone() } } else { plan.clone() };
        let settings = RunSettings::new(&plan, circuit).map_err(|error| self.failure(&error))?;
        let mut settings = if is_plain { settings.with_duration(seconds) } else { settings };
        settings.every = settings.duration();
        settings.record.clear();
        settings.sensitivities.clear();
        settings.check().map_err(|error| self.failure(&error))?;
        Ok(settings)
    }

    /// The time in words. An error if the run ends before the requested time.
    fn description(
        &self,
        circuit: &Circuit,
        machine: &Machine<'_>,
        clock: f64,
        seconds: f64,
    ) -> Result<String, Failure> {
        let is_reached = clock >= seconds * (1.0 - TIME_TOLERANCE);
        match (is_reached, circuit.run_plan()) {
            (true, plan) if plan.phases.is_empty() => Ok(format!("at t = {} s", format_number(seconds))),
            (true, _) => Ok(format!("after {} s of the run", format_number(seconds))),
            (false, plan) if plan.hold_on_overload && machine.is_overloaded() => {
                Ok(format!("at t = {} s, held by an overload", format_number(machine.time())))
            }
            _ => Err(Failure::usage(format!(
                "the run ends after {} s: give an earlier time with {}",
                format_number(clock),
                self.option
            ))),
        }
    }

    /// The failure for an error of the run, with advice.
    fn failure(&self, error: &RunError) -> Failure {
        let advice = match error {
            RunError::MissingTimes(_) => {
                ": write {\"step\": SECONDS} there, which a later time needs".to_owned()
            }
            RunError::LongerThanRun { .. } => format!(": give a later time with {}", self.option),
            RunError::TooManySteps { .. } => format!(": give an earlier time with {}", self.option),
            _ => String::new(),
        };
        let message = format!("{error}{advice}");
        let failure = if advice.is_empty() { Failure::data(message) } else { Failure::usage(message) };
        failure.with_detail("code", error.code().into())
    }
}
