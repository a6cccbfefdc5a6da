//! Errors of a run: why it stopped, or could not begin.
//!
//! Every message says what is wrong, at which element and problem time, and what the user can do. [`RunError::code`] is
//! the stable name for programs. [`RunError::element`] is the element whose line in the patch the command line prints.
//! Options of the command line are not named here: the command line adds them.

use super::time_setting::TimeSetting;
use crate::document::{format_distinct, format_number, format_outside, range_violation};
use crate::ir::SettingError;

/// Why a run stopped, or could not begin.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{Machine, RunError};
///
/// let lag = ElementBuilder::new("lag").cords("x1", ["+100"]).set("time", 1e-4);
/// let patch = PatchBuilder::new("fast lag").element("L1", lag).build()?;
/// let program = Program::new(&Circuit::new(&patch)?)?;
/// let error: RunError = Machine::new(&program, 1e-3).unwrap_err();
/// assert_eq!((error.code(), error.element()), ("lag-too-short", Some("L1")));
/// assert!(error.to_string().ends_with("choose a step of at most 0.0001 s"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The output of an element is not a number.
    #[error(
        "the output of {element} is not a number at t = {time} s; look for an overflow or a division by 0 in its inputs"
    )]
    NotANumber {
        /// The first element, in the order of evaluation, whose output is not a number.
        element: String,
        /// Problem time in seconds.
        time: f64,
    },
    /// A loop without an integrator does not have exactly one solution. Example: "at t = 0.5 s the loop M, A5 has no
    /// integrator and 3 solutions: ...".
    #[error("at t = {time} s the loop {members} has no integrator and {solutions}; {advice}")]
    Loop {
        /// Names of the members, in their order in the loop, separated by ", ".
        members: String,
        /// Name of the member whose output is the unknown for which the loop is solved.
        opened: String,
        /// The number of solutions and their voltages, as a phrase that follows "has no integrator and".
        solutions: String,
        /// Advice to the user, as a sentence without a full stop.
        advice: &'static str,
        /// Problem time in seconds.
        time: f64,
    },
    /// A quantity has no derivative by a parameter, in the whole run.
    #[error("there is no derivative by {parameter}: {why}")]
    NoDerivative {
        /// Name of the parameter.
        parameter: String,
        /// The reason and the advice, separated by ";".
        why: String,
    },
    /// A derivative by a parameter is too large for a number, in its unit or in volts.
    #[error(
        "there is no derivative by {parameter}: at t = {time} s it is not a finite number; check the scales and the \
         range of the parameter, or end the run earlier"
    )]
    InfiniteDerivative {
        /// Name of the parameter.
        parameter: String,
        /// Problem time in seconds.
        time: f64,
    },
    /// The derivative by a parameter exists up to an event, and not after it. The state after the event would jump if
    /// the parameter changed.
    #[error(
        "at t = {time} s {element} {why}; from there on there is no derivative by {parameter}; end the run earlier, or \
         change a parameter slightly"
    )]
    DerivativeLost {
        /// Name of the parameter.
        parameter: String,
        /// Name of the element that switches.
        element: String,
        /// The reason, as a phrase that follows the name of the element.
        why: String,
        /// Problem time in seconds.
        time: f64,
    },
    /// A mode changes, or a kink is crossed, so often that time would not advance (chatter).
    #[error(
        "{element} switched more than {max} times within {within} s at t = {time} s: it chatters; {advice}",
        within = format_number(*within), time = format_number(*time)
    )]
    Chatter {
        /// Name of the element that switches, or whose curve has the kink.
        element: String,
        /// The largest number of changes allowed.
        max: usize,
        /// The length of time for which that number is allowed, in problem seconds.
        within: f64,
        /// Problem time in seconds.
        time: f64,
        /// Advice to the user, as a sentence without a full stop.
        advice: &'static str,
    },
    /// No step is short enough to keep the error of a voltage within the tolerance.
    #[error(
        "{element} changes too fast at t = {time} s: even a step of {step} s exceeds the tolerance; choose a larger \
         tolerance, or find out why the voltage diverges there",
        time = format_number(*time), step = format_number(*step)
    )]
    StepTooShort {
        /// Name of the integrator or lag with the largest error, or of the element whose sine or cosine turns too fast.
        element: String,
        /// Problem time in seconds.
        time: f64,
        /// The shortest step tried, in problem seconds.
        step: f64,
    },
    /// A delay is shorter than the step. Only equal steps have this limit: adaptive steps are at most as long as a
    /// delay.
    #[error(
        "{element} delays by {delay} s, less than the step of {step} s; choose a step of at most {delay} s",
        delay = format_distinct(*delay, *step), step = format_distinct(*step, *delay)
    )]
    DelayTooShort {
        /// Name of the delay line.
        element: String,
        /// Its delay in problem seconds.
        delay: f64,
        /// The step in problem seconds.
        step: f64,
    },
    /// The time constant of a lag is shorter than the step. Only equal steps have this limit.
    #[error(
        "{element} has a time constant of {time} s, less than the step of {step} s; choose a step of at most {time} s",
        time = format_distinct(*time, *step), step = format_distinct(*step, *time)
    )]
    LagTooShort {
        /// Name of the lag.
        element: String,
        /// Its time constant in problem seconds.
        time: f64,
        /// The step in problem seconds.
        step: f64,
    },
    /// A parameter is unknown, or it or a setting that follows from it is outside its range.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// No element has this name. The field is the name.
    #[error("there is no element {0}; choose a name from the patch")]
    UnknownElement(String),
    /// No signal, element or drive has this name, so it cannot be recorded. The field is the name.
    #[error("there is no signal {0} to record; choose a signal, an element or a drive of the patch")]
    UnknownSignal(String),
    /// An integrator was to be set to a voltage outside its limits.
    #[error(
        "{integrator} cannot be set to {volts} V, {fault}; choose a voltage within the limits",
        volts = format_outside(*volts, (*low, *high)),
        fault = range_violation(*volts, (*low, *high), "V")
    )]
    StateOutsideRange {
        /// Name of the integrator.
        integrator: String,
        /// The voltage that was given, in volts.
        volts: f64,
        /// Lower limit of the integrator in volts.
        low: f64,
        /// Upper limit of the integrator in volts.
        high: f64,
    },
    /// A phase waits for an element that does not switch. The field is its name.
    #[error("{0} does not switch, so no phase can wait for it; name a relay")]
    NotARelay(String),
    /// A phase waits for a position that its relay does not have.
    #[error("{relay} has no position \"{position}\"; choose {known}")]
    UnknownPosition {
        /// Name of the relay.
        relay: String,
        /// The position that was given.
        position: String,
        /// The positions of the relay, joined by " or ".
        known: String,
    },
    /// A phase sets a parameter to a formula that has no value, or whose unit does not fit.
    #[error("{parameter} cannot be set to {formula}: {message}; correct the formula in the phase")]
    BadFormula {
        /// Name of the parameter.
        parameter: String,
        /// Text of the formula.
        formula: String,
        /// What is wrong with the formula.
        message: String,
    },
    /// A phase sets a parameter on which the scale of a recorded signal depends.
    #[error(
        "a phase would change the scale of {signal} within its record; set the parameter before the run, or do not \
         record {signal}"
    )]
    Rescaled {
        /// Name of the signal.
        signal: String,
    },
    /// No phase of the run takes time.
    #[error("no phase of the run takes any time; add a phase \"operate\" or \"hold\"")]
    NoTime,
    /// A repetition without phases, or of 0 times.
    #[error("a repetition has no phases or 0 times; give it at least one phase and one time")]
    EmptyRepeat,
    /// Neither the patch nor the caller specifies these times, which a run needs. The list is not empty.
    #[error("the patch's \"run\" does not give {}", name_list(.0))]
    MissingTimes(Vec<TimeSetting>),
    /// A time is not positive and finite.
    #[error("{which} must be positive and finite, got {value} s", value = format_number(*value))]
    NotATime {
        /// The use of the time.
        which: TimeSetting,
        /// The value that was given, in seconds.
        value: f64,
    },
    /// The time over which a machine is to operate is negative or not finite; 0 is allowed.
    #[error("the time to operate must be finite and at least 0 s, got {value} s", value = format_number(*value))]
    NotAnOperatingTime {
        /// The value that was given, in problem seconds.
        value: f64,
    },
    /// The tolerance is too small, too large or not a number.
    #[error(
        "the tolerance must be from {min} to {max}, got {value}; rounding makes smaller errors impossible",
        value = format_outside(*value, (*min, *max)), min = format_distinct(*min, *value),
        max = format_distinct(*max, *value)
    )]
    NotATolerance {
        /// The value that was given, as a share of 100 V.
        value: f64,
        /// The smallest tolerance that is allowed, [`MIN_TOLERANCE`](crate::document::MIN_TOLERANCE).
        min: f64,
        /// The largest tolerance that is allowed, [`MAX_TOLERANCE`](crate::document::MAX_TOLERANCE).
        max: f64,
    },
    /// The step, or the time between samples, is longer than the run.
    #[error(
        "{which} is {value} s, longer than the run of {duration} s",
        value = format_distinct(*value, *duration), duration = format_distinct(*duration, *value)
    )]
    LongerThanRun {
        /// The use of the time.
        which: TimeSetting,
        /// The time in problem seconds.
        value: f64,
        /// The longest time between two initial conditions, in problem seconds.
        duration: f64,
    },
    /// The run would take too many steps, or an adaptive run has taken too many.
    #[error(
        "the run would take {steps}; at most {max} are allowed",
        steps = steps_text(*steps, *max), max = format_distinct(*max, *steps)
    )]
    TooManySteps {
        /// Steps of all phases, with repetitions.
        steps: f64,
        /// The largest number allowed.
        max: f64,
    },
    /// The run would take too many steps, most of the additional ones because of a noise drive. Each of its numbers
    /// ends a step.
    #[error(
        "{element} draws a number every {every} s, {numbers} in the run, and each ends a step; the run would take up to \
         {steps}; at most {max} are allowed; choose a longer \"every\" of {element}",
        every = format_number(*every), numbers = count_text(*numbers, *max),
        steps = steps_text(*steps, *max), max = format_distinct(*max, *steps)
    )]
    NoiseTooFine {
        /// Name of the noise drive.
        element: String,
        /// Problem seconds between two numbers.
        every: f64,
        /// Numbers drawn in all phases, with repetitions.
        numbers: f64,
        /// Steps of all phases, with repetitions: the equal steps, and those that end at a jump of a drive.
        steps: f64,
        /// The largest number of steps allowed.
        max: f64,
    },
    /// The run would take too many steps, most of the additional ones because of a drive with edges. Each edge ends a
    /// step.
    #[error(
        "{element} has {edges} edges in the run, and each ends a step; the run would take up to {steps}; at most {max} \
         are allowed; choose a lower frequency or a longer period of {element}",
        edges = count_text(*edges, *max), steps = steps_text(*steps, *max), max = format_distinct(*max, *steps)
    )]
    PulsesTooFast {
        /// Name of the drive.
        element: String,
        /// Edges in all phases, with repetitions.
        edges: f64,
        /// Steps of all phases, with repetitions: the equal steps, and those that end at a jump of a drive.
        steps: f64,
        /// The largest number of steps allowed.
        max: f64,
    },
    /// The run would record too many numbers for the memory, or for a table.
    #[error(
        "the run would record {numbers} numbers; at most {max} are allowed",
        numbers = count_text(*numbers, *max), max = format_distinct(*max, *numbers)
    )]
    TooManyNumbers {
        /// The recorded numbers, with repetitions: times and signals of every sample, 16 numbers for every phase and
        /// every parameter set, and 6 for every phase and signal.
        numbers: f64,
        /// The largest number allowed.
        max: f64,
    },
}

impl RunError {
    /// The element of the patch that the error is about; `None` if it is not about one element. For a loop it is the
    /// member whose output is the unknown.
    pub fn element(&self) -> Option<&str> {
        match self {
            RunError::NotANumber { element, .. }
            | RunError::Loop { opened: element, .. }
            | RunError::DerivativeLost { element, .. }
            | RunError::Chatter { element, .. }
            | RunError::StepTooShort { element, .. }
            | RunError::DelayTooShort { element, .. }
            | RunError::LagTooShort { element, .. }
            | RunError::StateOutsideRange { integrator: element, .. }
            | RunError::NotARelay(element)
            | RunError::UnknownPosition { relay: element, .. }
            | RunError::NoiseTooFine { element, .. }
            | RunError::PulsesTooFast { element, .. } => Some(element),
            _ => None,
        }
    }

    /// Whether the error may depend on the length of equal steps, so that a run with shorter ones may have none.
    pub fn may_depend_on_step(&self) -> bool {
        match self {
            RunError::NotANumber { .. }
            | RunError::Loop { .. }
            | RunError::InfiniteDerivative { .. }
            | RunError::DerivativeLost { .. }
            | RunError::Chatter { .. }
            | RunError::DelayTooShort { .. }
            | RunError::LagTooShort { .. } => true,
            RunError::LongerThanRun { which, .. } => *which == TimeSetting::Step,
            _ => false,
        }
    }

    /// A stable name for programs that read failures, such as "chatter". JSON output contains it under "code".
    pub fn code(&self) -> &'static str {
        match self {
            RunError::NotANumber { .. } => "not-a-number",
            RunError::Loop { .. } => "loop-unsolved",
            RunError::NoDerivative { .. } | RunError::InfiniteDerivative { .. } => "no-derivative",
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
            RunError::PulsesTooFast { .. } => "pulses-too-fast",
            RunError::MissingTimes(_) => "missing-time",
            RunError::NotATime { .. } | RunError::NotAnOperatingTime { .. } => "not-a-time",
            RunError::NotATolerance { .. } => "not-a-tolerance",
            RunError::LongerThanRun { .. } => "longer-than-run",
            RunError::TooManySteps { .. } => "too-many-steps",
            RunError::TooManyNumbers { .. } => "too-many-numbers",
        }
    }
}

/// The names of times and how they are written, joined by "and": "the length of the run ("for": SECONDS) and the step
/// ("step": SECONDS)".
fn name_list(times: &[TimeSetting]) -> String {
    let names: Vec<_> = times.iter().map(|time| format!("{time} (\"{}\": SECONDS)", time.key())).collect();
    names.join(" and ")
}

/// A number of steps, with the time that they take at a million steps a second. The time is left out if the number is
/// too large for a floating-point number. `max` is the number that is allowed.
fn steps_text(steps: f64, max: f64) -> String {
    let count = count_text(steps, max);
    match steps.is_finite() {
        true => format!("{count} steps, {} at a million steps a second", computing_time(steps)),
        false => format!("{count} steps"),
    }
}

/// A count in a message, with the digits by which it differs from the number that is allowed. A count that is too large
/// for a floating-point number is infinite, and has a lower limit only.
fn count_text(count: f64, max: f64) -> String {
    if count.is_finite() { format_distinct(count, max) } else { "more than 1e308".to_owned() }
}

/// The time that a number of steps takes at a million steps a second, in whole hours, days or years. The speed is a
/// round number; docs/performance.md has measured ones.
fn computing_time(steps: f64) -> String {
    let hours = steps / 1e6 / 3600.0;
    match hours {
        ..48.0 => format!("{hours:.0} hours"),
        ..17520.0 => format!("{:.0} days", hours / 24.0),
        _ => format!("{} years", format_number((hours / 8760.0).round())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shorter_step_may_help_against_errors_of_the_solver_only() {
        let longer = |which| RunError::LongerThanRun { which, value: 2.0, duration: 1.0 };
        let not_a_number = RunError::NotANumber { element: "A1".to_owned(), time: 0.5 };
        assert!(not_a_number.may_depend_on_step() && longer(TimeSetting::Step).may_depend_on_step());
        let unknown = RunError::UnknownSignal("x".to_owned());
        let steps = RunError::TooManySteps { steps: 2e10, max: 1e10 };
        for error in [unknown, steps, longer(TimeSetting::Every), RunError::NoTime] {
            assert!(!error.may_depend_on_step(), "{error}");
        }
    }

    #[test]
    fn a_number_above_a_limit_differs_from_it() {
        let numbers = RunError::TooManyNumbers { numbers: 2e8 + 2.0, max: 2e8 };
        let text = "the run would record 2.00000002e8 numbers; at most 2e8 are allowed";
        assert_eq!(numbers.to_string(), text);
        let steps = RunError::TooManySteps { steps: 1e10 + 1.0, max: 1e10 };
        assert!(steps.to_string().starts_with("the run would take 1.0000000001e10 steps, "), "{steps}");
        let longer =
            RunError::LongerThanRun { which: TimeSetting::Step, value: 2.000_000_4, duration: 2.000_000_1 };
        assert_eq!(longer.to_string(), "the step is 2.0000004 s, longer than the run of 2.0000001 s");
    }
}
