use std::fmt;

use super::dimension::Dimension;
use super::error::UnitError;
use super::read::{Factor, factors};
use super::symbols::{LARGEST_EXACT_TEN, NO_PREFIX, SECOND, ten_to};
use super::write::written;

/// A unit of measurement: its text, what one of it is in SI units, and its dimension.
///
/// It displays as its text.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    text: String,
    factor: f64,
    dimension: Dimension,
    factors: Vec<Factor>,
}

impl Unit {
    /// Reads a unit such as `N s/m`, `mm`, `kg/(m s2)`, `1/s`, `%` or `1` (`""` is also 1).
    ///
    /// A blank, `*` or a middle dot multiplies. A `/` divides by the one factor that follows it,
    /// and several may follow each other: `N/m/s` is `N/(m s)`. Because readers disagree about
    /// `kg/m s2`, a product directly after a `/` is refused. Powers are written `s2`, `s^2`,
    /// `s-1`, `s^-1`, `s²` or `m^0.5`, up to 12. The prefixes are p, n, u or µ, m, c, k, M and G.
    ///
    /// # Errors
    ///
    /// An unknown name (with the nearest known one as hint), a writing that is not clear, or a
    /// size outside the range of numbers; always with the bytes at fault.
    pub fn parse(text: &str) -> Result<Self, UnitError> {
        let factors = factors(text)?;
        let factor = size_of(&factors);
        if !factor.is_normal() {
            let message = "this unit is too large or too small for a number";
            return Err(UnitError::new(0..text.len(), message));
        }
        Ok(Self { text: text.to_owned(), factor, dimension: dimension_of(&factors), factors })
    }

    /// The text of the unit, as it was written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// What one of this unit is in SI units: 0.001 for `mm`.
    pub fn factor(&self) -> f64 {
        self.factor
    }

    /// The kind of quantity that is measured in this unit.
    pub fn dimension(&self) -> Dimension {
        self.dimension
    }

    /// A value given in this unit, in SI units.
    pub fn to_si(&self, value: f64) -> f64 {
        value * self.factor
    }

    /// A value given in SI units, in this unit.
    pub fn out_of_si(&self, value: f64) -> f64 {
        value / self.factor
    }

    /// The unit in which the rate of change of a quantity in this unit is given: `m/s` for `m`,
    /// `m/s2` for `m/s`, `N` for `N s`.
    pub fn per_second(&self) -> Self {
        let mut factors = self.factors.clone();
        match factors.iter_mut().find(|factor| is_second(factor)) {
            Some(second) => second.power -= 1.0,
            None => factors.push(Factor { prefix: NO_PREFIX, symbol: SECOND, power: -1.0 }),
        }
        factors.retain(|factor| factor.power != 0.0);
        Self {
            text: text_of(&factors),
            factor: self.factor,
            dimension: self.dimension.over(Dimension::TIME),
            factors,
        }
    }

    /// The unit of a product of quantities, each raised to a power: `N s2/m2` for `N` and `m/s` to the power -2.
    pub fn of_product<'u>(parts: impl IntoIterator<Item = (&'u Unit, f64)>) -> Self {
        let mut factors: Vec<Factor> = Vec::new();
        for (unit, power) in parts {
            for factor in unit.factors.iter().map(|factor| factor.raised(power)) {
                let is_same = |own: &&mut Factor| own.prefix == factor.prefix && own.symbol == factor.symbol;
                match factors.iter_mut().find(is_same) {
                    Some(own) => own.power += factor.power,
                    None => factors.push(factor),
                }
            }
        }
        factors.retain(|factor| factor.power != 0.0);
        let (factor, dimension) = (size_of(&factors), dimension_of(&factors));
        Self { text: text_of(&factors), factor, dimension, factors }
    }

    pub(super) fn factors(&self) -> &[Factor] {
        &self.factors
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.pad(&self.text)
    }
}

/// The regular writing of some factors.
pub(super) fn text_of(factors: &[Factor]) -> String {
    written(factors.iter().map(|factor| (factor.name(), factor.power)))
}

fn dimension_of(factors: &[Factor]) -> Dimension {
    factors
        .iter()
        .fold(Dimension::NONE, |product, factor| product.times(factor.symbol.dimension.power(factor.power)))
}

// The prefixes are added up as powers of ten, so that decimal sizes come out without rounding.
fn size_of(factors: &[Factor]) -> f64 {
    let tens = factors.iter().map(|factor| f64::from(factor.prefix.exponent) * factor.power).sum();
    let (above, below): (Vec<_>, Vec<_>) = factors.iter().partition(|factor| factor.power > 0.0);
    power_of_ten(tens) * size_without_prefix(&above) / size_without_prefix(&below)
}

fn size_without_prefix(factors: &[&Factor]) -> f64 {
    factors.iter().map(|factor| libm::pow(factor.symbol.factor, factor.power.abs())).product()
}

fn power_of_ten(exponent: f64) -> f64 {
    let exact = exponent.fract() == 0.0 && exponent.abs() <= f64::from(LARGEST_EXACT_TEN);
    if exact { ten_to(exponent as i32) } else { libm::pow(10.0, exponent) }
}

fn is_second(factor: &Factor) -> bool {
    factor.prefix == NO_PREFIX && factor.symbol == SECOND
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn unit(text: &str) -> Unit {
        Unit::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"))
    }

    fn error(text: &str) -> UnitError {
        Unit::parse(text).expect_err(text)
    }

    #[test]
    fn reads_sizes() {
        let sizes = [
            ("", 1.0),
            ("1", 1.0),
            ("%", 0.01),
            ("mm", 1e-3),
            ("cm/s", 1e-2),
            ("kg", 1.0),
            ("mg", 1e-6),
            ("µm", 1e-6),
            ("um", 1e-6),
            ("kN", 1e3),
            ("min", 60.0),
            ("P", 0.1),
            ("cP", 1e-3),
            ("mm²", 1e-6),
            ("1/min", 1.0 / 60.0),
            ("kgf", 9.80665),
            ("km/h", 1e3 / 3600.0),
            ("N/mm2", 1e6),
            ("1/mm3", 1e9),
            ("ml", 1e-6),
            ("m/s^0.5", 1.0),
            ("km^0.5", 1000f64.sqrt()),
        ];
        for (text, size) in sizes {
            assert_eq!(unit(text).factor(), size, "{text}");
        }
    }

    #[test]
    fn the_same_unit_may_be_written_in_many_ways() {
        let groups: [&[&str]; 4] = [
            &["N s/m", "N*s/m", "N·s/m", "N s m-1", "kg/s", " N  s / m ", "(N s)/m"],
            &["m/s2", "m/s^2", "m s-2", "m s^-2", "m/s²", "m s⁻²", "m/s/s", "m/(s s)"],
            &["Pa", "N/m2", "kg/(m s2)", "kg/m/s2"],
            &["1/s", "s-1", "Hz", "rad/s", "1 / s"],
        ];
        for group in groups {
            for text in group {
                assert_eq!(unit(text).dimension(), unit(group[0]).dimension(), "{text}");
                assert_eq!(unit(text).factor(), 1.0, "{text}");
            }
        }
    }

    #[test]
    fn refuses_a_product_after_a_slash() {
        let refusal = error("kg/m s2");
        assert_eq!(refusal.range, 3..7);
        let hint = refusal.hint.unwrap();
        assert_eq!(hint, "write /(m s2) if it does, else put s2 before the /");
    }

    #[test]
    fn names_the_part_at_fault() {
        let faults = [
            ("N sec/m", 2..5),
            ("100 N", 0..3),
            ("m 2", 2..3),
            ("N/", 2..2),
            ("N//m", 2..3),
            ("(m", 0..1),
            ("m)", 1..2),
            ("m^", 1..2),
            ("m--1", 1..4),
            ("m99", 1..3),
            ("m!", 1..2),
            ("((((((((((m))))))))))", 8..9),
        ];
        for (text, range) in faults {
            assert_eq!(error(text).range, range, "{text}: {}", error(text));
        }
        for degrees in ["degC", "celsius", "Fahrenheit", "°C"] {
            assert!(error(degrees).hint.unwrap().starts_with("temperatures are in K"), "{degrees}");
        }
        assert_eq!(error("KN").hint.as_deref(), Some("did you mean kN or K N?"));
        assert_eq!(error("Nm").hint.as_deref(), Some("did you mean nm or N m?"));
    }

    #[test]
    fn refuses_sizes_beyond_the_numbers() {
        assert!(Unit::parse("Gm12 Gm12 Gm12").is_err());
        assert!(Unit::parse("1/(Gm12 Gm12 Gm12)").is_err());
        assert!(Unit::parse(&"m ".repeat(200)).is_err());
    }

    #[test]
    fn rates_are_per_second() {
        let rates = [
            ("m", "m/s"),
            ("m/s", "m/s2"),
            ("mm", "mm/s"),
            ("N s", "N"),
            ("N s/m", "N/m"),
            ("N/m", "N/(m s)"),
            ("s", "1"),
            ("1", "1/s"),
            ("", "1/s"),
            ("%", "%/s"),
            ("1/s", "1/s2"),
        ];
        for (text, rate) in rates {
            let found = unit(text).per_second();
            assert_eq!(found.text(), rate);
            assert_eq!(found, unit(rate), "{text}");
        }
    }

    #[test]
    fn products_have_the_units_of_their_factors() {
        let drag = Unit::of_product([(&unit("N"), 1.0), (&unit("mm/s"), -2.0)]);
        assert_eq!((drag.text(), drag.factor()), ("N s2/mm2", 1e6));
        assert_eq!(Unit::of_product([(&unit("m/s"), 1.0), (&unit("s"), 1.0)]).text(), "m");
        assert_eq!(Unit::of_product([(&unit("N"), 1.0), (&unit("N"), -1.0)]), unit("1"));
    }

    proptest! {
        #[test]
        fn reading_never_panics(text in "\\PC*") {
            let _ = Unit::parse(&text);
        }

        #[test]
        fn reading_something_like_a_unit_never_panics(text in "[mNs1%²⁻µ() */^.2-]{0,40}") {
            if let Err(error) = Unit::parse(&text) {
                prop_assert!(text.get(error.range).is_some());
            }
        }

        #[test]
        fn dimensions_survive_writing_and_reading(powers in prop::array::uniform5(-9i8..=9)) {
            let [kilogram, metre, second, ampere, kelvin] = powers;
            let dimension = Dimension::new(kilogram, metre, second, ampere, kelvin);
            if !dimension.is_none() {
                let unit = Unit::parse(&dimension.to_string()).unwrap();
                prop_assert_eq!(unit.dimension(), dimension);
                prop_assert_eq!(unit.factor(), 1.0);
            }
        }

        #[test]
        fn values_survive_the_way_to_si_and_back(value in -1e6..1e6f64, text in "(mm|kN|min|ft)/(s|h|kg)2") {
            let unit = unit(&text);
            let back = unit.out_of_si(unit.to_si(value));
            prop_assert!((back - value).abs() <= 1e-15 * value.abs());
        }
    }
}
