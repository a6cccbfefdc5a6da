//! What a quantity may be for a law to hold, and the error that tells where it does not.

/// Why a law gives no number.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SlidewayError {
    /// A quantity for which the law does not hold.
    #[error("{} is {}, and must be {}", range.quantity, range.told(*value), range.bounds())]
    OutOfRange {
        /// What the value is outside of.
        range: Range,
        /// The value.
        value: f64,
    },
    /// What is sought does not exist for these values.
    #[error("there is no {sought}: {because}")]
    NoSolution {
        /// What is sought.
        sought: &'static str,
        /// What rules it out.
        because: String,
    },
}

/// The values that a quantity may have, ends included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// What the quantity is called.
    pub quantity: &'static str,
    /// Its unit; empty for a pure number.
    pub unit: &'static str,
    /// The lowest value.
    pub low: f64,
    /// The highest value.
    pub high: f64,
}

impl Range {
    /// From the lowest to the highest value.
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

    /// The value, if it lies within.
    ///
    /// # Errors
    /// [`SlidewayError::OutOfRange`] for any other value and for what is not a number.
    pub fn check(&self, value: f64) -> Result<f64, SlidewayError> {
        let is_within = (self.low..=self.high).contains(&value);
        if is_within { Ok(value) } else { Err(SlidewayError::OutOfRange { range: *self, value }) }
    }

    /// All numbers.
    pub const fn finite(quantity: &'static str, unit: &'static str) -> Self {
        Range::new(quantity, unit, f64::MIN, f64::MAX)
    }

    /// A value with its unit, if there is one.
    fn told(&self, value: f64) -> String {
        format!("{value} {}", self.unit).trim_end().to_owned()
    }

    fn bounds(&self) -> String {
        match (self.low, self.high) {
            (f64::MIN, f64::MAX) => "a finite number".to_owned(),
            (f64::MIN_POSITIVE, f64::MAX) => "above 0".to_owned(),
            (low, f64::MAX) => format!("at least {low}"),
            (low, high) => format!("{low} ... {high}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_outside_is_told_with_its_range() {
        let viscosity = Range::new("viscosity", "Pa s", 0.01, 0.6);
        assert_eq!(viscosity.check(0.6), Ok(0.6));
        let told = |range: Range, value: f64| range.check(value).unwrap_err().to_string();
        assert_eq!(told(viscosity, 0.7), "viscosity is 0.7 Pa s, and must be 0.01 ... 0.6");
        assert_eq!(told(viscosity, f64::NAN), "viscosity is NaN Pa s, and must be 0.01 ... 0.6");
        assert_eq!(told(Range::new("ratio", "", 0.0, 1.0), 2.0), "ratio is 2, and must be 0 ... 1");
        assert_eq!(told(Range::positive("mass", "kg"), 0.0), "mass is 0 kg, and must be above 0");
        assert_eq!(
            told(Range::not_negative("speed", "m/s"), -1.0),
            "speed is -1 m/s, and must be at least 0"
        );
        assert_eq!(
            told(Range::finite("speed", "m/s"), f64::INFINITY),
            "speed is inf m/s, and must be a finite number"
        );
        assert!(Range::positive("mass", "kg").check(f64::INFINITY).is_err());
    }
}
