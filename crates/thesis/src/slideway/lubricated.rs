//! Lubricated sliding (7.3.ii).
//!
//! The oil film lifts the table, so the load on the ridges falls with velocity. Solid friction is 0 from the velocity
//! VcL on. Above VcL the oil film carries the whole table.

use super::boundary_film::BoundaryFilm;
use super::joint::Joint;
use super::oil::Oil;
use super::root::bisect;
use super::units::CM_PER_S;
use super::wedge::RangeProfile;
use super::{Range, SlidewayError};

/// Velocities for which the law of the film was fitted.
const VELOCITY: Range = Range::new("velocity", "m/s", 0.0, 10.0 * CM_PER_S);

/// A lubricated joint under a mean pressure.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::slideway::boundary_film::BoundaryFilm;
/// use patchcord_thesis::slideway::joint::THESIS_PRESSURE;
/// use patchcord_thesis::slideway::lubricated::LubricatedJoint;
/// use patchcord_thesis::slideway::oil::Oil;
///
/// let joint = LubricatedJoint::of_thesis(Oil::ONE, BoundaryFilm::NON_POLAR, THESIS_PRESSURE)?;
/// let limit = joint.limit_velocity()?;
/// let (rest, fast) = (joint.at_velocity(0.0)?, joint.at_velocity(1.5 * limit)?);
/// assert!((rest.total - joint.static_friction()?).abs() < 1e-12);
/// assert_eq!((fast.solid, fast.solid_share), (0.0, 0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LubricatedJoint {
    /// The surfaces.
    pub joint: Joint,
    /// The film of oil molecules on the metal.
    pub film: BoundaryFilm,
    /// The oil between the ridges.
    pub oil: Oil,
    /// Gap 2 he in m at which ridges just touch: Ho + hd of eq 140-7.
    pub touching_gap: f64,
    /// Mean pressure Pw, in Pa.
    pub pressure: f64,
}

/// The state of a lubricated joint at a velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LubricatedSliding {
    /// Lift hs of the table from its position at rest, in m.
    pub lift: f64,
    /// The share of the load on the ridges, 1 / alpha = 1 - PL / Pw: 1 at rest, 0 from VcL on (eq 162-7).
    pub solid_share: f64,
    /// Solid friction coefficient mu_k: solid friction / weight (eq 163-7).
    pub solid: f64,
    /// Oil friction coefficient mu_0: drag / load that the oil carries (eq 172-7). It is 0 at rest.
    pub oil: f64,
    /// Total friction coefficient: (solid friction + drag) / weight.
    pub total: f64,
}

impl LubricatedSliding {
    /// mu_T = mu_k + mu_0 as the thesis adds them (eq 179-7).
    ///
    /// The first term is relative to the weight, the second to the load that the oil carries. So the sum is up to
    /// 0.0074 too large below VcL, and correct from VcL on.
    pub fn printed_total(&self) -> f64 {
        self.solid + self.oil
    }
}

impl LubricatedJoint {
    /// The thesis's surfaces with an oil, its film and a mean pressure in Pa.
    ///
    /// # Errors
    /// None: all values are within the ranges. The pressure is checked when it is used.
    pub fn of_thesis(oil: Oil, film: BoundaryFilm, pressure: f64) -> Result<Self, SlidewayError> {
        let touching_gap = RangeProfile::OF_THESIS.touching_gap()?;
        Ok(LubricatedJoint { joint: Joint::PRINTED, film, oil, touching_gap, pressure })
    }

    /// Velocity VcL in m/s at which the ridges part: the film carries the whole load over the gap Ho + hd (eq 166-7,
    /// 167-7). The boundary film has no influence on it.
    ///
    /// # Errors
    /// If viscosity, gap or pressure is outside the ranges of the oil.
    pub fn limit_velocity(&self) -> Result<f64, SlidewayError> {
        self.oil.velocity(self.touching_gap, self.pressure)
    }

    /// Static friction coefficient (eq 85-7).
    ///
    /// # Errors
    /// If the pressure is outside the laws of the joint.
    pub fn static_friction(&self) -> Result<f64, SlidewayError> {
        self.joint.static_friction(self.pressure, &self.film)
    }

    /// The joint at a velocity in m/s, 0 ... 10 cm/s (Fig 7.29 ... 7.33).
    ///
    /// The term in CE is omitted, as in the thesis. The load on the ridges is Pw (1 - hs / hd)^4.55. This is eq 160-7
    /// without the rounding error of its terms at rest.
    ///
    /// # Errors
    /// If the velocity is outside 0 ... 10 cm/s, the pressure outside the laws of the joint, or the gap less than the
    /// penetration.
    pub fn at_velocity(&self, velocity: f64) -> Result<LubricatedSliding, SlidewayError> {
        VELOCITY.check(velocity)?;
        let penetration = self.joint.penetration(self.pressure)?;
        let gap_at_rest = Range::positive("gap Ho at rest", "m").check(self.touching_gap - penetration)?;
        let lift = self.lift(velocity, penetration, gap_at_rest)?;
        let gap = gap_at_rest + lift;
        let solid_share = self.solid_share(lift, penetration);
        let solid = self.solid_friction(solid_share)?;
        let (carried, drag) = (self.oil.film_pressure(velocity, gap)?, self.oil.drag(velocity, gap)?);
        let oil = if carried > 0.0 { drag / carried } else { 0.0 };
        Ok(LubricatedSliding { lift, solid_share, solid, oil, total: solid + drag / self.pressure })
    }

    /// The lift at which ridges and film carry the load together (eq 160-7), or the film alone above VcL.
    fn lift(&self, velocity: f64, penetration: f64, gap_at_rest: f64) -> Result<f64, SlidewayError> {
        if velocity == 0.0 {
            return Ok(0.0);
        }
        if velocity >= self.limit_velocity()? {
            return Ok(self.oil.gap(velocity, self.pressure)? - gap_at_rest);
        }
        let is_too_low = |lift: f64| {
            let film = self.oil.film_pressure(velocity, gap_at_rest + lift);
            let ridges = self.pressure * self.solid_share(lift, penetration);
            film.is_ok_and(|film| film + ridges > self.pressure)
        };
        Ok(bisect(0.0, penetration, is_too_low))
    }

    fn solid_share(&self, lift: f64, penetration: f64) -> f64 {
        (1.0 - lift / penetration).max(0.0).powf(1.0 / self.joint.penetration.exponent)
    }

    /// mu_k = (AcL KLP + load tan(theta)) / weight for the load on the ridges (eq 163-7).
    fn solid_friction(&self, solid_share: f64) -> Result<f64, SlidewayError> {
        let strength = self.film.joint_strength(&self.joint.material)?;
        let area = self.joint.leading_share_of(self.pressure * solid_share);
        Ok(area * strength / self.pressure + solid_share * self.joint.ridge.climb()?)
    }
}

/// Exponent of the fall of solid friction with velocity, mu_k = mu_s (1 - V / VcL)^2.18 (eq 168-7 ... 170-7). The
/// curves of the model follow it up to 0.7 ... 0.8 VcL, and fall more steeply from there on.
pub const FALL_EXPONENT: f64 = 2.18;

/// Solid friction coefficient at a velocity in m/s by the thesis's law mu_s (1 - V / VcL)^2.18, 0 from VcL on (eq
/// 170-7).
///
/// # Errors
/// If mu_s or the velocity is below 0, or VcL not above 0.
pub fn falling_solid_friction(at_rest: f64, limit: f64, velocity: f64) -> Result<f64, SlidewayError> {
    let at_rest = Range::not_negative("static friction coefficient", "").check(at_rest)?;
    let limit = Range::positive("limit velocity VcL", "m/s").check(limit)?;
    let velocity = Range::not_negative("velocity", "m/s").check(velocity)?;
    Ok(at_rest * (1.0 - velocity / limit).max(0.0).powf(FALL_EXPONENT))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::slideway::assert_close;
    use crate::slideway::units::{KGF_PER_CM2, UM};

    fn joint(oil: Oil, film: BoundaryFilm) -> LubricatedJoint {
        LubricatedJoint::of_thesis(oil, film, 0.65 * KGF_PER_CM2).unwrap()
    }

    #[test]
    fn curves_of_oil_1_agree_with_an_independent_calculation() {
        let joint = joint(Oil::ONE, BoundaryFilm::NON_POLAR);
        assert_close(joint.limit_velocity().unwrap() / CM_PER_S, 4.3101, 1e-4);
        for (velocity, lift, solid, oil) in [
            (0.5, 0.082_573, 0.194_916, 0.002_379_3),
            (2.0, 0.260_107, 0.069_422, 0.004_267_6),
            (10.0, 2.130_176, 0.0, 0.013_574_1),
        ] {
            let at = joint.at_velocity(velocity * CM_PER_S).unwrap();
            assert_close(at.lift / UM, lift, 1e-5);
            assert!((at.solid - solid).abs() < 1e-6, "{at:?}");
            assert_close(at.oil, oil, 1e-4);
        }
    }

    #[test]
    fn total_friction_at_rest_is_static_friction() {
        let joint = joint(Oil::TWO, BoundaryFilm::POLAR);
        let at_rest = joint.at_velocity(0.0).unwrap();
        assert_eq!((at_rest.lift, at_rest.solid_share, at_rest.oil), (0.0, 1.0, 0.0));
        assert_close(at_rest.total, joint.static_friction().unwrap(), 1e-12);
    }

    #[test]
    fn values_outside_the_laws_are_refused() {
        let joint = joint(Oil::ONE, BoundaryFilm::POLAR);
        assert!(joint.at_velocity(0.2).is_err());
        assert!(LubricatedJoint { touching_gap: 0.5 * UM, ..joint }.at_velocity(0.01).is_err());
        assert!(falling_solid_friction(0.2, 0.0, 0.1).is_err());
        assert_eq!(falling_solid_friction(0.2, 0.04, 0.05), Ok(0.0));
    }

    proptest! {
        #[test]
        fn ridges_and_oil_carry_the_load_together(centimetres in 0.01..4.2f64) {
            let joint = joint(Oil::ONE, BoundaryFilm::POLAR);
            let at = joint.at_velocity(centimetres * CM_PER_S).unwrap();
            let gap = joint.touching_gap - joint.joint.penetration(joint.pressure).unwrap() + at.lift;
            let film = joint.oil.film_pressure(centimetres * CM_PER_S, gap).unwrap();
            prop_assert!((film / joint.pressure + at.solid_share - 1.0).abs() < 1e-9);
            prop_assert!(at.printed_total() >= at.total);
        }

        #[test]
        fn lift_rises_with_velocity(centimetres in 0.01..9.0f64, more in 0.01..1.0f64) {
            let joint = joint(Oil::TWO, BoundaryFilm::NON_POLAR);
            let lift = |velocity: f64| joint.at_velocity(velocity * CM_PER_S).unwrap().lift;
            prop_assert!(lift(centimetres + more) > lift(centimetres));
        }
    }
}
