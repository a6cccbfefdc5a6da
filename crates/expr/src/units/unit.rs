//! A unit of measurement with its size in SI units.

use std::fmt;
use std::str::FromStr;

use super::conversion::Conversion;
use super::dimension::Dimension;
use super::error::UnitError;
use super::format::format_product;
use super::parse::{Factor, parse_factors};
use super::symbols::{MAX_EXACT_POWER_OF_TEN, NO_PREFIX, SECOND, Symbol, power_of_ten};

/// A unit of measurement: its text, its size in SI units and its dimension.
///
/// A unit displays as its text.
///
/// # Examples
///
/// ```
/// use patchcord_expr::{Dimension, Unit};
///
/// let length: Unit = "mm".parse()?;
/// assert_eq!(length, Unit::parse("mm")?);
/// assert_eq!(length.factor(), 1e-3);
/// assert_eq!(length.dimension(), Dimension::LENGTH);
/// assert_eq!(length.to_si(2.0), 0.002);
/// assert_eq!(length.per_second().text(), "mm/s");
///
/// let error = Unit::parse("KN").unwrap_err();
/// assert_eq!(error.hint.as_deref(), Some("did you mean kN or K N?"));
/// # Ok::<(), patchcord_expr::UnitError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// The text as the user wrote it, or in the regular form if the unit was computed.
    text: String,
    /// The size of the unit in SI units; always a normal number.
    factor: f64,
    /// The dimension that follows from the factors.
    dimension: Dimension,
    /// The factors in the order of the text; empty for a pure number.
    factors: Vec<Factor>,
}

impl Unit {
    /// Parses a unit such as `N s/m`, `mm`, `kg/(m s2)`, `1/s`, `%` or `1` (`""` is also 1).
    ///
    /// A blank, `*` or a middle dot multiplies. A `/` divides by the one factor that follows it;
    /// several divisions may follow each other, so `N/m/s` is `N/(m s)`. The text `kg/m s2` is
    /// ambiguous, so a product directly after a `/` is an error. Powers are written `s2`, `s^2`,
    /// `s-1`, `s^-1`, `s²` or `m^0.5`; the maximum power is 12. The prefixes are p, n, u or µ, m, c,
    /// k, M and G.
    ///
    /// # Errors
    ///
    /// If a name is unknown, the text is ambiguous, or the size of the unit overflows or underflows.
    /// The error contains the bytes at fault. For an unknown name, the hint is the nearest known one.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::Unit;
    ///
    /// // Spellings of one unit have the same size and dimension.
    /// let damping = Unit::parse("N s/m")?;
    /// for text in ["N*s/m", "N·s/m", "N s m-1", "kg/s"] {
    ///     assert_eq!(Unit::parse(text)?.dimension(), damping.dimension());
    /// }
    /// let error = Unit::parse("kg/m s2").unwrap_err();
    /// assert_eq!(error.message, "it is not clear whether the / also divides by s2");
    /// # Ok::<(), patchcord_expr::UnitError>(())
    /// ```
    pub fn parse(text: &str) -> Result<Self, UnitError> {
        let factors = parse_factors(text)?;
        let factor = size_of(&factors);
        if !factor.is_normal() {
            let message = "this unit is too large or too small for a number";
            return Err(UnitError::new(0..text.len(), message));
        }
        Ok(Self { text: text.to_owned(), factor, dimension: dimension_of(&factors), factors })
    }

    /// Returns the text of the unit as the user wrote it.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the size of the unit in SI units: 0.001 for `mm`.
    pub fn factor(&self) -> f64 {
        self.factor
    }

    /// Returns the dimension of the quantities that are measured in this unit.
    pub fn dimension(&self) -> Dimension {
        self.dimension
    }

    /// Returns whether the values in both units are the same, whatever their texts. `Hz` differs from
    /// `rad/s`, see [`Unit::conversion_to`].
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::Unit;
    ///
    /// assert!(Unit::parse("N")?.is_same_as(&Unit::parse("kg m/s2")?));
    /// assert!(!Unit::parse("m")?.is_same_as(&Unit::parse("mm")?));
    /// assert!(!Unit::parse("Hz")?.is_same_as(&Unit::parse("rad/s")?));
    /// assert!(Unit::parse("rpm")?.is_same_as(&Unit::parse("1/min")?));
    /// # Ok::<(), patchcord_expr::UnitError>(())
    /// ```
    pub fn is_same_as(&self, other: &Unit) -> bool {
        self.conversion_to(other).is_ok_and(Conversion::is_identity)
    }

    /// Returns the power of the angle in the unit: 1 for `rad/s`, `deg/s` and `rpm`, 0 for `Hz` and
    /// `1/s`.
    pub(crate) fn angle_power(&self) -> f64 {
        self.power_of(Symbol::is_angle)
    }

    /// Returns whether the unit is a number of cycles per second, such as `Hz` or `kHz`.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::Unit;
    ///
    /// assert!(Unit::parse("kHz")?.counts_cycles());
    /// assert!(!Unit::parse("rad/s")?.counts_cycles());
    /// # Ok::<(), patchcord_expr::UnitError>(())
    /// ```
    pub fn counts_cycles(&self) -> bool {
        self.dimension == Dimension::FREQUENCY && self.power_of(Symbol::is_cycle) == 1.0
    }

    /// Returns the sum of the powers of all factors whose symbol satisfies a condition.
    pub(super) fn power_of(&self, belongs: impl Fn(Symbol) -> bool) -> f64 {
        let matching = self.factors.iter().filter(|factor| belongs(factor.symbol));
        matching.fold(0.0, |sum, factor| sum + factor.power)
    }

    /// Returns the size of the unit if angles are measured in turns: 1/60 for `rpm`, which is a turn per
    /// minute.
    pub(super) fn size_in_turns(&self) -> f64 {
        let in_turns = |factor: &Factor| {
            let symbol = Symbol { factor: factor.symbol.size_in_turns(), ..factor.symbol };
            Factor { symbol, ..*factor }
        };
        size_of(&self.factors.iter().map(in_turns).collect::<Vec<_>>())
    }

    /// Converts a value from this unit to SI units.
    pub fn to_si(&self, value: f64) -> f64 {
        value * self.factor
    }

    /// Converts a value from SI units to this unit.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::Unit;
    ///
    /// assert_eq!(Unit::parse("km")?.out_of_si(2500.0), 2.5);
    /// assert_eq!(Unit::parse("min")?.out_of_si(90.0), 1.5);
    /// # Ok::<(), patchcord_expr::UnitError>(())
    /// ```
    pub fn out_of_si(&self, value: f64) -> f64 {
        value / self.factor
    }

    /// Returns the unit of the rate of change of a quantity in this unit: `m/s` for `m`, `m/s2` for
    /// `m/s`, `N` for `N s`.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::Unit;
    ///
    /// for (unit, rate) in [("m", "m/s"), ("m/s", "m/s2"), ("N s", "N"), ("%", "%/s")] {
    ///     assert_eq!(Unit::parse(unit)?.per_second().text(), rate);
    /// }
    /// # Ok::<(), patchcord_expr::UnitError>(())
    /// ```
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

    /// Returns the unit of a product of powers of quantities.
    ///
    /// Example: `N` to the power 1 and `m/s` to the power -2 give `N s2/m2`. Factors of the same symbol
    /// and prefix are merged; factors with power 0 are omitted.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::Unit;
    ///
    /// let (force, speed) = (Unit::parse("N")?, Unit::parse("m/s")?);
    /// let drag = Unit::of_product([(&force, 1.0), (&speed, -2.0)]);
    /// assert_eq!(drag.text(), "N s2/m2");
    /// # Ok::<(), patchcord_expr::UnitError>(())
    /// ```
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

    /// Returns the factors in the order of the text.
    pub(super) fn factors(&self) -> &[Factor] {
        &self.factors
    }
}

impl FromStr for Unit {
    type Err = UnitError;

    /// Parses a unit, see [`Unit::parse`].
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::parse(text)
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.pad(&self.text)
    }
}

/// Formats factors in the regular form: `kg m/s2`.
pub(super) fn text_of(factors: &[Factor]) -> String {
    format_product(factors.iter().map(|factor| (factor.name(), factor.power)))
}

/// Returns the dimension of a product of factors.
fn dimension_of(factors: &[Factor]) -> Dimension {
    factors
        .iter()
        .fold(Dimension::NONE, |product, factor| product.times(factor.symbol.dimension.power(factor.power)))
}

/// Returns the size of a product of factors in SI units.
///
/// The powers of ten of all prefixes are added first, so that decimal sizes are free of rounding.
fn size_of(factors: &[Factor]) -> f64 {
    let tens = factors.iter().map(|factor| f64::from(factor.prefix.exponent) * factor.power).sum();
    let (positive, negative): (Vec<_>, Vec<_>) = factors.iter().partition(|factor| factor.power > 0.0);
    real_power_of_ten(tens) * size_without_prefix(&positive) / size_without_prefix(&negative)
}

/// Returns the product of the sizes of the bare symbols, each to the absolute value of its power.
fn size_without_prefix(factors: &[&Factor]) -> f64 {
    factors.iter().map(|factor| libm::pow(factor.symbol.factor, factor.power.abs())).product()
}

/// Returns ten to a power. Whole powers up to 22 are exact; others are rounded.
fn real_power_of_ten(exponent: f64) -> f64 {
    let exact = exponent.fract() == 0.0 && exponent.abs() <= f64::from(MAX_EXACT_POWER_OF_TEN);
    if exact { power_of_ten(exponent as i32) } else { libm::pow(10.0, exponent) }
}

/// Whether a factor is a power of the second without prefix.
fn is_second(factor: &Factor) -> bool {
    factor.prefix == NO_PREFIX && factor.symbol == SECOND
}

#[cfg(test)]
mod tests;
