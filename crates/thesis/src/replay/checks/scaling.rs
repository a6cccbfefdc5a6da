//! The slideway in volts: scales, gains, settings, the diode dead zone (8.1 ... 8.4).

use super::super::finding::Finding;
use super::super::given::Given;
use super::{Check, CheckError};
use crate::slideway::SlidewayError;
use crate::slideway::scaling::{
    DeadZone, LagSetting, Scales, computer_gain, lag_response, root_of_square, sum_of_squares,
};
use patchcord_core::machines::{self, Part};

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

/// How many of a part the machine has.
fn inventory(given: &Given) -> Result<Finding, CheckError> {
    let parts = [
        ("summers", Part::Summer),
        ("integrators", Part::Integrator),
        ("fixed-pots", Part::FixedPot),
        ("free-pots", Part::FreePot),
        ("diode-pairs", Part::DiodePair),
        ("multipliers", Part::Multiplier),
    ];
    let part = given.word("of", &parts)?;
    let count = machines::find("solartron-1451").and_then(|machine| machine.count(part)).unwrap_or(0);
    Ok(Finding::Number(count as f64))
}

/// The machine's reference in V.
fn reference(_: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(machines::REFERENCE))
}

/// Input scale x block gain / output scale (eq 4-8).
fn gain(given: &Given) -> Result<Finding, CheckError> {
    let gain = computer_gain(given.number("in")?, given.number_or("block", 1.0)?, given.number("out")?)?;
    Ok(Finding::Number(gain))
}

/// Set A or B.
fn scales(given: &Given) -> Result<Scales, CheckError> {
    Ok(given.word("set", &[("A", Scales::A), ("B", Scales::B)])?)
}

/// A gain of the circuit in a set of scales, by the element's gain `by` where a potentiometer shares it: K, M or f in SI, or an integrator.
fn scaled_gain(given: &Given) -> Result<Finding, CheckError> {
    type Gain = fn(&Scales, &Given) -> Result<f64, CheckError>;
    let gains: [(&str, Gain); 5] = [
        ("K", |scales, given| Ok(scales.stiffness_gain(given.number("K")?)?)),
        ("M", |scales, given| Ok(scales.mass_gain(given.number("M")?)?)),
        ("f", |scales, given| Ok(scales.viscous_gain(given.number("f")?)?)),
        ("velocity", |scales, _| Ok(scales.velocity_integrator()?)),
        ("position", |scales, _| Ok(scales.position_integrator()?)),
    ];
    let (scales, gain) = (scales(given)?, given.word("of", &gains)?);
    Ok(Finding::Number(gain(&scales, given)? / given.number_or("by", 1.0)?))
}

/// Setting of the potentiometer before B2, for VcL in m/s.
fn limit_setting(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(Scales::B.limit_setting(given.number("VcL")?)?))
}

/// Setting PA1 for a time constant in s.
fn lag_setting(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(LagSetting::new(given.number("Tc")?)?.setting))
}

/// Whether PA1 can be set for all time constants in s, to 0.05 and more as the text wants it.
fn lag_settings_fit(given: &Given) -> Result<Finding, CheckError> {
    let memories = given.numbers("Tc")?;
    let settings = memories.iter().map(|memory| LagSetting::new(*memory)).collect::<Result<Vec<_>, _>>()?;
    let told: Vec<_> = settings.iter().map(|lag| format!("{:.4} on x{}", lag.setting, lag.gain)).collect();
    let fits = settings.iter().all(|lag| (0.05..=1.0).contains(&lag.setting));
    Ok(Finding::truth(fits, told.join(", ")))
}

/// What a lag makes of an amplitude in V, at w = 1 / Tc.
fn lag_gain(given: &Given) -> Result<Finding, CheckError> {
    let (gain, _) = corner(given)?;
    Ok(Finding::Number(given.number("V")? * gain))
}

/// How late a lag is at w = 1 / Tc, in degrees.
fn lag_angle(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(corner(given)?.1.to_degrees()))
}

/// What a lag leaves at w = 1 / Tc, in decibels.
fn lag_decibels(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(20.0 * corner(given)?.0.log10()))
}

fn corner(given: &Given) -> Result<(f64, f64), CheckError> {
    let memory = given.number("Tc")?;
    Ok(lag_response(memory, 1.0 / memory)?)
}

/// The dead zone with a wiper r, a bias VB of 50 V and ideal diodes, or what is given instead.
fn zone(given: &Given) -> Result<DeadZone, CheckError> {
    let (bias, diode) = (given.number_or("VB", 50.0)?, given.number_or("diode", 0.0)?);
    Ok(DeadZone { wiper: given.number("r")?, bias, diode })
}

/// The wiper that is set by an input and its output in V, with 50 V of bias.
fn wiper(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(DeadZone::set(given.number("in")?, given.number("out")?, 50.0)?.wiper))
}

/// Where the zone ends, in V or as a share of `by` V.
fn opens(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(zone(given)?.opens_at()? / given.number_or("by", 1.0)?))
}

/// The output for an input in V.
fn output(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(zone(given)?.output(given.number("in")?)?))
}

/// The gain that makes the slope 1 again.
fn correction(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(1.0 / zone(given)?.slope()))
}

/// That the end of the zone goes with the bias, and the slope stays.
fn scales_with_bias(given: &Given) -> Result<Finding, CheckError> {
    let zone = zone(given)?;
    let ends = given
        .numbers("over")?
        .into_iter()
        .map(|bias| DeadZone { bias, ..zone }.opens_at().map(|end| end / bias));
    let shares = ends.collect::<Result<Vec<f64>, SlidewayError>>()?;
    let holds = shares.iter().all(|share| (share / shares[0] - 1.0).abs() < 1e-12);
    Ok(Finding::truth(holds, format!("{:.4} of VB, slope {:.3}, at every bias", shares[0], zone.slope())))
}

/// What the multiplier makes of A and B in V.
fn square(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(sum_of_squares(given.number("A")?, given.number_or("B", 0.0)?)))
}

/// The input of the multiplier for an output in V, or as a share of `by` V.
fn root(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(root_of_square(given.number("V")?)? / given.number_or("by", 1.0)?))
}

/// That from set A to set B only the gain of the position integrator changes, at K, M and f in SI.
fn only_one_gain(given: &Given) -> Result<Finding, CheckError> {
    let (stiffness, mass, damping) = (given.number("K")?, given.number("M")?, given.number("f")?);
    let gains = |scales: Scales| -> Result<[f64; 4], SlidewayError> {
        let forces =
            [scales.stiffness_gain(stiffness)?, scales.mass_gain(mass)?, scales.viscous_gain(damping)?];
        Ok([forces[0], forces[1], forces[2], scales.velocity_integrator()?])
    };
    let (first, second) = (gains(Scales::A)?, gains(Scales::B)?);
    let same = first.iter().zip(second).all(|(one, other)| (one / other - 1.0).abs() < 1e-9);
    Ok(Finding::truth(same, format!("the gain of K goes from {:.2} to {:.2}", first[0], second[0])))
}

/// That a velocity in m/s stays within the machine's ±100 V in set B.
fn within_reference(given: &Given) -> Result<Finding, CheckError> {
    let voltage = given.number("v")? / Scales::B.velocity;
    Ok(Finding::truth(voltage <= machines::REFERENCE, format!("{voltage:.1} V")))
}
