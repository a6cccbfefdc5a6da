//! Formats quantities for people: four significant digits, and a unit prefix that keeps the numbers short.
//!
//! [`format_quantity`] formats one value, [`format_pure_number`] one pure number, and [`QuantityFormat`] several values
//! in the same unit. A function that formats a quantity takes the value first and then the unit.
//!
//! Example: 0.00254 in "m/s" becomes "2.54 mm/s", and 45e6 in "N/m" becomes "45 MN/m".

use patchcord_expr::{Unit, engineering, format_decimals};

/// The number format of one quantity. All values are printed in the same prefixed unit, so that they can be compared.
///
/// # Examples
///
/// The largest value selects the prefix for all values:
///
/// ```
/// use patchcord_analysis::format::QuantityFormat;
///
/// let format = QuantityFormat::new("m/s", 0.025);
/// assert_eq!(format.unit, "mm/s");
/// assert_eq!((format.text(0.025), format.number(0.0005)), ("25 mm/s".to_owned(), "0.5".to_owned()));
/// assert_eq!(format.number(1e-20), "0");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct QuantityFormat {
    /// Printed value = value * factor.
    factor: f64,
    /// Largest absolute value of the quantity, in its original unit.
    largest: f64,
    /// The unit that is printed, such as "mm/s"; empty for pure numbers.
    pub unit: String,
}

/// A value below this fraction of the largest value is a rounding error of zero and is printed as 0.
const NEGLIGIBLE: f64 = 1e-12;

impl QuantityFormat {
    /// The format for values in `unit`, of which `largest` is the largest absolute value. The prefix suits `largest`.
    /// A unit that cannot be parsed is printed as it is.
    pub fn new(unit: &str, largest: f64) -> Self {
        let (factor, shown) = match Unit::parse(unit) {
            Ok(parsed) => engineering(&parsed, largest.abs()),
            Err(_) => (1.0, unit.to_owned()),
        };
        QuantityFormat::with_factor(factor, largest, shown)
    }

    /// The format for values in `unit` as it is written, without another prefix.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_analysis::format::QuantityFormat;
    ///
    /// let format = QuantityFormat::unprefixed("A", 0.4301);
    /// assert_eq!((format.text(0.4301), format.number(-0.002)), ("0.4301 A".to_owned(), "-0.002".to_owned()));
    /// ```
    pub fn unprefixed(unit: &str, largest: f64) -> Self {
        QuantityFormat::with_factor(1.0, largest, unit.to_owned())
    }

    /// The format with a factor and the unit that is printed.
    fn with_factor(factor: f64, largest: f64, unit: String) -> Self {
        let unit = if unit == "1" { String::new() } else { unit };
        QuantityFormat { factor, largest: largest.abs(), unit }
    }

    /// Converts a value to the printed unit.
    pub fn value(&self, value: f64) -> f64 {
        value * self.factor
    }

    /// A value in the printed unit, to four digits, without the unit. A value that is negligible compared with the
    /// largest value is printed as 0.
    pub fn number(&self, value: f64) -> String {
        let is_rounding = value.abs() < NEGLIGIBLE * self.largest;
        four_digits(if is_rounding { 0.0 } else { self.value(value) })
    }

    /// A value followed by its unit.
    pub fn text(&self, value: f64) -> String {
        format!("{} {}", self.number(value), self.unit).trim_end().to_owned()
    }
}

/// One value with its unit and the prefix that suits it: `format_quantity(0.00254, "m/s")` is "2.54 mm/s".
///
/// # Examples
///
/// ```
/// use patchcord_analysis::format::format_quantity;
///
/// assert_eq!(format_quantity(0.00254, "m/s"), "2.54 mm/s");
/// assert_eq!(format_quantity(45e6, "N/m"), "45 MN/m");
/// assert_eq!(format_quantity(0.123456, "1"), "0.1235");
/// ```
pub fn format_quantity(value: f64, unit: &str) -> String {
    QuantityFormat::new(unit, value).text(value)
}

/// A number to four digits; in scientific notation below 1e-5 and from 1e7.
///
/// Trailing zeros are printed only in scientific notation, so this differs from
/// [`format_significant`](patchcord_expr::format_significant).
fn four_digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let magnitude = value.abs().log10().floor();
    if !(-5.0..7.0).contains(&magnitude) {
        return format!("{value:.3e}");
    }
    format_decimals(value, (3.0 - magnitude).max(0.0) as usize)
}

/// A number without a unit, to four digits. A number below 1e-12 is printed as 0.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::format::format_pure_number;
///
/// assert_eq!(format_pure_number(1.0 / 3.0), "0.3333");
/// assert_eq!(format_pure_number(2e7), "2.000e7");
/// assert_eq!(format_pure_number(0.0), "0");
/// ```
pub fn format_pure_number(value: f64) -> String {
    QuantityFormat::new("", 1.0).number(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_get_a_prefix_and_few_digits() {
        let shown = |unit: &str, value: f64| QuantityFormat::new(unit, value).text(value);
        assert_eq!(shown("m/s", 0.00254), "2.54 mm/s");
        assert_eq!(shown("N", 771.0), "771 N");
        assert_eq!(shown("N/m", 45e6), "45 MN/m");
        assert_eq!(shown("1", 0.123456), "0.1235");
        assert_eq!(shown("V", -100.0), "-100 V");
        assert_eq!(shown("s", 0.0), "0 s");
    }

    #[test]
    fn rounding_errors_of_zero_are_printed_as_0() {
        let format = QuantityFormat::new("m", 5.0);
        assert_eq!((format.number(-3.7e-22), format.number(1e-9)), ("0".into(), "1.000e-9".into()));
    }
}
