//! What a check finds, and whether a number is as near to the printed one as the text says it is.

/// What a check finds.
#[derive(Debug, Clone, PartialEq)]
pub enum Finding {
    /// A number, in the unit of the claim.
    Number(f64),
    /// Whether a statement is so, and in short what was found.
    Truth {
        /// Whether it is so.
        holds: bool,
        /// What was found.
        found: String,
    },
    /// Whether the shape is as stated (an order, a sign, a rise), where size is not compared.
    Shape {
        /// Whether it is.
        holds: bool,
        /// What was found.
        found: String,
    },
}

impl Finding {
    /// A statement that is so or not, and in short what was found.
    pub fn truth(holds: bool, found: impl Into<String>) -> Self {
        Finding::Truth { holds, found: found.into() }
    }

    /// A shape that is as stated or not, and in short what was found.
    pub fn shape(holds: bool, found: impl Into<String>) -> Self {
        Finding::Shape { holds, found: found.into() }
    }
}

/// A number as it is printed.
#[derive(Debug, Clone, PartialEq)]
pub struct Printed {
    /// As it stands.
    pub text: String,
    /// What it is.
    pub number: f64,
}

impl Printed {
    /// A number with what its last digit is worth; nothing where the text is no number.
    pub fn parse(text: &str) -> Option<Self> {
        let number = text.parse().ok().filter(|number: &f64| number.is_finite())?;
        Some(Printed { text: text.to_owned(), number })
    }

    /// What one unit of the last printed digit is worth: 0.001 for "0.375", 100 for "1.32e4".
    pub fn last_digit(&self) -> f64 {
        let (mantissa, power) = self.text.split_once(['e', 'E']).unwrap_or((&self.text, "0"));
        let decimals = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len()) as i32;
        10f64.powi(power.parse::<i32>().unwrap_or(0) - decimals)
    }
}

/// How near the text itself says that its number is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Within {
    /// To rounding.
    Exact,
    /// A share of the printed number, in percent.
    Percent(f64),
    /// Units of the last printed digit.
    Digits(f64),
    /// A difference, in the unit of the claim.
    Absolute(f64),
}

/// What double precision may leave of a long sum, as a share of the number.
const ROUNDING: f64 = 1e-9;

impl Within {
    /// From "2 %", "2 digits", "0.25" or "exact"; nothing from anything else.
    pub fn parse(text: &str) -> Option<Self> {
        let (number, kind): (&str, fn(f64) -> Self) = match text.rsplit_once(' ') {
            _ if text == "exact" => return Some(Within::Exact),
            Some((number, "%")) => (number, Within::Percent),
            Some((number, "digit" | "digits")) => (number, Within::Digits),
            _ => (text, Within::Absolute),
        };
        number.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0).map(kind)
    }

    /// Whether a number is as near to the printed one as this.
    pub fn holds(&self, got: f64, printed: &Printed) -> bool {
        let size = printed.number.abs();
        let most = match self {
            Within::Exact => 0.0,
            Within::Percent(percent) => percent / 100.0 * size,
            Within::Digits(units) => units * printed.last_digit(),
            Within::Absolute(most) => *most,
        };
        (got - printed.number).abs() <= most + ROUNDING * size
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn printed(text: &str) -> Printed {
        Printed::parse(text).unwrap()
    }

    #[test]
    fn the_last_digit_is_that_of_the_text() {
        for (text, worth) in
            [("0.375", 0.001), ("0.30", 0.01), ("220", 1.0), ("1.32e4", 100.0), ("5e-6", 1e-6)]
        {
            assert!((printed(text).last_digit() / worth - 1.0).abs() < 1e-12, "{text}");
        }
    }

    #[test]
    fn nearness_is_as_told() {
        let is_within =
            |within: &str, got: f64, text: &str| Within::parse(within).unwrap().holds(got, &printed(text));
        assert!(is_within("2 %", 1.02, "1") && !is_within("2 %", 1.021, "1"));
        assert!(is_within("2 digits", 0.377, "0.375") && !is_within("2 digits", 0.3771, "0.375"));
        assert!(is_within("1 digit", 1.33e4, "1.32e4") && !is_within("1 digit", 1.3301e4, "1.32e4"));
        assert!(is_within("0.25", -0.25, "0") && !is_within("0.25", 0.26, "0"));
        assert!(is_within("exact", 0.1 + 0.2, "0.3") && !is_within("exact", 0.300001, "0.3"));
        assert!(!is_within("5 %", f64::NAN, "1"));
    }

    #[test]
    fn what_tells_no_nearness_is_refused() {
        for text in ["", "near", "2 percent", "-1 %", "0", "inf"] {
            assert_eq!(Within::parse(text), None, "{text}");
        }
    }
}
