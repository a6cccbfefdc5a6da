//! Dry sliding (7.3.i).
//!
//! Iron stiffens with the speed at which asperities are deformed. The real area of contact shrinks, so friction falls
//! with velocity.

use super::joint::{Joint, PRESSURE};
use super::material::Material;
use super::power_law::PowerLaw;
use super::root::bisect;
use super::units::{CM2, KGF_PER_MM2, UM};
use super::{Range, SlidewayError};

const STIFFENING: Range = Range::new("stiffening alpha", "", 1.0 + 1e-9, 1e3);
const VISCOSITY: Range = Range::new("viscosity Um of the metal", "Pa s", 1.0, 1e15);
const FREQUENCY: Range = Range::new("frequency of deformation", "rad/s", 0.0, 1e15);
const VELOCITY: Range = Range::new("velocity", "m/s", 0.0, 100.0);

/// A dry sliding joint under a mean pressure.
///
/// # Examples
///
/// Friction falls and the table rises with velocity (Fig 7.19):
///
/// ```
/// use patchcord_thesis::slideway::dry_friction::DryFriction;
/// use patchcord_thesis::slideway::joint::{Joint, THESIS_PRESSURE};
///
/// let dry = DryFriction::of_thesis(Joint::PRINTED, THESIS_PRESSURE);
/// assert!((dry.time_constant()? - 0.0318).abs() < 2e-4);
/// let (slow, fast) = (dry.at_velocity(0.5e-3)?, dry.at_velocity(10e-3)?);
/// assert!(fast.friction < slow.friction && fast.penetration < slow.penetration);
/// assert_eq!(dry.at_velocity(0.0)?.damping, None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DryFriction {
    /// The joint.
    pub joint: Joint,
    /// Mean pressure Pw, in Pa.
    pub pressure: f64,
    /// Maximum growth of the modulus, alpha = Ev / E0 (eq 93-7), above 1.
    pub stiffening: f64,
    /// Viscosity Um of the metal, in Pa s.
    pub viscosity: f64,
}

/// The state of a dry joint at a velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrySliding {
    /// Velocity V, in m/s (eq 122-7).
    pub velocity: f64,
    /// Modulus of the complex alpha at this velocity, 1 at rest.
    pub stiffening: f64,
    /// Leading area AcLV, as a share of the apparent area (eq 92-7).
    pub leading_share: f64,
    /// Friction coefficient mu_k (eq 115-7, 116-7).
    pub friction: f64,
    /// Penetration hdv, in m (eq 95-7).
    pub penetration: f64,
    /// Normal stiffness KE of a square metre, in Pa/m (eq 98-7, 110-7).
    pub stiffness: f64,
    /// Normal damping CE of a square metre, in Pa s/m, from the balance of eq 102-7. `None` at rest.
    pub damping: Option<f64>,
}

/// Leading area by penetration: cm2 per cm2 against um (eq 100-7).
const AREA_BY_PENETRATION: PowerLaw = PowerLaw::new(1.32e-4, 3.7);

impl DrySliding {
    /// Viscosity UA of the asperities in Pa s: CE hd / AcL with AcL as printed, 1.32 hd^3.7 1e-4 (eq 99-7 ... 101-7).
    /// `None` at rest.
    pub fn asperity_viscosity(&self) -> Option<f64> {
        let share = AREA_BY_PENETRATION.at(self.penetration / UM);
        self.damping.map(|damping| damping * self.penetration / share)
    }
}

impl DryFriction {
    /// The thesis's values: alpha = 2.9 at VcL, Um = 8e10 P = 800 kgf s/mm2 (7.3.i).
    pub fn of_thesis(joint: Joint, pressure: f64) -> Self {
        DryFriction { joint, pressure, stiffening: 2.9, viscosity: 800.0 * KGF_PER_MM2 }
    }

    /// Time constant of stiffening in s, T = Um / ((alpha - 1) E0) (eq 118-7).
    ///
    /// # Errors
    /// If alpha is not above 1 or a property of the metal not above 0.
    pub fn time_constant(&self) -> Result<f64, SlidewayError> {
        let Material { modulus, .. } = *self.joint.material.checked()?;
        let excess = STIFFENING.check(self.stiffening)? - 1.0;
        Ok(VISCOSITY.check(self.viscosity)? / (excess * modulus))
    }

    /// Real and imaginary part of alpha(jw) = (1 + alpha T jw) / (1 + T jw) at a frequency in rad/s (eq 117-7, 119-7).
    ///
    /// # Errors
    /// If the frequency is below 0, or there is no time constant.
    pub fn response(&self, frequency: f64) -> Result<(f64, f64), SlidewayError> {
        let turn = self.time_constant()? * FREQUENCY.check(frequency)?;
        let square = turn.powi(2);
        let real = (1.0 + self.stiffening * square) / (1.0 + square);
        Ok((real, (self.stiffening - 1.0) * turn / (1.0 + square)))
    }

    /// The joint while its asperities are deformed at a frequency in rad/s.
    ///
    /// Alpha is the modulus of the response. Only this choice reproduces the thesis's range of CE / KE.
    ///
    /// # Errors
    /// If the frequency is below 0, the pressure beyond the laws of the joint, or there is no time constant.
    pub fn at_frequency(&self, frequency: f64) -> Result<DrySliding, SlidewayError> {
        let square = (self.time_constant()? * FREQUENCY.check(frequency)?).powi(2);
        let stiffening = ((1.0 + self.stiffening.powi(2) * square) / (1.0 + square)).sqrt();
        // stiffening - 1, in a form without cancellation.
        let excess = (self.stiffening.powi(2) - 1.0) * square / (1.0 + square) / (1.0 + stiffening);
        let joint = &self.joint;
        let climb = joint.ridge.climb()?;
        // Real area shrinks as if the load were less by alpha (eq 92-7).
        let share = joint.leading_share(self.pressure)? / stiffening.powf(joint.leading_area.exponent);
        let penetration = joint.penetration(self.pressure)? / stiffening.powf(joint.penetration.exponent);
        let stiffness = self.pressure / stiffening / penetration;
        // The range of a square centimetre deforms over the side of its leading area taken as a square (eq 120-7,
        // 121-7).
        let velocity = frequency * (share * CM2).sqrt();
        let approach = 2.0 * climb * velocity;
        let damping = self.pressure * excess / stiffening / approach;
        Ok(DrySliding {
            velocity,
            stiffening,
            leading_share: share,
            friction: share * joint.material.shear_strength / self.pressure + climb,
            penetration,
            stiffness,
            damping: (velocity > 0.0).then_some(damping),
        })
    }

    /// The joint at a velocity in m/s (Fig 7.19 ... 7.21).
    ///
    /// # Errors
    /// If the velocity is outside 0 ... 100 m/s, and as [`DryFriction::at_frequency`].
    pub fn at_velocity(&self, velocity: f64) -> Result<DrySliding, SlidewayError> {
        if VELOCITY.check(velocity)? == 0.0 {
            return self.at_frequency(0.0);
        }
        // Velocity is frequency times a length that shrinks to 1 / alpha at most.
        let highest = velocity / self.at_frequency(1.0)?.velocity * self.stiffening;
        let is_slower = |frequency: f64| self.at_frequency(frequency).is_ok_and(|at| at.velocity < velocity);
        self.at_frequency(bisect(0.0, highest, is_slower))
    }

    /// Velocity VcL in m/s from which friction is constant, as the thesis suggests it: three octaves above the corner
    /// 1/T with the maximum alpha (eq 132-7, whose power 0.4 is 0.41).
    ///
    /// It is 13.4 mm/s for the thesis's joint. The thesis reads 11.0 mm/s from its own Fig 7.19.
    ///
    /// # Errors
    /// As [`DryFriction::at_frequency`].
    pub fn limit_velocity(&self) -> Result<f64, SlidewayError> {
        let shrunk = self.stiffening.powf(-self.joint.leading_area.exponent);
        let length = (self.joint.leading_share(self.pressure)? * shrunk * CM2).sqrt();
        Ok(8.0 / self.time_constant()? * length)
    }

    /// Alpha at which the pressure on the leading area is Px in Pa, by the law of the area itself (eq 92-7, 128-7).
    ///
    /// It is 2.77 for the thesis's joint and 220 kgf/mm2. The thesis calculates it from the penetrations, which gives
    /// 2.9 (eq 111-7).
    ///
    /// # Errors
    /// If the mean pressure is beyond the laws of the joint, or alpha would not be above 1.
    pub fn stiffening_at(joint: &Joint, pressure: f64, borne: f64) -> Result<f64, SlidewayError> {
        let borne = Range::positive("pressure on the leading area", "Pa").check(borne)?;
        let shrinking = joint.leading_share(PRESSURE.check(pressure)?)? * borne / pressure;
        STIFFENING.check(shrinking.powf(1.0 / joint.leading_area.exponent))
    }
}

/// Penetration in m of a joint by its leading area in m2 on a square centimetre: hd = 0.077 AcL^0.27 in um and um2,
/// as printed (eq 96-7).
///
/// # Errors
/// If the area is outside 0 ... 1 m2.
pub fn printed_penetration(leading_area: f64) -> Result<f64, SlidewayError> {
    let area = Range::new("leading area", "m2", 0.0, 1.0).check(leading_area)?;
    Ok(0.077 * (area / UM.powi(2)).powf(0.27) * UM)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::slideway::assert_close;
    use crate::slideway::boundary_film::BoundaryFilm;
    use crate::slideway::units::{KGF, KGF_PER_CM2, MM_PER_S};

    fn model() -> DryFriction {
        DryFriction::of_thesis(Joint::PRINTED, 0.65 * KGF_PER_CM2)
    }

    #[test]
    fn figures_of_the_thesis_are_reproduced() {
        assert_close(model().time_constant().unwrap(), 0.0318, 5e-3);
        let at_rest = model().at_frequency(0.0).unwrap();
        assert_close(
            at_rest.friction,
            model().joint.static_friction(model().pressure, &BoundaryFilm::DRY).unwrap(),
            1e-12,
        );
        assert_close(at_rest.stiffness * 1e-2 * 1e-4 / KGF, 7760.0, 3e-3);
        assert_eq!(at_rest.damping, None);
        assert_close(model().at_velocity(11.0 * MM_PER_S).unwrap().friction, 0.185, 0.01);
        assert_close(model().limit_velocity().unwrap() / MM_PER_S, 13.38, 1e-3);
        assert_close(printed_penetration(2950e-12).unwrap() / UM, 0.663, 6e-3);
    }

    #[test]
    fn friction_by_velocity_agrees_with_an_independent_calculation() {
        for (velocity, friction, penetration, stiffening) in
            [(0.5, 0.341, 0.813, 1.14), (2.0, 0.218, 0.702, 2.23), (10.0, 0.187, 0.664, 2.86)]
        {
            let at = model().at_velocity(velocity * MM_PER_S).unwrap();
            assert_close(at.friction, friction, 3e-3);
            assert_close(at.penetration / UM, penetration, 2e-3);
            assert_close(at.stiffening, stiffening, 4e-3);
        }
    }

    #[test]
    fn values_without_a_time_constant_are_refused() {
        assert!(DryFriction { stiffening: 1.0, ..model() }.at_velocity(1e-3).is_err());
        assert!(model().at_velocity(f64::INFINITY).is_err());
    }

    proptest! {
        #[test]
        fn velocity_is_reached_and_friction_falls(velocity in 1e-5..0.1f64, factor in 1.01..3.0f64) {
            let [slow, fast] = [velocity, velocity * factor].map(|velocity| model().at_velocity(velocity).unwrap());
            prop_assert!((slow.velocity / velocity - 1.0).abs() < 1e-9);
            prop_assert!(fast.friction < slow.friction && fast.penetration < slow.penetration);
        }
    }
}
