//! Why there is no chain.

use super::inputs::Input;
use crate::slideway::SlidewayError;
use patchcord_analysis::instruments::{Display, NoCriticalVelocity, with_unit};
use patchcord_core::document::{Report, told};
use patchcord_core::patch::EditError;
use patchcord_core::solve::RunError;

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
    /// An input for which a law does not hold.
    #[error("{error}")]
    Input {
        /// The input, or those that a limit binds together.
        inputs: &'static [Input],
        /// What is wrong.
        error: SlidewayError,
    },
    /// No scales of the circuit take a value: the bounds go from the least value to the largest, each with the scales that allow it.
    #[error("{} what the circuit of Fig 8.16 takes, {}", .0.told(), .0.bounds_told())]
    BeyondCircuit(Beyond),
    /// The scales that another value asks for do not take a value.
    #[error("{} what the circuit of Fig 8.16 takes with scales {multiple} times as large, which the command or what overshoots it asks for: {}", beyond.told(), beyond.bounds_told())]
    BeyondScales {
        /// The value, and the bounds that it has with these scales.
        beyond: Beyond,
        /// How many times scale set B they are.
        multiple: f64,
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
    #[error("the critical velocity cannot be read: {}", .0.told_in("m/s"))]
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

/// A value of the circuit outside of its bounds.
#[derive(Debug, Clone, PartialEq)]
pub struct Beyond {
    /// The parameter.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Its unit.
    pub unit: String,
    /// The least and the largest value that it may have.
    pub bounds: [f64; 2],
}

impl Beyond {
    /// Value and bounds in one unit, which suits the middle of the bounds.
    fn display(&self) -> Display {
        let [low, high] = self.bounds;
        Display::new(&self.unit, if low > 0.0 { (low * high).sqrt() } else { high })
    }

    fn told(&self) -> String {
        let side = if self.value < self.bounds[0] { "below" } else { "above" };
        format!("{} = {} is {side}", self.name, self.display().text(self.value))
    }

    fn bounds_told(&self) -> String {
        let [low, high] = self.bounds;
        let display = self.display();
        format!("{} ... {}", display.number(low), display.text(high))
    }
}

impl From<Box<Report>> for ChainError {
    fn from(report: Box<Report>) -> Self {
        ChainError::Circuit(report)
    }
}
