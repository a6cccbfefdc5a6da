//! How well a value that is fitted is known.

use patchcord_analysis::instruments::number;

/// How well a value is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known {
    /// Its standard error, in declared units; infinite where the data do not tell.
    pub error: f64,
    /// Between which values it lies in 95 of 100 cases.
    pub interval: [f64; 2],
}

impl Known {
    /// What the data do not tell.
    pub const NOT: Known = Known { error: f64::INFINITY, interval: [f64::NEG_INFINITY, f64::INFINITY] };

    /// Its interval in words: from where to where, or "anything".
    pub fn interval_told(&self) -> String {
        let [low, high] = self.interval;
        match self.error.is_finite() {
            true => format!("{} ... {}", self.number(low), self.number(high)),
            false => "anything".to_owned(),
        }
    }

    /// A number in or about its interval, with as many digits as tell the ends of that apart.
    pub fn number(&self, value: f64) -> String {
        let [low, high] = self.interval;
        let width = high - low;
        match number(low) == number(high) && width > 0.0 {
            true => {
                let decimals = 1.0 - width.log10().floor();
                let magnitude = value.abs().log10().floor();
                match magnitude < -5.0 && value != 0.0 {
                    true => format!("{value:.*e}", (magnitude + decimals).clamp(0.0, 15.0) as usize),
                    false => format!("{value:.*}", decimals.clamp(0.0, 15.0) as usize),
                }
            }
            false => number(value),
        }
    }
}
