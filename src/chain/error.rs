//! Why there is no chain.

use crate::instruments::{Display, NoCriticalVelocity};
use crate::patch::{EditError, Report, told};
use crate::slideway::SlidewayError;
use crate::solve::RunError;

/// Why there is no chain.
#[derive(Debug, thiserror::Error)]
pub enum ChainError {
    /// A law does not hold for the inputs.
    #[error(transparent)]
    Law(#[from] SlidewayError),
    /// The circuit has no such parameter.
    #[error("the circuit of Fig 8.16 has no parameter {name}; {hint}")]
    NoParameter {
        /// What was to be set.
        name: String,
        /// What may have been meant.
        hint: String,
    },
    /// No scales of the circuit take a value.
    #[error("{name} = {} is beyond what the circuit of Fig 8.16 takes, {}", with_unit(*value, unit), between(*low, *high, unit))]
    BeyondCircuit {
        /// The parameter.
        name: String,
        /// Its value.
        value: f64,
        /// Its unit.
        unit: String,
        /// The least value, with the scales at their smallest.
        low: f64,
        /// The largest value, with the scales at their largest.
        high: f64,
    },
    /// The command does not rise from rest or a run.
    #[error("the velocity command has to rise from rest or forward motion, which v_start = {} m/s, v_rate = {} m/s2 and v_turn = {} s do not make it", told(*start), told(*rate), told(*turn))]
    NoRise {
        /// Where it begins, in m/s.
        start: f64,
        /// Its rate, in m/s2.
        rate: f64,
        /// When it turns back, in s.
        turn: f64,
    },
    /// A setting is out of its range.
    #[error("{what} must be {wanted}, not {value}")]
    Setting {
        /// Which.
        what: &'static str,
        /// What it must be.
        wanted: &'static str,
        /// What it is.
        value: f64,
    },
    /// An amplifier was overloaded whatever the scales.
    #[error("{element} is overloaded even at {} a volt: the motion grows without end, or is not followed by so long a step", with_unit(*velocity_per_volt, "m/s"))]
    Overload {
        /// The amplifier.
        element: String,
        /// The largest scale of velocity, in m/s a volt.
        velocity_per_volt: f64,
    },
    /// The critical velocity cannot be read off the run.
    #[error("the critical velocity cannot be read: {0}")]
    Unread(NoCriticalVelocity),
    /// The circuit cannot be set so.
    #[error("{0}")]
    Circuit(Box<Report>),
    /// The document cannot be changed so.
    #[error(transparent)]
    Document(#[from] EditError),
    /// The run cannot be made, or had to stop.
    #[error(transparent)]
    Run(#[from] RunError),
}

fn with_unit(value: f64, unit: &str) -> String {
    Display::new(unit, value).text(value)
}

fn between(low: f64, high: f64, unit: &str) -> String {
    let display = Display::new(unit, high);
    format!("{} ... {}", display.number(low), display.text(high))
}

impl From<Box<Report>> for ChainError {
    fn from(report: Box<Report>) -> Self {
        ChainError::Circuit(report)
    }
}
