//! Conversions between units of the same dimension, and the rule for angles.
//!
//! An angle is a pure number, so `rad/s`, `rpm`, `Hz` and `1/s` have the same dimension. `Hz` counts cycles,
//! and a cycle is 2 pi rad. A plain rate such as `1/min` does not contain what it counts. The rule is:
//!
//! * Units with the same power of an angle are converted by their sizes in SI units. So are `Hz` and `1/s`.
//! * If one unit has an angle where the other one has a cycle, the angle is measured in turns: 1 Hz is 60 rpm.
//! * `rpm` counts revolutions, so a plain rate next to it does too: 1 rpm is 1 1/min, and 60 rpm are 1 1/s.
//! * The radian is the number 1: 1 rad/s is 1 1/s, 1 N m/rad is 1 N m, and 180 deg are pi.
//! * A plain rate next to `deg` may count degrees, radians or revolutions. So may one in `1/min` or `1/h` next
//!   to `rad`. Such units are not converted. Other factors do not matter: `deg/(s V)` is a rate, too.

use super::dimension::Dimension;
use super::symbols::Symbol;
use super::unit::Unit;

/// The factor between the values in two units.
///
/// # Examples
///
/// ```
/// use patchcord_expr::Unit;
///
/// let conversion = Unit::parse("km")?.conversion_to(&Unit::parse("m")?)?;
/// assert_eq!(conversion.apply(2.5), 2500.0);
/// assert!(!conversion.is_identity());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conversion {
    /// The size of the unit of the values.
    from: f64,
    /// The size of the unit of the converted values.
    to: f64,
}

impl Conversion {
    /// Converts a value.
    pub fn apply(self, value: f64) -> f64 {
        value * self.from / self.to
    }

    /// Whether all values stay the same.
    pub fn is_identity(self) -> bool {
        self.from == self.to
    }
}

/// Why values in one unit cannot be converted to another unit.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ConversionError {
    /// The units measure different quantities.
    #[error("{from} and {to} measure different quantities")]
    Dimension {
        /// The unit of the values.
        from: String,
        /// The other unit.
        to: String,
    },
    /// One unit has an angle, and the other one is a plain rate. It may count radians, degrees or revolutions.
    #[error("{from} cannot be converted to {to}, because {plain} may count radians, degrees or revolutions")]
    Angle {
        /// The unit of the values.
        from: String,
        /// The other unit.
        to: String,
        /// The one of the two units that has no angle.
        plain: String,
        /// What to write.
        hint: String,
    },
}

/// The unit in which angles are measured for a conversion.
#[derive(Clone, Copy)]
enum AngleUnit {
    /// The radian, which is the number 1.
    Radian,
    /// The turn, which is also a cycle.
    Turn,
}

impl Unit {
    /// Returns the conversion of values in this unit to another unit.
    ///
    /// `Hz` counts cycles, and `rad`, `deg` and `rpm` are angles. A cycle is 2 pi rad. Next to `rpm`, `1/s` and
    /// `1/min` count revolutions. The values in `1/s` are the same in `Hz` and in `rad/s`.
    ///
    /// # Errors
    ///
    /// If the dimensions differ, or if the factor depends on what a plain rate counts. Examples are `deg/s` and
    /// `1/s`, or `rad/s` and `1/min`.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::Unit;
    ///
    /// let unit = |text: &str| Unit::parse(text);
    /// assert_eq!(unit("rpm")?.conversion_to(&unit("Hz")?)?.apply(120.0), 2.0);
    /// assert_eq!(unit("1/min")?.conversion_to(&unit("rpm")?)?.apply(150.0), 150.0);
    /// assert_eq!(unit("1/min")?.conversion_to(&unit("Hz")?)?.apply(120.0), 2.0);
    ///
    /// let error = unit("1/min")?.conversion_to(&unit("deg/s")?).unwrap_err();
    /// assert_eq!(
    ///     error.to_string(),
    ///     "1/min cannot be converted to deg/s, because 1/min may count radians, degrees or revolutions"
    /// );
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn conversion_to(&self, to: &Unit) -> Result<Conversion, ConversionError> {
        if self.dimension() != to.dimension() {
            let (from, to) = (self.text().to_owned(), to.text().to_owned());
            return Err(ConversionError::Dimension { from, to });
        }
        match self.common_angle_unit(to) {
            Some(AngleUnit::Radian) => Ok(Conversion { from: self.factor(), to: to.factor() }),
            Some(AngleUnit::Turn) => Ok(Conversion { from: self.size_in_turns(), to: to.size_in_turns() }),
            None => Err(self.angle_error(to)),
        }
    }

    /// Returns the unit in which angles are measured for the conversion to another unit of the same dimension.
    /// `None` if it is not clear.
    fn common_angle_unit(&self, to: &Unit) -> Option<AngleUnit> {
        let angles = self.angle_power() - to.angle_power();
        if angles == 0.0 {
            return Some(AngleUnit::Radian);
        }
        let cycles = to.power_of(Symbol::is_cycle) - self.power_of(Symbol::is_cycle);
        if angles == cycles {
            return Some(AngleUnit::Turn);
        }
        if self.has_more_angles_than(to) { self.angle_unit_for(to) } else { to.angle_unit_for(self) }
    }

    /// Whether the power of the angle is larger in this unit than in the other one.
    fn has_more_angles_than(&self, other: &Unit) -> bool {
        self.angle_power().abs() > other.angle_power().abs()
    }

    /// Returns the unit of the angles of this unit if `plain` has no such angle. `None` if it is not clear.
    fn angle_unit_for(&self, plain: &Unit) -> Option<AngleUnit> {
        let power = |unit: &Unit, name: &str| unit.power_of(|symbol| symbol.name == name);
        let is_rate = plain.dimension().is_power_of_time() || self.time_power() != 0.0;
        let revolutions = power(self, "rpm");
        let minutes = power(plain, "min");
        if power(self, "deg") != 0.0 {
            (!is_rate).then_some(AngleUnit::Radian)
        } else if revolutions != 0.0 {
            let is_plain_rate = plain.dimension() == Dimension::FREQUENCY.power(revolutions);
            (is_plain_rate || minutes == -revolutions).then_some(AngleUnit::Turn)
        } else {
            let may_count_revolutions = is_rate && (minutes != 0.0 || power(plain, "h") != 0.0);
            (!may_count_revolutions).then_some(AngleUnit::Radian)
        }
    }

    /// Returns the power of time in the text of the unit: -1 for `deg/(s V)`, and 0 for `N m/deg`. The times that other
    /// symbols contain, such as the newton, do not count.
    fn time_power(&self) -> f64 {
        let times = self.power_of(|symbol| symbol.dimension == Dimension::TIME);
        times - self.power_of(|symbol| symbol.dimension == Dimension::FREQUENCY)
    }

    /// Returns the error for a conversion whose factor depends on what the unit without an angle counts.
    fn angle_error(&self, to: &Unit) -> ConversionError {
        let (from, target) = (self.text().to_owned(), to.text().to_owned());
        let example = "as in \"rad/s\", \"deg/s\" or \"rpm\"";
        let (plain, hint) = if self.has_more_angles_than(to) {
            (&target, format!("write the value in {target}, or declare {target} with its angle, {example}"))
        } else {
            (&from, format!("write the unit with its angle, {example}"))
        };
        let plain = plain.clone();
        ConversionError::Angle { from, to: target, plain, hint }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;

    fn conversion(from: &str, to: &str) -> Result<Conversion, ConversionError> {
        Unit::parse(from).unwrap().conversion_to(&Unit::parse(to).unwrap())
    }

    /// Checks the value of 1 in the unit `from`, and the conversion back.
    fn assert_factor(from: &str, to: &str, expected: f64) {
        let found = conversion(from, to).unwrap().apply(1.0);
        assert!((found / expected - 1.0).abs() < 1e-14, "{from} {to}: {found} {expected}");
        let back = conversion(to, from).unwrap().apply(found);
        assert!((back - 1.0).abs() < 1e-14, "{to} {from}: {back}");
    }

    #[test]
    fn angles_and_cycles_are_converted() {
        let cases = [
            ("rad/s", "Hz", 1.0 / TAU),
            ("rpm", "Hz", 1.0 / 60.0),
            ("kHz", "rpm", 60_000.0),
            ("deg/s", "mHz", 1000.0 / 360.0),
            ("m rad/s", "mm Hz", 1000.0 / TAU),
            ("rpm", "rad/s", PI / 30.0),
            ("rpm", "deg/s", 6.0),
            ("rpm/s", "rad/s2", PI / 30.0),
            ("rpm/V", "Hz/V", 1.0 / 60.0),
            ("1/s", "Hz", 1.0),
            ("1/min", "Hz", 1.0 / 60.0),
            ("deg", "rad", PI / 180.0),
        ];
        for (from, to, expected) in cases {
            assert_factor(from, to, expected);
        }
    }

    #[test]
    fn a_plain_rate_next_to_rpm_counts_revolutions() {
        let cases = [
            ("rpm", "1/min", 1.0),
            ("rpm", "1/s", 1.0 / 60.0),
            ("rpm", "1/ms", 1.0 / 60_000.0),
            ("rpm", "1/h", 60.0),
            ("rpm/V", "1/(min V)", 1.0),
            ("V/rpm", "V min", 1.0),
            ("rpm/s", "1/(min s)", 1.0),
            ("1/rpm", "s", 60.0),
        ];
        for (from, to, expected) in cases {
            assert_factor(from, to, expected);
        }
        assert_eq!(conversion("1/min", "rpm").unwrap().apply(150.0), 150.0);
        assert_eq!(conversion("1/s", "rpm").unwrap().apply(2.5), 150.0);
        assert!(conversion("1/min", "rpm").unwrap().is_identity());
    }

    #[test]
    fn the_radian_is_the_number_1() {
        let cases = [
            ("rad/s", "1/s", 1.0),
            ("rad/ms", "1/s", 1000.0),
            ("rad/s2", "1/s2", 1.0),
            ("N m/rad", "N m", 1.0),
            ("rad/(s V)", "1/(V s)", 1.0),
            ("N m/deg", "N m", 180.0 / PI),
            ("N m/deg", "kg m2/s2", 180.0 / PI),
            ("J/rad", "kW h", 1.0 / 3.6e6),
            ("deg", "1", PI / 180.0),
            ("mrad", "1", 1e-3),
        ];
        for (from, to, expected) in cases {
            assert_factor(from, to, expected);
        }
    }

    #[test]
    fn a_plain_rate_that_may_count_anything_is_not_converted() {
        let pairs = [
            ("deg/s", "1/s"),
            ("deg/s", "1/min"),
            ("deg/s2", "1/s2"),
            ("rad/s", "1/min"),
            ("rad/min", "1/min"),
            ("rad/h", "1/h"),
            ("rad/(s V)", "1/(min V)"),
            ("V h/rad", "V h"),
            ("deg/(s V)", "1/(s V)"),
            ("N m s/deg", "N m s"),
            ("rpm/V", "1/(V s)"),
            ("V/rpm", "V s"),
        ];
        for (angular, plain) in pairs {
            for (from, to) in [(angular, plain), (plain, angular)] {
                let error = conversion(from, to).unwrap_err();
                let ConversionError::Angle { plain: found, hint, .. } = &error else { panic!("{error}") };
                assert_eq!(found, plain, "{from} {to}");
                assert!(hint.contains("\"rad/s\", \"deg/s\" or \"rpm\""), "{hint}");
            }
        }
        assert!(!Unit::parse("deg/s").unwrap().is_same_as(&Unit::parse("1/s").unwrap()));
    }

    #[test]
    fn other_quantities_are_not_converted() {
        let error = conversion("kg", "m/s").unwrap_err();
        assert_eq!(error.to_string(), "kg and m/s measure different quantities");
    }
}
