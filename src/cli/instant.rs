//! The machine at an instant that an option chooses.

use super::failure::Failure;
use super::load::{Loaded, problem_check};
use super::progress::Progress;
use patchcord::circuit::Circuit;
use patchcord::patch::{Placed, RunPlan, Span};
use patchcord::solve::{self, Machine, MachineMode, RunError, RunSettings};

/// An option that chooses an instant, for messages.
pub(super) struct InstantOption {
    pub name: &'static str,
    /// What there is for runs with phases.
    pub without: &'static str,
}

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
    /// The machine in initial condition, or after so many problem seconds of one run.
    pub fn machine<'l>(&self, loaded: &'l Loaded, seconds: f64) -> Result<Machine<'l>, Failure> {
        let Loaded { circuit, program } = loaded;
        if seconds == 0.0 {
            return Ok(problem_check(circuit, program)?);
        }
        let settings = self.run_until(circuit.run_plan(), seconds, circuit)?;
        let mut progress = Progress::new(settings.whole());
        let machine = solve::machine_after(program, &settings, &mut |time| {
            if let Some(progress) = &mut progress {
                progress.step(time);
            }
        });
        machine.map_err(|error| self.refused(&error))
    }

    /// One initial condition and so many seconds; nothing is recorded.
    fn run_until(&self, plan: &RunPlan, seconds: f64, circuit: &Circuit) -> Result<RunSettings, Failure> {
        if !plan.phases.is_empty() {
            return Err(Failure::usage(format!(
                "the patch's run is a list of phases: {} takes no SECONDS then, since they would not be followed; {}",
                self.name, self.without
            )));
        }
        let duration = Some(Placed { value: seconds, span: Span::default() });
        let plan = RunPlan { duration, ..plan.clone() };
        let settings = RunSettings::new(&plan, circuit).map_err(|error| self.refused(&error))?;
        let settings = RunSettings { every: seconds, record: vec![], ..settings }.lasting(seconds);
        settings.check().map_err(|error| self.refused(&error))?;
        Ok(settings)
    }

    /// What the error says, and what helps.
    fn refused(&self, error: &RunError) -> Failure {
        let advice = match error {
            RunError::Missing(_) => {
                ": write {\"step\": SECONDS} there to come to the voltages of a later time".to_owned()
            }
            RunError::LongerThanRun { .. } => format!(": ask {} for a later time", self.name),
            RunError::TooManySteps { .. } => format!(": ask {} for an earlier time", self.name),
            _ => String::new(),
        };
        let message = format!("{error}{advice}");
        let failure = if advice.is_empty() { Failure::data(message) } else { Failure::usage(message) };
        failure.with("code", error.code().into())
    }
}

/// When the machine stands as it does.
pub(super) fn instant_told(machine: &Machine<'_>, seconds: f64) -> String {
    match machine.mode() {
        MachineMode::Hold => format!("at t = {:.6} s, held by an overload", machine.time()),
        _ if seconds > 0.0 => format!("at t = {seconds} s"),
        _ => "at initial condition".to_owned(),
    }
}
