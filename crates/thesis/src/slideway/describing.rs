//! Oscillations of a size: describing functions of the slideway's friction (9.4 (ii)).
//!
//! About a steady velocity the drive pulls with a force that swings by E, and velocity swings with it, so that solid friction
//! swings by n, a quarter of a period apart. What is left to accelerate the mass is E sin(t) - n cos(t), cut off below at -a, where
//! a = f v0 is what viscous friction takes: the drive does not push back. A sum of a sine and a cosine is one sine of the size
//! S = sqrt(E^2 + n^2), so both branches of the study (eq 65-9 ... 72-9 where n < a, eq 73-9 ... 80-9 where n > a) are one cut-off
//! sine, with the share g(S / a) of eq 56-9 and the angle of the sum. With the time constant Tc, which the study leaves for later,
//! n is smaller and comes later, by 1 / (1 + j w Tc).

use std::f64::consts::PI;

use nalgebra::Complex;

use super::falling::FallingFriction;
use super::root::halved;
use super::stability::DrivenTable;
use super::units::N_S_PER_MM;
use super::{Range, SlidewayError};

const FREQUENCY: Range = Range::positive("frequency", "rad/s");
const FORCE_RATIO: Range = Range::positive("ratio E/a", "");
const FRICTION_RATIO: Range = Range::not_negative("ratio n/a", "");

/// What is left of a force by a cut-off at -a, both in units of a: the drive does not push back (eq 53-9, Fig 9.11 (b)).
pub fn cut_off(force: f64) -> f64 {
    force.max(-1.0)
}

/// What is left of a force by a dead zone, in units of its half width: what is beyond friction is useful (eq 52-9, Fig 9.10 (b)).
pub fn dead_zone(force: f64) -> f64 {
    (force.abs() - 1.0).max(0.0).copysign(force)
}

/// The share of a sine that passes a cut-off at -a, for a sine of `size` times a (eq 56-9): 1 up to a size of 1, towards 1/2 for
/// large ones.
pub fn cut_off_gain(size: f64) -> f64 {
    if size <= 1.0 {
        return 1.0;
    }
    let share = 1.0 / size;
    0.5 + (share.asin() + share * (1.0 - share.powi(2)).sqrt()) / PI
}

/// The share of a sine that passes a dead zone, for a sine of `size` times the half width of the zone: 0 up to a size of 1, towards 1
/// for large ones (Fig 9.10 (c)).
pub fn dead_zone_gain(size: f64) -> f64 {
    if size <= 1.0 {
        return 0.0;
    }
    let share = 1.0 / size;
    1.0 - 2.0 / PI * (share.asin() + share * (1.0 - share.powi(2)).sqrt())
}

/// What swings, in units of the spare force a = f v0.
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
    /// Where E/a is not above 0 or n/a is below 0.
    pub fn describing_function(&self) -> Result<Complex<f64>, SlidewayError> {
        let (force, friction) = (FORCE_RATIO.check(self.force)?, FRICTION_RATIO.check(self.friction)?);
        Ok(Complex::new(1.0, -friction / force) * cut_off_gain(force.hypot(friction)))
    }

    /// 1 / |N|, as Table T9-4 and Figs 9.13, 9.15 and 9.16 have it.
    ///
    /// # Errors
    /// Where E/a is not above 0 or n/a is below 0.
    pub fn reciprocal(&self) -> Result<f64, SlidewayError> {
        self.describing_function().map(|function| 1.0 / function.norm())
    }

    /// The angle by which the output is late, atan(n/E), in radians (eq 71-9, 79-9).
    ///
    /// # Errors
    /// Where E/a is not above 0 or n/a is below 0.
    pub fn angle(&self) -> Result<f64, SlidewayError> {
        self.describing_function().map(|function| -function.arg())
    }
}

/// A limit cycle: where the curve of the table meets that of the describing function, 1 + N G = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitCycle {
    /// E/a: amplitude of the drive's force, in units of the spare force.
    pub force_ratio: f64,
    /// n/E: amplitude of solid friction, as it would be without its time constant, by that of the drive's force (eq 85-9).
    pub friction_ratio: f64,
    /// The share that the cut-off leaves, 1/2 ... 1.
    pub gain: f64,
    /// Frequency in rad/s.
    pub frequency: f64,
    /// The slope Cn of solid friction that keeps it up, in N s/m.
    pub slope: f64,
    /// The angle by which the curve of the table is short of half a turn, in radians (eq 59-9).
    pub angle: f64,
}

/// A limit cycle in physical units, at the steady velocity that belongs to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillation {
    /// Steady velocity v0 about which it swings, in m/s.
    pub velocity: f64,
    /// Amplitude e of the position error, in m (eq 86-9).
    pub error: f64,
    /// Amplitude v = e w of velocity, in m/s (eq 84-9).
    pub swing: f64,
    /// Frequency in rad/s.
    pub frequency: f64,
}

impl Oscillation {
    /// Whether velocity comes to rest within the swing, which makes it stick-slip.
    pub fn sticks(&self) -> bool {
        self.swing >= self.velocity
    }
}

impl DrivenTable {
    /// The table's part of the loop, G(j w) = K / (j w (j w M + f)) (eq 57-9), at w in rad/s.
    ///
    /// # Errors
    /// Where a quantity is out of its range.
    pub fn open_loop(&self, frequency: f64) -> Result<Complex<f64>, SlidewayError> {
        let (table, frequency) = (self.checked()?, FREQUENCY.check(frequency)?);
        Ok(table.stiffness / Complex::new(-table.mass * frequency.powi(2), table.damping * frequency))
    }

    /// The angle by which G(j w) is short of half a turn, atan(f / (M w)), in radians (eq 59-9), at w in rad/s.
    ///
    /// # Errors
    /// Where a quantity is out of its range.
    pub fn open_loop_angle(&self, frequency: f64) -> Result<f64, SlidewayError> {
        let (table, frequency) = (self.checked()?, FREQUENCY.check(frequency)?);
        Ok((table.damping / (table.mass * frequency)).atan())
    }

    /// The frequency in rad/s at which it is short of half a turn by an angle in radians: f / (M tan).
    ///
    /// # Errors
    /// Where a quantity is out of its range.
    pub fn frequency_at_angle(&self, angle: f64) -> Result<f64, SlidewayError> {
        let table = self.checked()?;
        let angle = Range::new("angle", "rad", f64::MIN_POSITIVE, PI / 2.0).check(angle)?;
        Ok(table.damping / (table.mass * angle.tan()))
    }

    /// The limit cycle with E/a (Fig 9.15, 9.16). With the share g that the cut-off leaves, 1 + N G = 0 is solved by
    /// w^2 = g K / (M + f Tc) and Cn = f / g + f K Tc^2 / (M + f Tc): with g = 1 that is Routh-Hurwitz's boundary (eq 32-9,
    /// 40-9), without Tc it is what Table T9-6 was read from.
    ///
    /// # Errors
    /// Where a quantity is out of its range, or there is no viscous friction.
    pub fn limit_cycle(&self, force_ratio: f64) -> Result<LimitCycle, SlidewayError> {
        let (force, table) = (FORCE_RATIO.check(force_ratio)?, self.checked()?);
        Range::positive("viscous coefficient f", "N s/m").check(table.damping)?;
        // S changes by half as many percent as g at most, and what the cut-off leaves of it by two thirds of that: one solution.
        let is_short = |gain: f64| cut_off_gain(force * table.cycle_with_gain(gain, force).sum(table)) > gain;
        let gain = halved(0.5, 1.0, is_short);
        Ok(table.cycle_with_gain(gain, force))
    }

    fn cycle_with_gain(&self, gain: f64, force_ratio: f64) -> LimitCycle {
        let slowed_mass = self.mass + self.damping * self.memory;
        let frequency = (gain * self.stiffness / slowed_mass).sqrt();
        let slope = self.damping / gain + self.damping * self.stiffness * self.memory.powi(2) / slowed_mass;
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
    /// The amplitude of what is cut off, in units of E: |1 - j (n/E) / (1 + j w Tc)|.
    fn sum(&self, table: &DrivenTable) -> f64 {
        let late = Complex::new(1.0, self.frequency * table.memory);
        (Complex::new(1.0, 0.0) - Complex::new(0.0, self.friction_ratio) / late).norm()
    }

    /// n/a: amplitude of solid friction, in units of the spare force.
    pub fn friction_by_spare(&self) -> f64 {
        self.friction_ratio * self.force_ratio
    }

    /// The limit cycle on a slideway with this friction: v0 from Cn by eq 64-9, e = (E/a) f v0 / K by eq 86-9, v = e w.
    ///
    /// # Errors
    /// Where friction is nowhere as steep as the limit cycle needs.
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

/// The oscillation at a steady velocity in m/s (Fig 9.17 is drawn from it): the limit cycle that the slope of friction there keeps
/// up.
///
/// # Errors
/// Where friction falls too little there to keep up any, or so steeply that one would grow without end (g = 1/2).
pub fn oscillation_at(
    table: &DrivenTable,
    friction: &FallingFriction,
    velocity: f64,
) -> Result<Oscillation, SlidewayError> {
    let (least, slope) = (table.critical_slope()?, friction.slope(velocity)?);
    let gain = table.damping / (slope - (least - table.damping));
    if slope < least || gain <= 0.5 {
        let which = if slope < least { "too little to keep it up" } else { "so steeply that it has no end" };
        let because = format!("friction falls by {:.2} N s/mm, {which}", slope / N_S_PER_MM);
        return Err(SlidewayError::NoSolution { sought: "limit cycle", because });
    }
    let cycle = table.cycle_with_gain(gain, 1.0);
    let cycle = LimitCycle { force_ratio: size_with_gain(gain) / cycle.sum(table), ..cycle };
    cycle.oscillation(table, friction)
}

/// The limit cycle whose swing just reaches down to standstill, v = v0: at lower steady velocities it is stick-slip, above them
/// quasi-harmonic motion up to the critical velocity (9.4 (ii), 2).
///
/// # Errors
/// Where a quantity is out of its range, there is no viscous friction, or friction is nowhere so steep.
pub fn end_of_sticking(
    table: &DrivenTable,
    friction: &FallingFriction,
) -> Result<Oscillation, SlidewayError> {
    Range::positive("viscous coefficient f", "N s/m").check(table.damping)?;
    // v / v0 = (E/a) f w / K grows with E/a: w gets less by a factor of sqrt(2) at most. So it is 1 by twice K / (f wn).
    let share = |cycle: &LimitCycle| cycle.force_ratio * table.damping * cycle.frequency / table.stiffness;
    let most = 2.0 * table.stiffness / (table.damping * table.boundary_frequency()?);
    let is_short = |force: f64| table.limit_cycle(force).is_ok_and(|cycle| share(&cycle) < 1.0);
    table.limit_cycle(halved(0.0, most, is_short))?.oscillation(table, friction)
}

/// The size of the sine of which a cut-off leaves this share, above 1/2: the inverse of [`cut_off_gain`].
fn size_with_gain(gain: f64) -> f64 {
    1.0 / halved(0.0, 1.0, |share| cut_off_gain(1.0 / share) < gain)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::slideway::units::{MM, MM_PER_S, N_S_PER_MM};

    /// Table T9-6 was read with f = 10.71 N s/mm and VcL = 40 mm/s.
    fn table(stiffness: f64) -> DrivenTable {
        DrivenTable { stiffness, damping: 10.71e3, ..DrivenTable::simulated(0.0) }
    }

    fn near(got: f64, wanted: f64, most: f64) {
        assert!((got - wanted).abs() <= most, "{got}, not {wanted}");
    }

    #[test]
    fn tables_of_the_study_come_out() {
        for (force, friction, reciprocal, degrees) in [
            (20.0, 0.0, 1.88, 0.0),
            (20.0, 10.0, 1.69, 26.6),
            (5.0, 0.6, 1.587, 6.84),
            (1.0, 4.0, 0.37, 75.96),
        ] {
            let swing = Swing { force, friction };
            near(swing.reciprocal().unwrap(), reciprocal, 5e-3);
            near(swing.angle().unwrap().to_degrees(), degrees, 0.05);
        }
        near(DrivenTable::simulated(0.0).open_loop(100.0).unwrap().norm(), 10.09, 5e-3);
        near(DrivenTable::simulated(0.0).open_loop_angle(100.0).unwrap().to_degrees(), 13.9, 0.05);
        let cycle = table(45e6).limit_cycle(20.0).unwrap();
        near(cycle.slope / N_S_PER_MM, 20.13, 0.02);
        near(cycle.frequency, 235.0, 0.1);
        near(cycle.friction_by_spare(), 2.10, 0.01);
        let motion = cycle.oscillation(&table(45e6), &FallingFriction::simulated(0.04)).unwrap();
        near(motion.velocity / MM_PER_S, 19.1, 0.01);
        near(motion.error / MM, 0.0909, 1e-4);
        near(motion.swing / MM_PER_S, 21.36, 0.02);
        assert!(motion.sticks());
    }

    /// Fundamental of E sin(t) - n cos(t), cut off at -1, by the integrals of eq 46-9 and 47-9.
    fn by_integrals(force: f64, friction: f64) -> Complex<f64> {
        const POINTS: usize = 20_000;
        let step = 2.0 * PI / POINTS as f64;
        let sums = (0..POINTS).map(|index| {
            let (sine, cosine) = (step * index as f64).sin_cos();
            Complex::new(sine, cosine) * cut_off(force * sine - friction * cosine)
        });
        sums.sum::<Complex<f64>>() * step / (PI * force)
    }

    /// The study's own formulas: eq 67-9, 69-9, 70-9 where n < a, eq 75-9, 77-9, 78-9 where n > a, in units of a.
    fn in_branches(force: f64, friction: f64) -> f64 {
        let squared = force.powi(2) + friction.powi(2);
        let root = (squared - 1.0).sqrt();
        let third = ((force * root - friction) / squared).acos();
        let other = ((force * root + friction) / squared).acos();
        let turn = if friction < 1.0 { third + other } else { third - other };
        0.5 * (1.0 + turn / PI) + root / (PI * squared)
    }

    proptest! {
        #[test]
        fn the_describing_function_is_that_of_its_integrals(force in 0.1..30.0f64, friction in 0.0..15.0f64) {
            let got = Swing { force, friction }.describing_function().unwrap();
            prop_assert!((got - by_integrals(force, friction)).norm() < 1e-6);
        }

        #[test]
        fn both_branches_of_the_study_are_one(force in 1.0..30.0f64, friction in 0.01..15.0f64) {
            let got = Swing { force, friction }.describing_function().unwrap().re;
            prop_assert!((got - in_branches(force, friction)).abs() < 1e-7);
        }

        #[test]
        fn a_limit_cycle_closes_the_loop(
            memory in 0.0..0.02f64, damping in 2e3..4e4f64, stiffness in 5e6..1e8f64, force in 0.5..40.0f64,
        ) {
            let table = DrivenTable { mass: 433.0, stiffness, damping, memory };
            let cycle = table.limit_cycle(force).unwrap();
            let late = Complex::new(1.0, cycle.frequency * memory);
            let sum = Complex::new(1.0, 0.0) - Complex::new(0.0, cycle.friction_ratio) / late;
            let function = sum * cut_off_gain(force * sum.norm());
            let closed = function * table.open_loop(cycle.frequency).unwrap() + 1.0;
            prop_assert!(closed.norm() < 1e-9, "{}", closed);
        }

        #[test]
        fn the_oscillation_at_a_velocity_is_that_of_its_limit_cycle(memory in 0.0..0.005f64, force in 1.5..20.0f64) {
            let (table, friction) = (DrivenTable::simulated(memory), FallingFriction::simulated(0.01));
            let wanted = table.limit_cycle(force).unwrap().oscillation(&table, &friction).unwrap();
            let got = oscillation_at(&table, &friction, wanted.velocity).unwrap();
            prop_assert!((got.swing / wanted.swing - 1.0).abs() < 1e-6);
            prop_assert!((got.frequency / wanted.frequency - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn small_swings_are_those_of_routh_and_hurwitz() {
        let table = DrivenTable::simulated(0.0065);
        let cycle = table.limit_cycle(0.5).unwrap();
        assert_eq!(cycle.gain, 1.0);
        near(cycle.slope / table.critical_slope().unwrap(), 1.0, 1e-12);
        near(cycle.frequency / table.boundary_frequency().unwrap(), 1.0, 1e-12);
    }

    #[test]
    fn sticking_ends_where_the_swing_reaches_standstill() {
        let (table, friction) = (DrivenTable::simulated(0.0065), FallingFriction::simulated(0.010_16));
        let end = end_of_sticking(&table, &friction).unwrap();
        near(end.swing / end.velocity, 1.0, 1e-9);
        near(oscillation_at(&table, &friction, end.velocity).unwrap().swing / end.swing, 1.0, 1e-6);
        assert!(end.velocity < table.critical_velocity(&friction).unwrap());
        assert!(end_of_sticking(&DrivenTable { memory: 0.02, ..table }, &friction).is_err());
        assert!(end_of_sticking(&DrivenTable { damping: 0.0, ..table }, &friction).is_err());
    }

    #[test]
    fn beyond_its_ends_there_is_none() {
        let (table, friction) = (DrivenTable::simulated(0.0), FallingFriction::simulated(0.04));
        let told = |velocity| oscillation_at(&table, &friction, velocity).unwrap_err().to_string();
        assert!(told(0.035).contains("too little"));
        assert!(told(0.005).contains("no end"));
        assert!(DrivenTable { damping: 0.0, ..table }.limit_cycle(1.0).is_err());
        assert_eq!(dead_zone_gain(0.5), 0.0);
        near(dead_zone_gain(1e6), 1.0, 1e-5);
    }
}
