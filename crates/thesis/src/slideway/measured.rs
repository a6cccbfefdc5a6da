//! What was measured: Table T9-2, the only measurements of oscillating slideways that the scan kept.

use super::falling::FallingFriction;
use super::units::{MM_PER_S, POISE};
use super::{SlidewayError, simulated};

/// A cell of Table T9-2: the time constant that eq 15-9 made of a measured critical velocity, on a table of 450 kgf.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    /// Viscosity of the oil, in Pa s.
    pub viscosity: f64,
    /// VcL in m/s, by eq 14-9 (Table T9-1, whose cells the scan lost).
    pub limit: f64,
    /// Stiffness of the drive, in N/m.
    pub stiffness: f64,
    /// Time constant Tc as it is printed, in s.
    pub memory: f64,
}

/// Static friction behind all of them, in N (9.3).
pub const STATIC_FRICTION: f64 = 1249.0;

/// The table, stiffest drive first, in each the thinnest oil first.
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

/// From P, mm/s, kN/mm and s, as they are printed.
const fn cell(poise: f64, limit: f64, stiffness: f64, memory: f64) -> Measurement {
    Measurement { viscosity: poise * POISE, limit: limit * MM_PER_S, stiffness: stiffness * 1e6, memory }
}

impl Measurement {
    /// Friction of the slideway that was measured.
    pub fn friction(&self) -> FallingFriction {
        FallingFriction { static_friction: STATIC_FRICTION, limit: self.limit }
    }

    /// The critical velocity in m/s that was measured: eq 15-9 run backwards from the time constant.
    ///
    /// # Errors
    /// None of the table's cells gives one.
    pub fn critical_velocity(&self) -> Result<f64, SlidewayError> {
        self.friction().velocity_at_slope(simulated::slope(self.memory, self.stiffness)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocities_behind_the_table_come_back() {
        let wanted = [6.39, 4.51, 3.25, 2.16, 11.55, 6.71, 5.29, 3.51, 24.26, 8.04, 6.63, 5.41];
        for (cell, velocity) in TABLE_9_2.iter().zip(wanted) {
            let got = cell.critical_velocity().unwrap() / MM_PER_S;
            assert!((got - velocity).abs() < 0.01, "{got}, not {velocity}");
        }
    }
}
