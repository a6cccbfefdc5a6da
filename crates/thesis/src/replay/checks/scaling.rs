//! Claims on scales, gains, potentiometer settings and the diode dead zone (8.1 ... 8.4).
//!
//! The machine is the thesis's Solartron with a reference of 100 V. Scales state what one volt represents. Set A is
//! that of Fig 8.4; set B, from Fig 8.7 on, has ten times finer scales of velocity, acceleration and force.

use super::super::check_arguments::CheckArguments;
use super::super::finding::Finding;
use super::{Check, CheckError};
use crate::slideway::SlidewayError;
use crate::slideway::scaling::{
    DeadZone, LagSetting, Scales, computer_gain, lag_response, root_of_square, sum_of_squares,
};
use patchcord_core::machines::{self, Part};

/// The checks of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[
    Check { name: "inventory", run: inventory },
    Check { name: "reference", run: reference },
    Check { name: "computer-gain", run: gain },
    Check { name: "scaled-gain", run: scaled_gain },
    Check { name: "limit-setting", run: limit_setting },
    Check { name: "lag-setting", run: lag_setting },
    Check { name: "lag-settings-fit", run: lag_settings_fit },
    Check { name: "lag-gain", run: lag_gain },
    Check { name: "lag-angle", run: lag_angle },
    Check { name: "lag-decibels", run: lag_decibels },
    Check { name: "dead-zone-wiper", run: wiper },
    Check { name: "dead-zone-opens", run: opens },
    Check { name: "dead-zone-output", run: output },
    Check { name: "dead-zone-correction", run: correction },
    Check { name: "dead-zone-scales", run: scales_with_bias },
    Check { name: "square", run: square },
    Check { name: "root-of-square", run: root },
    Check { name: "only-one-gain-changes", run: only_one_gain },
    Check { name: "within-reference", run: within_reference },
];

/// The number of parts of a kind on the machine.
///
/// Argument `of`: `summers`, `integrators`, `fixed-pots`, `free-pots`, `diode-pairs`, `multipliers`. Claims 8-001 ...
/// 8-006.
fn inventory(given: &CheckArguments) -> Result<Finding, CheckError> {
    let parts = [
        ("summers", Part::Summer),
        ("integrators", Part::Integrator),
        ("fixed-pots", Part::FixedPot),
        ("free-pots", Part::FreePot),
        ("diode-pairs", Part::DiodePair),
        ("multipliers", Part::Multiplier),
    ];
    let part = given.choice("of", &parts)?;
    let count = machines::find("solartron-1451").and_then(|machine| machine.count(part)).unwrap_or(0);
    Ok(Finding::Number(count as f64))
}

/// The machine's reference in V.
///
/// Claim 8-007.
fn reference(_: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(machines::REFERENCE))
}

/// Input scale x block gain / output scale (eq 4-8).
///
/// Arguments: `in` and `out` in unit per volt, `block` (1). Claim 8-013.
fn gain(given: &CheckArguments) -> Result<Finding, CheckError> {
    let gain = computer_gain(given.number("in")?, given.number_or("block", 1.0)?, given.number("out")?)?;
    Ok(Finding::Number(gain))
}

/// Scale set A or B. The argument `set` is required.
fn scales(given: &CheckArguments) -> Result<Scales, CheckError> {
    Ok(given.choice("set", &[("A", Scales::A), ("B", Scales::B)])?)
}

/// A gain of the circuit in a set of scales: that of K, M or f in SI units, or of an integrator. It is divided by
/// `by`, the gain of the amplifier behind a potentiometer.
///
/// Argument `of`: `K` (eq 6-8), `M` (eq 7-8), `f` (eq 10-8), or `velocity` and `position` for the integrators in 1/s
/// (eq 8-8, 9-8). Claims 8-016 ... 8-025, 8-041, 8-043.a, 8-109, 8-111 and 8-113.
fn scaled_gain(given: &CheckArguments) -> Result<Finding, CheckError> {
    type Gain = fn(&Scales, &CheckArguments) -> Result<f64, CheckError>;
    let gains: [(&str, Gain); 5] = [
        ("K", |scales, given| Ok(scales.stiffness_gain(given.number("K")?)?)),
        ("M", |scales, given| Ok(scales.mass_gain(given.number("M")?)?)),
        ("f", |scales, given| Ok(scales.viscous_gain(given.number("f")?)?)),
        ("velocity", |scales, _| Ok(scales.velocity_integrator()?)),
        ("position", |scales, _| Ok(scales.position_integrator()?)),
    ];
    let (scales, gain) = (scales(given)?, given.choice("of", &gains)?);
    Ok(Finding::Number(gain(&scales, given)? / given.number_or("by", 1.0)?))
}

/// Setting of the potentiometer before B2, for VcL in m/s.
///
/// PC2 = velocity scale / VcL = 0.254 mm/s / VcL. The scan lost eq 29-8. Claims 8-072 ... 8-075 and 8-117.a.
fn limit_setting(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(Scales::B.limit_setting(given.number("VcL")?)?))
}

/// Setting PA1 for a time constant in s.
///
/// 0.001 / Tc on the x1000 input (eq 34-8), 0.01 / Tc on x100 for more than 20 ms (eq 35-8). Claims 8-094, 8-095.b and
/// 8-096.
fn lag_setting(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(LagSetting::new(given.number("Tc")?)?.setting))
}

/// Checks whether PA1 can be set for all time constants in s, with settings of 0.05 or more as in the text.
///
/// Argument `Tc`: a list in s. Claim 8-118: 6 ... 25 ms.
fn lag_settings_fit(given: &CheckArguments) -> Result<Finding, CheckError> {
    let memories = given.numbers("Tc")?;
    let settings = memories.iter().map(|memory| LagSetting::new(*memory)).collect::<Result<Vec<_>, _>>()?;
    let texts: Vec<_> = settings.iter().map(|lag| format!("{:.4} on x{}", lag.setting, lag.gain)).collect();
    let fits = settings.iter().all(|lag| (0.05..=1.0).contains(&lag.setting));
    Ok(Finding::truth(fits, texts.join(", ")))
}

/// The output amplitude of a lag for an input amplitude in V, at w = 1 / Tc.
///
/// V / sqrt(2). Claim 8-103: 7.07 V for 10 V.
fn lag_gain(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (gain, _) = corner(given)?;
    Ok(Finding::Number(given.number("V")? * gain))
}

/// The phase lag at w = 1 / Tc, in degrees.
///
/// Claim 8-104: 45 degrees.
fn lag_angle(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(corner(given)?.1.to_degrees()))
}

/// The gain of a lag at w = 1 / Tc, in decibels.
///
/// Claim 8-103.b: -3 dB.
fn lag_decibels(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(20.0 * corner(given)?.0.log10()))
}

/// Gain and phase lag in rad at w = 1 / Tc. The argument is `Tc` in s.
fn corner(given: &CheckArguments) -> Result<(f64, f64), CheckError> {
    let memory = given.number("Tc")?;
    Ok(lag_response(memory, 1.0 / memory)?)
}

/// The dead zone with a wiper r. The defaults are a bias VB of 50 V and ideal diodes.
///
/// `r` is the share of the track between signal and wiper. `diode` is the voltage drop of a diode in V; the formulas of
/// the text omit it.
fn zone(given: &CheckArguments) -> Result<DeadZone, CheckError> {
    let (bias, diode) = (given.number_or("VB", 50.0)?, given.number_or("diode", 0.0)?);
    Ok(DeadZone { wiper: given.number("r")?, bias, diode })
}

/// The wiper that gives an output for an input, both in V, with a bias of 50 V.
///
/// r = (V1 - Vo) / (VB + V1) (eq 17-8); with an output of 0 it sets the end of the zone (eq 21-8). Claims 8-045 and
/// 8-048.
fn wiper(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(DeadZone::set(given.number("in")?, given.number("out")?, 50.0)?.wiper))
}

/// The end of the dead zone in V, or as a share of `by` V.
///
/// (r VB + diode) / (1 - r) (eq 20-8, 26-8). Claims 8-032, 8-037, 8-047, 8-053 and 8-055.b.
fn opens(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(zone(given)?.opens_at()? / given.number_or("by", 1.0)?))
}

/// The output for an input in V.
///
/// V1 - r (V1 + VB) above the end of the zone (eq 18-8). Claims 8-033, 8-049 and 8-055.
fn output(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(zone(given)?.output(given.number("in")?)?))
}

/// The gain that restores a slope of 1.
///
/// 1 / (1 - r). Claim 8-052: 1.35.
fn correction(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(1.0 / zone(given)?.slope()))
}

/// Checks that the end of the dead zone is proportional to the bias, and the slope does not change.
///
/// Argument `over`: biases in V. The ratio must be constant to 1e-12. Fig 8.6, claim 8-054.
fn scales_with_bias(given: &CheckArguments) -> Result<Finding, CheckError> {
    let zone = zone(given)?;
    let ends = given
        .numbers("over")?
        .into_iter()
        .map(|bias| DeadZone { bias, ..zone }.opens_at().map(|end| end / bias));
    let shares = ends.collect::<Result<Vec<f64>, SlidewayError>>()?;
    let holds = shares.iter().all(|share| (share / shares[0] - 1.0).abs() < 1e-12);
    Ok(Finding::truth(holds, format!("{:.4} of VB, slope {:.3}, at every bias", shares[0], zone.slope())))
}

/// The output of the multiplier for A and B in V.
///
/// (A^2 + B^2) / 100 of the positive inputs (eq 32-8); B is 0 unless given. Claims 8-061, 8-086 and 8-086.b.
fn square(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(sum_of_squares(given.number("A")?, given.number_or("B", 0.0)?)))
}

/// The input of the multiplier for an output in V, or as a share of `by` V.
///
/// sqrt(100 V). Claim 8-087: 70.7 V for 50 V; with `by=100` the setting of PC1, claim 8-088.
fn root(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(root_of_square(given.number("V")?)? / given.number_or("by", 1.0)?))
}

/// Checks that only the gain of the position integrator changes from set A to set B, for K, M and f in SI units.
///
/// The gains of K, M, f and of the velocity integrator must agree to 1e-9. Claim 8-043.b: the gain of K changes from 1
/// to 10.
fn only_one_gain(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (stiffness, mass, damping) = (given.number("K")?, given.number("M")?, given.number("f")?);
    let gains = |scales: Scales| -> Result<[f64; 4], SlidewayError> {
        let forces =
            [scales.stiffness_gain(stiffness)?, scales.mass_gain(mass)?, scales.viscous_gain(damping)?];
        Ok([forces[0], forces[1], forces[2], scales.velocity_integrator()?])
    };
    let (first, second) = (gains(Scales::A)?, gains(Scales::B)?);
    let same = first.iter().zip(second).all(|(one, other)| (one / other - 1.0).abs() < 1e-9);
    Ok(Finding::truth(same, format!("the gain of K changes from {:.2} to {:.2}", first[0], second[0])))
}

/// Checks that a velocity v in m/s is within the machine's ±100 V in set B.
///
/// Claims 8-117.b and 8-156: 25.4 mm/s are 100 V, 40 mm/s would be 157 V.
fn within_reference(given: &CheckArguments) -> Result<Finding, CheckError> {
    let voltage = given.number("v")? / Scales::B.velocity;
    Ok(Finding::truth(voltage <= machines::REFERENCE, format!("{voltage:.1} V")))
}
