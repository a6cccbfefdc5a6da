//! Theories of stick-slip before the thesis (chapter 2).

use std::f64::consts::PI;

use super::root::bisect;
use super::{Range, SlidewayError};

const DROP: Range = Range::positive("drop of friction", "N");
const MASS: Range = Range::positive("mass M", "kg");
const STIFFNESS: Range = Range::positive("stiffness K", "N/m");
const VELOCITY: Range = Range::positive("drive velocity", "m/s");
const WEIGHT: Range = Range::not_negative("weight W", "N");
const DISTANCE: Range = Range::positive("critical distance", "m");
const TIME: Range = Range::not_negative("time at rest", "s");
/// Permitted damping ratios. Closer to 1 a slip decays over more than a hundred powers of ten, which numbers cannot
/// follow.
const DAMPING: Range = Range::new("damping ratio", "", 0.0, 0.999);
const RATE: Range = Range::not_negative("constant of the lubricant", "");

/// Slip of a mass on a moving base by Derjaguin, Push and Tolstoi (eq 15.2 ... 19.2). Friction drops by dF when the
/// slip starts, and falls linearly with the velocity of slip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slip {
    /// Drop of friction dF at the instant of slip, in N, above 0.
    pub drop: f64,
    /// Mass M, in kg, above 0.
    pub mass: f64,
    /// Stiffness K, in N/m, above 0.
    pub stiffness: f64,
    /// Net damping ratio zeta = (f - n) / (2 sqrt(K M)), where n is the slope of falling friction; 0 ... 0.999.
    pub damping: f64,
}

impl Slip {
    fn checked(&self) -> Result<&Self, SlidewayError> {
        DROP.check(self.drop)?;
        MASS.check(self.mass)?;
        STIFFNESS.check(self.stiffness)?;
        DAMPING.check(self.damping)?;
        Ok(self)
    }

    /// sqrt(K M), in N s/m.
    fn impedance(&self) -> f64 {
        (self.stiffness * self.mass).sqrt()
    }

    /// Drop ratio phi = dF / (V sqrt(K M)) at a drive velocity V in m/s (eq 17.2).
    ///
    /// # Errors
    /// If a quantity is out of its range.
    pub fn drop_ratio(&self, velocity: f64) -> Result<f64, SlidewayError> {
        Ok(self.checked()?.drop / (VELOCITY.check(velocity)? * self.impedance()))
    }

    /// Velocity of slip in m/s at a `time` in s after its start, for a drive velocity V in m/s (eq 18.2). It holds
    /// until the slip ends.
    ///
    /// The formula is V (1 - exp(-theta w t) (cos w t + (zeta - phi) / sqrt(1 - zeta^2) sin w t)), with
    /// theta = zeta / sqrt(1 - zeta^2) and w = sqrt(K/M) sqrt(1 - zeta^2).
    ///
    /// # Errors
    /// If a quantity is out of its range.
    pub fn velocity(&self, drive: f64, time: f64) -> Result<f64, SlidewayError> {
        let wave = Wave { damping: self.damping, drop: self.drop_ratio(drive)? };
        let frequency = (self.stiffness / self.mass).sqrt() * wave.root();
        Ok(drive * (1.0 - wave.at(frequency * time)))
    }

    /// Duration of a slip in s, at a drive velocity in m/s.
    ///
    /// Without damping it is 2 (pi - atan(phi)) / wn, which tends to pi / wn for slow drives (Bowden and Tabor).
    ///
    /// # Errors
    /// If a quantity is out of its range, or the drive is faster than the critical velocity. Then the slip never ends.
    pub fn duration(&self, drive: f64) -> Result<f64, SlidewayError> {
        let wave = Wave { damping: self.damping, drop: self.drop_ratio(drive)? };
        if wave.crest() < 1.0 {
            let reason = format!("the drive at {drive} m/s is faster than the critical velocity");
            return Err(SlidewayError::NoSolution { sought: "end of slip", reason });
        }
        let (trough, crest) = wave.extrema();
        let angle = bisect(trough, crest, |angle| wave.at(angle) < 1.0);
        Ok(angle / ((self.stiffness / self.mass).sqrt() * wave.root()))
    }

    /// The critical drive velocity in m/s. At faster drives a slip never ends, so there is no stick. Eq 18.2 touches
    /// 0 there.
    ///
    /// # Errors
    /// If a quantity is out of its range, or there is no damping. Then a slip ends at every velocity.
    pub fn critical_velocity(&self) -> Result<f64, SlidewayError> {
        self.damped()?;
        // The crest rises with phi without limit, and is below 1 for phi = zeta.
        let crest = |drop| Wave { damping: self.damping, drop }.crest();
        let mut high = 1.0;
        while crest(high) < 1.0 {
            high *= 2.0;
        }
        let drop = bisect(0.0, high, |drop| crest(drop) < 1.0);
        Ok(self.drop / (drop * self.impedance()))
    }

    /// The approximation of the critical velocity for small damping, dF / sqrt(4 pi zeta M K), in m/s (eq 19.2). It
    /// is 3 % too high at zeta = 0.01, 15 % at 0.05, 31 % at 0.1.
    ///
    /// # Errors
    /// If a quantity is out of its range, or there is no damping.
    pub fn approximate_critical_velocity(&self) -> Result<f64, SlidewayError> {
        let slip = self.damped()?;
        Ok(slip.drop / ((4.0 * PI * slip.damping).sqrt() * slip.impedance()))
    }

    fn damped(&self) -> Result<&Self, SlidewayError> {
        Range::positive("damping ratio", "").check(self.damping)?;
        self.checked()
    }
}

/// The difference between drive and slip velocity, relative to the drive velocity, against angle x = w t:
/// exp(-theta x) (cos x + (zeta - phi) / sqrt(1 - zeta^2) sin x).
struct Wave {
    damping: f64,
    drop: f64,
}

impl Wave {
    fn root(&self) -> f64 {
        (1.0 - self.damping.powi(2)).sqrt()
    }

    fn at(&self, angle: f64) -> f64 {
        let (sine, cosine) = angle.sin_cos();
        let decay = (-self.damping / self.root() * angle).exp();
        decay * (cosine + (self.damping - self.drop) / self.root() * sine)
    }

    /// The angles of the first trough and of the following crest.
    fn extrema(&self) -> (f64, f64) {
        let lead = (self.drop * self.root()).atan2(1.0 - self.damping * self.drop);
        (PI - lead, 2.0 * PI - lead)
    }

    fn crest(&self) -> f64 {
        self.at(self.extrema().1)
    }
}

/// Brockley's law of static friction that grows at rest: mu_s - mu_k = gamma t^beta (eq 20.2).
///
/// # Examples
///
/// ```
/// use patchcord_thesis::slideway::history::GrowthAtRest;
///
/// let growth = GrowthAtRest { kinetic: 0.2, factor: 0.05, exponent: 0.3 };
/// assert_eq!(growth.static_coefficient(0.0)?, 0.2);
/// assert!((growth.static_coefficient(1.0)? - 0.25).abs() < 1e-12);
///
/// // A stiffer drive makes shorter slips.
/// assert!(growth.slip(10.0, 5e4, 1e-4)? < growth.slip(10.0, 1e4, 1e-4)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrowthAtRest {
    /// Kinetic coefficient mu_k. The static coefficient is equal to it at t = 0.
    pub kinetic: f64,
    /// Factor gamma of growth, in s^-beta.
    pub factor: f64,
    /// Exponent beta of growth.
    pub exponent: f64,
}

impl GrowthAtRest {
    /// Static coefficient after a time at rest in s.
    ///
    /// # Errors
    /// If the time is below 0.
    pub fn static_coefficient(&self, time: f64) -> Result<f64, SlidewayError> {
        Ok(self.kinetic + self.factor * TIME.check(time)?.powf(self.exponent))
    }

    /// Distance of each slip in m, without damping, for a weight in N, a stiffness in N/m and a drive velocity in m/s
    /// (2.3, Fig 2.2).
    ///
    /// The spring relaxes by 2 W (mu_s - mu_k) / K in a slip, and the drive stretches it by the same distance while
    /// friction grows. So x = (2 W gamma / (K V^beta))^(1 / (1 - beta)).
    ///
    /// # Errors
    /// If weight, stiffness or velocity is not above 0, or gamma is not above 0, or beta is outside
    /// 0 ... 0.99.
    pub fn slip(&self, weight: f64, stiffness: f64, velocity: f64) -> Result<f64, SlidewayError> {
        let (unit_slip, beta) = self.unit_slip(weight, stiffness)?;
        Ok((unit_slip / VELOCITY.check(velocity)?.powf(beta)).powf(1.0 / (1.0 - beta)))
    }

    /// The velocity in m/s at which the distance of a slip equals the critical distance in m. Stick-slip ends there
    /// by Rabinowicz.
    ///
    /// # Errors
    /// As [`GrowthAtRest::slip`], and if the distance is not above 0 or friction does not grow.
    pub fn end_of_stick_slip(
        &self,
        weight: f64,
        stiffness: f64,
        critical_distance: f64,
    ) -> Result<f64, SlidewayError> {
        let (unit_slip, beta) = self.unit_slip(weight, stiffness)?;
        let distance = DISTANCE.check(critical_distance)?;
        let beta = Range::positive("beta", "").check(beta)?;
        Ok(distance * (unit_slip / distance).powf(1.0 / beta))
    }

    /// 2 W gamma / K, the distance of a slip after growth for one second, and beta.
    fn unit_slip(&self, weight: f64, stiffness: f64) -> Result<(f64, f64), SlidewayError> {
        let weight = Range::positive("weight W", "N").check(weight)?;
        let factor = Range::positive("gamma", "").check(self.factor)?;
        let beta = Range::new("beta", "", 0.0, 0.99).check(self.exponent)?;
        Ok((2.0 * weight * factor / STIFFNESS.check(stiffness)?, beta))
    }

    /// Kinetic coefficient at a velocity in m/s by Rabinowicz's rule. It is the static coefficient after the time in
    /// which the critical distance in m is covered.
    ///
    /// # Errors
    /// If velocity or distance is not above 0.
    pub fn coefficient_at(&self, velocity: f64, critical_distance: f64) -> Result<f64, SlidewayError> {
        let distance = DISTANCE.check(critical_distance)?;
        self.static_coefficient(distance / VELOCITY.check(velocity)?)
    }
}

/// Constants of a lubricant by Kato, Yamaguchi and Matsubayashi (eq 36.2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KatoLubricant {
    /// mu_s - mu_d: static coefficient minus its value for a stick of zero duration.
    pub drop: f64,
    /// Rate a, in s^-m.
    pub a: f64,
    /// Exponent m.
    pub m: f64,
    /// Rate b, in s^-n.
    pub b: f64,
    /// Exponent n.
    pub n: f64,
}

impl KatoLubricant {
    /// Critical velocity in m/s for a weight in N, a mass in kg and a stiffness in N/m (eq 36.2).
    ///
    /// The formula is 2 W / (pi sqrt(K M)) (mu_s - mu_d) (1 - exp(-a (pi/wn)^m)) (1 - exp(-b (pi/wn)^n)).
    ///
    /// # Errors
    /// If mass or stiffness is not above 0, or the weight, a or b below 0.
    pub fn critical_velocity(&self, weight: f64, mass: f64, stiffness: f64) -> Result<f64, SlidewayError> {
        let (mass, stiffness) = (MASS.check(mass)?, STIFFNESS.check(stiffness)?);
        let half_period = PI * (mass / stiffness).sqrt();
        let (first, second) = (RATE.check(self.a)?, RATE.check(self.b)?);
        let grown = |rate: f64, power: f64| 1.0 - (-rate * half_period.powf(power)).exp();
        let most = 2.0 * WEIGHT.check(weight)? / (PI * (mass * stiffness).sqrt());
        Ok(most * self.drop * grown(first, self.m) * grown(second, self.n))
    }
}

/// Bell and Burdekin's slope of dynamic friction in N s/m: (F1 - F2) / (v1 - v2) between the largest force and the
/// largest velocity of a cycle (eq 33.2).
///
/// Each argument is a force in N with its velocity in m/s. At their critical velocity this slope and the equivalent
/// linear damping add up to 0.
///
/// # Errors
/// If the largest velocity does not exceed the velocity at the largest force.
pub fn dynamic_slope(largest_force: (f64, f64), largest_velocity: (f64, f64)) -> Result<f64, SlidewayError> {
    let (force, velocity) = largest_force;
    let (force_there, velocity_there) = largest_velocity;
    let rise =
        Range::positive("rise of velocity from the largest force", "m/s").check(velocity_there - velocity)?;
    Ok((force_there - force) / rise)
}

/// Nakashima, Takata and Morita's friction for small motions, W a b0 / (s + b0) + T0 (eq 38.2), in the notation of
/// the thesis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NakashimaFriction {
    /// Weight W, in N.
    pub weight: f64,
    /// Slope a, in s/m; negative while friction falls.
    pub slope: f64,
    /// Rate b0, in 1/s.
    pub rate: f64,
    /// Linear damping T0, in N s/m.
    pub linear: f64,
}

impl NakashimaFriction {
    /// The slope Cn of falling friction, -W a, in N s/m.
    pub fn falling(&self) -> f64 {
        -self.weight * self.slope
    }

    /// The time constant Tc = 1 / b0, in s.
    ///
    /// # Errors
    /// If b0 is not above 0.
    pub fn memory(&self) -> Result<f64, SlidewayError> {
        Ok(1.0 / Range::positive("rate b0", "1/s").check(self.rate)?)
    }
}

#[cfg(test)]
mod tests;
