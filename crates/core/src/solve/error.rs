//! Why a run stopped, or never began.

use std::fmt;

use crate::document::{behind, outside, told};
use crate::trace::Trace;

/// What went wrong with a run.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RunError {
    /// A voltage that is not a number.
    #[error("{element} gave a voltage that is not a number at t = {time} s")]
    NotANumber {
        /// The first element, in the order of working out, whose output is not a number.
        element: String,
        /// When, in problem seconds.
        time: f64,
    },
    /// A loop without an integrator that has not exactly one solution.
    #[error("at t = {time} s the loop {members} has no integrator and {solutions}; {advice}")]
    Loop {
        /// The members, in order.
        members: String,
        /// The member that opens it.
        opened: String,
        /// What can be said of its solutions.
        solutions: String,
        /// What to do about it.
        advice: &'static str,
        /// When, in problem seconds.
        time: f64,
    },
    /// A parameter by which there is no derivative.
    #[error("there is no derivative by {parameter}: {why}")]
    NoDerivative {
        /// The parameter.
        parameter: String,
        /// Why.
        why: String,
    },
    /// An event at which the derivative by a parameter ends.
    #[error("at t = {time} s {element} {why}: there is no derivative by {parameter} from there on")]
    DerivativeLost {
        /// The parameter.
        parameter: String,
        /// What switches.
        element: String,
        /// How it does.
        why: String,
        /// When, in problem seconds.
        time: f64,
    },
    /// Changes of mode without end.
    #[error(
        "{element} switched more than {most} times within {within} s at t = {time} s: it chatters; {advice}",
        within = told(*within), time = told(*time)
    )]
    Chatter {
        /// The element.
        element: String,
        /// The limit.
        most: usize,
        /// The span of time, in problem seconds.
        within: f64,
        /// When, in problem seconds.
        time: f64,
        /// What to do about it.
        advice: &'static str,
    },
    /// A voltage that no step is short enough to follow.
    #[error(
        "{element} cannot be followed at t = {time} s: even a step of {step} s is not right to the tolerance; take a \
         larger tolerance, or look for what makes the voltage run away there",
        time = told(*time), step = told(*step)
    )]
    StepTooShort {
        /// The integrator or lag whose error is largest, or what takes a periodic function.
        element: String,
        /// When, in problem seconds.
        time: f64,
        /// The step that was too long, in problem seconds.
        step: f64,
    },
    /// A delay shorter than the step.
    #[error(
        "{element} delays by {delay} s, less than the step of {step} s; take a step of at most {delay} s",
        delay = told(*delay), step = told(*step)
    )]
    DelayTooShort {
        /// The delay line.
        element: String,
        /// Its delay in problem seconds.
        delay: f64,
        /// The step in problem seconds.
        step: f64,
    },
    /// A lag shorter than the step.
    #[error(
        "{element} has a time constant of {time} s, less than the step of {step} s; take a step of at most {time} s",
        time = told(*time), step = told(*step)
    )]
    LagTooShort {
        /// The lag.
        element: String,
        /// Its time constant in problem seconds.
        time: f64,
        /// The step in problem seconds.
        step: f64,
    },
    /// A parameter that does not exist.
    #[error("there is no parameter {0} to set")]
    UnknownParameter(String),
    /// An element that does not exist.
    #[error("there is no element {0}")]
    UnknownElement(String),
    /// A signal that does not exist.
    #[error("there is no signal {0} to record")]
    UnknownSignal(String),
    /// A parameter, or what follows from it, outside what is allowed.
    #[error(
        "{what} comes to {value}{unit}, {fault}",
        value = told(*value),
        unit = behind(unit),
        fault = outside(*value, (*low, *high), unit)
    )]
    OutsideRange {
        /// The parameter or the setting.
        what: String,
        /// Its value.
        value: f64,
        /// Least value allowed.
        low: f64,
        /// Largest value allowed.
        high: f64,
        /// Text of the unit of a parameter or a voltage; empty where it is not known.
        unit: String,
    },
    /// A setting that does not stand to another of its element as it must.
    #[error("{what} comes to {value}, {stands} {other} at {limit}", value = told(*value), limit = told(*limit))]
    OutOfOrder {
        /// The setting.
        what: String,
        /// Its value.
        value: f64,
        /// How it stands to the other: "not below", "below" or "above".
        stands: &'static str,
        /// The other setting.
        other: String,
        /// The other's value.
        limit: f64,
    },
    /// An element that a phase waits for and that does not switch.
    #[error("{0} does not switch: a phase can wait for a relay only")]
    NotARelay(String),
    /// A position that a relay does not have.
    #[error("{relay} does not become \"{position}\", but {known}")]
    UnknownPosition {
        /// The relay.
        relay: String,
        /// What was waited for.
        position: String,
        /// What it becomes.
        known: String,
    },
    /// A parameter that cannot be set to what its formula says.
    #[error("{parameter} cannot be set to {formula}: {message}")]
    BadFormula {
        /// The parameter.
        parameter: String,
        /// The formula as it was written.
        formula: String,
        /// What is wrong with it.
        message: String,
    },
    /// A parameter set within the run on which the scale of a recorded signal depends.
    #[error("the scale of {signal} would change within its record")]
    Rescaled {
        /// The signal.
        signal: String,
    },
    /// A run without a phase that takes time.
    #[error("no phase of the run takes any time")]
    NoTime,
    /// A repetition of nothing, or no repetition.
    #[error("a phase repeats nothing, or no times")]
    EmptyRepeat,
    /// A number that must be whole and is not.
    #[error("{what} comes to {value}, and must be a whole number", value = told(*value))]
    NotWhole {
        /// The setting.
        what: String,
        /// Its value.
        value: f64,
    },
    /// Times that a run cannot do without, and that nobody gave.
    #[error("the patch's \"run\" does not give {}", listed(.0))]
    Missing(Vec<TimeSetting>),
    /// A time that is none.
    #[error("{which} must be a time above 0 s, not {value} s", value = told(*value))]
    NotATime {
        /// What it is for.
        which: TimeSetting,
        /// What was given.
        value: f64,
    },
    /// A tolerance that is none.
    #[error(
        "the tolerance must be a number from {least} on, not {value}: the rounding of numbers is no smaller",
        value = told(*value), least = told(*least)
    )]
    NotATolerance {
        /// What was given.
        value: f64,
        /// The limit.
        least: f64,
    },
    /// A step, or a time between samples, that is longer than the run.
    #[error(
        "{which} is {value} s, longer than the run of {duration} s",
        value = told(*value), duration = told(*duration)
    )]
    LongerThanRun {
        /// What it is for.
        which: TimeSetting,
        /// Its length in problem seconds.
        value: f64,
        /// Length of the run in problem seconds.
        duration: f64,
    },
    /// More steps than anybody will wait for.
    #[error(
        "the run would take {steps} steps, {work} at a million steps a second; at most {most} are allowed",
        steps = told(*steps), work = work(*steps), most = told(*most)
    )]
    TooManySteps {
        /// Steps of all its phases, repetitions counted.
        steps: f64,
        /// The limit.
        most: f64,
    },
    /// More numbers of noise than anybody will wait for.
    #[error(
        "{element} would draw {numbers} numbers in the run; at most {most} are allowed; choose a longer \"every\"",
        numbers = told(*numbers), most = told(*most)
    )]
    NoiseTooFine {
        /// The drive.
        element: String,
        /// Numbers of all repetitions.
        numbers: f64,
        /// The limit.
        most: f64,
    },
    /// More recorded numbers than fit into memory.
    #[error(
        "the run would record {numbers} numbers; at most {most} are allowed",
        numbers = told(*numbers), most = told(*most)
    )]
    TooManyNumbers {
        /// Times and signals of every sample, 16 for every phase and every parameter set, 6 for every phase and
        /// signal, repetitions counted.
        numbers: f64,
        /// The limit.
        most: f64,
    },
}

impl RunError {
    /// The element that it is about.
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

    /// A name that never changes, for programs that read failures.
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
            RunError::UnknownParameter(_) => "unknown-parameter",
            RunError::UnknownElement(_) => "unknown-element",
            RunError::UnknownSignal(_) => "unknown-signal",
            RunError::OutsideRange { .. } => "outside-range",
            RunError::OutOfOrder { .. } => "out-of-order",
            RunError::NotARelay(_) => "not-a-relay",
            RunError::UnknownPosition { .. } => "unknown-position",
            RunError::BadFormula { .. } => "bad-formula",
            RunError::Rescaled { .. } => "scale-in-run",
            RunError::NoTime => "no-time",
            RunError::EmptyRepeat => "empty-repeat",
            RunError::NotWhole { .. } => "not-whole",
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

/// The times that a run is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeSetting {
    /// Length of the run, or of a phase in which it operates.
    Duration,
    /// Length of a hold.
    Hold,
    /// Step of the solver.
    Step,
    /// Time between recorded samples.
    Every,
}

impl TimeSetting {
    /// Its key in the `run` of a patch, or in a phase.
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

fn listed(times: &[TimeSetting]) -> String {
    let told: Vec<_> = times.iter().map(|time| format!("{time} (\"{}\")", time.key())).collect();
    told.join(" and ")
}

/// How long a million steps a second take for so many, in whole hours, days or years.
fn work(steps: f64) -> String {
    let hours = steps / 1e6 / 3600.0;
    match hours {
        ..48.0 => format!("{hours:.0} hours"),
        ..17520.0 => format!("{:.0} days", hours / 24.0),
        _ => format!("{} years", told((hours / 8760.0).round())),
    }
}

/// A run that did not come to its end.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{error}")]
pub struct Stopped {
    /// Why it stopped.
    pub error: RunError,
    /// What was recorded until then; empty where the run never began.
    pub trace: Box<Trace>,
}

impl From<RunError> for Stopped {
    fn from(error: RunError) -> Self {
        Stopped { error, trace: Box::default() }
    }
}
