//! Solid friction that falls with velocity: Fs at rest, 0 from VcL on (4.6, 8.2, 8.3, 8.5).

use super::units::N_S_PER_MM;
use super::{Range, SlidewayError};

const STATIC: Range = Range::positive("static friction Fs", "N");
const LIMIT: Range = Range::positive("limit velocity VcL", "m/s");
const VELOCITY: Range = Range::finite("velocity", "m/s");
const DAMPING: Range = Range::not_negative("viscous coefficient f", "N s/m");
const SLOPE: Range = Range::not_negative("slope of friction Cn", "N s/m");

/// Static friction of the thesis's simulation, in N (8.4).
pub const SIMULATED_STATIC: f64 = 771.0;

/// The law of solid friction, given by static friction and the velocity from which solid friction is 0.
///
/// # Examples
///
/// The square law: a quarter of static friction remains at half of VcL.
///
/// ```
/// use patchcord_thesis::slideway::falling::FallingFriction;
///
/// // Fs = 771 N, VcL = 10 mm/s.
/// let friction = FallingFriction::simulated(10e-3);
/// assert!((friction.solid(0.0)? - 771.0).abs() < 1e-9);
/// assert!((friction.solid(5e-3)? - 771.0 / 4.0).abs() < 1e-9);
/// assert_eq!(friction.solid(12e-3)?, 0.0);
/// assert!((friction.steepest()? - 2.0 * 771.0 / 10e-3).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FallingFriction {
    /// Static friction Fs, in N, above 0.
    pub static_friction: f64,
    /// Velocity VcL from which there is no solid friction, in m/s, above 0.
    pub limit: f64,
}

impl FallingFriction {
    /// The friction of the thesis's simulation, 771 N (8.4), with a limit velocity in m/s. The thesis set 1.27 ... 25.4
    /// mm/s, and 40 mm/s when it changed the stiffness (8.5).
    pub const fn simulated(limit: f64) -> Self {
        FallingFriction { static_friction: SIMULATED_STATIC, limit }
    }

    fn checked(&self) -> Result<&Self, SlidewayError> {
        STATIC.check(self.static_friction)?;
        LIMIT.check(self.limit)?;
        Ok(self)
    }

    /// Coefficient of the square law, N = Fs / VcL^2, in N s2/m2 (eq 9-4, 36-8).
    ///
    /// # Errors
    /// If Fs or VcL is not above 0.
    pub fn coefficient(&self) -> Result<f64, SlidewayError> {
        self.checked().map(|friction| friction.static_friction / friction.limit.powi(2))
    }

    /// Solid friction in N at a velocity in m/s by the square law, N (VcL - |v|)^2 with the sign of v, 0 from VcL on
    /// (eq 8-4, 30-8, 31-8). At rest it may have any value up to Fs; the result for v = 0 is Fs.
    ///
    /// # Errors
    /// If Fs or VcL is not above 0, or the velocity is not a number.
    pub fn solid(&self, velocity: f64) -> Result<f64, SlidewayError> {
        let margin = (self.limit - VELOCITY.check(velocity)?.abs()).max(0.0);
        Ok(sign(velocity) * self.coefficient()? * margin.powi(2))
    }

    /// Solid friction in N at a velocity in m/s by the straight line, Fs (1 - |v| / VcL) (eq 28-8, Fig 8.9).
    ///
    /// # Errors
    /// If Fs or VcL is not above 0, or the velocity is not a number.
    pub fn solid_straight(&self, velocity: f64) -> Result<f64, SlidewayError> {
        let share = (1.0 - VELOCITY.check(velocity)?.abs() / self.checked()?.limit).max(0.0);
        Ok(sign(velocity) * self.static_friction * share)
    }

    /// Total friction in N at a steady velocity, N (VcL - v)^2 + f v (eq 11-4, 14-4, 31-8).
    ///
    /// # Errors
    /// If Fs or VcL is not above 0, the velocity is not a number, or the viscous coefficient f is below 0.
    pub fn total(&self, velocity: f64, damping: f64) -> Result<f64, SlidewayError> {
        Ok(self.solid(velocity)? + DAMPING.check(damping)? * velocity)
    }

    /// The slope with which solid friction falls at a velocity, Cn = 2 Fs (VcL - v) / VcL^2, in N s/m (eq 37-8 ...
    /// 40-8). It is positive while friction falls, and 0 from VcL on.
    ///
    /// # Errors
    /// If Fs or VcL is not above 0, or the velocity is below 0.
    pub fn slope(&self, velocity: f64) -> Result<f64, SlidewayError> {
        let velocity = Range::not_negative("velocity", "m/s").check(velocity)?;
        Ok(2.0 * self.coefficient()? * (self.limit - velocity).max(0.0))
    }

    /// The steepest slope, at rest: 2 Fs / VcL, in N s/m. A table whose critical slope is larger never oscillates (eq
    /// 2-9, 50-8).
    ///
    /// # Errors
    /// If Fs or VcL is not above 0.
    pub fn steepest(&self) -> Result<f64, SlidewayError> {
        self.slope(0.0)
    }

    /// The velocity in m/s at which the slope is Cn, VcL - Cn VcL^2 / (2 Fs) (eq 41-8, 4-9). With the critical slope
    /// of a table it is the critical velocity.
    ///
    /// # Errors
    /// If the slope exceeds the steepest slope. Then there is no oscillation at any velocity.
    pub fn velocity_at_slope(&self, slope: f64) -> Result<f64, SlidewayError> {
        let (slope, steepest) = (SLOPE.check(slope)?, self.steepest()?);
        if slope > steepest {
            let [steepest, slope] = [steepest, slope].map(|slope| slope / N_S_PER_MM);
            let reason = format!(
                "the slope of friction is at most {steepest:.2} N s/mm, and {slope:.2} N s/mm is needed"
            );
            return Err(SlidewayError::NoSolution { sought: "critical velocity", reason });
        }
        Ok(self.limit * (1.0 - slope / steepest))
    }

    /// The velocity in m/s at which total friction is least, VcL (1 - f VcL / (2 Fs)) (eq 46-8 ... 48-8).
    ///
    /// # Errors
    /// If viscous friction outweighs solid friction at every velocity.
    pub fn velocity_of_least(&self, damping: f64) -> Result<f64, SlidewayError> {
        self.velocity_at_slope(DAMPING.check(damping)?)
    }
}

/// The limit velocity in m/s at which a table with the critical slope Cn is just stable at rest, VcL = 2 Fs / Cn (eq
/// 51-8, 3-9).
///
/// # Errors
/// If Fs or Cn is not above 0.
pub fn stable_limit(static_friction: f64, slope: f64) -> Result<f64, SlidewayError> {
    Ok(2.0 * worst_limit(static_friction, slope)?)
}

/// The limit velocity in m/s for which the critical velocity is highest, VcL = Fs / Cn (eq 45-8). The critical
/// velocity is then half of VcL (eq 44-8).
///
/// # Errors
/// If Fs or Cn is not above 0.
pub fn worst_limit(static_friction: f64, slope: f64) -> Result<f64, SlidewayError> {
    Ok(STATIC.check(static_friction)? / Range::positive("slope of friction Cn", "N s/m").check(slope)?)
}

/// The sign of a velocity: -1 below 0, 1 from 0 on.
fn sign(velocity: f64) -> f64 {
    if velocity < 0.0 { -1.0 } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::slideway::units::{MM_PER_S, N_S_PER_MM};

    #[test]
    fn figures_of_the_thesis_are_reproduced() {
        let friction = FallingFriction::simulated(2.54 * MM_PER_S);
        assert!((friction.coefficient().unwrap() * 1e-6 - 119.51).abs() < 0.01);
        assert_eq!(friction.solid(0.0), Ok(771.0));
        assert_eq!(friction.solid(-1e-3).unwrap(), -friction.solid(1e-3).unwrap());
        let least = friction.velocity_of_least(10.7 * N_S_PER_MM).unwrap();
        assert!((1.0 - least / friction.limit - 0.00694 * 2.54).abs() < 1e-5);
        let worst = worst_limit(771.0, 32.1 * N_S_PER_MM).unwrap();
        let highest = FallingFriction::simulated(worst).velocity_at_slope(32.1 * N_S_PER_MM).unwrap();
        assert!((highest / worst - 0.5).abs() < 1e-12);
    }

    #[test]
    fn too_steep_a_slope_has_no_critical_velocity() {
        let error = FallingFriction::simulated(0.04).velocity_at_slope(40e3).unwrap_err();
        let expected = "there is no critical velocity: the slope of friction is at most 38.55 N s/mm, and \
                        40.00 N s/mm is needed";
        assert_eq!(error.to_string(), expected);
        assert!(FallingFriction::simulated(0.04).solid(f64::NAN).is_err());
        assert!(FallingFriction { limit: 0.0, ..FallingFriction::simulated(1.0) }.solid(0.0).is_err());
    }

    proptest! {
        #[test]
        fn slope_is_the_derivative_and_velocity_its_inverse(limit in 1e-3..0.1f64, share in 0.01..0.99f64) {
            let friction = FallingFriction::simulated(limit);
            let (velocity, small) = (share * limit, 1e-6 * limit);
            let rise = friction.solid(velocity + small).unwrap() - friction.solid(velocity - small).unwrap();
            let slope = friction.slope(velocity).unwrap();
            prop_assert!((rise / (2.0 * small) / slope + 1.0).abs() < 1e-6);
            prop_assert!((friction.velocity_at_slope(slope).unwrap() / velocity - 1.0).abs() < 1e-9);
        }

        #[test]
        fn no_limit_gives_a_higher_critical_velocity_than_the_worst(slope in 1e3..1e5f64, factor in 0.05..1.95f64) {
            let worst = worst_limit(771.0, slope).unwrap();
            let at = |limit| FallingFriction::simulated(limit).velocity_at_slope(slope).unwrap();
            prop_assert!(at(worst * factor) <= at(worst) * (1.0 + 1e-12));
        }
    }
}
