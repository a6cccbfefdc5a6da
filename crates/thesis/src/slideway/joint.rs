//! The joint of a table and its slides at rest (7.2).
//!
//! The model has one asperity range on every square centimetre. The range is lumped into one pair of ridges, whose
//! leading side carries the load and shears.

use std::f64::consts::FRAC_PI_2;

use super::asperities::{AsperityRange, ContactLaws};
use super::boundary_film::BoundaryFilm;
use super::crossing::Crossing;
use super::material::Material;
use super::power_law::PowerLaw;
use super::ridge::Ridge;
use super::units::{CM2, KGF_PER_CM2, UM, UM2};
use super::{Range, SlidewayError};

/// Mean pressures under a table for which the laws of a range are fitted: 1e-4 ... 8 kgf/cm2.
pub(super) const PRESSURE: Range =
    Range::new("mean pressure Pw", "Pa", 1e-4 * KGF_PER_CM2, 8.0 * KGF_PER_CM2);

/// Mean pressure under the thesis's table, 454 kgf on 697 cm2, in Pa (7.2).
pub const THESIS_PRESSURE: f64 = 0.65 * KGF_PER_CM2;

/// A joint of two like surfaces.
///
/// # Examples
///
/// The static friction coefficient at 0.65 kgf/cm2, dry (eq 60-7) and with oils:
///
/// ```
/// use patchcord_thesis::slideway::boundary_film::BoundaryFilm;
/// use patchcord_thesis::slideway::joint::{Joint, THESIS_PRESSURE};
///
/// let friction = |film| Joint::PRINTED.static_friction(THESIS_PRESSURE, &film);
/// assert!((friction(BoundaryFilm::DRY)? - 0.375).abs() < 2e-3);
/// assert!(friction(BoundaryFilm::POLAR)? < friction(BoundaryFilm::NON_POLAR)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// Its ridges.
    pub ridge: Ridge,
    /// Its metal.
    pub material: Material,
    /// Penetration hd at rest in um against pressure in kgf/cm2 (eq 94-7).
    pub penetration: PowerLaw,
    /// Real area of contact at rest Ac in um2 per cm2 against pressure in kgf/cm2.
    pub area: PowerLaw,
    /// Leading area AcL in um2 per cm2 against pressure in kgf/cm2 (eq 56-7): the part of the real area that carries
    /// the whole load when the joint is about to slip.
    pub leading_area: PowerLaw,
}

impl Joint {
    /// The thesis's joint with its constants as printed: ground grade 17 iron, hd = 0.92 Pw^0.22, Ac = 10460 Pw^0.82,
    /// AcL = 9707 Pw^0.82.
    ///
    /// [`Joint::new`] with the printed laws gives 9528. The thesis's 51.44 of eq 53-7 is 1 / (0.072 x 0.27), and its
    /// table has 0.075.
    pub const PRINTED: Joint = Joint {
        ridge: Ridge::GROUND,
        material: Material::GRADE_17_IRON,
        penetration: ContactLaws::PRINTED.overlap,
        area: ContactLaws::PRINTED.area,
        leading_area: PowerLaw::new(9707.0, 0.82),
    };

    /// The joint of a ridge and a metal whose ranges follow these laws.
    ///
    /// Half the area leads at rest. Until the joint slips, this half takes over the load of the other half. It sinks
    /// by WT / Ka (eq 50-7) and grows by Kd / 2 times this sinking (eq 54-7, 55-7), calculated at 1 kgf/cm2.
    pub fn new(ridge: Ridge, material: Material, laws: &ContactLaws) -> Self {
        let area = laws.area.at(1.0);
        let growth = area / laws.overlap_of_area.at(area) / laws.overlap_of_area.exponent;
        let sinking = laws.overlap.exponent * laws.overlap.at(1.0);
        Joint {
            ridge,
            material,
            penetration: laws.overlap,
            area: laws.area,
            leading_area: PowerLaw::new((area + sinking * growth) / 2.0, laws.area.exponent),
        }
    }

    /// The joint from geometry and metal alone. The ridges cross at right angles, and the levels of a range are a
    /// step in m apart. The laws are fitted to the sums over the levels of the thesis.
    ///
    /// These levels correspond to the loads of [`Joint::penetration`] on surfaces like the thesis's. Much softer,
    /// harder, rougher or smoother surfaces need other levels ([`ContactLaws::fitted`]).
    ///
    /// # Errors
    /// If a dimension of the ridge, a property of the metal, or the step is out of its range.
    pub fn of_surfaces(ridge: Ridge, material: Material, step: f64) -> Result<Self, SlidewayError> {
        let range = AsperityRange { crossing: Crossing::new(&ridge, &material, FRAC_PI_2)?, step };
        let laws = ContactLaws::fitted(&range, ContactLaws::LEVELS_OF_THESIS)?;
        Ok(Joint::new(ridge, material, &laws))
    }

    /// Penetration hd in m under a mean pressure in Pa (eq 94-7).
    ///
    /// # Errors
    /// If the pressure is outside 1e-4 ... 8 kgf/cm2.
    pub fn penetration(&self, pressure: f64) -> Result<f64, SlidewayError> {
        Ok(self.penetration.at(in_kgf_per_cm2(pressure)?) * UM)
    }

    /// Real area of contact as a share of the apparent area, at rest under a mean pressure in Pa (eq 46-7).
    ///
    /// # Errors
    /// If the pressure is outside 1e-4 ... 8 kgf/cm2.
    pub fn area_share(&self, pressure: f64) -> Result<f64, SlidewayError> {
        Ok(self.area.at(in_kgf_per_cm2(pressure)?) * UM2 / CM2)
    }

    /// Leading area as a share of the apparent area, just before slip under a mean pressure in Pa (eq 56-7, 92-7).
    ///
    /// # Errors
    /// If the pressure is outside 1e-4 ... 8 kgf/cm2.
    pub fn leading_share(&self, pressure: f64) -> Result<f64, SlidewayError> {
        in_kgf_per_cm2(pressure).map(|_| self.leading_share_of(pressure))
    }

    /// The leading area for the remaining part of a pressure that was within the range. The part may be 0.
    pub(super) fn leading_share_of(&self, pressure: f64) -> f64 {
        self.leading_area.at(pressure / KGF_PER_CM2) * UM2 / CM2
    }

    /// Static friction coefficient with a boundary film, under a mean pressure in Pa: (AcL / WT) KLP + tan(theta)
    /// (eq 57-7, 59-7, 85-7). [`BoundaryFilm::DRY`] means no film.
    ///
    /// # Errors
    /// If the pressure is outside 1e-4 ... 8 kgf/cm2, or a strength of the film is out of its range.
    pub fn static_friction(&self, pressure: f64, film: &BoundaryFilm) -> Result<f64, SlidewayError> {
        let strength = film.joint_strength(&self.material)?;
        Ok(self.leading_share(pressure)? * strength / pressure + self.ridge.climb()?)
    }

    /// Friction coefficient at the beginning of a pull on the dry joint, mu_so = Ac Ss / (2 WT), without climbing (eq
    /// 67-7).
    ///
    /// # Errors
    /// If the pressure is outside 1e-4 ... 8 kgf/cm2.
    pub fn initial_friction(&self, pressure: f64) -> Result<f64, SlidewayError> {
        Ok(self.area_share(pressure)? * self.material.shear_strength / (2.0 * pressure))
    }

    /// Displacement xm in m at which the joint slips under a mean pressure in Pa: WT / (Ka tan(theta)) (eq 52-7).
    ///
    /// # Errors
    /// If the pressure is outside 1e-4 ... 8 kgf/cm2.
    pub fn slip_displacement(&self, pressure: f64) -> Result<f64, SlidewayError> {
        Ok(self.penetration.exponent * self.penetration(pressure)? / self.ridge.climb()?)
    }

    /// Normal stiffness Ka = dWT/dhd of a square metre at rest, in Pa/m, under a mean pressure in Pa (eq 49-7).
    ///
    /// # Errors
    /// If the pressure is outside 1e-4 ... 8 kgf/cm2.
    pub fn tangent_stiffness(&self, pressure: f64) -> Result<f64, SlidewayError> {
        Ok(pressure / (self.penetration.exponent * self.penetration(pressure)?))
    }

    /// Mean pressure over the leading area, Pa = WT / AcL in Pa (eq 74-7).
    ///
    /// # Errors
    /// If the pressure is outside 1e-4 ... 8 kgf/cm2.
    pub fn leading_pressure(&self, pressure: f64) -> Result<f64, SlidewayError> {
        Ok(pressure / self.leading_share(pressure)?)
    }
}

fn in_kgf_per_cm2(pressure: f64) -> Result<f64, SlidewayError> {
    Ok(PRESSURE.check(pressure)? / KGF_PER_CM2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slideway::assert_close;

    const MODEL: f64 = 0.65 * KGF_PER_CM2;

    #[test]
    fn dry_joint_of_the_thesis_is_reproduced() {
        let joint = Joint::PRINTED;
        assert_close(joint.penetration(MODEL).unwrap() / UM, 0.8368, 1e-4);
        assert_close(joint.leading_share(MODEL).unwrap() * CM2 / UM2, 6820.0, 1e-3);
        assert_close(joint.static_friction(MODEL, &BoundaryFilm::DRY).unwrap(), 0.375, 5e-3);
        assert_close(joint.initial_friction(KGF_PER_CM2).unwrap(), 0.160, 1e-2);
        assert_close(joint.slip_displacement(MODEL).unwrap() / UM, 3.68, 1e-3);
    }

    #[test]
    fn leading_area_of_consistent_laws_has_a_closed_form() {
        // The law of hd by Ac that follows from the other two gives AcL = Ac (1 + exponent of Ac) / 2.
        let (overlap, area) = (ContactLaws::PRINTED.overlap, ContactLaws::PRINTED.area);
        let exponent = overlap.exponent / area.exponent;
        let consistent = PowerLaw::new(overlap.factor / area.factor.powf(exponent), exponent);
        let laws = ContactLaws { overlap_of_area: consistent, ..ContactLaws::PRINTED };
        let joint = Joint::new(Ridge::GROUND, Material::GRADE_17_IRON, &laws);
        assert_close(joint.leading_area.factor, area.factor * (1.0 + area.exponent) / 2.0, 1e-12);
    }

    #[test]
    fn geometry_and_metal_give_nearly_the_printed_joint() {
        let joint = Joint::of_surfaces(Ridge::GROUND, Material::GRADE_17_IRON, 0.06 * UM).unwrap();
        let friction = |joint: Joint| joint.static_friction(MODEL, &BoundaryFilm::DRY).unwrap();
        assert_close(friction(joint), friction(Joint::PRINTED), 0.01);
        assert_close(joint.penetration(MODEL).unwrap(), Joint::PRINTED.penetration(MODEL).unwrap(), 0.005);
    }

    #[test]
    fn pressures_outside_the_laws_are_refused() {
        assert!(Joint::PRINTED.penetration(9.0 * KGF_PER_CM2).is_err());
        assert!(Joint::PRINTED.static_friction(0.0, &BoundaryFilm::DRY).is_err());
    }
}
