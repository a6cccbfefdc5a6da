//! The velocity command: up to a top, and back.

use super::document::default_of;
use super::error::ChainError;
use super::parameters::Parameters;
use super::predictions::{fitted, stability};
use super::settings::Settings;
use patchcord_core::patch::Patch;

/// The velocity command: from a start up to a top and back to rest, at one rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    /// Where it begins, in m/s.
    pub start: f64,
    /// Its rate, in m/s2.
    pub rate: f64,
    /// When it turns back, in s.
    pub turn: f64,
}

/// How far beyond what is expected of the critical velocity the first command goes: that times this, and so many m/s.
const BEYOND: f64 = 1.25;
const ABOVE: f64 = 4e-3;
/// By how much longer the command rises where oscillation has not ended.
const LONGER: f64 = 1.5;
/// Turns come at whole tenths of a second.
const TENTHS: f64 = 10.0;

impl Ramp {
    /// The first to try; where `v_turn` is set, the only one.
    pub(super) fn first(
        template: &Patch,
        parameters: &Parameters,
        settings: &Settings,
    ) -> Result<Self, ChainError> {
        let or_default = |name| settings.value(name).unwrap_or_else(|| default_of(template, name));
        let (start, rate) = (or_default("v_start"), or_default("v_rate"));
        let enough = (BEYOND * expected(parameters) + ABOVE) / rate;
        let turn = settings.value("v_turn").unwrap_or_else(|| whole_tenths(enough));
        let rises = start >= 0.0 && rate > 0.0 && turn > 0.0;
        if rises { Ok(Ramp { start, rate, turn }) } else { Err(ChainError::NoRise { start, rate, turn }) }
    }

    /// The same, rising longer.
    pub(super) fn longer(self) -> Self {
        Ramp { turn: whole_tenths(LONGER * self.turn), ..self }
    }

    /// When it turns back at the latest, made longer so many times, in s.
    pub(super) fn latest_turn(&self, times: i32) -> f64 {
        LONGER.powi(times) * self.turn
    }

    /// Where it turns back, in m/s.
    pub fn top(&self) -> f64 {
        self.start + self.rate * self.turn
    }

    /// When it is back at rest, in s.
    pub fn duration(&self) -> f64 {
        2.0 * self.turn + self.start / self.rate
    }
}

fn whole_tenths(seconds: f64) -> f64 {
    (TENTHS * seconds).ceil() / TENTHS
}

/// The higher of the critical velocities by Routh-Hurwitz and by the study's simulation, in m/s; 0 where neither sees any.
fn expected(parameters: &Parameters) -> f64 {
    [stability(parameters), fitted(parameters)].into_iter().flatten().fold(0.0, f64::max)
}
