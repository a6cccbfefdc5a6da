//! The finding of a check, and the comparison of a number with the printed one.
//!
//! The text states some numbers with a tolerance, and prints others with a number of digits. A [`Tolerance`] is
//! either. A computed number agrees with the printed one if their difference is at most the tolerance.

/// The finding of a check.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Finding {
    /// A number, in the unit of the claim.
    Number(f64),
    /// Whether a statement holds.
    Truth {
        /// Whether the statement holds.
        holds: bool,
        /// The result in a few words, for the page.
        found: String,
    },
    /// Whether a result has the stated shape (an order, a sign, a trend). Sizes are not compared.
    Shape {
        /// Whether the result has that shape.
        holds: bool,
        /// The result in a few words, for the page.
        found: String,
    },
}

impl Finding {
    /// Makes a [`Finding::Truth`]: whether a statement holds, and the result in a few words.
    pub fn truth(holds: bool, found: impl Into<String>) -> Self {
        Finding::Truth { holds, found: found.into() }
    }

    /// Makes a [`Finding::Shape`]: whether a result has the stated shape, and the result in a few words.
    pub fn shape(holds: bool, found: impl Into<String>) -> Self {
        Finding::Shape { holds, found: found.into() }
    }
}

/// A number as it is printed. Its text specifies the place value of its last digit.
#[derive(Debug, Clone, PartialEq)]
pub struct PrintedNumber {
    /// The text, such as "0.30".
    pub text: String,
    /// The value of the text.
    pub number: f64,
}

impl PrintedNumber {
    /// Parses a printed number. Returns `None` if the text is not a finite number.
    pub fn parse(text: &str) -> Option<Self> {
        let number = text.parse().ok().filter(|number: &f64| number.is_finite())?;
        Some(PrintedNumber { text: text.to_owned(), number })
    }

    /// Returns the value of one unit of the last printed digit: 0.001 for "0.375", 100 for "1.32e4".
    pub fn last_digit(&self) -> f64 {
        let (mantissa, power) = self.text.split_once(['e', 'E']).unwrap_or((&self.text, "0"));
        let decimals = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len()) as i32;
        10f64.powi(power.parse::<i32>().unwrap_or(0) - decimals)
    }
}

/// The tolerance that the text itself states for a number.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::replay::{PrintedNumber, Tolerance};
///
/// let printed = PrintedNumber::parse("0.375").ok_or("a number")?;
/// assert!((printed.last_digit() - 0.001).abs() < 1e-15);
/// let tolerance = Tolerance::parse("2 digits").ok_or("a tolerance")?;
/// assert!(tolerance.accepts(0.377, &printed) && !tolerance.accepts(0.3775, &printed));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Tolerance {
    /// Equal except for rounding in double precision.
    Exact,
    /// Percent of the printed number.
    Percent(f64),
    /// Units of the last printed digit.
    Digits(f64),
    /// An absolute difference, in the unit of the claim.
    Absolute(f64),
}

/// The rounding error of a long sum in double precision, as a share of the number. It is added to every tolerance; it
/// is chosen, not derived.
const SUM_ROUNDING: f64 = 1e-9;

impl Tolerance {
    /// Parses "2 %", "2 digits", "0.25" or "exact". Returns `None` for any other text, and for a tolerance that is
    /// not positive.
    pub fn parse(text: &str) -> Option<Self> {
        let (number, kind): (&str, fn(f64) -> Self) = match text.rsplit_once(' ') {
            _ if text == "exact" => return Some(Tolerance::Exact),
            Some((number, "%")) => (number, Tolerance::Percent),
            Some((number, "digit" | "digits")) => (number, Tolerance::Digits),
            _ => (text, Tolerance::Absolute),
        };
        number.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0).map(kind)
    }

    /// Returns whether a computed number is within this tolerance of the printed one. NaN never is.
    pub fn accepts(&self, got: f64, printed: &PrintedNumber) -> bool {
        let size = printed.number.abs();
        let allowed = match self {
            Tolerance::Exact => 0.0,
            Tolerance::Percent(percent) => percent / 100.0 * size,
            Tolerance::Digits(units) => units * printed.last_digit(),
            Tolerance::Absolute(difference) => *difference,
        };
        (got - printed.number).abs() <= allowed + SUM_ROUNDING * size
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn printed(text: &str) -> PrintedNumber {
        PrintedNumber::parse(text).unwrap()
    }

    #[test]
    fn the_last_digit_follows_from_the_text() {
        for (text, worth) in
            [("0.375", 0.001), ("0.30", 0.01), ("220", 1.0), ("1.32e4", 100.0), ("5e-6", 1e-6)]
        {
            assert!((printed(text).last_digit() / worth - 1.0).abs() < 1e-12, "{text}");
        }
    }

    #[test]
    fn tolerances_are_applied_as_written() {
        let is_within = |within: &str, got: f64, text: &str| {
            Tolerance::parse(within).unwrap().accepts(got, &printed(text))
        };
        assert!(is_within("2 %", 1.02, "1") && !is_within("2 %", 1.021, "1"));
        assert!(is_within("2 digits", 0.377, "0.375") && !is_within("2 digits", 0.3771, "0.375"));
        assert!(is_within("1 digit", 1.33e4, "1.32e4") && !is_within("1 digit", 1.3301e4, "1.32e4"));
        assert!(is_within("0.25", -0.25, "0") && !is_within("0.25", 0.26, "0"));
        assert!(is_within("exact", 0.1 + 0.2, "0.3") && !is_within("exact", 0.300001, "0.3"));
        assert!(!is_within("5 %", f64::NAN, "1"));
    }

    #[test]
    fn texts_without_a_tolerance_are_refused() {
        for text in ["", "near", "2 percent", "-1 %", "0", "inf"] {
            assert_eq!(Tolerance::parse(text), None, "{text}");
        }
    }
}
