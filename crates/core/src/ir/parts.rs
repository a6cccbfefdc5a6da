//! The parts of a program in addition to its operations: outputs, states, delay lines, loops, lamps and signals.
//!
//! Each part names an element by its index in the circuit and its voltages by registers of the body. Numbers that
//! depend on parameters are indices of coefficients.

use std::ops::Range;

use super::Register;
use crate::machines::REFERENCE;
use patchcord_expr::Dimension;

/// A table that a drive looks up at time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Timetable {
    /// Index of the drive among the elements.
    pub element: usize,
    /// Index of the table.
    pub table: usize,
    /// Whether the drive follows straight lines between the points. Otherwise it keeps each value until the next
    /// point.
    pub is_straight: bool,
}

/// The output of an element, drive or reference.
#[derive(Debug, Clone)]
pub struct ElementOutput {
    /// Its name in the patch.
    pub name: String,
    /// The register of the body that contains its voltage.
    pub register: Register,
}

/// The state of an integrator or a lag: its output voltage.
#[derive(Debug, Clone)]
pub struct State {
    /// Index of the element.
    pub element: usize,
    /// Register of the rate, in volts per problem second. The rate is 0 while a limit holds the state.
    pub rate: Register,
    /// Register of the rate without the limit.
    pub demand: Register,
    /// Registers of the lower and the upper voltage at which the state is held.
    pub limits: [Register; 2],
    /// Index of the coefficient with the initial voltage.
    pub initial: u32,
    /// The time constant if the element is a lag. No step may be longer.
    pub lag: Option<TimeConstant>,
}

/// The time constant of a lag.
#[derive(Debug, Clone, Copy)]
pub struct TimeConstant {
    /// Coefficient of the time in machine seconds.
    pub time: u32,
    /// Problem seconds per machine second.
    pub problem_seconds: f64,
}

/// A delay line of the program.
#[derive(Debug, Clone)]
pub struct Delay {
    /// Index of the element.
    pub element: usize,
    /// Register of the input.
    pub input: Register,
    /// Indices of the delay lines on whose output the input depends through anything except other delay lines. The
    /// line itself may be among them.
    pub upstream: Vec<usize>,
    /// Index of the coefficient with the delay, in machine seconds.
    pub time: u32,
    /// Index of the coefficient with the output before the first input arrives.
    pub initial: u32,
    /// Problem seconds per machine second.
    pub problem_seconds: f64,
}

/// A value that is constant within a step and sampled at its end: the memory of backlash and track-and-hold.
#[derive(Debug, Clone)]
pub struct SampledValue {
    /// Index of the element.
    pub element: usize,
    /// Index of the coefficient with the initial value.
    pub initial: u32,
    /// Register whose value is sampled at the end of every step.
    pub next: Register,
    /// Register with the input that the sampled value follows up to its turning points, if there is one. Steps end at
    /// these turning points.
    pub follows: Option<Register>,
}

/// A loop without an integrator.
///
/// The loop is opened at some of its elements, so that no loop remains among the others. The outputs of these elements
/// become unknowns, the tears. The operations of the loop compute the outputs again. Voltages at which all tears equal
/// their recomputed outputs solve the loop.
#[derive(Debug, Clone)]
pub struct Loop {
    /// The tears. Their registers are consecutive, and the operations of the loop follow them.
    pub tears: Vec<Tear>,
    /// The operations that depend on a tear, as a range of the body.
    pub operations: Range<usize>,
    /// The lamps of the members, as a range of the program's lamps.
    pub(crate) lamps: Range<usize>,
    /// The registers before the loop that its operations read, in ascending order.
    pub(crate) inputs: Vec<Register>,
    /// Whether the recomputed outputs are piecewise linear in the tears: no tear is multiplied by another, is a divisor
    /// or is the argument of a function.
    pub(crate) is_straight: bool,
    /// Names of the members in order of evaluation.
    pub members: Vec<String>,
}

/// An unknown output of a loop.
#[derive(Debug, Clone)]
pub struct Tear {
    /// Name of the element.
    pub name: String,
    /// Register of the unknown output.
    pub register: Register,
    /// Register of the recomputed output; the tear must equal it.
    pub result: Register,
    /// Register of the recomputed output before the limit of ±100 V. `None` if the output is not limited.
    pub demand: Option<Register>,
    /// Index of the coefficient with the amplification of an open amplifier.
    pub amplification: Option<u32>,
}

impl Tear {
    /// Register of the recomputed output before the limit, or of the output itself if it is not limited.
    pub(crate) fn demanded(&self) -> Register {
        self.demand.unwrap_or(self.result)
    }
}

impl Loop {
    /// Names of the elements at which the loop is opened.
    pub fn openers(&self) -> impl Iterator<Item = &str> {
        self.tears.iter().map(|tear| tear.name.as_str())
    }
}

/// An overload lamp of an amplifier without a state.
#[derive(Debug, Clone)]
pub struct Lamp {
    /// Index of the element.
    pub element: usize,
    /// Register of the demanded output, before the amplifier's limit.
    pub demand: Register,
    /// Register of the output, within ±100 V.
    pub output: Register,
}

/// A signal that can be recorded.
#[derive(Debug, Clone)]
pub struct SignalInfo {
    /// Name of the signal.
    pub name: String,
    /// Register with its voltage.
    pub register: Register,
    /// Index of the coefficient with the signal's value per volt, in SI. `None` if the signal is in volts.
    pub per_volt: Option<u32>,
    /// Text of the unit.
    pub unit: String,
    /// Value of the unit in SI.
    pub per_unit: f64,
    /// Dimension of the unit; that of a voltage if the signal has no scale.
    pub dimension: Dimension,
    /// Whether the patch defines it under `signals`. The outputs of elements and drives are recordable under their own
    /// names.
    pub is_named: bool,
}

/// An element that switches between named positions.
#[derive(Debug, Clone)]
pub(crate) struct Switch {
    /// Index of the element.
    pub element: usize,
    /// Index of the mode. Its values 0, 1 and so on are the indices of the positions.
    pub mode: usize,
    /// Names of the positions.
    pub positions: &'static [&'static str],
}

/// Demanded output above which a lamp lights, in volts. The margin of 1e-6 of the reference prevents a lamp from
/// lighting by rounding.
pub(crate) const LAMP_THRESHOLD: f64 = REFERENCE * (1.0 + 1e-6);
