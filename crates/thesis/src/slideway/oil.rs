//! Oils: pressure and drag of their film between sliding surfaces (7.3.ii), and viscosity against pressure and
//! temperature (6.5).

use super::power_law::PowerLaw;
use super::units::{CM_PER_S, KGF_PER_CM2, POISE, UM};
use super::wedge::DRAG_FACTOR;
use super::{Range, SlidewayError};

const VISCOSITY: Range = Range::new("viscosity", "Pa s", 1e-6, 1e3);
const GAP: Range = Range::new("height of the gap H", "m", 1e-9, 1e-2);
/// Velocities for which the thesis fitted its laws: up to 10 cm/s.
const VELOCITY: Range = Range::new("velocity", "m/s", 0.0, 10.0 * CM_PER_S);
const PRESSURE: Range = Range::new("film pressure", "Pa", 1e-3, 1e9);

/// Exponent of the gap in the film pressure: 2 from Reynolds' equation and 0.478 from Ks (eq 155-7).
const GAP_EXPONENT: f64 = 2.478;
/// Factor of eq 155-7: 6 times Ks 0.05 times 100, for P, cm/s, um, kgf/cm2. Exact units would give 30.6, because one
/// kgf/cm2 is 98.07 kPa and not 100 kPa.
const FILM_FACTOR: f64 = 30.0;

/// An oil between the thesis's surfaces.
///
/// # Examples
///
/// The velocity at which the film carries 0.65 kgf/cm2 over a gap of 5.48 um. A thicker oil does so at a lower
/// velocity:
///
/// ```
/// use patchcord_thesis::slideway::oil::Oil;
/// use patchcord_thesis::slideway::units::{KGF_PER_CM2, MM_PER_S, UM};
///
/// let parting = |oil: Oil| oil.velocity(5.48 * UM, 0.65 * KGF_PER_CM2);
/// assert!((parting(Oil::ONE)? / MM_PER_S - 43.1).abs() < 0.4);
/// assert!(parting(Oil::TWO)? < parting(Oil::ONE)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oil {
    /// Viscosity eta, in Pa s.
    pub viscosity: f64,
    /// V / Cv in cm/s against velocity in cm/s. The film pressure is proportional to it. Cv is the thesis's correction
    /// of Reynolds' equation.
    pub wedge_speed: PowerLaw,
}

impl Oil {
    /// Oil 1: 0.74 P, V / Cv = 0.79 V^0.624. The factor is chosen so that eq 153-7 has 23.89 (eq 149-7 rounds it).
    pub const ONE: Oil =
        Oil { viscosity: 0.74 * POISE, wedge_speed: PowerLaw::new(23.89 / FILM_FACTOR, 0.624) };

    /// Oil 2: V / Cv = 0.145 V^0.7. The factor is chosen so that eq 154-7 has 4.38. The scan lost its viscosity; 5.88
    /// P follows from eq 10-9.
    pub const TWO: Oil = Oil { viscosity: 5.88 * POISE, wedge_speed: PowerLaw::new(4.38 / FILM_FACTOR, 0.7) };

    /// An oil of any viscosity in Pa s, interpolated between oil 1 and oil 2.
    ///
    /// The exponent of the law of V / Cv and the logarithm of its factor are linear in the logarithm of viscosity. This
    /// interpolation is ours. The thesis interpolates with one exponent (eq 10-9).
    ///
    /// # Errors
    /// If the viscosity is outside 1e-6 ... 1e3 Pa s.
    pub fn of_viscosity(viscosity: f64) -> Result<Self, SlidewayError> {
        let [one, two] = [Self::ONE, Self::TWO];
        let share = (VISCOSITY.check(viscosity)? / one.viscosity).ln() / (two.viscosity / one.viscosity).ln();
        let between = |first: f64, last: f64| first + share * (last - first);
        let [first, last] = [one.wedge_speed, two.wedge_speed];
        let factor = between(first.factor.ln(), last.factor.ln()).exp();
        let wedge_speed = PowerLaw::new(factor, between(first.exponent, last.exponent));
        Ok(Oil { viscosity, wedge_speed })
    }

    /// Pressure PL in Pa of the film at a velocity in m/s and a gap H in m: 30 eta (V / Cv) / H^2.478 (eq 153-7 ...
    /// 155-7).
    ///
    /// The law was fitted for velocities up to 10 cm/s and gaps of 4.64 ... 9.2 um. Eq 149-7 and 150-7 were fitted
    /// above VcL, and the thesis uses them from rest on.
    ///
    /// # Errors
    /// If the viscosity is outside 1e-6 ... 1e3 Pa s, the gap of 1e-9 ... 1e-2 m, or the velocity of 0 ... 10 cm/s.
    pub fn film_pressure(&self, velocity: f64, gap: f64) -> Result<f64, SlidewayError> {
        let speed = self.wedge_speed.at(VELOCITY.check(velocity)? / CM_PER_S);
        Ok(self.pressure_of(speed, GAP.check(gap)?, VISCOSITY.check(self.viscosity)?))
    }

    /// The gap in m at which the film has a pressure in Pa, for a velocity in m/s above 0.
    ///
    /// # Errors
    /// As [`Oil::film_pressure`], and where the pressure is outside 1e-3 ... 1e9 Pa.
    pub fn gap(&self, velocity: f64, pressure: f64) -> Result<f64, SlidewayError> {
        let at_unit_gap = self.film_pressure(velocity, UM)?;
        Ok((at_unit_gap / PRESSURE.check(pressure)?).powf(1.0 / GAP_EXPONENT) * UM)
    }

    /// The velocity in m/s at which the film has a pressure in Pa, for a gap in m (eq 166-7, 167-7).
    ///
    /// # Errors
    /// If viscosity, gap or pressure is outside the ranges of [`Oil::film_pressure`] and [`Oil::gap`].
    pub fn velocity(&self, gap: f64, pressure: f64) -> Result<f64, SlidewayError> {
        let at_unit_speed = self.pressure_of(1.0, GAP.check(gap)?, VISCOSITY.check(self.viscosity)?);
        Ok(self.wedge_speed.inverse().at(PRESSURE.check(pressure)? / at_unit_speed) * CM_PER_S)
    }

    /// Drag of the film on a square metre, in Pa, at a velocity in m/s and a gap in m: eta V Kf / H (eq 171-7, 176-7).
    ///
    /// # Errors
    /// If the viscosity is outside 1e-6 ... 1e3 Pa s, the gap of 1e-9 ... 1e-2 m, or the velocity of 0 ... 10 cm/s.
    pub fn drag(&self, velocity: f64, gap: f64) -> Result<f64, SlidewayError> {
        let rate = VELOCITY.check(velocity)? / GAP.check(gap)?;
        Ok(VISCOSITY.check(self.viscosity)? * rate * DRAG_FACTOR.at(gap / UM))
    }

    fn pressure_of(&self, speed: f64, gap: f64, viscosity: f64) -> f64 {
        let printed = FILM_FACTOR * (viscosity / POISE) * speed / (gap / UM).powf(GAP_EXPONENT);
        printed * KGF_PER_CM2
    }
}

/// The thesis's correction of Reynolds' equation, Cv = slow + by_speed V with V in cm/s (eq 146-7 ... 148-7). It
/// divides the pressure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correction {
    /// Cv at rest.
    pub slow: f64,
    /// Increase of Cv per cm/s.
    pub by_speed: f64,
}

impl Correction {
    /// The correction of oil 1 (eq 147-7).
    pub const ONE: Correction = Correction { slow: 1.6, by_speed: 0.14 };
    /// The correction of oil 2 (eq 148-7).
    pub const TWO: Correction = Correction { slow: 7.4, by_speed: 0.64 };

    /// V / Cv at a velocity, both in cm/s.
    pub fn wedge_speed(&self, velocity: f64) -> f64 {
        velocity / (self.slow + self.by_speed * velocity)
    }
}

/// The factor by which viscosity grows under a pressure in Pa: it doubles every 35 MN/m2 (6.5 1e).
///
/// # Errors
/// If the pressure is outside 0 ... 1e9 Pa.
pub fn thickening(pressure: f64) -> Result<f64, SlidewayError> {
    let pressure = Range::new("pressure on the oil", "Pa", 0.0, 1e9).check(pressure)?;
    Ok((pressure / 35e6).exp2())
}

/// The factor by which viscosity changes with a rise of temperature in K: it halves every 10 K (6.5 1f).
///
/// # Errors
/// If the rise is outside -100 ... 100 K.
pub fn thinning(rise: f64) -> Result<f64, SlidewayError> {
    let rise = Range::new("rise of temperature", "K", -100.0, 100.0).check(rise)?;
    Ok((-rise / 10.0).exp2())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn limit_velocities_of_both_oils_are_reproduced() {
        let at = |oil: Oil| oil.velocity(5.48 * UM, 0.65 * KGF_PER_CM2).unwrap() / CM_PER_S;
        assert!((at(Oil::ONE) - 4.314).abs() < 0.03, "{}", at(Oil::ONE));
        assert!((at(Oil::TWO) - 2.1483).abs() < 0.01, "{}", at(Oil::TWO));
    }

    #[test]
    fn interpolation_is_exact_at_both_oils() {
        for oil in [Oil::ONE, Oil::TWO] {
            let again = Oil::of_viscosity(oil.viscosity).unwrap().wedge_speed;
            assert!((again.factor / oil.wedge_speed.factor - 1.0).abs() < 1e-12);
            assert!((again.exponent / oil.wedge_speed.exponent - 1.0).abs() < 1e-12);
        }
        let at =
            |poise: f64| Oil::of_viscosity(poise * POISE).unwrap().velocity(5.48 * UM, 0.65 * KGF_PER_CM2);
        assert!((at(2.0).unwrap() / CM_PER_S - 3.028).abs() < 1e-3, "{:?}", at(2.0));
        assert!(Oil::of_viscosity(0.0).is_err());
    }

    #[test]
    fn laws_of_wedge_speed_are_fits_of_the_corrections() {
        for (oil, correction, slowest) in
            [(Oil::ONE, Correction::ONE, 4.31), (Oil::TWO, Correction::TWO, 2.15)]
        {
            let points: Vec<_> = (0..=20)
                .map(|step| slowest * (10.0f64 / slowest).powf(f64::from(step) / 20.0))
                .map(|velocity| (velocity, correction.wedge_speed(velocity)))
                .collect();
            let fit = PowerLaw::fit(&points).unwrap();
            assert!((fit.exponent - oil.wedge_speed.exponent).abs() < 0.01, "{fit:?}");
            assert!(oil.wedge_speed.max_deviation(&points) < 0.05);
        }
    }

    #[test]
    fn viscosity_follows_pressure_and_temperature() {
        assert_eq!((thickening(70e6), thinning(30.0)), (Ok(4.0), Ok(0.125)));
        assert!(thickening(-1.0).is_err() && thinning(f64::NAN).is_err());
    }

    proptest! {
        #[test]
        fn gap_and_velocity_are_inverse_to_pressure(velocity in 1e-4..0.1f64, micrometres in 4.0..10.0f64) {
            let (oil, gap) = (Oil::ONE, micrometres * UM);
            let pressure = oil.film_pressure(velocity, gap).unwrap();
            prop_assert!((oil.gap(velocity, pressure).unwrap() / gap - 1.0).abs() < 1e-9);
            prop_assert!((oil.velocity(gap, pressure).unwrap() / velocity - 1.0).abs() < 1e-9);
        }
    }
}
