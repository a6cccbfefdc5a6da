//! Power laws that the thesis fitted to its simulation (9.2, 9.3).
//!
//! They give the slope at which oscillation ceased against time constant and stiffness, and the time constant against
//! the viscosity of the oil.

use super::falling::FallingFriction;
use super::power_law::PowerLaw;
use super::units::{KGF, MS, N_PER_MM, N_S_PER_MM, POISE};
use super::{Range, SlidewayError};

const MEMORY: Range = Range::positive("time constant Tc", "s");
const STIFFNESS: Range = Range::positive("stiffness K", "N/m");
const VISCOSITY: Range = Range::positive("viscosity", "Pa s");
const WEIGHT: Range = Range::positive("weight W", "N");

/// Slope in N s/mm at which oscillation ceased in the simulation, against time constant in s, at 45 kN/mm, 433 kg and
/// 6 ... 25 ms (eq 1-9, Fig 9.1).
pub const SLOPE_BY_MEMORY: PowerLaw = PowerLaw::new(7.5e4, 1.54);

/// Slope in N s/mm at which oscillation ceased in the simulation, against stiffness in N/mm, at 7.1 ms (eq 5-9, Fig
/// 9.3).
pub const SLOPE_BY_STIFFNESS: PowerLaw = PowerLaw::new(16.0, 0.077);

/// Factor of Tc^1.54 K^0.077 in eq 6-9, in N s/mm, s and N/mm.
pub const JOINT_FACTOR: f64 = 3.3e4;

/// The slope of solid friction in N s/m at which oscillation ceased in the thesis's simulation: 3.3e4 Tc^1.54 K^0.077
/// N s/mm (eq 6-9).
///
/// The arguments are a time constant in s and a stiffness in N/m. It was fitted over 6 ... 25 ms at 45 kN/mm and
/// along a line of 7.1 ms. [`DrivenTable::critical_slope`](super::stability::DrivenTable::critical_slope) is the
/// slope by theory.
///
/// # Errors
/// If the time constant or the stiffness is not above 0.
pub fn slope(memory: f64, stiffness: f64) -> Result<f64, SlidewayError> {
    let by_memory = MEMORY.check(memory)?.powf(SLOPE_BY_MEMORY.exponent);
    Ok(JOINT_FACTOR * by_memory * by_stiffness(stiffness)? * N_S_PER_MM)
}

/// K^0.077, with K in N/mm.
pub(super) fn by_stiffness(stiffness: f64) -> Result<f64, SlidewayError> {
    Ok((STIFFNESS.check(stiffness)? / N_PER_MM).powf(SLOPE_BY_STIFFNESS.exponent))
}

/// The time constant in s that belongs to a critical velocity in m/s, by the inverse of eq 6-9 (eq 15-9).
///
/// # Errors
/// If the velocity is not below VcL, or the stiffness not above 0.
pub fn memory_from_critical_velocity(
    friction: &FallingFriction,
    velocity: f64,
    stiffness: f64,
) -> Result<f64, SlidewayError> {
    let slope = friction.slope(velocity)? / N_S_PER_MM;
    let slope = Range::positive("slope of friction at the critical velocity", "N s/mm").check(slope)?;
    Ok((slope / (JOINT_FACTOR * by_stiffness(stiffness)?)).powf(1.0 / SLOPE_BY_MEMORY.exponent))
}

/// The laws that the thesis fitted for one table weight.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::slideway::simulated::OilLaw;
///
/// // An oil of 0.34 P (0.034 Pa s) gives Tc = 8.65 ms at 450 kgf, and less at 850 kgf.
/// let memory = OilLaw::AT_450_KGF.memory(0.034)?;
/// assert!((memory - 8.65e-3).abs() < 0.05e-3);
/// assert!(OilLaw::AT_850_KGF.memory(0.034)? < memory);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OilLaw {
    /// Time constant in ms against viscosity in P (eq 25-9).
    pub memory: PowerLaw,
    /// Viscosity in P against time constant in ms, as the line was read from the plot.
    pub viscosity: PowerLaw,
    /// Slope at which oscillation ceased, without the factor K^0.077: N s/mm against P (eq 24-9).
    pub slope: PowerLaw,
}

impl OilLaw {
    /// The laws for a table of 450 kgf: eq 17-9, 16-9 and 18-9 (22-9).
    pub const AT_450_KGF: OilLaw = OilLaw {
        memory: PowerLaw::new(11.16, 0.236),
        viscosity: PowerLaw::new(36e-6, 4.238),
        slope: PowerLaw::new(32.5, 0.363),
    };

    /// The laws for a table of 850 kgf: eq 20-9, 19-9 and 21-9 (23-9).
    ///
    /// The scan prints eq 19-9 a second time in place of eq 20-9. 8.3 eta^0.183 follows from eq 21-9 and chapter 10.
    pub const AT_850_KGF: OilLaw = OilLaw {
        memory: PowerLaw::new(8.3, 0.183),
        viscosity: PowerLaw::new(9e-6, 5.47),
        slope: PowerLaw::new(20.6, 0.282),
    };

    /// Time constant in s for a viscosity in Pa s (eq 17-9, 20-9).
    ///
    /// # Errors
    /// If the viscosity is not above 0.
    pub fn memory(&self, viscosity: f64) -> Result<f64, SlidewayError> {
        Ok(self.memory.at(VISCOSITY.check(viscosity)? / POISE) * MS)
    }

    /// Viscosity in Pa s for a time constant in s (eq 16-9, 19-9).
    ///
    /// # Errors
    /// If the time constant is not above 0.
    pub fn viscosity(&self, memory: f64) -> Result<f64, SlidewayError> {
        Ok(self.viscosity.at(MEMORY.check(memory)? / MS) * POISE)
    }

    /// Slope in N s/m at which oscillation ceased, for a viscosity in Pa s and a stiffness in N/m (eq 22-9, 23-9).
    ///
    /// # Errors
    /// If viscosity or stiffness is not above 0.
    pub fn slope(&self, viscosity: f64, stiffness: f64) -> Result<f64, SlidewayError> {
        let by_viscosity = self.slope.at(VISCOSITY.check(viscosity)? / POISE);
        Ok(by_viscosity * by_stiffness(stiffness)? * N_S_PER_MM)
    }

    /// The law of the slope that follows from the law of the time constant and eq 6-9.
    pub fn derived_slope(&self) -> PowerLaw {
        let (memory, power) = (self.memory, SLOPE_BY_MEMORY.exponent);
        PowerLaw::new(JOINT_FACTOR * (memory.factor * MS).powf(power), memory.exponent * power)
    }
}

/// Weight of the lighter table for which the thesis fitted a time constant, in kgf.
const LIGHT: f64 = 450.0;
/// Weight of the heavier table, in kgf.
const HEAVY: f64 = 850.0;

/// Time constant in s for a table weight in N and a viscosity in Pa s.
///
/// It is that of eq 17-9 at 450 kgf and that of eq 20-9 at 850 kgf. For other weights it follows the power law of
/// weight through both. This law is ours: the thesis says only that the constants of eq 25-9 fall with weight.
///
/// # Errors
/// If the weight or the viscosity is not above 0.
pub fn memory_at_weight(weight: f64, viscosity: f64) -> Result<f64, SlidewayError> {
    let light = OilLaw::AT_450_KGF.memory(viscosity)?;
    let exponent = (OilLaw::AT_850_KGF.memory(viscosity)? / light).ln() / (HEAVY / LIGHT).ln();
    Ok(light * (WEIGHT.check(weight)? / KGF / LIGHT).powf(exponent))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slideway::assert_close;
    use crate::slideway::units::MM_PER_S;

    #[test]
    fn figures_of_the_thesis_are_reproduced() {
        assert_close(SLOPE_BY_STIFFNESS.at(45e3), 36.5, 1e-3);
        assert_close(slope(0.0071, 45e6).unwrap(), 36.96e3, 1e-3);
        assert_close(OilLaw::AT_450_KGF.memory(0.013).unwrap(), 6.90e-3, 1e-3);
        assert_close(OilLaw::AT_450_KGF.viscosity(8.65e-3).unwrap(), 0.0337, 1e-2);
        assert_close(OilLaw::AT_450_KGF.derived_slope().factor, 32.5, 1e-3);
        assert_close(OilLaw::AT_850_KGF.derived_slope().factor, 20.6, 1e-3);
    }

    #[test]
    fn time_constant_follows_from_a_measured_velocity() {
        let friction = FallingFriction { static_friction: 1249.0, limit: 45.31 * MM_PER_S };
        let velocity = friction.velocity_at_slope(slope(0.0086, 45e6).unwrap()).unwrap();
        assert_close(velocity / MM_PER_S, 4.51, 2e-3);
        assert_close(memory_from_critical_velocity(&friction, velocity, 45e6).unwrap(), 0.0086, 1e-9);
        assert!(memory_from_critical_velocity(&friction, 0.05, 45e6).is_err());
    }

    #[test]
    fn time_constants_of_both_weights_follow_their_laws() {
        for (weight, law) in [(450.0, OilLaw::AT_450_KGF), (850.0, OilLaw::AT_850_KGF)] {
            assert_close(memory_at_weight(weight * KGF, 0.034).unwrap(), law.memory(0.034).unwrap(), 1e-12);
        }
        assert_close(memory_at_weight(620.0 * KGF, 0.034).unwrap(), 7.667e-3, 1e-3);
        assert!(memory_at_weight(0.0, 0.034).is_err() && memory_at_weight(4e3, -1.0).is_err());
    }
}
