//! Options for length, step and recording interval of a run, and failures of runs with the options that help.

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use serde::Serialize;

use super::failure::Failure;
use super::numbers::seconds;
use patchcord::circuit::Circuit;
use patchcord::document::{Placed, Span, TypedNumber, format_number};
use patchcord::expr::Unit;
use patchcord::ir::Program;
use patchcord::machines::REFERENCE;
use patchcord::patch::RunPlan;
use patchcord::solve::{
    Backend, MAX_TOLERANCE, MIN_TOLERANCE, RunError, RunSettings, TimeSetting, is_tolerance, sufficient_step,
};

#[derive(Args)]
pub(super) struct TimeArguments {
    /// Length of the run in problem seconds. The run is then a single operate, without the phases of the patch
    #[arg(long = "for", value_name = "SECONDS", allow_hyphen_values = true, value_parser = seconds)]
    duration: Option<f64>,
    #[command(flatten)]
    steps: StepArguments,
}

#[derive(Args)]
pub(super) struct StepArguments {
    /// Step of the solver in problem seconds, or "auto" for a step that the checks of the run find short enough
    #[arg(long, value_name = "SECONDS|auto", allow_hyphen_values = true, value_parser = step)]
    pub step: Option<StepChoice>,
    /// Let the solver choose steps whose errors add up to at most this share of 100 V, such as 1e-6
    #[arg(long = "tol", value_name = "SHARE", allow_hyphen_values = true, value_parser = share, conflicts_with = "step")]
    pub tolerance: Option<f64>,
    /// Time between recorded samples, in problem seconds
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = seconds)]
    pub every: Option<f64>,
    /// Backend that computes the steps. All except reference give identical bits. Native code is for patches of up to
    /// about 1100 elements; larger ones are interpreted. With --tol, the backend is always reference
    #[arg(long, value_name = "BACKEND", value_parser = backend(), default_value_t)]
    pub backend: Backend,
}

/// The step of a run with equal steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum StepChoice {
    /// This many problem seconds.
    Seconds(f64),
    /// A step that the checks of a run find short enough.
    Automatic,
}

impl StepChoice {
    /// The step in problem seconds; `None` if it is chosen automatically.
    pub(super) fn seconds(self) -> Option<f64> {
        if let StepChoice::Seconds(seconds) = self { Some(seconds) } else { None }
    }
}

/// Parses a step.
fn step(text: &str) -> Result<StepChoice, String> {
    if text == "auto" { Ok(StepChoice::Automatic) } else { seconds(text).map(StepChoice::Seconds) }
}

/// Parses the name of a backend. The names are listed in the help and in completions.
fn backend() -> impl TypedValueParser<Value = Backend> {
    let named = |name: String| Backend::ALL.into_iter().find(|backend| backend.name() == name);
    PossibleValuesParser::new(Backend::ALL.map(Backend::name))
        .map(move |name| named(name).unwrap_or_default())
}

/// Parses a tolerance. A voltage is refused, with the share of 100 V that it is.
fn share(text: &str) -> Result<f64, String> {
    let typed = TypedNumber::parse(text).map_err(|error| error.to_string())?;
    let in_unit = |unit: &str| -> Result<f64, String> {
        let unit = Unit::parse(unit).map_err(|error| error.to_string())?;
        typed.in_unit(&unit).map_err(|error| error.to_string())
    };
    let volts = if typed.unit.is_some() { in_unit("V").ok() } else { None };
    let share = match volts {
        Some(volts) => volts / REFERENCE,
        None => in_unit("1")?,
    };
    if !is_tolerance(share) {
        return Err(format!(
            "must be from {MIN_TOLERANCE:e} to {MAX_TOLERANCE}, such as 1e-6: rounding errors are not smaller"
        ));
    }
    if volts.is_some() {
        let advised = format_number(share);
        return Err(format!(
            "\"{text}\" is a voltage, but the tolerance is a share of 100 V: write {advised}"
        ));
    }
    Ok(share)
}

/// Length, step, tolerance and recording interval for `--json`, in seconds and as a fraction of 100 V.
#[derive(Serialize)]
pub(super) struct TimesDocument {
    #[serde(rename = "for")]
    duration: f64,
    step: f64,
    tolerance: Option<f64>,
    every: f64,
}

impl TimesDocument {
    /// The times of these settings.
    pub(super) fn of(settings: &RunSettings) -> Self {
        let RunSettings { step, tolerance, every, .. } = *settings;
        TimesDocument { duration: settings.duration(), step, tolerance, every }
    }
}

/// A value from the command line, which has no position in a file.
pub(super) fn from_command_line(value: f64) -> Placed<f64> {
    Placed { value, span: Span::default() }
}

impl TimeArguments {
    /// The run plan of the patch with the changes by the options.
    pub(super) fn plan(&self, patch: &RunPlan) -> RunPlan {
        let mut plan = patch.clone();
        if self.duration.is_some() {
            plan.phases.clear();
        }
        let StepArguments { step, tolerance, every, .. } = self.steps;
        plan.duration = self.duration.map(from_command_line).or(plan.duration);
        plan.step = match step {
            Some(StepChoice::Automatic) => plan.step.or(first_step(patch, self.duration)),
            Some(StepChoice::Seconds(seconds)) => Some(from_command_line(seconds)),
            None => plan.step,
        };
        // An explicit step means equal steps, so it overrides a tolerance of the patch.
        plan.tolerance = match step {
            Some(_) => None,
            None => tolerance.map(from_command_line).or(plan.tolerance),
        };
        plan.every = every.map(from_command_line).or(plan.every);
        plan
    }

    /// The run settings for a plan. An automatic step is found by runs of the program.
    ///
    /// # Errors
    /// Those of [`RunSettings::new`] and [`sufficient_step`].
    pub(super) fn settings(
        &self,
        plan: &RunPlan,
        circuit: &Circuit,
        program: &Program,
    ) -> Result<RunSettings, RunError> {
        let settings = RunSettings::new(plan, circuit)?.with_backend(self.steps.backend);
        match self.steps.step {
            Some(StepChoice::Automatic) => {
                let step = sufficient_step(program, &settings)?;
                Ok(settings.with_step(step))
            }
            _ => Ok(settings),
        }
    }

    /// The line with the step of these settings, if it was chosen automatically; otherwise empty.
    pub(super) fn step_text(&self, settings: &RunSettings) -> String {
        match self.steps.step {
            Some(StepChoice::Automatic) => format!("step {} s, found by --step auto\n", settings.step),
            _ => String::new(),
        }
    }

    /// Whether these options, and not the patch, cause an error.
    pub(super) fn is_cause_of(&self, error: &RunError) -> bool {
        matches!(error, RunError::MissingTimes(_))
            || (self.duration.is_some() && concerns_times(error))
            || self.steps.is_cause_of(error)
    }
}

impl StepArguments {
    /// Whether these options cause an error.
    pub(super) fn is_cause_of(&self, error: &RunError) -> bool {
        match error {
            RunError::DelayTooShort { .. } | RunError::LagTooShort { .. } => self.step.is_some(),
            _ => concerns_times(error) && (self.step.is_some() || self.every.is_some()),
        }
    }
}

/// The first step that is tried if neither the patch nor an option gives one: a thousandth of the run.
fn first_step(patch: &RunPlan, duration: Option<f64>) -> Option<Placed<f64>> {
    duration.or_else(|| patch.longest_repetition()).map(|length| from_command_line(1e-3 * length))
}

/// Whether the times of a run are inconsistent, or give too many steps or samples.
fn concerns_times(error: &RunError) -> bool {
    matches!(
        error,
        RunError::LongerThanRun { .. }
            | RunError::NotATime { .. }
            | RunError::TooManySteps { .. }
            | RunError::TooManyNumbers { .. }
    )
}

/// The failure for an error of a run, with the option that helps and the position in the patch. `is_usage`: options
/// cause it.
pub(super) fn run_failure(error: &RunError, circuit: &Circuit, is_usage: bool) -> Failure {
    failure_with_code(message_with_advice(error) + &position_text(error, circuit), error, is_usage)
}

/// The failure with this message and the code of an error of a run. `is_usage`: options cause it.
pub(super) fn failure_with_code(message: String, error: &RunError, is_usage: bool) -> Failure {
    let failure = if is_usage { Failure::usage(message) } else { Failure::data(message) };
    failure.with_detail("code", error.code().into())
}

/// The position in the patch of the element that an error concerns, on a new line. Empty if there is none.
pub(super) fn position_text(error: &RunError, circuit: &Circuit) -> String {
    let concerned = error.element().and_then(|element| Some((element, circuit.position_of(element)?)));
    let Some((element, (line, column))) = concerned else { return String::new() };
    format!("\n  --> {}:{line}:{column}: {element}", circuit.patch().file())
}

/// The message of an error and the option that helps.
pub(super) fn message_with_advice(error: &RunError) -> String {
    match advice(error) {
        Some(advice) => format!("{error}: {advice}"),
        None => error.to_string(),
    }
}

/// The option that helps against an error; None if there is none.
pub(super) fn advice(error: &RunError) -> Option<String> {
    let option = |time: &TimeSetting| match time {
        TimeSetting::Step => "--step or --tol".to_owned(),
        _ => format!("--{}", time.key()),
    };
    match error {
        RunError::MissingTimes(times) => {
            Some(format!("give {}", times.iter().map(option).collect::<Vec<_>>().join(" and ")))
        }
        RunError::LongerThanRun { which, .. } => Some(format!("give a shorter --{}", which.key())),
        RunError::DelayTooShort { .. } | RunError::LagTooShort { .. } => {
            Some("give a step with --step, or a tolerance with --tol".to_owned())
        }
        RunError::TooManySteps { .. } => {
            Some("give a longer --step, a shorter --for or fewer repetitions".to_owned())
        }
        RunError::TooManyNumbers { .. } => {
            Some("give a longer --every, a shorter --for or fewer repetitions".to_owned())
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tolerance_is_a_share_of_100_v() {
        assert_eq!(["1e-6", " 0.01 % ", "1"].map(share), [Ok(1e-6), Ok(1e-4), Ok(1.0)]);
        let advice = |text: &str, share: &str| {
            Err(format!("\"{text}\" is a voltage, but the tolerance is a share of 100 V: write {share}"))
        };
        for (text, expected) in [("1e-6V", "1e-8"), ("100 uV", "1e-6")] {
            assert_eq!(share(text), advice(text, expected));
        }
        assert_eq!(share("5 s"), Err("\"5 s\" is in s, but a pure number is expected".to_owned()));
        assert_eq!(share("small"), Err("\"small\" is not a number".to_owned()));
        for text in ["2", "200V", "-5V", "1e-12V"] {
            let error = share(text).unwrap_err();
            assert!(error.starts_with("must be from 1e-13 to 1, such as 1e-6"), "{text}: {error}");
        }
    }
}
