//! Oscillations of finite amplitude: describing functions of the slideway's friction (9.4 (ii)).
//!
//! The table moves at a steady velocity v0. The force of the drive swings by the amplitude E about its mean, and
//! solid friction swings by the amplitude n, a quarter of a period apart. The force that accelerates the mass is E
//! sin(t) - n cos(t), cut off below at -a. Here a = f v0 is the viscous friction; the drive does not push back.
//!
//! The sum of sine and cosine is one sine of the amplitude S = sqrt(E^2 + n^2). So both branches of the thesis (eq
//! 65-9 ... 72-9 for n < a, eq 73-9 ... 80-9 for n > a) are one cut-off sine, with the gain g(S / a) of eq 56-9 and
//! the angle of the sum. The time constant Tc, which the thesis omits here, multiplies n by 1 / (1 + j w Tc).

use std::f64::consts::PI;

use nalgebra::Complex;

use super::falling::FallingFriction;
use super::root::bisect;
use super::stability::DrivenTable;
use super::units::N_S_PER_MM;
use super::{Range, SlidewayError};

const FREQUENCY: Range = Range::positive("frequency", "rad/s");
const FORCE_RATIO: Range = Range::positive("ratio E/a", "");
const FRICTION_RATIO: Range = Range::not_negative("ratio n/a", "");

/// The output of a cut-off at -a for a force, both in units of a (eq 53-9, Fig 9.11 (b)). The drive does not push back.
pub fn cut_off(force: f64) -> f64 {
    force.max(-1.0)
}

/// The output of a dead zone for a force, both in units of its half width (eq 52-9, Fig 9.10 (b)). Only the force in
/// excess of friction is useful.
pub fn dead_zone(force: f64) -> f64 {
    (force.abs() - 1.0).max(0.0).copysign(force)
}

/// The gain of a cut-off at -a for a sine of amplitude `size` times a (eq 56-9): 1 up to a size of 1, tending to 1/2
/// for large sizes.
pub fn cut_off_gain(size: f64) -> f64 {
    if size <= 1.0 {
        return 1.0;
    }
    let share = 1.0 / size;
    0.5 + (share.asin() + share * (1.0 - share.powi(2)).sqrt()) / PI
}

/// The gain of a dead zone for a sine of amplitude `size` times its half width (Fig 9.10 (c)): 0 up to a size of 1,
/// tending to 1 for large sizes.
pub fn dead_zone_gain(size: f64) -> f64 {
    if size <= 1.0 {
        return 0.0;
    }
    let share = 1.0 / size;
    1.0 - 2.0 / PI * (share.asin() + share * (1.0 - share.powi(2)).sqrt())
}

/// The amplitudes of the two forces, in units of the viscous friction a = f v0 at the steady velocity v0.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::slideway::describing::{Swing, cut_off_gain};
///
/// // Table T9-4 has 1.2 and 45 degrees for E/a = 5 and n/a = 5.
/// let swing = Swing { force: 5.0, friction: 5.0 };
/// assert!((swing.reciprocal()? - 1.2).abs() < 0.02);
/// assert!((swing.angle()?.to_degrees() - 45.0).abs() < 1e-9);
/// assert_eq!(cut_off_gain(1.0), 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swing {
    /// E/a: amplitude of the drive's force.
    pub force: f64,
    /// n/a: amplitude of solid friction.
    pub friction: f64,
}

impl Swing {
    /// The describing function N = g + j b: g by eq 67-9 or 75-9, b = -(n/E) g by eq 68-9 or 76-9.
    ///
    /// # Errors
    /// If E/a is not above 0 or n/a is below 0.
    pub fn describing_function(&self) -> Result<Complex<f64>, SlidewayError> {
        let (force, friction) = (FORCE_RATIO.check(self.force)?, FRICTION_RATIO.check(self.friction)?);
        Ok(Complex::new(1.0, -friction / force) * cut_off_gain(force.hypot(friction)))
    }

    /// 1 / |N|, as in Table T9-4 and Figs 9.13, 9.15 and 9.16.
    ///
    /// # Errors
    /// If E/a is not above 0 or n/a is below 0.
    pub fn reciprocal(&self) -> Result<f64, SlidewayError> {
        self.describing_function().map(|function| 1.0 / function.norm())
    }

    /// The angle by which the output lags, atan(n/E), in radians (eq 71-9, 79-9).
    ///
    /// # Errors
    /// If E/a is not above 0 or n/a is below 0.
    pub fn angle(&self) -> Result<f64, SlidewayError> {
        self.describing_function().map(|function| -function.arg())
    }
}

/// A limit cycle: the intersection of the curve of the table with that of the describing function, 1 + N G = 0.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::slideway::falling::FallingFriction;
/// use patchcord_thesis::slideway::stability::DrivenTable;
///
/// // Table T9-6, E/a = 20 at 45 MN/m: 235 rad/s about 19.1 mm/s. The table comes to rest.
/// let table = DrivenTable { damping: 10.71e3, ..DrivenTable::simulated(0.0) };
/// let cycle = table.limit_cycle(20.0)?;
/// assert!((cycle.frequency - 235.0).abs() < 0.5);
/// let motion = cycle.oscillation(&table, &FallingFriction::simulated(0.04))?;
/// assert!((motion.velocity - 19.1e-3).abs() < 0.05e-3 && motion.is_stick_slip());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitCycle {
    /// E/a: amplitude of the drive's force, in units of the viscous friction a.
    pub force_ratio: f64,
    /// n/E: ratio of the amplitude of solid friction to that of the drive's force (eq 85-9). n is the amplitude
    /// without the time constant.
    pub friction_ratio: f64,
    /// Gain g of the cut-off, 1/2 ... 1.
    pub gain: f64,
    /// Frequency in rad/s.
    pub frequency: f64,
    /// The slope Cn of solid friction that maintains the limit cycle, in N s/m.
    pub slope: f64,
    /// The angle between G(j w) and the negative real axis, in radians (eq 59-9).
    pub angle: f64,
}

/// A limit cycle in physical units, at its steady velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillation {
    /// Steady velocity v0 about which velocity swings, in m/s.
    pub velocity: f64,
    /// Amplitude e of the position error, in m (eq 86-9).
    pub error: f64,
    /// Amplitude v = e w of velocity, in m/s (eq 84-9).
    pub swing: f64,
    /// Frequency in rad/s.
    pub frequency: f64,
}

impl Oscillation {
    /// Whether velocity reaches 0 within the swing. The oscillation is then stick-slip.
    pub fn is_stick_slip(&self) -> bool {
        self.swing >= self.velocity
    }
}

impl DrivenTable {
    /// The transfer function of the table, G(j w) = K / (j w (j w M + f)) (eq 57-9), at w in rad/s.
    ///
    /// # Errors
    /// If a quantity is out of its range.
    pub fn open_loop(&self, frequency: f64) -> Result<Complex<f64>, SlidewayError> {
        let (table, frequency) = (self.checked()?, FREQUENCY.check(frequency)?);
        Ok(table.stiffness / Complex::new(-table.mass * frequency.powi(2), table.damping * frequency))
    }

    /// The angle between G(j w) and the negative real axis, atan(f / (M w)), in radians (eq 59-9), at w in rad/s.
    ///
    /// # Errors
    /// If a quantity is out of its range.
    pub fn open_loop_angle(&self, frequency: f64) -> Result<f64, SlidewayError> {
        let (table, frequency) = (self.checked()?, FREQUENCY.check(frequency)?);
        Ok((table.damping / (table.mass * frequency)).atan())
    }

    /// The frequency in rad/s at which G(j w) has an angle in radians from the negative real axis: f / (M tan).
    ///
    /// # Errors
    /// If a quantity is out of its range.
    pub fn frequency_at_angle(&self, angle: f64) -> Result<f64, SlidewayError> {
        let table = self.checked()?;
        let angle = Range::new("angle", "rad", f64::MIN_POSITIVE, PI / 2.0).check(angle)?;
        Ok(table.damping / (table.mass * angle.tan()))
    }

    /// The limit cycle for a ratio E/a (Fig 9.15, 9.16).
    ///
    /// With the gain g of the cut-off, the solution of 1 + N G = 0 is w^2 = g K / (M + f Tc) and Cn = f / g + f K
    /// Tc^2 / (M + f Tc). With g = 1 this is the boundary of Routh-Hurwitz (eq 32-9, 40-9). Table T9-6 was read
    /// without Tc.
    ///
    /// # Errors
    /// If a quantity is out of its range, or there is no viscous friction.
    pub fn limit_cycle(&self, force_ratio: f64) -> Result<LimitCycle, SlidewayError> {
        let (force, table) = (FORCE_RATIO.check(force_ratio)?, self.checked()?);
        Range::positive("viscous coefficient f", "N s/m").check(table.damping)?;
        // S changes by at most half as many percent as g, and the gain by two thirds of that: there is one solution.
        let is_below =
            |gain: f64| cut_off_gain(force * table.cycle_with_gain(gain, force).input_ratio(table)) > gain;
        let gain = bisect(0.5, 1.0, is_below);
        Ok(table.cycle_with_gain(gain, force))
    }

    /// The limit cycle with a given gain g of the cut-off.
    fn cycle_with_gain(&self, gain: f64, force_ratio: f64) -> LimitCycle {
        let effective_mass = self.mass + self.damping * self.memory;
        let frequency = (gain * self.stiffness / effective_mass).sqrt();
        let slope =
            self.damping / gain + self.damping * self.stiffness * self.memory.powi(2) / effective_mass;
        let angle = (self.damping / (self.mass * frequency)).atan();
        LimitCycle {
            force_ratio,
            friction_ratio: slope * frequency / self.stiffness,
            gain,
            frequency,
            slope,
            angle,
        }
    }
}

impl LimitCycle {
    /// The amplitude at the input of the cut-off, in units of E: |1 - j (n/E) / (1 + j w Tc)|.
    fn input_ratio(&self, table: &DrivenTable) -> f64 {
        let lag = Complex::new(1.0, self.frequency * table.memory);
        (Complex::new(1.0, 0.0) - Complex::new(0.0, self.friction_ratio) / lag).norm()
    }

    /// n/a: amplitude of solid friction, in units of the viscous friction a.
    pub fn friction_amplitude(&self) -> f64 {
        self.friction_ratio * self.force_ratio
    }

    /// The limit cycle in physical units on a slideway with this friction: v0 from Cn by eq 64-9, e = (E/a) f v0 / K
    /// by eq 86-9, v = e w.
    ///
    /// # Errors
    /// If the slope of friction is below that of the limit cycle at every velocity.
    pub fn oscillation(
        &self,
        table: &DrivenTable,
        friction: &FallingFriction,
    ) -> Result<Oscillation, SlidewayError> {
        let velocity = friction.velocity_at_slope(self.slope)?;
        let error = self.force_ratio * table.damping * velocity / table.checked()?.stiffness;
        Ok(Oscillation { velocity, error, swing: error * self.frequency, frequency: self.frequency })
    }
}

/// The oscillation at a steady velocity in m/s: the limit cycle that the slope of friction at this velocity maintains
/// (Fig 9.17).
///
/// # Errors
/// If the slope of friction is too small to maintain a limit cycle, or so large that it would grow without limit (g =
/// 1/2).
pub fn oscillation_at(
    table: &DrivenTable,
    friction: &FallingFriction,
    velocity: f64,
) -> Result<Oscillation, SlidewayError> {
    let (least, slope) = (table.critical_slope()?, friction.slope(velocity)?);
    let gain = table.damping / (slope - (least - table.damping));
    if slope < least || gain <= 0.5 {
        let fault =
            if slope < least { "too small to maintain it" } else { "so large that it grows without limit" };
        let reason = format!("the slope of friction is {:.2} N s/mm, {fault}", slope / N_S_PER_MM);
        return Err(SlidewayError::NoSolution { sought: "limit cycle", reason });
    }
    let cycle = table.cycle_with_gain(gain, 1.0);
    let cycle = LimitCycle { force_ratio: size_with_gain(gain) / cycle.input_ratio(table), ..cycle };
    cycle.oscillation(table, friction)
}

/// The limit cycle whose swing just reaches standstill, v = v0 (9.4 (ii), 2).
///
/// Stick-slip occurs at lower steady velocities, and quasi-harmonic motion from there up to the critical velocity.
///
/// # Errors
/// If a quantity is out of its range, there is no viscous friction, or friction is not so steep at any velocity.
pub fn end_of_sticking(
    table: &DrivenTable,
    friction: &FallingFriction,
) -> Result<Oscillation, SlidewayError> {
    Range::positive("viscous coefficient f", "N s/m").check(table.damping)?;
    // v / v0 = (E/a) f w / K grows with E/a, and w falls by a factor of at most sqrt(2). So the ratio reaches 1 below
    // E/a = 2 K / (f wn).
    let share = |cycle: &LimitCycle| cycle.force_ratio * table.damping * cycle.frequency / table.stiffness;
    let most = 2.0 * table.stiffness / (table.damping * table.boundary_frequency()?);
    let is_short = |force: f64| table.limit_cycle(force).is_ok_and(|cycle| share(&cycle) < 1.0);
    table.limit_cycle(bisect(0.0, most, is_short))?.oscillation(table, friction)
}

/// The amplitude of the sine with this gain of the cut-off, above 1/2: the inverse of [`cut_off_gain`].
fn size_with_gain(gain: f64) -> f64 {
    1.0 / bisect(0.0, 1.0, |share| cut_off_gain(1.0 / share) < gain)
}

#[cfg(test)]
mod tests;
