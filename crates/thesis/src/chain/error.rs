//! Errors of the design chain.

use super::inputs::Input;
use crate::slideway::SlidewayError;
use patchcord_analysis::format::{QuantityFormat, format_quantity};
use patchcord_analysis::instruments::CriticalVelocityError;
use patchcord_core::document::{Report, format_number};
use patchcord_core::patch::EditError;
use patchcord_core::solve::RunError;

/// The reason why a chain has no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ChainError {
    /// A law does not hold for the inputs.
    #[error(transparent)]
    Law(#[from] SlidewayError),
    /// The circuit has no such parameter.
    #[error("the circuit of Fig 8.16 has no parameter {name}; {hint}")]
    NoParameter {
        /// The name to be set.
        name: String,
        /// A hint that names a similar parameter.
        hint: String,
    },
    /// An input is outside the range of a law.
    #[error("{error}")]
    Input {
        /// The input, or the inputs that one limit combines.
        inputs: &'static [Input],
        /// The range and the value.
        error: SlidewayError,
    },
    /// A value is outside the range of the circuit with all scales. The bounds are the extremes over all scales.
    #[error("{} the range of the circuit of Fig 8.16, {}", .0.relation(), .0.bounds_text())]
    OutsideCircuitRange(RangeViolation),
    /// A value is outside the range that is left by the scales that another value needs.
    #[error(
        "{} the range of the circuit of Fig 8.16 with scales {multiple} times as large, {}: \
         the command or its overshoot needs these scales",
        violation.relation(),
        violation.bounds_text()
    )]
    OutsideScaleRange {
        /// The value, and its bounds with these scales.
        violation: RangeViolation,
        /// Ratio of the scales to scale set B.
        multiple: f64,
    },
    /// The command does not rise from rest or forward motion.
    #[error(
        "the velocity command must rise from rest or forward motion (v_start at least 0, v_rate and v_turn \
         positive), got v_start = {} m/s, v_rate = {} m/s2 and v_turn = {} s",
        format_number(*start),
        format_number(*rate),
        format_number(*turn)
    )]
    NoRise {
        /// Velocity at time 0, in m/s.
        start: f64,
        /// Rate, in m/s2.
        rate: f64,
        /// Time at which the command turns back, in s.
        turn: f64,
    },
    /// A setting is out of its range.
    #[error("{what} must be {wanted}, got {value}")]
    Setting {
        /// The setting, in words.
        what: &'static str,
        /// The permitted range, in words.
        wanted: &'static str,
        /// The value.
        value: f64,
    },
    /// An amplifier was overloaded with all scales.
    #[error(
        "{element} is overloaded even at {} a volt: the motion grows without limit, or the step is too long for it",
        format_quantity(*velocity_per_volt, "m/s")
    )]
    Overload {
        /// The amplifier.
        element: String,
        /// The largest scale of velocity, in m/s per volt.
        velocity_per_volt: f64,
    },
    /// The critical velocity cannot be read from the run.
    #[error("the critical velocity cannot be read: {}", .0.message_in("m/s"))]
    Unread(CriticalVelocityError),
    /// The circuit cannot be set to these values.
    #[error("{0}")]
    Circuit(Box<Report>),
    /// The patch document cannot be edited.
    #[error(transparent)]
    Document(#[from] EditError),
    /// The run cannot start, or stopped with an error.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// A parameter of the circuit whose value is outside its bounds.
#[derive(Debug, Clone, PartialEq)]
pub struct RangeViolation {
    /// Name of the parameter.
    pub name: String,
    /// Value in SI units.
    pub value: f64,
    /// SI unit as text.
    pub unit: String,
    /// The minimum and the maximum permitted value, in SI units.
    pub bounds: [f64; 2],
}

impl RangeViolation {
    /// The unit prefix for value and bounds, chosen for the middle of the bounds.
    fn display(&self) -> QuantityFormat {
        let [low, high] = self.bounds;
        QuantityFormat::new(&self.unit, if low > 0.0 { (low * high).sqrt() } else { high })
    }

    /// Text such as "K = 1 MN/m is below".
    fn relation(&self) -> String {
        let side = if self.value < self.bounds[0] { "below" } else { "above" };
        format!("{} = {} is {side}", self.name, self.display().text(self.value))
    }

    /// Text such as "5 ... 178 MN/m".
    fn bounds_text(&self) -> String {
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
