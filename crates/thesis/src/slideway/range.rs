//! Ranges of quantities in which a law holds, and the error for values outside them.

use patchcord_core::document::unit_suffix;

/// The reason why a law gives no number.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SlidewayError {
    /// A quantity is outside the range in which the law holds.
    #[error("{} must be {}, got {}", range.quantity, range.bounds(), value.to_string() + &unit_suffix(range.unit))]
    OutOfRange {
        /// The range that the value violates.
        range: Range,
        /// The value, in the unit of the range.
        value: f64,
    },
    /// The wanted quantity does not exist for these values.
    #[error("there is no {sought}: {reason}")]
    NoSolution {
        /// Name of the wanted quantity.
        sought: &'static str,
        /// The reason, as text.
        reason: String,
    },
}

/// The permitted values of a quantity, both ends included.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::slideway::Range;
///
/// let overlap = Range::new("overlap", "m", 0.0, 1.0);
/// assert_eq!(overlap.check(0.5), Ok(0.5));
/// let message = overlap.check(2.0).map_err(|error| error.to_string());
/// assert_eq!(message, Err("overlap must be within 0 ... 1, got 2 m".to_owned()));
/// assert!(Range::positive("mass M", "kg").check(0.0).is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Name of the quantity.
    pub quantity: &'static str,
    /// Unit of the quantity; empty for a pure number.
    pub unit: &'static str,
    /// The lowest value.
    pub low: f64,
    /// The highest value.
    pub high: f64,
}

impl Range {
    /// The range from the lowest to the highest value.
    pub const fn new(quantity: &'static str, unit: &'static str, low: f64, high: f64) -> Self {
        Range { quantity, unit, low, high }
    }

    /// All numbers above 0.
    pub const fn positive(quantity: &'static str, unit: &'static str) -> Self {
        Range::new(quantity, unit, f64::MIN_POSITIVE, f64::MAX)
    }

    /// 0 and all numbers above.
    pub const fn not_negative(quantity: &'static str, unit: &'static str) -> Self {
        Range::new(quantity, unit, 0.0, f64::MAX)
    }

    /// Returns the value if it is within the range.
    ///
    /// # Errors
    /// [`SlidewayError::OutOfRange`] if the value is outside the range or not a number.
    pub fn check(&self, value: f64) -> Result<f64, SlidewayError> {
        let is_within = (self.low..=self.high).contains(&value);
        if is_within { Ok(value) } else { Err(SlidewayError::OutOfRange { range: *self, value }) }
    }

    /// All finite numbers.
    pub const fn finite(quantity: &'static str, unit: &'static str) -> Self {
        Range::new(quantity, unit, f64::MIN, f64::MAX)
    }

    /// The permitted values in words, as they follow "must be".
    fn bounds(&self) -> String {
        match (self.low, self.high) {
            (f64::MIN, f64::MAX) => "a finite number".to_owned(),
            (f64::MIN_POSITIVE, f64::MAX) => "positive".to_owned(),
            (low, f64::MAX) => format!("at least {low}"),
            (low, high) => format!("within {low} ... {high}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_names_quantity_range_and_value() {
        let viscosity = Range::new("viscosity", "Pa s", 0.01, 0.6);
        assert_eq!(viscosity.check(0.6), Ok(0.6));
        let error = |range: Range, value: f64| range.check(value).unwrap_err().to_string();
        assert_eq!(error(viscosity, 0.7), "viscosity must be within 0.01 ... 0.6, got 0.7 Pa s");
        assert_eq!(error(viscosity, f64::NAN), "viscosity must be within 0.01 ... 0.6, got NaN Pa s");
        assert_eq!(error(Range::new("ratio", "", 0.0, 1.0), 2.0), "ratio must be within 0 ... 1, got 2");
        assert_eq!(error(Range::positive("mass", "kg"), 0.0), "mass must be positive, got 0 kg");
        assert_eq!(error(Range::not_negative("speed", "m/s"), -1.0), "speed must be at least 0, got -1 m/s");
        assert_eq!(
            error(Range::finite("speed", "m/s"), f64::INFINITY),
            "speed must be a finite number, got inf m/s"
        );
        assert!(Range::positive("mass", "kg").check(f64::INFINITY).is_err());
    }
}
