//! Bands of frequencies: their limits, and the band that shows all roots and delay lines of a model.

use std::f64::consts::TAU;

use super::LinearError;
use super::roots::Root;
use patchcord_core::ir::StateSpace;

/// A band of frequencies, in Hz.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::linear::{FrequencyBand, LinearError};
///
/// assert!(FrequencyBand { low: 0.1, high: 100.0 }.check().is_ok());
/// let reversed = FrequencyBand { low: 10.0, high: 1.0 };
/// assert_eq!(reversed.check(), Err(LinearError::BadBand { low: 10.0, high: 1.0 }));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrequencyBand {
    /// Lower limit, at least 1e-100.
    pub low: f64,
    /// Upper limit, above the lower limit, at most 1e100.
    pub high: f64,
}

/// The lower limit of a frequency band in Hz. Squares of frequencies within the limits do not overflow in complex
/// division.
const MIN_FREQUENCY: f64 = 1e-100;
/// The upper limit of a frequency band in Hz, see [`MIN_FREQUENCY`].
const MAX_FREQUENCY: f64 = 1e100;

impl FrequencyBand {
    /// Checks the limits.
    ///
    /// # Errors
    /// If the upper limit is not above the lower one, or a limit is outside 1e-100 ... 1e100 Hz.
    pub fn check(self) -> Result<(), LinearError> {
        let FrequencyBand { low, high } = self;
        let is_band = MIN_FREQUENCY <= low && low < high && high <= MAX_FREQUENCY;
        if is_band { Ok(()) } else { Err(LinearError::BadBand { low, high }) }
    }

    /// The default band: a decade beyond the slowest and the fastest root and delay line, rounded to whole decades.
    /// 0.01 ... 100 Hz if there are neither.
    pub fn around(roots: &[Root], model: &StateSpace) -> FrequencyBand {
        let natural = roots.iter().map(Root::hertz);
        let delays = model.delays.iter().map(|delay| 1.0 / (TAU * delay.seconds));
        let (low, high) = natural
            .chain(delays)
            .filter(|frequency| *frequency > 0.0)
            .fold((f64::INFINITY, 0.0f64), |(low, high), frequency| {
                (low.min(frequency), high.max(frequency))
            });
        let (low, high) = if high > 0.0 { (low, high) } else { (0.1, 10.0) };
        let decade = |exponent: f64| 10f64.powi(exponent as i32);
        FrequencyBand { low: decade(low.log10().floor() - 1.0), high: decade(high.log10().ceil() + 1.0) }
    }
}
