//! The dimension of a quantity: its powers of kg, m, s, A and K.

use std::fmt;

use super::format::format_product;

/// Two exponents that differ by less than this are equal. It covers the rounding of roots.
const EXPONENT_TOLERANCE: f64 = 1e-9;

/// The symbols of the base units, in the order of the exponents.
const BASE_UNITS: [&str; 5] = ["kg", "m", "s", "A", "K"];

/// The dimensions that are displayed under a name instead of in base units.
const NAMED: [(&str, Dimension); 18] = [
    ("N", Dimension::FORCE),
    ("N/m", Dimension::new(1, 0, -2, 0, 0)),
    ("N s/m", Dimension::new(1, 0, -1, 0, 0)),
    ("N s", Dimension::new(1, 1, -1, 0, 0)),
    ("N/s", Dimension::new(1, 1, -3, 0, 0)),
    ("Pa", Dimension::PRESSURE),
    ("Pa s", Dimension::VISCOSITY),
    ("J", Dimension::ENERGY),
    ("W", Dimension::POWER),
    ("V", Dimension::VOLTAGE),
    ("V/s", Dimension::new(1, 2, -4, -1, 0)),
    ("ohm", Dimension::RESISTANCE),
    ("C", Dimension::CHARGE),
    ("F", Dimension::CAPACITANCE),
    ("H", Dimension::INDUCTANCE),
    ("T", Dimension::FLUX_DENSITY),
    ("N/A", Dimension::new(1, 1, -2, -1, 0)),
    ("W/K", Dimension::new(1, 2, -3, 0, -1)),
];

/// The dimension of a quantity: the powers of kg, m, s, A and K in its SI unit.
///
/// Two dimensions are equal if their exponents agree to within 1e-9. A root followed by a power
/// therefore gives the original dimension again.
///
/// A dimension displays as its SI unit, for example `N s/m` or `kg m2`. The dimension of a pure
/// number displays as `a pure number`.
///
/// # Examples
///
/// ```
/// use patchcord_expr::Dimension;
///
/// let speed = Dimension::LENGTH.over(Dimension::TIME);
/// assert_eq!(speed.to_string(), "m/s");
/// assert_eq!(Dimension::MASS.times(speed.power(2.0)), Dimension::ENERGY);
/// assert_eq!(Dimension::FORCE.power(0.5).power(2.0), Dimension::FORCE);
/// assert!(speed.over(speed).is_dimensionless());
/// assert_eq!(Dimension::NONE.to_string(), "a pure number");
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Dimension {
    /// The powers of kg, m, s, A and K, in this order. Roots make fractions.
    exponents: [f64; 5],
}

impl Dimension {
    /// The dimension of a pure number.
    pub const NONE: Self = Self::new(0, 0, 0, 0, 0);
    /// Mass, kg.
    pub const MASS: Self = Self::new(1, 0, 0, 0, 0);
    /// Length, m.
    pub const LENGTH: Self = Self::new(0, 1, 0, 0, 0);
    /// Time, s.
    pub const TIME: Self = Self::new(0, 0, 1, 0, 0);
    /// Electric current, A.
    pub const CURRENT: Self = Self::new(0, 0, 0, 1, 0);
    /// Temperature, K.
    pub const TEMPERATURE: Self = Self::new(0, 0, 0, 0, 1);
    /// Volume, m3.
    pub const VOLUME: Self = Self::new(0, 3, 0, 0, 0);
    /// Frequency or rate, 1/s.
    pub const FREQUENCY: Self = Self::new(0, 0, -1, 0, 0);
    /// Force, N.
    pub const FORCE: Self = Self::new(1, 1, -2, 0, 0);
    /// Pressure, Pa.
    pub const PRESSURE: Self = Self::new(1, -1, -2, 0, 0);
    /// Dynamic viscosity, Pa s.
    pub const VISCOSITY: Self = Self::new(1, -1, -1, 0, 0);
    /// Energy, J.
    pub const ENERGY: Self = Self::new(1, 2, -2, 0, 0);
    /// Power, W.
    pub const POWER: Self = Self::new(1, 2, -3, 0, 0);
    /// Voltage, V.
    pub const VOLTAGE: Self = Self::new(1, 2, -3, -1, 0);
    /// Electric resistance, ohm.
    pub const RESISTANCE: Self = Self::new(1, 2, -3, -2, 0);
    /// Electric charge, C.
    pub const CHARGE: Self = Self::new(0, 0, 1, 1, 0);
    /// Electric capacitance, F.
    pub const CAPACITANCE: Self = Self::new(-1, -2, 4, 2, 0);
    /// Inductance, H.
    pub const INDUCTANCE: Self = Self::new(1, 2, -2, -2, 0);
    /// Magnetic flux density, T.
    pub const FLUX_DENSITY: Self = Self::new(1, 0, -2, -1, 0);

    /// Returns the dimension with these powers of kg, m, s, A and K.
    pub const fn new(kilogram: i8, metre: i8, second: i8, ampere: i8, kelvin: i8) -> Self {
        Self { exponents: [kilogram as f64, metre as f64, second as f64, ampere as f64, kelvin as f64] }
    }

    /// Returns the dimension of the product of two quantities.
    pub fn times(self, other: Self) -> Self {
        self.combined(other, |a, b| a + b)
    }

    /// Returns the dimension of the quotient of two quantities.
    pub fn over(self, other: Self) -> Self {
        self.combined(other, |a, b| a - b)
    }

    /// Returns the dimension of a quantity raised to a power; 0.5 is the square root.
    pub fn power(self, exponent: f64) -> Self {
        Self { exponents: self.exponents.map(|own| own * exponent) }
    }

    /// Whether this is the dimension of a pure number.
    pub fn is_dimensionless(self) -> bool {
        self == Self::NONE
    }

    /// Whether the dimension has a power of time, as that of a velocity or a force has.
    pub fn contains_time(self) -> bool {
        let [_, _, second, _, _] = self.exponents;
        second.abs() >= EXPONENT_TOLERANCE
    }

    /// Whether this is the dimension of a power of time, such as 1/s or 1/s2. False for a pure number.
    pub(super) fn is_power_of_time(self) -> bool {
        let [_, _, second, _, _] = self.exponents;
        !self.is_dimensionless() && self == Self::TIME.power(second)
    }

    /// The same dimension without its power of time. Volts stay, because they are the unit of the machine; amperes count
    /// as those of volts.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::Dimension;
    ///
    /// let speed = Dimension::LENGTH.over(Dimension::TIME);
    /// assert_eq!(speed.without_time(), Dimension::LENGTH);
    /// assert_eq!(Dimension::FREQUENCY.without_time(), Dimension::NONE);
    /// let slope = Dimension::VOLTAGE.over(Dimension::LENGTH);
    /// assert_eq!(slope.over(Dimension::TIME).without_time(), slope);
    /// ```
    pub fn without_time(self) -> Self {
        let [kilogram, metre, _, ampere, kelvin] = self.exponents;
        let [_, _, of_a_volt, _, _] = Self::VOLTAGE.exponents;
        // A volt has one ampere in its divisor.
        Self { exponents: [kilogram, metre, -ampere * of_a_volt, ampere, kelvin] }
    }

    /// The SI unit with volts in place of amperes, such as `V/m` in place of `kg m/(s3 A)`. For quantities of a machine
    /// whose numbers are voltages.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::Dimension;
    ///
    /// let slope = Dimension::VOLTAGE.over(Dimension::LENGTH);
    /// assert_eq!(slope.text_in_volts(), "V/m");
    /// assert_eq!(slope.power(-1.0).over(Dimension::TIME).text_in_volts(), "m/(s V)");
    /// assert_eq!(Dimension::FORCE.text_in_volts(), "N");
    /// ```
    pub fn text_in_volts(self) -> String {
        if self.has_current() { format_product(self.factors_in_volts()) } else { self.to_string() }
    }

    /// The SI unit in volts, and with amperes or coulombs if the powers are then smaller: `A/(s V)` in place of
    /// `kg m2/(s4 V2)`. For a machine whose voltages represent currents or charges.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::Dimension;
    ///
    /// let rate = Dimension::CURRENT.over(Dimension::TIME);
    /// assert_eq!(rate.over(Dimension::VOLTAGE).text_in_volts_and_amperes(), "A/(s V)");
    /// assert_eq!(Dimension::VOLTAGE.over(Dimension::CHARGE).text_in_volts_and_amperes(), "V/C");
    /// assert_eq!(Dimension::VOLTAGE.over(Dimension::LENGTH).text_in_volts_and_amperes(), "V/m");
    /// ```
    pub fn text_in_volts_and_amperes(self) -> String {
        if !self.has_current() {
            return self.to_string();
        }
        let candidates = [("A", Self::CURRENT), ("C", Self::CHARGE)].into_iter().flat_map(|(name, unit)| {
            [1.0, -1.0, 2.0, -2.0].map(|power| {
                let rest = self.over(unit.power(power)).factors_in_volts();
                [(name, power)].into_iter().chain(rest).collect::<Vec<_>>()
            })
        });
        let size = |factors: &[(&str, f64)]| factors.iter().map(|(_, power)| power.abs()).sum::<f64>();
        let smallest = candidates.fold(self.factors_in_volts(), |smallest, candidate| {
            // Rounding of the exponents must not decide between units of the same size.
            if size(&candidate) < size(&smallest) - EXPONENT_TOLERANCE { candidate } else { smallest }
        });
        format_product(smallest)
    }

    /// Whether the dimension has a power of current, as volts, ohms and coulombs have.
    fn has_current(self) -> bool {
        let [_, _, _, ampere, _] = self.exponents;
        ampere != 0.0
    }

    /// Whether the dimension has a power of current and is not that of volts over something without current, such as
    /// `V/m`. Parameters of this kind belong to a circuit, and not only to the machine.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::Dimension;
    ///
    /// assert!(Dimension::CURRENT.is_of_circuit());
    /// assert!(Dimension::RESISTANCE.is_of_circuit());
    /// assert!(!Dimension::VOLTAGE.over(Dimension::LENGTH).is_of_circuit());
    /// assert!(!Dimension::FORCE.is_of_circuit());
    /// ```
    pub fn is_of_circuit(self) -> bool {
        let [_, _, _, ampere, _] = self.exponents;
        !(-1.0 - EXPONENT_TOLERANCE..=EXPONENT_TOLERANCE).contains(&ampere)
    }

    /// The factors of the SI unit with volts in place of amperes, each with its power. Some powers may be 0.
    fn factors_in_volts(self) -> Vec<(&'static str, f64)> {
        let [_, _, _, ampere, _] = self.exponents;
        let rest = self.times(Self::VOLTAGE.power(ampere));
        match NAMED.iter().find(|(name, dimension)| *dimension == rest && !name.contains('/')) {
            Some((name, _)) => vec![(*name, 1.0), ("V", -ampere)],
            None => BASE_UNITS.into_iter().zip(rest.exponents).chain([("V", -ampere)]).collect(),
        }
    }

    /// Combines the exponents of two dimensions one by one.
    fn combined(self, other: Self, combine: impl Fn(f64, f64) -> f64) -> Self {
        let combined = |index| combine(self.exponents[index], other.exponents[index]);
        Self { exponents: std::array::from_fn(combined) }
    }
}

impl PartialEq for Dimension {
    fn eq(&self, other: &Self) -> bool {
        let mut pairs = self.exponents.iter().zip(other.exponents);
        pairs.all(|(own, others)| (own - others).abs() < EXPONENT_TOLERANCE)
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_dimensionless() {
            return out.pad("a pure number");
        }
        match NAMED.iter().find(|(_, dimension)| dimension == self) {
            Some((name, _)) => out.pad(name),
            None => out.pad(&format_product(BASE_UNITS.into_iter().zip(self.exponents))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Unit;
    use super::*;

    #[test]
    fn every_named_dimension_matches_its_unit() {
        for (name, dimension) in NAMED {
            assert_eq!(Unit::parse(name).unwrap().dimension(), dimension, "{name}");
        }
    }

    #[test]
    fn displays_si_units() {
        let speed = Dimension::LENGTH.over(Dimension::TIME);
        assert_eq!(speed.to_string(), "m/s");
        assert_eq!(speed.over(Dimension::TIME).to_string(), "m/s2");
        assert_eq!(Dimension::MASS.times(speed.power(2.0)).to_string(), "J");
        assert_eq!(Dimension::FORCE.power(2.0).to_string(), "kg2 m2/s4");
        assert_eq!(Dimension::FREQUENCY.to_string(), "1/s");
        assert_eq!(Dimension::TIME.power(0.5).to_string(), "s^0.5");
        let loss = Dimension::CURRENT.over(Dimension::LENGTH.times(Dimension::TEMPERATURE));
        assert_eq!(loss.to_string(), "A/(m K)");
        assert_eq!(Dimension::NONE.to_string(), "a pure number");
    }

    #[test]
    fn powers_of_time_have_no_other_base_unit() {
        for time in [Dimension::TIME, Dimension::FREQUENCY, Dimension::FREQUENCY.power(2.0)] {
            assert!(time.is_power_of_time(), "{time}");
        }
        for other in [Dimension::NONE, Dimension::LENGTH, Dimension::LENGTH.over(Dimension::TIME)] {
            assert!(!other.is_power_of_time(), "{other}");
        }
    }

    #[test]
    fn velocities_and_forces_contain_time() {
        let speed = Dimension::LENGTH.over(Dimension::TIME);
        assert!([speed, Dimension::FORCE, Dimension::FREQUENCY].into_iter().all(Dimension::contains_time));
        let length = speed.times(Dimension::TIME.power(0.5)).times(Dimension::TIME.power(0.5));
        let without = [Dimension::NONE, length, Dimension::MASS, Dimension::TEMPERATURE];
        assert!(!without.into_iter().any(Dimension::contains_time));
    }

    #[test]
    fn powers_invert_roots() {
        let third = Dimension::FORCE.power(1.0 / 3.0);
        assert_eq!(third.times(third).times(third), Dimension::FORCE);
        assert_ne!(third, Dimension::FORCE);
    }
}
