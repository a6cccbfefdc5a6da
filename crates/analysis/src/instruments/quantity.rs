//! Quantities as a person reads them: a prefix that keeps numbers short, few digits.

use patchcord_expr::{Unit, engineering};

/// How values of one quantity are shown: all of them in the same prefixed unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Display {
    factor: f64,
    largest: f64,
    /// The unit shown; empty for pure numbers.
    pub unit: String,
}

/// A smaller share of the largest value is what rounding leaves of 0.
const NEGLIGIBLE: f64 = 1e-12;

impl Display {
    /// The display of values in `unit`, the largest of which (without sign) is `largest`.
    pub fn new(unit: &str, largest: f64) -> Self {
        let (factor, shown) = match Unit::parse(unit) {
            Ok(parsed) => engineering(&parsed, largest.abs()),
            Err(_) => (1.0, unit.to_owned()),
        };
        Display { factor, largest: largest.abs(), unit: if shown == "1" { String::new() } else { shown } }
    }

    /// A value in the unit shown.
    pub fn value(&self, value: f64) -> f64 {
        value * self.factor
    }

    /// A value in the unit shown, to four digits, without the unit. What is nothing beside the largest value
    /// is 0.
    pub fn number(&self, value: f64) -> String {
        let is_rounding = value.abs() < NEGLIGIBLE * self.largest;
        digits(if is_rounding { 0.0 } else { self.value(value) })
    }

    /// A value with its unit.
    pub fn text(&self, value: f64) -> String {
        format!("{} {}", self.number(value), self.unit).trim_end().to_owned()
    }
}

/// A value with its unit, prefixed as suits it.
pub fn with_unit(value: f64, unit: &str) -> String {
    Display::new(unit, value).text(value)
}

/// A number to four digits, in powers of ten where it is very large or small.
fn digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let magnitude = value.abs().log10().floor();
    if !(-5.0..7.0).contains(&magnitude) {
        return format!("{value:.3e}");
    }
    let decimals = (3.0 - magnitude).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A number of no unit, to four digits.
pub fn number(value: f64) -> String {
    Display::new("", 1.0).number(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_are_short() {
        let shown = |unit: &str, value: f64| Display::new(unit, value).text(value);
        assert_eq!(shown("m/s", 0.00254), "2.54 mm/s");
        assert_eq!(shown("N", 771.0), "771 N");
        assert_eq!(shown("N/m", 45e6), "45 MN/m");
        assert_eq!(shown("1", 0.123456), "0.1235");
        assert_eq!(shown("V", -100.0), "-100 V");
        assert_eq!(shown("s", 0.0), "0 s");
    }

    #[test]
    fn what_rounding_leaves_of_0_is_0() {
        let display = Display::new("m", 5.0);
        assert_eq!((display.number(-3.7e-22), display.number(1e-9)), ("0".into(), "1.000e-9".into()));
    }
}
