//! Errors of a run: why it stopped, or could not begin.

use std::fmt;

use crate::document::{outside, told};
use crate::ir::SettingError;
use crate::trace::Trace;

/// Why a run stopped, or could not begin.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RunError {
    /// The output of an element is not a number.
    #[error("{element} gave a voltage that is not a number at t = {time} s")]
    NotANumber {
        /// The first element, in the order of evaluation, whose output is not a number.
        element: String,
        /// Problem time in seconds.
        time: f64,
    },
    /// A loop without an integrator does not have exactly one solution.
    #[error("at t = {time} s the loop {members} has no integrator and {solutions}; {advice}")]
    Loop {
        /// Names of the members, in their order in the loop.
        members: String,
        /// Name of the member at which the loop is opened for the solution.
        opened: String,
        /// The number of solutions, as a phrase.
        solutions: String,
        /// Advice to the user.
        advice: &'static str,
        /// Problem time in seconds.
        time: f64,
    },
    /// A quantity has no derivative by a parameter.
    #[error("there is no derivative by {parameter}: {why}")]
    NoDerivative {
        /// Name of the parameter.
        parameter: String,
        /// The reason.
        why: String,
    },
    /// The derivative by a parameter ends at an event.
    #[error("at t = {time} s {element} {why}: there is no derivative by {parameter} from there on")]
    DerivativeLost {
        /// The parameter.
        parameter: String,
        /// Name of the element that switches.
        element: String,
        /// The reason, as a phrase that follows the name of the element.
        why: String,
        /// Problem time in seconds.
        time: f64,
    },
    /// A mode changes, or a kink is crossed, again and again (chatter).
    #[error(
        "{element} switched more than {most} times within {within} s at t = {time} s: it chatters; {advice}",
        within = told(*within), time = told(*time)
    )]
    Chatter {
        /// The element.
        element: String,
        /// The largest number of changes allowed.
        most: usize,
        /// The time in which they are allowed, in problem seconds.
        within: f64,
        /// Problem time in seconds.
        time: f64,
        /// Advice to the user.
        advice: &'static str,
    },
    /// No step is short enough to keep the error of a voltage within the tolerance.
    #[error(
        "{element} cannot be followed at t = {time} s: even a step of {step} s exceeds the tolerance; take a larger \
         tolerance, or find out why the voltage diverges there",
        time = told(*time), step = told(*step)
    )]
    StepTooShort {
        /// The integrator or lag with the largest error, or the element that takes a sine or cosine.
        element: String,
        /// Problem time in seconds.
        time: f64,
        /// The shortest step tried, in problem seconds.
        step: f64,
    },
    /// A delay is shorter than the step.
    #[error(
        "{element} delays by {delay} s, less than the step of {step} s; take a step of at most {delay} s",
        delay = told(*delay), step = told(*step)
    )]
    DelayTooShort {
        /// Name of the delay line.
        element: String,
        /// Its delay in problem seconds.
        delay: f64,
        /// The step in problem seconds.
        step: f64,
    },
    /// The time constant of a lag is shorter than the step.
    #[error(
        "{element} has a time constant of {time} s, less than the step of {step} s; take a step of at most {time} s",
        time = told(*time), step = told(*step)
    )]
    LagTooShort {
        /// Name of the lag.
        element: String,
        /// Its time constant in problem seconds.
        time: f64,
        /// The step in problem seconds.
        step: f64,
    },
    /// A parameter, or a setting that follows from one, cannot have a value.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// No element has this name.
    #[error("there is no element {0}")]
    UnknownElement(String),
    /// No signal has this name.
    #[error("there is no signal {0} to record")]
    UnknownSignal(String),
    /// An integrator set to a voltage outside its limits.
    #[error(
        "{integrator} cannot be set to {volts} V, {fault}",
        volts = told(*volts),
        fault = outside(*volts, (*low, *high), "V")
    )]
    StateOutsideRange {
        /// The integrator.
        integrator: String,
        /// The voltage that was given.
        volts: f64,
        /// Lower limit of the integrator in volts.
        low: f64,
        /// Upper limit of the integrator in volts.
        high: f64,
    },
    /// A phase waits for an element that does not switch.
    #[error("{0} does not switch: a phase can wait for a relay only")]
    NotARelay(String),
    /// A phase waits for a position that its relay does not have.
    #[error("{relay} does not become \"{position}\", but {known}")]
    UnknownPosition {
        /// Name of the relay.
        relay: String,
        /// The position that was given.
        position: String,
        /// The positions of the relay, joined by "or".
        known: String,
    },
    /// The formula that a phase sets a parameter to has no value.
    #[error("{parameter} cannot be set to {formula}: {message}")]
    BadFormula {
        /// Name of the parameter.
        parameter: String,
        /// Text of the formula.
        formula: String,
        /// The error of the formula.
        message: String,
    },
    /// A phase sets a parameter on which the scale of a recorded signal depends.
    #[error("the scale of {signal} would change within its record")]
    Rescaled {
        /// Name of the signal.
        signal: String,
    },
    /// No phase of the run takes time.
    #[error("no phase of the run takes any time")]
    NoTime,
    /// A repetition without phases, or of 0 times.
    #[error("a repetition has no phases, or is repeated 0 times")]
    EmptyRepeat,
    /// Times that a run needs, and that neither the patch nor the caller specifies.
    #[error("the patch's \"run\" does not give {}", listed(.0))]
    Missing(Vec<TimeSetting>),
    /// A time is not positive and finite.
    #[error("{which} must be positive, got {value} s", value = told(*value))]
    NotATime {
        /// The use of the time.
        which: TimeSetting,
        /// The value that was given.
        value: f64,
    },
    /// The tolerance is too small or not finite.
    #[error(
        "the tolerance must be at least {least}, got {value}: rounding makes smaller errors impossible",
        value = told(*value), least = told(*least)
    )]
    NotATolerance {
        /// The value that was given.
        value: f64,
        /// The least tolerance.
        least: f64,
    },
    /// The step, or the time between samples, is longer than the run.
    #[error(
        "{which} is {value} s, longer than the run of {duration} s",
        value = told(*value), duration = told(*duration)
    )]
    LongerThanRun {
        /// The use of the time.
        which: TimeSetting,
        /// The time in problem seconds.
        value: f64,
        /// Length of the run in problem seconds.
        duration: f64,
    },
    /// The run would take too many steps.
    #[error(
        "the run would take {steps} steps, {work} at a million steps a second; at most {most} are allowed",
        steps = told(*steps), work = work(*steps), most = told(*most)
    )]
    TooManySteps {
        /// Steps of all phases, with repetitions.
        steps: f64,
        /// The largest number allowed.
        most: f64,
    },
    /// A noise drive would draw too many numbers.
    #[error(
        "{element} would draw {numbers} numbers in the run; at most {most} are allowed; choose a longer \"every\"",
        numbers = told(*numbers), most = told(*most)
    )]
    NoiseTooFine {
        /// Name of the drive.
        element: String,
        /// Numbers drawn in all phases, with repetitions.
        numbers: f64,
        /// The largest number allowed.
        most: f64,
    },
    /// The run would record too many numbers for the memory.
    #[error(
        "the run would record {numbers} numbers; at most {most} are allowed",
        numbers = told(*numbers), most = told(*most)
    )]
    TooManyNumbers {
        /// The recorded numbers, with repetitions: times and signals of every sample, 16 numbers for every phase and
        /// every parameter set, and 6 for every phase and signal.
        numbers: f64,
        /// The largest number allowed.
        most: f64,
    },
}

impl RunError {
    /// The element that the error is about; `None` if it is not about one element.
    pub fn element(&self) -> Option<&str> {
        match self {
            RunError::NotANumber { element, .. }
            | RunError::Loop { opened: element, .. }
            | RunError::Chatter { element, .. }
            | RunError::DelayTooShort { element, .. }
            | RunError::LagTooShort { element, .. }
            | RunError::NoiseTooFine { element, .. }
            | RunError::DerivativeLost { element, .. } => Some(element),
            _ => None,
        }
    }

    /// A stable name for programs that read failures, such as "chatter".
    pub fn code(&self) -> &'static str {
        match self {
            RunError::NotANumber { .. } => "not-a-number",
            RunError::Loop { .. } => "loop-unsolved",
            RunError::NoDerivative { .. } => "no-derivative",
            RunError::DerivativeLost { .. } => "derivative-lost",
            RunError::Chatter { .. } => "chatter",
            RunError::StepTooShort { .. } => "step-too-short",
            RunError::DelayTooShort { .. } => "delay-too-short",
            RunError::LagTooShort { .. } => "lag-too-short",
            RunError::Setting(error) => error.code(),
            RunError::UnknownElement(_) => "unknown-element",
            RunError::UnknownSignal(_) => "unknown-signal",
            RunError::StateOutsideRange { .. } => "outside-range",
            RunError::NotARelay(_) => "not-a-relay",
            RunError::UnknownPosition { .. } => "unknown-position",
            RunError::BadFormula { .. } => "bad-formula",
            RunError::Rescaled { .. } => "scale-in-run",
            RunError::NoTime => "no-time",
            RunError::EmptyRepeat => "empty-repeat",
            RunError::NoiseTooFine { .. } => "noise-too-fine",
            RunError::Missing(_) => "missing-time",
            RunError::NotATime { .. } => "not-a-time",
            RunError::NotATolerance { .. } => "not-a-tolerance",
            RunError::LongerThanRun { .. } => "longer-than-run",
            RunError::TooManySteps { .. } => "too-many-steps",
            RunError::TooManyNumbers { .. } => "too-many-numbers",
        }
    }
}

/// The times in the settings of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeSetting {
    /// Length of the run, or of a phase in which the machine operates.
    Duration,
    /// Length of a hold.
    Hold,
    /// Length of the solver's steps.
    Step,
    /// Time between recorded samples.
    Every,
}

impl TimeSetting {
    /// The key of the time in the `run` of a patch, or in a phase.
    pub fn key(self) -> &'static str {
        match self {
            TimeSetting::Duration => "for",
            TimeSetting::Hold => "hold",
            TimeSetting::Step => "step",
            TimeSetting::Every => "every",
        }
    }
}

impl fmt::Display for TimeSetting {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            TimeSetting::Duration => "the length of the run",
            TimeSetting::Hold => "the length of a hold",
            TimeSetting::Step => "the step",
            TimeSetting::Every => "the time between samples",
        })
    }
}

/// The names and keys of times, joined by "and".
fn listed(times: &[TimeSetting]) -> String {
    let names: Vec<_> = times.iter().map(|time| format!("{time} (\"{}\")", time.key())).collect();
    names.join(" and ")
}

/// The time that a number of steps takes at a million steps a second, in whole hours, days or years.
fn work(steps: f64) -> String {
    let hours = steps / 1e6 / 3600.0;
    match hours {
        ..48.0 => format!("{hours:.0} hours"),
        ..17520.0 => format!("{:.0} days", hours / 24.0),
        _ => format!("{} years", told((hours / 8760.0).round())),
    }
}

/// A run that stopped before its end.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{error}")]
pub struct Stopped {
    /// The reason.
    pub error: RunError,
    /// The record up to then; empty if the run did not begin.
    pub trace: Box<Trace>,
}

impl From<RunError> for Stopped {
    fn from(error: RunError) -> Self {
        Stopped { error, trace: Box::default() }
    }
}
