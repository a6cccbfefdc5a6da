//! The velocity command that rises to a maximum and returns to rest.

use super::document::default_of;
use super::error::ChainError;
use super::parameters::Parameters;
use super::predictions::{fitted, stability};
use super::settings::Settings;
use patchcord_core::patch::Patch;

/// The velocity command: from a start value to a maximum and back to rest, at one rate.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::chain::Ramp;
///
/// let ramp = Ramp { start: 0.0, rate: 1.2e-3, turn: 10.0 };
/// assert!((ramp.top() - 12e-3).abs() < 1e-12);
/// assert!((ramp.duration() - 20.0).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    /// Velocity at time 0, in m/s, at least 0.
    pub start: f64,
    /// Rate of the rise and of the fall, in m/s2, above 0.
    pub rate: f64,
    /// Time at which the command turns back, in s, above 0.
    pub turn: f64,
}

/// The first command rises to this multiple of the expected critical velocity plus [`TOP_MARGIN`].
const TOP_FACTOR: f64 = 1.25;
/// Addition to the maximum of the first command, in m/s.
const TOP_MARGIN: f64 = 4e-3;
/// Factor by which the rise is extended if oscillation has not ended.
const EXTENSION_FACTOR: f64 = 1.5;
/// Number of steps per second to which the turning time is rounded up: tenths.
const PER_SECOND: f64 = 10.0;

impl Ramp {
    /// The first command to run. It is the only one if `v_turn` is set.
    ///
    /// # Errors
    /// If the settings make a command that does not rise from rest or forward motion.
    pub(super) fn initial(
        template: &Patch,
        parameters: &Parameters,
        settings: &Settings,
    ) -> Result<Self, ChainError> {
        let or_default = |name| settings.value(name).unwrap_or_else(|| default_of(template, name));
        let (start, rate) = (or_default("v_start"), or_default("v_rate"));
        let sufficient = (TOP_FACTOR * expected_critical_velocity(parameters) + TOP_MARGIN) / rate;
        let turn = settings.value("v_turn").unwrap_or_else(|| round_up_to_tenths(sufficient));
        let is_valid = start >= 0.0 && rate > 0.0 && turn > 0.0;
        if is_valid { Ok(Ramp { start, rate, turn }) } else { Err(ChainError::NoRise { start, rate, turn }) }
    }

    /// The command with a longer rise.
    pub(super) fn extended(self) -> Self {
        Ramp { turn: round_up_to_tenths(EXTENSION_FACTOR * self.turn), ..self }
    }

    /// The turning time after a number of extensions, in s.
    pub(super) fn turn_after(&self, extensions: i32) -> f64 {
        EXTENSION_FACTOR.powi(extensions) * self.turn
    }

    /// The maximum of the command, in m/s.
    pub fn top(&self) -> f64 {
        self.start + self.rate * self.turn
    }

    /// The time at which the command is back at 0, in s.
    pub fn duration(&self) -> f64 {
        2.0 * self.turn + self.start / self.rate
    }
}

/// Rounds a time in s up to tenths of a second.
fn round_up_to_tenths(seconds: f64) -> f64 {
    (PER_SECOND * seconds).ceil() / PER_SECOND
}

/// The higher of the critical velocities by Routh-Hurwitz and by eq 7-9, in m/s; 0 if neither gives one.
fn expected_critical_velocity(parameters: &Parameters) -> f64 {
    [stability(parameters), fitted(parameters)].into_iter().flatten().fold(0.0, f64::max)
}
