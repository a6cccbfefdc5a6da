//! The slideway in volts: scales, gains and settings of the study's machine (8.2, 8.3).

use super::{Range, SlidewayError};

const MASS: Range = Range::positive("mass M", "kg");
const STIFFNESS: Range = Range::positive("stiffness K", "N/m");
const DAMPING: Range = Range::not_negative("viscous coefficient f", "N s/m");
const LIMIT: Range = Range::positive("limit velocity VcL", "m/s");
const MEMORY: Range = Range::positive("time constant Tc", "s");
const SCALE: Range = Range::positive("scale", "");
const WIPER: Range = Range::new("wiper", "", 0.0, 1.0 - f64::EPSILON);
const BIAS: Range = Range::not_negative("bias VB", "V");

/// Gain of a computing element for a block of the system: input scale x block gain / output scale (eq 4-8).
///
/// # Errors
/// Where a scale is not above 0.
pub fn computer_gain(input_scale: f64, block: f64, output_scale: f64) -> Result<f64, SlidewayError> {
    Ok(SCALE.check(input_scale)? * block / SCALE.check(output_scale)?)
}

/// How much slower than the system the machine has to run for a plotter: plotter frequency by the highest frequency of the system, both in
/// Hz (eq 1-8).
///
/// # Errors
/// Where a frequency is not above 0.
pub fn time_scaling(plotter: f64, highest: f64) -> Result<f64, SlidewayError> {
    let frequency = Range::positive("frequency", "Hz");
    Ok(frequency.check(plotter)? / frequency.check(highest)?)
}

/// What one volt stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    /// Metres.
    pub position: f64,
    /// m/s.
    pub velocity: f64,
    /// m/s2.
    pub acceleration: f64,
    /// Newtons.
    pub force: f64,
}

impl Scales {
    /// The first set, of Fig 8.4.
    pub const A: Scales = Scales { position: 0.0254e-3, velocity: 2.54e-3, acceleration: 2.54, force: 453.6 };

    /// The second, from Fig 8.7 on, in which the dead zone is wide enough for its diodes.
    pub const B: Scales =
        Scales { position: 0.0254e-3, velocity: 0.254e-3, acceleration: 0.254, force: 45.36 };

    /// Gain from position error to spring force (eq 6-8), for N/m.
    ///
    /// # Errors
    /// Where the stiffness is not above 0.
    pub fn stiffness_gain(&self, stiffness: f64) -> Result<f64, SlidewayError> {
        computer_gain(self.position, STIFFNESS.check(stiffness)?, self.force)
    }

    /// Gain from force to acceleration (eq 7-8), for kg.
    ///
    /// # Errors
    /// Where the mass is not above 0.
    pub fn mass_gain(&self, mass: f64) -> Result<f64, SlidewayError> {
        computer_gain(self.force, 1.0 / MASS.check(mass)?, self.acceleration)
    }

    /// Gain from velocity to viscous force (eq 10-8), for N s/m.
    ///
    /// # Errors
    /// Where the coefficient is below 0.
    pub fn viscous_gain(&self, damping: f64) -> Result<f64, SlidewayError> {
        computer_gain(self.velocity, DAMPING.check(damping)?, self.force)
    }

    /// Gain of the integrator from acceleration to velocity, in 1/s (eq 8-8).
    ///
    /// # Errors
    /// Where a scale is not above 0.
    pub fn velocity_integrator(&self) -> Result<f64, SlidewayError> {
        computer_gain(self.acceleration, 1.0, self.velocity)
    }

    /// Gain of the integrator from velocity to position, in 1/s (eq 9-8).
    ///
    /// # Errors
    /// Where a scale is not above 0.
    pub fn position_integrator(&self) -> Result<f64, SlidewayError> {
        computer_gain(self.velocity, 1.0, self.position)
    }

    /// Setting of the potentiometer before B2 (x10, limited to 10 V), so that it stops at VcL in m/s (eq 29-8): velocity scale / VcL.
    ///
    /// # Errors
    /// Where VcL is not above 0.
    pub fn limit_setting(&self, limit: f64) -> Result<f64, SlidewayError> {
        computer_gain(self.velocity, 1.0 / LIMIT.check(limit)?, 1.0)
    }
}

/// Setting of the potentiometer of the lag, and the input of its integrator that it stands before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LagSetting {
    /// PA1.
    pub setting: f64,
    /// Gain of the input, in 1/s.
    pub gain: f64,
}

impl LagSetting {
    /// The longest time constant on the x1000 input, in s: beyond it settings would be below 0.05.
    pub const LONGEST: f64 = 0.02;

    /// For a time constant in s: 0.001 / Tc on x1000 (eq 34-8), above 0.02 s 0.01 / Tc on x100 (eq 35-8).
    ///
    /// # Errors
    /// Where the time constant is below 1 ms, so that no potentiometer gives it.
    pub fn new(memory: f64) -> Result<Self, SlidewayError> {
        let memory = Range::new("time constant Tc", "s", 1e-3, f64::MAX).check(memory)?;
        let gain = if memory > Self::LONGEST { 100.0 } else { 1000.0 };
        Ok(LagSetting { setting: 1.0 / (gain * memory), gain })
    }

    /// The time constant in s.
    pub fn memory(&self) -> f64 {
        1.0 / (self.gain * self.setting)
    }
}

/// What a lag of Tc in s, 1 / (1 + Tc s) (eq 33-8), makes of a sine of w in rad/s: its gain, and the angle in rad by which it comes later.
///
/// # Errors
/// Where the time constant is not above 0.
pub fn lag_response(memory: f64, frequency: f64) -> Result<(f64, f64), SlidewayError> {
    let turned = MEMORY.check(memory)? * frequency;
    Ok((1.0 / turned.hypot(1.0), turned.atan()))
}

/// The diode dead zone: potentiometers from the signal to a bias, and diodes at their wipers (Fig 8.5).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeadZone {
    /// The share r of the track that lies between signal and wiper, below 1.
    pub wiper: f64,
    /// Bias VB, in V.
    pub bias: f64,
    /// What a diode drops, in V; the study's formulas leave it out.
    pub diode: f64,
}

impl DeadZone {
    /// Set so that there is `out` at `input`, both in V: r = (V1 - Vo) / (VB + V1) (eq 17-8, with Vo = 0 eq 21-8).
    ///
    /// # Errors
    /// Where that takes no wiper between 0 and 1.
    pub fn set(input: f64, out: f64, bias: f64) -> Result<Self, SlidewayError> {
        let whole = Range::positive("VB + V1", "V").check(bias + input)?;
        let wiper = WIPER.check((input - out) / whole)?;
        Ok(DeadZone { wiper, bias, diode: 0.0 })
    }

    fn checked(&self) -> Result<&Self, SlidewayError> {
        WIPER.check(self.wiper)?;
        BIAS.check(self.bias)?;
        Ok(self)
    }

    /// The voltage from which it conducts: (r VB + drop) / (1 - r), in V (eq 20-8, 26-8).
    ///
    /// # Errors
    /// Where the wiper is not within 0 ... 1 or the bias below 0.
    pub fn opens_at(&self) -> Result<f64, SlidewayError> {
        let zone = self.checked()?;
        Ok((zone.wiper * zone.bias + zone.diode) / zone.slope())
    }

    /// The slope once it conducts: 1 - r (eq 24-8, 25-8).
    pub fn slope(&self) -> f64 {
        1.0 - self.wiper
    }

    /// The output in V for an input in V: V1 - r (V1 + VB) where it conducts (eq 18-8), 0 where it does not, the same with both signs.
    ///
    /// # Errors
    /// Where the wiper is not within 0 ... 1 or the bias below 0.
    pub fn output(&self, input: f64) -> Result<f64, SlidewayError> {
        let beyond = (input.abs() - self.opens_at()?).max(0.0);
        Ok(self.slope() * beyond.copysign(input))
    }
}

/// A quarter-squares multiplier that adds squares: (A^2 + B^2) / 100 of what is above 0, in V (eq 32-8).
pub fn sum_of_squares(first: f64, second: f64) -> f64 {
    (first.max(0.0).powi(2) + second.max(0.0).powi(2)) / 100.0
}

/// The voltage of which it makes this one: sqrt(100 V), for V.
///
/// # Errors
/// Where the voltage is below 0.
pub fn root_of_square(voltage: f64) -> Result<f64, SlidewayError> {
    Ok((100.0 * Range::not_negative("voltage", "V").check(voltage)?).sqrt())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn near(got: f64, wanted: f64) {
        crate::slideway::near(got, wanted, 1e-3);
    }

    #[test]
    fn both_sets_give_the_gains_of_the_text() {
        near(Scales::A.stiffness_gain(17.86e6).unwrap(), 1.0001);
        near(Scales::A.mass_gain(454.0).unwrap(), 0.3934);
        near(Scales::A.velocity_integrator().unwrap(), 1000.0);
        near(Scales::A.position_integrator().unwrap(), 100.0);
        near(Scales::A.viscous_gain(17.86e3).unwrap(), 0.1);
        near(Scales::B.stiffness_gain(45e6).unwrap(), 25.198);
        near(Scales::B.position_integrator().unwrap(), 10.0);
        near(Scales::B.limit_setting(2.54e-3).unwrap(), 0.1);
        assert!(Scales::B.mass_gain(0.0).is_err());
    }

    #[test]
    fn lags_change_their_input_beyond_20_ms() {
        assert_eq!(LagSetting::new(0.02).unwrap(), LagSetting { setting: 0.05, gain: 1000.0 });
        assert_eq!(LagSetting::new(0.025).unwrap(), LagSetting { setting: 0.4, gain: 100.0 });
        assert!(LagSetting::new(0.9e-3).is_err());
        let (gain, late) = lag_response(0.01, 100.0).unwrap();
        near(10.0 * gain, 7.071);
        near(late.to_degrees(), 45.0);
    }

    #[test]
    fn the_dead_zone_is_that_of_the_text() {
        let zone = DeadZone::set(17.0, 0.0, 50.0).unwrap();
        near(zone.wiper, 0.25373);
        near(zone.output(-20.0).unwrap(), -2.239);
        near(DeadZone { wiper: 0.25, diode: 0.26, ..zone }.opens_at().unwrap(), 17.013);
        assert!(DeadZone::set(20.0, -60.0, 50.0).is_err());
        near(sum_of_squares(root_of_square(50.0).unwrap(), -3.0), 50.0);
        assert!(time_scaling(1.0, 0.0).is_err());
    }

    proptest! {
        #[test]
        fn the_lag_is_the_one_asked_for(memory in 1e-3..2.0f64) {
            let lag = LagSetting::new(memory).unwrap();
            prop_assert!((lag.memory() / memory - 1.0).abs() < 1e-12 && lag.setting <= 1.0);
        }

        #[test]
        fn the_dead_zone_gives_what_it_was_set_to(input in 1.0..100.0f64, share in 0.0..0.9f64, bias in 0.0..100.0f64) {
            let zone = DeadZone::set(input, share * input, bias).unwrap();
            prop_assert!((zone.output(input).unwrap() - share * input).abs() < 1e-9);
        }
    }
}
