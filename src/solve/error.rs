//! Why a run stopped, or never began.

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
        /// What was recorded until then.
        trace: Option<Box<Trace>>,
    },
    /// A loop without an integrator that has not exactly one solution.
    #[error("at t = {time} s the loop {members} has no integrator and {solutions}")]
    Loop {
        /// The members, in order.
        members: String,
        /// What can be said of its solutions.
        solutions: String,
        /// When, in problem seconds.
        time: f64,
    },
    /// Changes of mode without end.
    #[error(
        "{element} changed its mode more than {most} times within one step at t = {time} s: it chatters; \
         give it hysteresis, or take a shorter step"
    )]
    Chatter {
        /// The element.
        element: String,
        /// The limit.
        most: usize,
        /// When, in problem seconds.
        time: f64,
    },
    /// A delay shorter than the step.
    #[error(
        "{element} delays by {delay} s, less than the step of {step} s; take a step of at most {delay} s (--step)"
    )]
    DelayTooShort {
        /// The delay line.
        element: String,
        /// Its delay in problem seconds.
        delay: f64,
        /// The step in problem seconds.
        step: f64,
    },
    /// A parameter that does not exist.
    #[error("there is no parameter {0} to set")]
    UnknownParameter(String),
    /// An element that does not exist.
    #[error("there is no element {0}")]
    UnknownElement(String),
    /// A parameter, or what follows from it, outside what is allowed.
    #[error("{what} comes to {value}, outside {low} ... {high}")]
    OutsideRange {
        /// The parameter or the setting.
        what: String,
        /// Its value.
        value: f64,
        /// Least value allowed.
        low: f64,
        /// Largest value allowed.
        high: f64,
    },
    /// Lengths of time that make no run.
    #[error("{0}")]
    Plan(String),
}
