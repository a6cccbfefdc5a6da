//! Storage oscilloscopes: controls, traces against time, X-Y curves, trigger.

use serde::{Deserialize, Serialize};

/// Number of scopes of a panel.
pub const SCOPES: usize = 2;
/// Number of channels of a scope.
pub const CHANNELS: usize = 2;
/// Divisions of the screen from left to right.
pub const DIVISIONS_ACROSS: f64 = 10.0;
/// Divisions of the screen from top to bottom.
pub const DIVISIONS_UP: f64 = 8.0;

/// All controls of a scope.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ScopeControls {
    /// Whether it shows channels against time or channel 2 against channel 1.
    pub display: Display,
    /// The channels.
    pub channels: [Channel; CHANNELS],
    /// Seconds per division. 0 selects a tenth of the sweep.
    pub seconds_per_division: f64,
    /// When a trace against time begins.
    pub trigger: Trigger,
    /// Whether new traces are added to those that are stored, instead of replacing them.
    pub store: bool,
    /// Seconds after which a stored trace has faded, on the screen; 0 if it does not fade.
    pub persistence: f64,
}

/// What a scope shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Display {
    /// Channels against time.
    Time,
    /// Channel 2 upwards against channel 1 to the right.
    Plane,
}

/// A channel of a scope.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Channel {
    /// Name of the output at its probe; absent if it is free.
    pub output: Option<String>,
    /// Volts of the machine per division.
    pub volts_per_division: f64,
    /// Volts at the centre of the screen.
    pub centre: f64,
    /// Whether the trace is inverted.
    pub inverted: bool,
}

/// When a trace begins.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Trigger {
    /// How traces follow each other.
    pub mode: TriggerMode,
    /// The channel that triggers, 0 or 1.
    pub channel: usize,
    /// The level in volts.
    pub level: f64,
    /// Whether the trace begins when the voltage rises through the level; otherwise when it falls.
    pub rising: bool,
}

/// How traces follow each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum TriggerMode {
    /// A trace begins with each run of the machine, and with each new screen of a longer run.
    Run,
    /// A trace begins whenever the channel passes the level.
    Level,
    /// One trace begins when the channel passes the level. Then the scope waits for `erase`.
    SingleShot,
}
