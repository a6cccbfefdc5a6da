//! Boundary films: molecules of oil between metal surfaces under pressure (7.2.i).
//!
//! A film separates part of a contact and ruptures in the rest. The strength of the joint is that of the metal where
//! the film is ruptured, and that of the film elsewhere.

use super::material::Material;
use super::units::{KGF_PER_MM2, UM};
use super::{Range, SlidewayError};

const RUPTURE: Range = Range::new("rupture constant Ko", "Pa", 0.0, 1e12);
const SHEAR: Range = Range::new("shear strength of the film", "Pa", 0.0, 1e12);
const THICKNESS: Range = Range::not_negative("thickness of the film", "m");
const CONTACT: Range = Range::new("pressure on the film", "Pa", 0.0, 1e10);

/// Pressure that a film of any thickness carries: 0.06 kgf/mm2 (eq 71-7).
const MIN_YIELD: f64 = 0.06 * KGF_PER_MM2;
/// Exponent by which the yield pressure falls with film thickness, in 1/m: 10 per um (eq 71-7).
const THINNING: f64 = 10.0 / UM;
/// Exponent by which the shear strength of a film grows with pressure, in 1/Pa: ko = 0.014 mm2/kgf (7.2.i, after
/// Akhmatov).
const SHEAR_GROWTH: f64 = 0.014 / KGF_PER_MM2;

/// The film of lubricant molecules on metal.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::slideway::boundary_film::BoundaryFilm;
/// use patchcord_thesis::slideway::material::Material;
/// use patchcord_thesis::slideway::units::KGF_PER_MM2;
///
/// let strength = BoundaryFilm::POLAR.joint_strength(&Material::GRADE_17_IRON)?;
/// assert!((strength / KGF_PER_MM2 - 7.73).abs() < 0.01);
/// assert_eq!(BoundaryFilm::DRY.covered_share(&Material::GRADE_17_IRON)?, 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundaryFilm {
    /// Rupture constant Ko, in Pa: the thinnest film ruptures at Ko + 0.06 kgf/mm2.
    pub rupture: f64,
    /// Shear strength SoL of the film, in Pa.
    pub shear_strength: f64,
}

impl BoundaryFilm {
    /// Shear strength of the film that the thesis uses for all oils, 2.9 kgf/mm2. [`film_shear_strength`] gives 2.79
    /// for the pressure of the thesis; 2.9 would need ko = 0.0143.
    pub const THESIS_SHEAR: f64 = 2.9 * KGF_PER_MM2;
    /// No film: metal on metal.
    pub const DRY: BoundaryFilm = BoundaryFilm { rupture: 0.0, shear_strength: 0.0 };
    /// Mineral oil without polar additive: Ko = 70 kgf/mm2 (7.3.ii).
    pub const NON_POLAR: BoundaryFilm = BoundaryFilm::of_thesis(70.0);
    /// Mineral oil with polar additive: Ko = 120 kgf/mm2 (7.3.ii).
    pub const POLAR: BoundaryFilm = BoundaryFilm::of_thesis(120.0);

    /// A film with Ko in kgf/mm2, as Fig 7.14 varies it, and the thesis's shear strength.
    pub const fn of_thesis(rupture: f64) -> Self {
        BoundaryFilm { rupture: rupture * KGF_PER_MM2, shear_strength: Self::THESIS_SHEAR }
    }

    /// Pressure PoL in Pa at which a film of a thickness in m yields: Ko exp(-10 ho) + 0.06 kgf/mm2, ho in um (eq
    /// 71-7).
    ///
    /// # Errors
    /// If Ko or the thickness is below 0.
    pub fn yield_pressure(&self, thickness: f64) -> Result<f64, SlidewayError> {
        let thinning = (-THINNING * THICKNESS.check(thickness)?).exp();
        Ok(RUPTURE.check(self.rupture)? * thinning + MIN_YIELD)
    }

    /// The share of a contact in which the film separates the metal, 0 ... 1: ((Ko + 0.06) / Pm)^2 (eq 77-7 ... 82-7).
    ///
    /// In this share the Hertz pressure is too low to rupture the film. It is 1 from Ko + 0.06 = Pm on, and 0 without
    /// a film.
    ///
    /// # Errors
    /// If Ko is below 0 or a property of the metal is out of its range.
    pub fn covered_share(&self, material: &Material) -> Result<f64, SlidewayError> {
        let rupture = self.yield_pressure(0.0)?;
        let is_film = *self != BoundaryFilm::DRY;
        let share = (rupture / material.checked()?.yield_pressure()).min(1.0).powi(2);
        Ok(if is_film { share } else { 0.0 })
    }

    /// Strength KLP in Pa of the leading area: that of the metal where the film is ruptured, that of the film elsewhere
    /// (eq 84-7; eq 164-7 lost a square).
    ///
    /// It is 23.0 kgf/mm2 without polar additive and 7.73 kgf/mm2 with it. The thesis prints 22.8 and 7.87.
    ///
    /// # Errors
    /// If Ko or a strength is below 0, or a property of the metal is out of its range.
    pub fn joint_strength(&self, material: &Material) -> Result<f64, SlidewayError> {
        let covered = self.covered_share(material)?;
        Ok((1.0 - covered) * material.shear_strength + covered * SHEAR.check(self.shear_strength)?)
    }
}

/// Shear strength SoL of a film in Pa under a pressure in Pa: exp(ko Pa) - 1 kgf/mm2, with ko = 0.014 mm2/kgf (eq
/// 72-7).
///
/// # Errors
/// If the pressure is outside 0 ... 1e10 Pa.
pub fn film_shear_strength(pressure: f64) -> Result<f64, SlidewayError> {
    Ok((SHEAR_GROWTH * CONTACT.check(pressure)?).exp_m1() * KGF_PER_MM2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slideway::assert_close;
    use crate::slideway::joint::Joint;
    use crate::slideway::units::KGF_PER_CM2;

    #[test]
    fn fig_7_14_is_reproduced() {
        let friction = |rupture: f64| {
            let film = BoundaryFilm::of_thesis(rupture);
            Joint::PRINTED.static_friction(0.65 * KGF_PER_CM2, &film).unwrap()
        };
        assert_close(friction(0.0), 0.373, 3e-3);
        assert_close(friction(131.94), 0.0807, 4e-3);
        assert_close(friction(70.0), 0.288, 0.02);
        assert_close(friction(120.0), 0.13, 0.02);
        assert_eq!(friction(150.0), friction(131.95));
    }

    #[test]
    fn strengths_of_both_oils_are_reproduced() {
        let strength =
            |film: BoundaryFilm| film.joint_strength(&Material::GRADE_17_IRON).unwrap() / KGF_PER_MM2;
        assert_close(strength(BoundaryFilm::NON_POLAR), 22.99, 1e-4);
        assert_close(strength(BoundaryFilm::POLAR), 7.731, 1e-4);
        assert_eq!(strength(BoundaryFilm::DRY), 30.87);
    }

    #[test]
    fn yield_pressure_and_shear_strength_follow_akhmatov() {
        let film = BoundaryFilm::POLAR;
        assert_close(film.yield_pressure(0.0).unwrap() / KGF_PER_MM2, 120.06, 1e-12);
        assert_close(film.yield_pressure(1.0).unwrap() / KGF_PER_MM2, 0.06, 1e-12);
        assert_close(film_shear_strength(95.2 * KGF_PER_MM2).unwrap() / KGF_PER_MM2, 2.79, 1e-3);
        assert!(film_shear_strength(-1.0).is_err() && film.yield_pressure(f64::NAN).is_err());
    }
}
