//! The state of the machine in an event.

use serde::{Deserialize, Serialize};

use crate::command::Mode;

/// The state of the machine and of the clock.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MachineState {
    /// The mode.
    pub mode: Mode,
    /// Problem time in seconds.
    pub time: f64,
    /// The speed factor; absent for as fast as possible.
    pub speed: Option<f64>,
    /// Whether the clock stands.
    pub paused: bool,
    /// Length of a sweep in problem seconds.
    pub sweep: f64,
    /// Sweeps per second; absent if the speed decides.
    pub rate: Option<f64>,
    /// The overloads since the last initial condition, in the order in which the lamps lit.
    pub overloads: Vec<OverloadView>,
    /// Why the machine stopped; absent if it did not.
    pub stopped: Option<String>,
    /// The earliest time to which the machine can be moved back, in problem seconds; absent if it cannot.
    pub oldest: Option<f64>,
    /// The end of the run in problem seconds, if the machine was moved back and can be moved forward again; absent
    /// otherwise.
    pub latest: Option<f64>,
    /// Name of the output at the voltmeter; absent if it is disconnected.
    pub meter: Option<String>,
    /// The null meter.
    pub null_meter: NullMeter,
}

/// The null meter: it shows the output minus a share of the reference.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct NullMeter {
    /// Name of the output; absent if it is disconnected.
    pub output: Option<String>,
    /// The reference divider, from -1 to 1.
    pub divider: f64,
}

/// An overload lamp that is lit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OverloadView {
    /// Name of the amplifier.
    pub element: String,
    /// Problem time at which it lit, in seconds.
    pub time: f64,
    /// The amplifier whose overload caused it, if there is one.
    pub caused_by: Option<String>,
}
