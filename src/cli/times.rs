//! The options that tell how long and how finely to run, and what is said of runs that cannot be made.

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use serde_json::{Value, json};

use super::failure::Failure;
use patchcord::circuit::Circuit;
use patchcord::document::{Placed, Span};
use patchcord::patch::RunPlan;
use patchcord::solve::{Backend, LEAST_TOLERANCE, RunError, RunSettings, TimeSetting};

#[derive(Args)]
pub(super) struct TimeArguments {
    /// How long to run, in problem seconds: one initial condition and operate, whatever phases the patch has
    #[arg(long = "for", value_name = "SECONDS", allow_hyphen_values = true, value_parser = seconds)]
    duration: Option<f64>,
    #[command(flatten)]
    fineness: FinenessArguments,
}

#[derive(Args)]
pub(super) struct FinenessArguments {
    /// Step of the solver, in problem seconds
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = seconds)]
    pub step: Option<f64>,
    /// Steps as long as this allows: what the errors of all steps may add up to, as a share of 100 V, say 1e-6
    #[arg(long = "tol", value_name = "SHARE", allow_hyphen_values = true, value_parser = share, conflicts_with = "step")]
    pub tolerance: Option<f64>,
    /// Time between recorded samples, in problem seconds
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = seconds)]
    pub every: Option<f64>,
    /// What works the steps out; all but the reference give the same bits. Native code is made of up to about 1100
    /// elements, more are interpreted; with a tolerance the reference takes all steps, whatever is chosen here
    #[arg(long, value_name = "BACKEND", value_parser = backend(), default_value_t)]
    pub backend: Backend,
}

/// The names of backends, which stand in the help and in completions.
fn backend() -> impl TypedValueParser<Value = Backend> {
    let named = |name: String| Backend::ALL.into_iter().find(|backend| backend.name() == name);
    PossibleValuesParser::new(Backend::ALL.map(Backend::name))
        .map(move |name| named(name).unwrap_or_default())
}

fn seconds(text: &str) -> Result<f64, String> {
    let seconds: f64 = text.parse().map_err(|_| format!("\"{text}\" is not a number"))?;
    if seconds > 0.0 && seconds.is_finite() {
        Ok(seconds)
    } else {
        Err("a time above 0 s is wanted".to_owned())
    }
}

fn share(text: &str) -> Result<f64, String> {
    let share: f64 = text.parse().map_err(|_| format!("\"{text}\" is not a number"))?;
    if (LEAST_TOLERANCE..1.0).contains(&share) {
        Ok(share)
    } else {
        Err(format!(
            "a number from {LEAST_TOLERANCE:e} to 1 is wanted, say 1e-6: the rounding of numbers is no smaller"
        ))
    }
}

/// How long and how finely a run goes, for `--json`.
pub(super) fn times_json(settings: &RunSettings) -> Value {
    json!({
        "for": settings.duration(),
        "step": settings.step,
        "tolerance": settings.tolerance,
        "every": settings.every,
    })
}

/// A value that stands on the command line.
pub(super) fn given(value: f64) -> Placed<f64> {
    Placed { value, span: Span::default() }
}

impl TimeArguments {
    /// The patch's plan with what the options change in it.
    pub fn plan(&self, patch: &RunPlan) -> RunPlan {
        let mut plan = patch.clone();
        if self.duration.is_some() {
            plan.phases.clear();
        }
        let FinenessArguments { step, tolerance, every, .. } = self.fineness;
        plan.duration = self.duration.map(given).or(plan.duration);
        plan.step = step.map(given).or(plan.step);
        // Who gives a step wants equal ones, who gives a tolerance does not.
        plan.tolerance = match step {
            Some(_) => None,
            None => tolerance.map(given).or(plan.tolerance),
        };
        plan.every = every.map(given).or(plan.every);
        plan
    }

    /// How a plan is run.
    ///
    /// # Errors
    /// Those of [`RunSettings::new`].
    pub fn settings(&self, plan: &RunPlan, circuit: &Circuit) -> Result<RunSettings, RunError> {
        Ok(RunSettings { backend: self.fineness.backend, ..RunSettings::new(plan, circuit)? })
    }

    /// Whether an error comes from these options rather than from the patch.
    pub fn is_to_blame(&self, error: &RunError) -> bool {
        matches!(error, RunError::Missing(_))
            || (self.duration.is_some() && is_of_times(error))
            || self.fineness.is_to_blame(error)
    }
}

impl FinenessArguments {
    /// Whether an error comes from these options rather than from what is run.
    pub fn is_to_blame(&self, error: &RunError) -> bool {
        match error {
            RunError::DelayTooShort { .. } | RunError::LagTooShort { .. } => self.step.is_some(),
            _ => is_of_times(error) && (self.step.is_some() || self.every.is_some()),
        }
    }
}

/// Whether the times of a run do not go with each other, or are too many.
fn is_of_times(error: &RunError) -> bool {
    matches!(
        error,
        RunError::LongerThanRun { .. }
            | RunError::NotATime { .. }
            | RunError::TooManySteps { .. }
            | RunError::TooManyNumbers { .. }
    )
}

/// What the error says, which option helps, and where. Who gave options is asked to give others.
pub(super) fn refused(error: &RunError, circuit: &Circuit, is_to_blame: bool) -> Failure {
    let message = with_advice(error) + &place_told(error, circuit);
    let failure = if is_to_blame { Failure::usage(message) } else { Failure::data(message) };
    failure.with("code", error.code().into())
}

/// Where the patch speaks of the element that an error is about.
pub(super) fn place_told(error: &RunError, circuit: &Circuit) -> String {
    let guilty = error.element().and_then(|element| Some((element, circuit.place_of(element)?)));
    let Some((element, (line, column))) = guilty else { return String::new() };
    format!("\n  --> {}:{line}:{column}: {element}", circuit.patch().file())
}

/// What an error says, and which option helps.
pub(super) fn with_advice(error: &RunError) -> String {
    match advice(error) {
        Some(advice) => format!("{error}: {advice}"),
        None => error.to_string(),
    }
}

/// The options that put an error right.
pub(super) fn advice(error: &RunError) -> Option<String> {
    let option = |time: &TimeSetting| match time {
        TimeSetting::Step => "--step or --tol".to_owned(),
        _ => format!("--{}", time.key()),
    };
    match error {
        RunError::Missing(times) => {
            Some(format!("give {}", times.iter().map(option).collect::<Vec<_>>().join(" and ")))
        }
        RunError::LongerThanRun { which, .. } => Some(format!("give a shorter one with {}", option(which))),
        RunError::DelayTooShort { .. } | RunError::LagTooShort { .. } => {
            Some("give one with --step, or a tolerance with --tol".to_owned())
        }
        RunError::TooManySteps { .. } => {
            Some("give a longer --step or a shorter --for, or repeat it less".to_owned())
        }
        RunError::TooManyNumbers { .. } => {
            Some("give a longer --every or a shorter --for, or repeat it less".to_owned())
        }
        _ => None,
    }
}
