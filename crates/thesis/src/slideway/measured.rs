//! Table T9-2: the only measurements of oscillating slideways that the scan preserves.

use super::falling::FallingFriction;
use super::units::{MM_PER_S, POISE};
use super::{SlidewayError, simulated};

/// A cell of Table T9-2: the time constant that eq 15-9 gave for a measured critical velocity, on a table of 450 kgf.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::slideway::measured::TABLE_9_2;
///
/// // 0.34 P on the drive of 27.6 kN/mm: Tc = 8.5 ms, which belongs to a critical velocity of 6.7 mm/s.
/// let cell = &TABLE_9_2[5];
/// assert_eq!(cell.memory, 0.0085);
/// assert!((cell.critical_velocity()? - 6.7e-3).abs() < 0.06e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    /// Viscosity of the oil, in Pa s.
    pub viscosity: f64,
    /// VcL in m/s, by eq 14-9 (Table T9-1, whose cells the scan lost).
    pub limit: f64,
    /// Stiffness of the drive, in N/m.
    pub stiffness: f64,
    /// Time constant Tc as printed, in s.
    pub memory: f64,
}

/// Static friction of the measured slideway, in N (9.3).
pub const STATIC_FRICTION: f64 = 1249.0;

/// The cells of the table: three drives, the stiffest first, each with four oils, the thinnest first.
pub const TABLE_9_2: [Measurement; 12] = [
    cell(0.13, 58.97, 45.0, 0.00720),
    cell(0.34, 45.31, 45.0, 0.00860),
    cell(0.455, 41.83, 45.0, 0.00920),
    cell(0.595, 38.86, 45.0, 0.00980),
    cell(0.13, 58.97, 27.6, 0.00690),
    cell(0.34, 45.31, 27.6, 0.00850),
    cell(0.455, 41.83, 27.6, 0.00910),
    cell(0.595, 38.86, 27.6, 0.00980),
    cell(0.13, 58.97, 11.0, 0.00590),
    cell(0.34, 45.31, 11.0, 0.00870),
    cell(0.455, 41.83, 11.0, 0.00930),
    cell(0.595, 38.86, 11.0, 0.0099),
];

/// A cell from P, mm/s, kN/mm and s, as printed.
const fn cell(poise: f64, limit: f64, stiffness: f64, memory: f64) -> Measurement {
    Measurement { viscosity: poise * POISE, limit: limit * MM_PER_S, stiffness: stiffness * 1e6, memory }
}

impl Measurement {
    /// Friction of the measured slideway.
    pub fn friction(&self) -> FallingFriction {
        FallingFriction { static_friction: STATIC_FRICTION, limit: self.limit }
    }

    /// The measured critical velocity in m/s: the inverse of eq 15-9 for the time constant.
    ///
    /// # Errors
    /// None for the cells of the table.
    pub fn critical_velocity(&self) -> Result<f64, SlidewayError> {
        self.friction().velocity_at_slope(simulated::slope(self.memory, self.stiffness)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measured_velocities_follow_from_the_table() {
        let expected = [6.39, 4.51, 3.25, 2.16, 11.55, 6.71, 5.29, 3.51, 24.26, 8.04, 6.63, 5.41];
        for (cell, velocity) in TABLE_9_2.iter().zip(expected) {
            let got = cell.critical_velocity().unwrap() / MM_PER_S;
            assert!((got - velocity).abs() < 0.01, "got {got}, expected {velocity}");
        }
    }
}
