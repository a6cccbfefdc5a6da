//! Coefficients of friction from shear strength, pressure and slopes, by earlier authors (2.2, 2.3).

use std::f64::consts::PI;

use super::{Range, SlidewayError};

const SHEAR: Range = Range::positive("shear strength Ss", "Pa");
const FLOW: Range = Range::positive("flow pressure Pm", "Pa");
const SHARE: Range = Range::new("share of metallic contact", "", 0.0, 1.0);
const AREA: Range = Range::not_negative("area", "m2");
const SLOPE: Range = Range::new("slope of asperities", "rad", 0.0, 1.5);
const MODULUS: Range = Range::positive("modulus", "Pa");

/// Bowden and Tabor's coefficient of friction, Ss / Pm, both in Pa (eq 7.2).
///
/// # Errors
/// If an argument is not above 0.
pub fn shear_by_flow(shear: f64, flow: f64) -> Result<f64, SlidewayError> {
    Ok(SHEAR.check(shear)? / FLOW.check(flow)?)
}

/// Friction in N of a contact with a sheared area A and a ploughed cross section a, both in m2: A Ss + a p (eq 4.2).
///
/// The shear strength Ss and the mean pressure p are in Pa.
///
/// # Errors
/// If Ss or p is not above 0, or an area below 0.
pub fn sheared_and_ploughed(
    area: f64,
    shear: f64,
    ploughed: f64,
    pressure: f64,
) -> Result<f64, SlidewayError> {
    Ok(AREA.check(area)? * SHEAR.check(shear)? + AREA.check(ploughed)? * FLOW.check(pressure)?)
}

/// Mean shear strength in Pa of a partly metallic contact: alpha Ss1 + (1 - alpha) Ss2 (eq 8.2).
///
/// `metallic` is the metallic share alpha of the area. `metal` and `film` are the shear strengths of both parts in Pa.
///
/// # Errors
/// If the share is not within 0 ... 1, or a strength not above 0.
pub fn mean_shear(metallic: f64, metal: f64, film: f64) -> Result<f64, SlidewayError> {
    let share = SHARE.check(metallic)?;
    Ok(share * SHEAR.check(metal)? + (1.0 - share) * SHEAR.check(film)?)
}

/// Ernst and Merchant's coefficient: Ss / Pm + tan(theta), theta the mean slope of asperities in rad (eq 11.2).
///
/// # Errors
/// If Ss or Pm is not above 0, or the slope not within 0 ... 1.5 rad.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::slideway::adhesion::{ernst_merchant, shear_by_flow};
///
/// // Shear strength 30.87 and flow pressure 132 kgf/mm2, with level and with inclined asperities.
/// let (shear, flow) = (30.87, 132.0);
/// assert!((shear_by_flow(shear, flow)? - 0.2339).abs() < 1e-4);
/// assert!((ernst_merchant(shear, flow, 0.05_f64.atan())? - 0.2839).abs() < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn ernst_merchant(shear: f64, flow: f64, slope: f64) -> Result<f64, SlidewayError> {
    Ok(shear_by_flow(shear, flow)? + SLOPE.check(slope)?.tan())
}

/// Kraghelskii's coefficient under ideal plasticity: alpha / (nu sigma_s) + beta (eq 14.2).
///
/// alpha and the yield stress are in Pa; nu and beta are pure numbers.
///
/// # Errors
/// If the yield stress or nu is not above 0.
pub fn kraghelskii(alpha: f64, nu: f64, yield_stress: f64, beta: f64) -> Result<f64, SlidewayError> {
    let nu = Range::positive("factor nu of the contact", "").check(nu)?;
    Ok(alpha / (nu * Range::positive("yield stress", "Pa").check(yield_stress)?) + beta)
}

/// Tsukizoe and Hisakado's coefficient of shearing, (Ss/Pm) / sqrt(1 - alpha (Ss/Pm)^2) (eq 21.2, whose root the scan
/// lost).
///
/// Junctions grow until p^2 + alpha s^2 = Pm^2.
///
/// # Errors
/// If Ss or Pm is not above 0, or alpha (Ss/Pm)^2 is not below 1.
pub fn tsukizoe_hisakado(shear: f64, flow: f64, alpha: f64) -> Result<f64, SlidewayError> {
    let ratio = shear_by_flow(shear, flow)?;
    let growth = Range::new("alpha (Ss/Pm)^2", "", 0.0, 1.0 - f64::EPSILON).check(alpha * ratio.powi(2))?;
    Ok(ratio / (1.0 - growth).sqrt())
}

/// Tsukizoe and Hisakado's static coefficient of a cone with base angle theta in rad on a soft plane:
/// [(2/pi) tan + mu/2 (1/cos + 1)] / [1 - (2/pi) mu tan] (eq 22.2).
///
/// The scan has 2 pi in the numerator and a plus in the denominator.
///
/// # Errors
/// If the slope is not within 0 ... 1.5 rad, or too steep for the cone to climb.
pub fn cone_on_plane(coefficient: f64, slope: f64) -> Result<f64, SlidewayError> {
    let climb = 2.0 / PI * SLOPE.check(slope)?.tan();
    let denominator =
        Range::new("1 - (2/pi) mu tan", "", f64::EPSILON, f64::MAX).check(1.0 - coefficient * climb)?;
    Ok((climb + 0.5 * coefficient * (1.0 / slope.cos() + 1.0)) / denominator)
}

/// Gupta and Cook's coefficient of spherical asperities, 0.93 S / Y (eq 26.2), from A / W = 0.31 (2 / Y) / (2/3) (eq
/// 24.2).
///
/// The arguments are the shear strength and the tensile yield stress in Pa.
///
/// # Errors
/// If an argument is not above 0.
pub fn gupta_cook(shear: f64, yield_stress: f64) -> Result<f64, SlidewayError> {
    let yield_stress = Range::positive("yield stress Y", "Pa").check(yield_stress)?;
    Ok(gupta_cook_area(1.0, yield_stress)? * SHEAR.check(shear)?)
}

/// Gupta and Cook's contact area in m2 under a load in N, 0.31 (2 / Y) W 3/2 (eq 24.2, 25.2), with the tensile yield
/// stress in Pa.
///
/// # Errors
/// If the yield stress is not above 0, or the load below 0.
pub fn gupta_cook_area(load: f64, yield_stress: f64) -> Result<f64, SlidewayError> {
    Ok(1.5 * 0.31 * 2.0 / Range::positive("yield stress Y", "Pa").check(yield_stress)?
        * Range::not_negative("load W", "N").check(load)?)
}

/// Tomlinson's constant of a material in 1/Pa, (3 E + sign 4 G) / (G (3 E + G)) (eq 2.2).
///
/// E is Young's modulus and G the shear modulus, both in Pa. The scan prints a minus; either sign has the right
/// dimension.
///
/// # Errors
/// If a modulus is not above 0.
pub fn tomlinson_constant(young: f64, shear: f64, sign: f64) -> Result<f64, SlidewayError> {
    let (young, shear) = (MODULUS.check(young)?, MODULUS.check(shear)?);
    Ok((3.0 * young + sign.signum() * 4.0 * shear) / (shear * (3.0 * young + shear)))
}

/// One lbf/in2 in Pa. Tomlinson's coefficient is plausible only in this unit.
pub const LBF_PER_IN2: f64 = 6894.757;

/// Tomlinson's coefficient of friction, 1.07e4 (A1 + A2)^(2/3), with A in in2/lbf (eq 1.2; the scan lost the unit),
/// for A in 1/Pa.
///
/// # Errors
/// If the constants do not add up to more than 0.
pub fn tomlinson(first: f64, second: f64) -> Result<f64, SlidewayError> {
    let sum = Range::positive("Tomlinson's A1 + A2", "1/Pa").check(first + second)?;
    Ok(1.07e4 * (sum * LBF_PER_IN2).powf(2.0 / 3.0))
}

/// Rabinowicz's minimum diameter of wear particles in m, 60000 W / p (2.3).
///
/// The arguments are the surface energy W in J/m2 and the hardness p in Pa. The text uses cgs units.
///
/// # Errors
/// If an argument is not above 0.
pub fn wear_particle(surface_energy: f64, hardness: f64) -> Result<f64, SlidewayError> {
    let energy = Range::positive("surface energy W", "J/m2").check(surface_energy)?;
    // W / p is a length, so the rule is the same in any units.
    Ok(60_000.0 * energy / FLOW.check(hardness)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slideway::assert_close;
    use crate::slideway::units::{CM, KGF_PER_MM2};

    #[test]
    fn cast_iron_has_plausible_coefficients() {
        let (young, shear) = (1.32e4 * KGF_PER_MM2, 1.32e4 / 2.54 * KGF_PER_MM2);
        let constant = tomlinson_constant(young, shear, -1.0).unwrap();
        assert_close(tomlinson(constant, constant).unwrap(), 0.251, 1e-2);
        let (strength, flow) = (51.45 * KGF_PER_MM2, 220.0 * KGF_PER_MM2);
        assert_close(ernst_merchant(strength, flow, 0.05f64.atan()).unwrap(), 0.28386, 1e-3);
        assert_close(tsukizoe_hisakado(strength, flow, 9.0).unwrap(), 0.328, 2e-3);
        assert_close(gupta_cook(1.0, 1.0).unwrap(), 0.93, 1e-12);
        assert_close(wear_particle(1.5, flow).unwrap() / CM, 0.00417, 1e-2);
    }

    #[test]
    fn limiting_cases_are_correct() {
        assert_close(cone_on_plane(0.0, 0.1).unwrap(), 2.0 / PI * 0.1f64.tan(), 1e-12);
        assert_close(cone_on_plane(0.3, 0.0).unwrap(), 0.3, 1e-12);
        assert_close(mean_shear(1.0, 5.0, 2.0).unwrap(), 5.0, 1e-12);
        assert_close(mean_shear(0.25, 4.0, 8.0).unwrap(), 7.0, 1e-12);
        assert_close(kraghelskii(6.0, 3.0, 10.0, 0.1).unwrap(), 0.3, 1e-12);
        assert_close(sheared_and_ploughed(2.0, 3.0, 0.5, 4.0).unwrap(), 8.0, 1e-12);
        assert!(tsukizoe_hisakado(1.0, 2.0, 4.0).is_err());
        assert!(cone_on_plane(2.0, 1.4).is_err());
        assert!(mean_shear(1.1, 5.0, 2.0).is_err());
    }
}
