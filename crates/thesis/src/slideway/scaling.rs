//! Scales, gains and potentiometer settings of the slideway on the thesis's machine (8.2, 8.3).

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
/// If a scale is not above 0.
pub fn computer_gain(input_scale: f64, block: f64, output_scale: f64) -> Result<f64, SlidewayError> {
    Ok(SCALE.check(input_scale)? * block / SCALE.check(output_scale)?)
}

/// Time scale of the machine for a plotter: plotter frequency divided by the highest frequency of the system, both in
/// Hz (eq 1-8). The machine must run this much slower than the system.
///
/// # Errors
/// If a frequency is not above 0.
pub fn time_scaling(plotter: f64, highest: f64) -> Result<f64, SlidewayError> {
    let frequency = Range::positive("frequency", "Hz");
    Ok(frequency.check(plotter)? / frequency.check(highest)?)
}

/// The quantities that one volt represents.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    /// Position in m per volt.
    pub position: f64,
    /// Velocity in m/s per volt.
    pub velocity: f64,
    /// Acceleration in m/s2 per volt.
    pub acceleration: f64,
    /// Force in N per volt.
    pub force: f64,
}

impl Scales {
    /// Scale set A, of Fig 8.4.
    pub const A: Scales = Scales { position: 0.0254e-3, velocity: 2.54e-3, acceleration: 2.54, force: 453.6 };

    /// Scale set B, from Fig 8.7 on. Its dead zone is wide enough for the diodes.
    pub const B: Scales =
        Scales { position: 0.0254e-3, velocity: 0.254e-3, acceleration: 0.254, force: 45.36 };

    /// Gain from position error to spring force (eq 6-8), for N/m.
    ///
    /// # Errors
    /// If the stiffness is not above 0.
    pub fn stiffness_gain(&self, stiffness: f64) -> Result<f64, SlidewayError> {
        computer_gain(self.position, STIFFNESS.check(stiffness)?, self.force)
    }

    /// Gain from force to acceleration (eq 7-8), for kg.
    ///
    /// # Errors
    /// If the mass is not above 0.
    pub fn mass_gain(&self, mass: f64) -> Result<f64, SlidewayError> {
        computer_gain(self.force, 1.0 / MASS.check(mass)?, self.acceleration)
    }

    /// Gain from velocity to viscous force (eq 10-8), for N s/m.
    ///
    /// # Errors
    /// If the coefficient is below 0.
    pub fn viscous_gain(&self, damping: f64) -> Result<f64, SlidewayError> {
        computer_gain(self.velocity, DAMPING.check(damping)?, self.force)
    }

    /// Gain of the integrator from acceleration to velocity, in 1/s (eq 8-8).
    ///
    /// # Errors
    /// If a scale is not above 0.
    pub fn velocity_integrator(&self) -> Result<f64, SlidewayError> {
        computer_gain(self.acceleration, 1.0, self.velocity)
    }

    /// Gain of the integrator from velocity to position, in 1/s (eq 9-8).
    ///
    /// # Errors
    /// If a scale is not above 0.
    pub fn position_integrator(&self) -> Result<f64, SlidewayError> {
        computer_gain(self.velocity, 1.0, self.position)
    }

    /// Setting of the potentiometer before B2 (x10, limited to 10 V), so that B2 reaches its limit at VcL in m/s (eq
    /// 29-8): velocity scale / VcL.
    ///
    /// # Errors
    /// If VcL is not above 0.
    pub fn limit_setting(&self, limit: f64) -> Result<f64, SlidewayError> {
        computer_gain(self.velocity, 1.0 / LIMIT.check(limit)?, 1.0)
    }
}

/// Setting of the potentiometer of the lag, and the gain of the integrator input behind it.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::slideway::scaling::LagSetting;
///
/// let lag = LagSetting::new(0.01)?;
/// assert!((lag.setting - 0.1).abs() < 1e-12 && lag.gain == 1000.0);
/// assert_eq!(LagSetting::new(0.025)?.gain, 100.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LagSetting {
    /// Setting of PA1, 0 ... 1.
    pub setting: f64,
    /// Gain of the input, in 1/s.
    pub gain: f64,
}

impl LagSetting {
    /// The longest time constant on the x1000 input, in s. With a longer one the setting would be below 0.05.
    pub const MAX_X1000: f64 = 0.02;

    /// The setting for a time constant in s: 0.001 / Tc on x1000 (eq 34-8), and 0.01 / Tc on x100 above 0.02 s (eq
    /// 35-8).
    ///
    /// # Errors
    /// If the time constant is below 1 ms. The setting would exceed 1.
    pub fn new(memory: f64) -> Result<Self, SlidewayError> {
        let memory = Range::new("time constant Tc", "s", 1e-3, f64::MAX).check(memory)?;
        let gain = if memory > Self::MAX_X1000 { 100.0 } else { 1000.0 };
        Ok(LagSetting { setting: 1.0 / (gain * memory), gain })
    }

    /// The time constant in s.
    pub fn memory(&self) -> f64 {
        1.0 / (self.gain * self.setting)
    }
}

/// Response of a lag 1 / (1 + Tc s) with Tc in s (eq 33-8) to a sine of w in rad/s: gain, and phase lag in rad.
///
/// # Errors
/// If the time constant is not above 0.
pub fn lag_response(memory: f64, frequency: f64) -> Result<(f64, f64), SlidewayError> {
    let product = MEMORY.check(memory)? * frequency;
    Ok((1.0 / product.hypot(1.0), product.atan()))
}

/// The diode dead zone: potentiometers from the signal to a bias, and diodes at their wipers (Fig 8.5).
///
/// # Examples
///
/// A dead zone of 17 V at a bias of 50 V (eq 21-8):
///
/// ```
/// use patchcord_thesis::slideway::scaling::DeadZone;
///
/// let zone = DeadZone::set(17.0, 0.0, 50.0)?;
/// assert!((zone.wiper - 17.0 / 67.0).abs() < 1e-12);
/// assert!((zone.opens_at()? - 17.0).abs() < 1e-9);
/// assert_eq!(zone.output(10.0)?, 0.0);
/// assert!(zone.output(-20.0)? < 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeadZone {
    /// The share r of the track between signal and wiper, below 1.
    pub wiper: f64,
    /// Bias VB, in V.
    pub bias: f64,
    /// Voltage drop of a diode, in V. The thesis's formulas omit it.
    pub diode: f64,
}

impl DeadZone {
    /// The dead zone that gives `out` at `input`, both in V: r = (V1 - Vo) / (VB + V1) (eq 17-8, with Vo = 0 eq 21-8).
    ///
    /// # Errors
    /// If the wiper would be outside 0 ... 1.
    pub fn set(input: f64, out: f64, bias: f64) -> Result<Self, SlidewayError> {
        let span = Range::positive("VB + V1", "V").check(bias + input)?;
        let wiper = WIPER.check((input - out) / span)?;
        Ok(DeadZone { wiper, bias, diode: 0.0 })
    }

    fn checked(&self) -> Result<&Self, SlidewayError> {
        WIPER.check(self.wiper)?;
        BIAS.check(self.bias)?;
        Ok(self)
    }

    /// The input voltage from which a diode conducts: (r VB + drop) / (1 - r), in V (eq 20-8, 26-8).
    ///
    /// # Errors
    /// If the wiper is not within 0 ... 1 or the bias below 0.
    pub fn opens_at(&self) -> Result<f64, SlidewayError> {
        let zone = self.checked()?;
        Ok((zone.wiper * zone.bias + zone.diode) / zone.slope())
    }

    /// The slope while a diode conducts: 1 - r (eq 24-8, 25-8).
    pub fn slope(&self) -> f64 {
        1.0 - self.wiper
    }

    /// The output in V for an input in V: V1 - r (V1 + VB) while a diode conducts (eq 18-8), otherwise 0. The
    /// characteristic is odd.
    ///
    /// # Errors
    /// If the wiper is not within 0 ... 1 or the bias below 0.
    pub fn output(&self, input: f64) -> Result<f64, SlidewayError> {
        let excess = (input.abs() - self.opens_at()?).max(0.0);
        Ok(self.slope() * excess.copysign(input))
    }
}

/// A quarter-squares multiplier that adds squares, in V: (A^2 + B^2) / 100 of the positive inputs (eq 32-8).
pub fn sum_of_squares(first: f64, second: f64) -> f64 {
    (first.max(0.0).powi(2) + second.max(0.0).powi(2)) / 100.0
}

/// The input of the multiplier that gives an output V: sqrt(100 V).
///
/// # Errors
/// If the voltage is below 0.
pub fn root_of_square(voltage: f64) -> Result<f64, SlidewayError> {
    Ok((100.0 * Range::not_negative("voltage", "V").check(voltage)?).sqrt())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn assert_close(got: f64, expected: f64) {
        crate::slideway::assert_close(got, expected, 1e-3);
    }

    #[test]
    fn gains_of_both_sets_agree_with_the_text() {
        assert_close(Scales::A.stiffness_gain(17.86e6).unwrap(), 1.0001);
        assert_close(Scales::A.mass_gain(454.0).unwrap(), 0.3934);
        assert_close(Scales::A.velocity_integrator().unwrap(), 1000.0);
        assert_close(Scales::A.position_integrator().unwrap(), 100.0);
        assert_close(Scales::A.viscous_gain(17.86e3).unwrap(), 0.1);
        assert_close(Scales::B.stiffness_gain(45e6).unwrap(), 25.198);
        assert_close(Scales::B.position_integrator().unwrap(), 10.0);
        assert_close(Scales::B.limit_setting(2.54e-3).unwrap(), 0.1);
        assert!(Scales::B.mass_gain(0.0).is_err());
    }

    #[test]
    fn lag_uses_the_x100_input_above_20_ms() {
        assert_eq!(LagSetting::new(0.02).unwrap(), LagSetting { setting: 0.05, gain: 1000.0 });
        assert_eq!(LagSetting::new(0.025).unwrap(), LagSetting { setting: 0.4, gain: 100.0 });
        assert!(LagSetting::new(0.9e-3).is_err());
        let (gain, phase) = lag_response(0.01, 100.0).unwrap();
        assert_close(10.0 * gain, 7.071);
        assert_close(phase.to_degrees(), 45.0);
    }

    #[test]
    fn dead_zone_agrees_with_the_text() {
        let zone = DeadZone::set(17.0, 0.0, 50.0).unwrap();
        assert_close(zone.wiper, 0.25373);
        assert_close(zone.output(-20.0).unwrap(), -2.239);
        assert_close(DeadZone { wiper: 0.25, diode: 0.26, ..zone }.opens_at().unwrap(), 17.013);
        assert!(DeadZone::set(20.0, -60.0, 50.0).is_err());
        assert_close(sum_of_squares(root_of_square(50.0).unwrap(), -3.0), 50.0);
        assert!(time_scaling(1.0, 0.0).is_err());
    }

    proptest! {
        #[test]
        fn lag_setting_gives_its_time_constant(memory in 1e-3..2.0f64) {
            let lag = LagSetting::new(memory).unwrap();
            prop_assert!((lag.memory() / memory - 1.0).abs() < 1e-12 && lag.setting <= 1.0);
        }

        #[test]
        fn dead_zone_gives_its_set_output(input in 1.0..100.0f64, share in 0.0..0.9f64, bias in 0.0..100.0f64) {
            let zone = DeadZone::set(input, share * input, bias).unwrap();
            prop_assert!((zone.output(input).unwrap() - share * input).abs() < 1e-9);
        }
    }
}
