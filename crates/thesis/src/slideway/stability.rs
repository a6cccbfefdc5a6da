//! Stability of small motions of a table whose solid friction lags behind velocity: Routh-Hurwitz (8.2, 9.4 (i)).
//!
//! Cn is the slope with which solid friction falls at the steady velocity. The characteristic equation of the table
//! is M s^2 + f s - Cn s / (1 + Tc s) + K = 0. The thesis writes N for -Cn (eq 26-9 ... 32-9). Here Cn is positive
//! while friction falls, as in eq 40-8.

use super::falling::FallingFriction;
use super::power_law::PowerLaw;
use super::units::{N_PER_MM, N_S_PER_MM};
use super::{Range, SlidewayError};

const MASS: Range = Range::positive("mass M", "kg");
const STIFFNESS: Range = Range::positive("stiffness K", "N/m");
const DAMPING: Range = Range::not_negative("viscous coefficient f", "N s/m");
const MEMORY: Range = Range::not_negative("time constant Tc", "s");
const SLOPE: Range = Range::finite("slope of friction Cn", "N s/m");

/// The critical slope in N s/mm against time constant in s, as the thesis drew it for 433 kg, 45 kN/mm and 10.71 N
/// s/mm (eq 37-9). It agrees with eq 32-9 to 4 % over 6 ... 25 ms.
pub const PRINTED_BY_MEMORY: PowerLaw = PowerLaw::new(12.95e4, 1.55);

/// The critical slope in N s/mm against stiffness in N/mm, as the thesis drew it for 433 kg, 10.71 N s/mm and 7.1 ms
/// (eq 38-9). It agrees with eq 32-9 to 7 % over 10 ... 45 kN/mm.
pub const PRINTED_BY_STIFFNESS: PowerLaw = PowerLaw::new(0.0385, 0.685);

/// Viscous coefficient of the thesis's simulation, in N s/m (8.4, 9.2). The time constants of the thesis were found
/// with it.
pub const SIMULATED_DAMPING: f64 = 10.7e3;

/// A table on its drive: a mass on a spring with viscous damping, whose solid friction lags behind velocity.
///
/// # Examples
///
/// Without lag the table is stable as long as friction falls less steeply than viscous friction rises:
///
/// ```
/// use patchcord_thesis::slideway::stability::DrivenTable;
///
/// let table = DrivenTable::simulated(0.0);
/// assert!((table.natural_frequency()? - 322.4).abs() < 0.1);
/// assert_eq!(table.critical_slope()?, 10.7e3);
///
/// // A lag of friction makes the table more stable.
/// let lagging = DrivenTable::simulated(0.0071);
/// let slope = 1.01 * table.critical_slope()?;
/// assert!(!table.is_stable(slope)? && lagging.is_stable(slope)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrivenTable {
    /// Sliding mass M, in kg, above 0.
    pub mass: f64,
    /// Stiffness K of the drive, in N/m, above 0.
    pub stiffness: f64,
    /// Viscous coefficient f, in N s/m, not below 0.
    pub damping: f64,
    /// Time constant Tc of the lag of solid friction behind velocity, in s, not below 0.
    pub memory: f64,
}

/// The dimensionless groups that decide stability (eq 33-9 ... 35-9).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Groups {
    /// A = K Tc^2 / M.
    pub stiffness: f64,
    /// B = Cn Tc / M, positive while friction falls (negative in the thesis).
    pub slope: f64,
    /// C = f Tc / M.
    pub damping: f64,
}

impl Groups {
    /// B on the boundary of stability, C + A C / (1 + C) (eq 36-9, Fig 9.8).
    pub fn boundary(stiffness: f64, damping: f64) -> f64 {
        damping + stiffness * damping / (1.0 + damping)
    }
}

impl DrivenTable {
    /// The table of the thesis's final simulation (8.4): M = 433 kg, K = 45 kN/mm, f = 10.7 N s/mm, with a time
    /// constant in s. The thesis set 6 ... 25 ms.
    pub const fn simulated(memory: f64) -> Self {
        DrivenTable { mass: 433.0, stiffness: 45e6, damping: SIMULATED_DAMPING, memory }
    }

    pub(super) fn checked(&self) -> Result<&Self, SlidewayError> {
        MASS.check(self.mass)?;
        STIFFNESS.check(self.stiffness)?;
        DAMPING.check(self.damping)?;
        MEMORY.check(self.memory)?;
        Ok(self)
    }

    /// M + f Tc, in kg: the effective mass on the boundary of stability.
    fn effective_mass(&self) -> f64 {
        self.mass + self.damping * self.memory
    }

    /// Undamped natural frequency, sqrt(K / M), in rad/s (eq 11-8).
    ///
    /// # Errors
    /// If a quantity is out of its range.
    pub fn natural_frequency(&self) -> Result<f64, SlidewayError> {
        self.checked().map(|table| (table.stiffness / table.mass).sqrt())
    }

    /// Damping ratio of the table without solid friction, f / (2 sqrt(M K)) (eq 12-8).
    ///
    /// # Errors
    /// If a quantity is out of its range.
    pub fn damping_ratio(&self) -> Result<f64, SlidewayError> {
        self.checked().map(|table| table.damping / (2.0 * (table.mass * table.stiffness).sqrt()))
    }

    /// Damped natural frequency of the table without solid friction, wn sqrt(1 - zeta^2), in rad/s.
    ///
    /// # Errors
    /// If a quantity is out of its range, or the damping ratio is 1 or more.
    pub fn damped_frequency(&self) -> Result<f64, SlidewayError> {
        let damping = self.damping_ratio()?;
        if damping >= 1.0 {
            let reason = format!("the damping ratio is {damping:.4}");
            return Err(SlidewayError::NoSolution { sought: "damped frequency", reason });
        }
        Ok(self.natural_frequency()? * (1.0 - damping.powi(2)).sqrt())
    }

    /// Coefficients of s^3, s^2, s and 1 in the denominator of eq 26-9, for a slope of solid friction in N s/m.
    ///
    /// # Errors
    /// If a quantity of the table is out of its range, or the slope is not a number.
    pub fn characteristic(&self, slope: f64) -> Result<[f64; 4], SlidewayError> {
        let (table, slope) = (self.checked()?, SLOPE.check(slope)?);
        let velocity = table.stiffness * table.memory + table.damping - slope;
        Ok([table.mass * table.memory, table.effective_mass(), velocity, table.stiffness])
    }

    /// Whether small motions decay at a slope of solid friction in N s/m: (M + f Tc)(K Tc + f - Cn) > M K Tc (eq
    /// 27-9). The thesis writes "at least", which includes the boundary.
    ///
    /// # Errors
    /// If a quantity of the table is out of its range, or the slope is not a number.
    pub fn is_stable(&self, slope: f64) -> Result<bool, SlidewayError> {
        let [cube, square, line, constant] = self.characteristic(slope)?;
        Ok(square * line > cube * constant)
    }

    /// The slope of solid friction on the boundary of stability, in N s/m: Cn = f + f K Tc^2 / (M + f Tc) (eq 32-9).
    ///
    /// # Errors
    /// If a quantity is out of its range.
    pub fn critical_slope(&self) -> Result<f64, SlidewayError> {
        let table = self.checked()?;
        let by_memory = table.damping * table.stiffness * table.memory.powi(2) / table.effective_mass();
        Ok(table.damping + by_memory)
    }

    /// The critical velocity in m/s on a slideway with this friction, above which small motions decay.
    ///
    /// The slope of friction equals the critical slope there: VcL - Cn VcL^2 / (2 Fs) (eq 41-8 with 32-9).
    ///
    /// # Errors
    /// If a quantity is out of its range, or the slope of friction is below the critical slope at every velocity.
    /// Then small motions always decay.
    pub fn critical_velocity(&self, friction: &FallingFriction) -> Result<f64, SlidewayError> {
        friction.velocity_at_slope(self.critical_slope()?)
    }

    /// Frequency on the boundary of stability, sqrt(K / (M + f Tc)), in rad/s (eq 40-9).
    ///
    /// # Errors
    /// If a quantity is out of its range.
    pub fn boundary_frequency(&self) -> Result<f64, SlidewayError> {
        self.checked().map(|table| (table.stiffness / table.effective_mass()).sqrt())
    }

    /// The dimensionless groups for a slope of solid friction in N s/m (eq 33-9 ... 35-9).
    ///
    /// # Errors
    /// If a quantity of the table is out of its range, or the slope is not a number.
    pub fn groups(&self, slope: f64) -> Result<Groups, SlidewayError> {
        let (table, slope) = (self.checked()?, SLOPE.check(slope)?);
        let per_mass = table.memory / table.mass;
        Ok(Groups {
            stiffness: table.stiffness * table.memory * per_mass,
            slope: slope * per_mass,
            damping: table.damping * per_mass,
        })
    }

    /// The power law fitted to the critical slope over time constants in s: N s/mm against s, in the form of eq 37-9.
    ///
    /// # Errors
    /// If a quantity is out of its range, or fewer than two time constants differ.
    pub fn slope_by_memory(&self, memories: &[f64]) -> Result<PowerLaw, SlidewayError> {
        let point = |memory: &f64| {
            Ok((*memory, DrivenTable { memory: *memory, ..*self }.critical_slope()? / N_S_PER_MM))
        };
        PowerLaw::fit(&memories.iter().map(point).collect::<Result<Vec<_>, SlidewayError>>()?)
    }

    /// The power law fitted to the critical slope over stiffnesses in N/m: N s/mm against N/mm, in the form of eq 38-9.
    ///
    /// # Errors
    /// If a quantity is out of its range, or fewer than two stiffnesses differ.
    pub fn slope_by_stiffness(&self, stiffnesses: &[f64]) -> Result<PowerLaw, SlidewayError> {
        let point = |stiffness: &f64| {
            let slope = DrivenTable { stiffness: *stiffness, ..*self }.critical_slope()?;
            Ok((*stiffness / N_PER_MM, slope / N_S_PER_MM))
        };
        PowerLaw::fit(&stiffnesses.iter().map(point).collect::<Result<Vec<_>, SlidewayError>>()?)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;
    use proptest::prelude::*;

    use super::*;
    use crate::slideway::assert_close;

    #[test]
    fn figures_of_the_thesis_are_reproduced() {
        let early = DrivenTable { mass: 454.0, stiffness: 17.86e6, damping: 17.86e3, memory: 0.0 };
        assert_close(early.natural_frequency().unwrap(), 198.34, 1e-4);
        assert_close(early.damping_ratio().unwrap(), 0.09917, 1e-4);
        let table = DrivenTable { damping: 10.71e3, ..DrivenTable::simulated(0.0071) };
        assert_close(table.critical_slope().unwrap() / N_S_PER_MM, 58.4, 1e-3);
        assert_close(table.boundary_frequency().unwrap(), 297.3, 1e-3);
        assert_close(table.damped_frequency().unwrap(), 322.14, 1e-4);
    }

    #[test]
    fn printed_power_laws_are_near_the_criterion() {
        let table =
            |memory, stiffness| DrivenTable { damping: 10.71e3, stiffness, ..DrivenTable::simulated(memory) };
        let slope = |table: DrivenTable| table.critical_slope().unwrap() / N_S_PER_MM;
        let by_memory =
            [0.006, 0.0071, 0.01, 0.015, 0.025].map(|memory| (memory, slope(table(memory, 45e6))));
        assert!(PRINTED_BY_MEMORY.max_deviation(&by_memory) < 0.04);
        let by_stiffness =
            [10e3, 20e3, 27.6e3, 45e3].map(|stiff| (stiff, slope(table(0.0071, stiff * N_PER_MM))));
        assert!(PRINTED_BY_STIFFNESS.max_deviation(&by_stiffness) < 0.07);
    }

    #[test]
    fn critical_velocity_follows_from_the_critical_slope() {
        let friction = FallingFriction::simulated(0.010_16);
        let velocity = DrivenTable::simulated(0.0065).critical_velocity(&friction).unwrap();
        assert_close(velocity * 1e3, 6.734, 1e-3);
        assert!(DrivenTable::simulated(0.025).critical_velocity(&friction).is_err());
    }

    #[test]
    fn critical_slope_without_lag_is_the_viscous_coefficient() {
        assert_eq!(DrivenTable::simulated(0.0).critical_slope(), Ok(10.7e3));
        assert!(DrivenTable { mass: 0.0, ..DrivenTable::simulated(0.0) }.critical_slope().is_err());
        assert!(DrivenTable { damping: 1e6, ..DrivenTable::simulated(0.0) }.damped_frequency().is_err());
    }

    /// Whether all roots of a cubic are in the left half-plane, from the eigenvalues of its companion matrix.
    fn has_stable_roots([cube, square, line, constant]: [f64; 4]) -> bool {
        // In units of the natural frequency, so that the matrix is balanced.
        let scale = (constant / cube).cbrt();
        let row = [-square / cube / scale, -line / cube / scale.powi(2), -1.0];
        let companion =
            DMatrix::from_row_slice(3, 3, &[row[0], row[1], row[2], 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        companion.complex_eigenvalues().iter().all(|root| root.re < 0.0)
    }

    prop_compose! {
        fn tables()(mass in 100.0..4000.0f64, stiffness in 5e6..2e8f64, damping in 1e2..1e5f64, memory in 1e-3..0.1f64)
            -> DrivenTable { DrivenTable { mass, stiffness, damping, memory } }
    }

    proptest! {
        #[test]
        fn criterion_agrees_with_the_roots(table in tables(), share in 0.2..2.0f64) {
            prop_assume!((share - 1.0).abs() > 1e-3);
            let slope = share * table.critical_slope().unwrap();
            prop_assert_eq!(table.is_stable(slope).unwrap(), share < 1.0);
            prop_assert_eq!(has_stable_roots(table.characteristic(slope).unwrap()), share < 1.0);
        }

        #[test]
        fn groups_give_the_same_boundary(table in tables()) {
            let groups = table.groups(table.critical_slope().unwrap()).unwrap();
            let boundary = Groups::boundary(groups.stiffness, groups.damping);
            prop_assert!((groups.slope / boundary - 1.0).abs() < 1e-9);
        }

        #[test]
        fn boundary_frequency_solves_the_characteristic_equation(table in tables()) {
            let [cube, square, line, constant] = table.characteristic(table.critical_slope().unwrap()).unwrap();
            let squared = table.boundary_frequency().unwrap().powi(2);
            prop_assert!((squared * square / constant - 1.0).abs() < 1e-9);
            prop_assert!((squared * cube / line - 1.0).abs() < 1e-6);
        }
    }
}
