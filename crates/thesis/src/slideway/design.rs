//! The design equation for the critical velocity (9.2, 9.3, 9.5).
//!
//! It combines the slope that the simulation found with the laws for VcL and static friction. The result is an
//! equation in oil, load, area, stiffness and surface.
//!
//! The constants are the thesis's. They were fitted to its simulation and to measurements by others on one pair of
//! cast-iron slideways: two table weights (450 and 850 kgf), oils of 0.13 ... 0.595 P without polar additive, drives
//! of 11 ... 45 kN/mm.

use super::power_law::PowerLaw;
use super::simulated::{OilLaw, SLOPE_BY_STIFFNESS, by_stiffness};
use super::units::{CM_PER_S, CM2, KGF, KGF_PER_CM2, KGF_PER_MM2, MM_PER_S, POISE, UM};
use super::{Range, SlidewayError};

const STIFFNESS: Range = Range::positive("stiffness K", "N/m");
const VISCOSITY: Range = Range::positive("viscosity", "Pa s");
const PRESSURE: Range = Range::positive("mean pressure Pw", "Pa");
/// Permitted lifts Ho + hd.
pub(crate) const LIFT: Range = Range::positive("lift Ho + hd", "m");
const AREA: Range = Range::positive("apparent area A", "m2");
const WEIGHT: Range = Range::positive("weight W", "N");
const POLAR: Range = Range::not_negative("oil constant KLP", "Pa");
const FLANK: Range = Range::not_negative("tangent of the flank", "");

/// Exponent of eq 9-9: the mean of 1/0.624 and 1/0.7, the exponents of the two oils of chapter 7.
pub const LIMIT_EXPONENT: f64 = 1.515;
/// Exponent of the lift in eq 8-9.
pub const LIFT_EXPONENT: f64 = 2.478;
/// Coefficient KL of eq 8-9 against viscosity in P (eq 10-9).
pub const LIMIT_COEFFICIENT: PowerLaw = PowerLaw::new(18.7, -0.819);

/// The velocity VcL in m/s from which the oil film carries the whole table (eq 11-9).
///
/// The arguments are the mean pressure in Pa, the lift Ho + hd in m and the viscosity in Pa s. The formula is
/// [Pw (Ho + hd)^2.478 / (18.7 eta^0.181)]^1.515 cm/s, with kgf/cm2, um and P.
///
/// # Errors
/// If an argument is not above 0.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::slideway::design::limit_velocity;
/// use patchcord_thesis::slideway::units::{KGF_PER_CM2, MM_PER_S, POISE, UM};
///
/// let limit = limit_velocity(0.615 * KGF_PER_CM2, 5.48 * UM, 0.34 * POISE)?;
/// assert!((limit / MM_PER_S - 45.3).abs() < 0.2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn limit_velocity(pressure: f64, lift: f64, viscosity: f64) -> Result<f64, SlidewayError> {
    let (pressure, lift) = (PRESSURE.check(pressure)? / KGF_PER_CM2, LIFT.check(lift)? / UM);
    let viscosity = VISCOSITY.check(viscosity)? / POISE;
    let base = pressure * lift.powf(LIFT_EXPONENT) / (LIMIT_COEFFICIENT.at(viscosity) * viscosity);
    Ok(base.powf(LIMIT_EXPONENT) * CM_PER_S)
}

/// Contact area in eq 164-7: the share of the apparent area in cm2/mm2 against pressure in kgf/cm2.
pub const CONTACT_SHARE: PowerLaw = PowerLaw::new(0.009705, 0.82);
/// Newtons per kgf as eq 12-9 rounds them.
pub const ROUND_KGF: f64 = 10.0;

/// The interface under a table: apparent area, strength of the contact and slope of the asperities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interface {
    /// Apparent area A, in m2.
    pub area: f64,
    /// The oil's constant KLP, in Pa (eq 163-7).
    pub polar: f64,
    /// Tangent of the flank of the asperities.
    pub flank: f64,
}

/// KLP of oil without polar additive, 22.8 kgf/mm2 (eq 163-7), in Pa.
pub const NON_POLAR: f64 = 22.8 * KGF_PER_MM2;
/// KLP of oil with polar additive, 7.87 kgf/mm2 (eq 165-7), in Pa.
pub const POLAR_ADDITIVE: f64 = 7.87 * KGF_PER_MM2;

impl Interface {
    /// The thesis's model slideway with oil without polar additive: 697 cm2, tangent 0.05 (9.3).
    pub const MODEL: Interface = Interface { area: 697.0 * CM2, polar: NON_POLAR, flank: 0.05 };

    fn checked(&self) -> Result<&Self, SlidewayError> {
        AREA.check(self.area)?;
        POLAR.check(self.polar)?;
        FLANK.check(self.flank)?;
        Ok(self)
    }

    /// Static friction Fs in N under a mean pressure in Pa: 10 A (0.009705 Pw^0.82 KLP + Pw tan), with cm2, kgf/cm2
    /// and kgf/mm2 (eq 12-9). The factor 10 replaces 9.80665 N per kgf, so the result is 2 % too large.
    ///
    /// # Errors
    /// If area or pressure is not above 0, or KLP or the flank is below 0.
    pub fn static_friction(&self, pressure: f64) -> Result<f64, SlidewayError> {
        let [shear, climb] = self.static_friction_factors()?;
        let pressure = PRESSURE.check(pressure)? / KGF_PER_CM2;
        Ok(shear * pressure.powf(CONTACT_SHARE.exponent) + climb * pressure)
    }

    /// The factors of Pw^0.82 and of Pw in static friction, in N, with Pw in kgf/cm2 (eq 13-9).
    ///
    /// # Errors
    /// If the area is not above 0, or KLP or the flank is below 0.
    pub fn static_friction_factors(&self) -> Result<[f64; 2], SlidewayError> {
        let area = ROUND_KGF * self.checked()?.area / CM2;
        Ok([area * CONTACT_SHARE.factor * self.polar / KGF_PER_MM2, area * self.flank])
    }
}

/// The design quantities of eq 93-9.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Design {
    /// Weight W of the table, in N.
    pub weight: f64,
    /// Lift Ho + hd, in m.
    pub lift: f64,
    /// Viscosity of the oil, in Pa s.
    pub viscosity: f64,
    /// Stiffness K of the drive, in N/m.
    pub stiffness: f64,
    /// The interface under the table.
    pub interface: Interface,
}

impl Design {
    /// A table of 450 kgf on the model slideway, with the lift of chapter 7, 4.64 + 0.84 um (9.3).
    ///
    /// The viscosity is in Pa s, the stiffness in N/m.
    pub const fn model(viscosity: f64, stiffness: f64) -> Self {
        Design { weight: 450.0 * KGF, lift: 5.48 * UM, viscosity, stiffness, interface: Interface::MODEL }
    }

    fn checked(&self) -> Result<&Self, SlidewayError> {
        WEIGHT.check(self.weight)?;
        LIFT.check(self.lift)?;
        VISCOSITY.check(self.viscosity)?;
        STIFFNESS.check(self.stiffness)?;
        self.interface.checked()?;
        Ok(self)
    }
}

/// The constants of eq 93-9: Vc = W^a H^b / (c A^a eta^d) (1 - T) mm/s, with
/// T = e W^g H^b K^0.077 eta^h / (A^i (KLP + k tan)), in kgf, um, P, N/mm, cm2 and kgf/mm2.
///
/// # Examples
///
/// A table of 450 kgf on oil of 0.34 P, with a drive of 27.6 kN/mm:
///
/// ```
/// use patchcord_thesis::slideway::design::{Design, DesignEquation};
///
/// let (equation, design) = (DesignEquation::derived(), Design::model(0.034, 27.6e6));
/// assert!(equation.critical_velocity(&design)? < equation.limit(&design)?);
///
/// // More viscosity or stiffness lowers the critical velocity, a larger KLP raises it.
/// let trends = equation.trends(&design)?;
/// assert!(trends.viscosity < 0.0 && trends.stiffness < 0.0 && trends.polar > 0.0);
/// assert_eq!(DesignEquation::PRINTED.bracket_viscosity, 0.12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DesignEquation {
    /// a: exponent of weight and, as a divisor, of area.
    pub load: f64,
    /// b: exponent of the lift Ho + hd, in both places.
    pub lift: f64,
    /// c: divisor.
    pub divisor: f64,
    /// d: exponent of viscosity, as a divisor.
    pub viscosity: f64,
    /// e: factor of the bracket.
    pub bracket: f64,
    /// g: exponent of weight in the bracket.
    pub bracket_weight: f64,
    /// h: exponent of viscosity in the bracket.
    pub bracket_viscosity: f64,
    /// i: exponent of area in the bracket, as a divisor.
    pub bracket_area: f64,
    /// k: factor of the flank's tangent, in kgf/mm2.
    pub flank: f64,
}

/// Relative change of the critical velocity divided by the relative change of a quantity, for every rule of 9.5.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trends {
    /// Trend with viscosity: rule a of 9.5.
    pub viscosity: f64,
    /// Trend with weight: rule b.
    pub weight: f64,
    /// Trend with stiffness: rule c.
    pub stiffness: f64,
    /// Trend with KLP: rule d.
    pub polar: f64,
    /// Trend with the lift Ho + hd: rule e.
    pub lift: f64,
    /// Trend with the tangent of the flank: rule f.
    pub flank: f64,
    /// Trend with area: rule g.
    pub area: f64,
}

impl DesignEquation {
    /// The constants as printed, with 0.12 for the last exponent of viscosity (eq 93-9, 94-9, 95-9).
    pub const PRINTED: DesignEquation = DesignEquation {
        load: 1.515,
        lift: 3.754,
        divisor: 8.45,
        viscosity: 0.274,
        bracket: 19.8,
        bracket_weight: 0.695,
        bracket_viscosity: 0.12,
        bracket_area: 1.695,
        flank: 103.0,
    };

    /// The constants as they follow from eq 11-9, 12-9 and 18-9, with Pw^0.82 in place of Pw in the term of the
    /// flank, as in the text. The last exponent of viscosity is 0.363 - 0.274 = 0.089.
    pub fn derived() -> Self {
        let (load, slope) = (LIMIT_EXPONENT, OilLaw::AT_450_KGF.slope);
        let divisor = LIMIT_COEFFICIENT.factor.powf(load) * MM_PER_S / CM_PER_S;
        let viscosity = (1.0 + LIMIT_COEFFICIENT.exponent) * load;
        DesignEquation {
            load,
            lift: LIFT_EXPONENT * load,
            divisor,
            viscosity,
            bracket: slope.factor / (2.0 * divisor * ROUND_KGF * CONTACT_SHARE.factor),
            bracket_weight: load - CONTACT_SHARE.exponent,
            bracket_viscosity: slope.exponent - viscosity,
            bracket_area: load + 1.0 - CONTACT_SHARE.exponent,
            flank: 1.0 / CONTACT_SHARE.factor,
        }
    }

    /// VcL in m/s: the factor before the bracket of eq 93-9.
    ///
    /// # Errors
    /// If a quantity of the design is out of its range.
    pub fn limit(&self, design: &Design) -> Result<f64, SlidewayError> {
        let design = design.checked()?;
        let pressed = design.weight / KGF / (design.interface.area / CM2);
        let thinned = (design.viscosity / POISE).powf(self.viscosity);
        Ok(pressed.powf(self.load) * (design.lift / UM).powf(self.lift) / (self.divisor * thinned) * MM_PER_S)
    }

    /// T, the subtrahend in the bracket 1 - T of eq 93-9. It is the ratio of the right side of eq 95-9 to its left
    /// side.
    ///
    /// There is no oscillation at any velocity if T is 1 or more (eq 94-9).
    ///
    /// # Errors
    /// If a quantity of the design is out of its range.
    pub fn reduction(&self, design: &Design) -> Result<f64, SlidewayError> {
        let design = design.checked()?;
        let interface = design.interface;
        let numerator = self.bracket
            * (design.weight / KGF).powf(self.bracket_weight)
            * (design.lift / UM).powf(self.lift)
            * by_stiffness(design.stiffness)?
            * (design.viscosity / POISE).powf(self.bracket_viscosity);
        let denominator = (interface.area / CM2).powf(self.bracket_area) * self.strength(&interface);
        Ok(numerator / Range::positive("KLP + 103 tan", "kgf/mm2").check(denominator)?)
    }

    /// KLP + k tan, in kgf/mm2.
    fn strength(&self, interface: &Interface) -> f64 {
        interface.polar / KGF_PER_MM2 + self.flank * interface.flank
    }

    /// The critical velocity in m/s.
    ///
    /// # Errors
    /// If a quantity of the design is out of its range, or there is no oscillation at any velocity.
    pub fn critical_velocity(&self, design: &Design) -> Result<f64, SlidewayError> {
        Ok(self.limit(design)? * (1.0 - self.reduction_below_one(design)?))
    }

    /// T, if it is below 1.
    fn reduction_below_one(&self, design: &Design) -> Result<f64, SlidewayError> {
        let reduction = self.reduction(design)?;
        if reduction >= 1.0 {
            let reason = format!("the bracket of eq 93-9 is 1 - {reduction:.4}: it never oscillates");
            return Err(SlidewayError::NoSolution { sought: "critical velocity", reason });
        }
        Ok(reduction)
    }

    /// The trends of the critical velocity (9.5, a ... g): derivatives of its logarithm by the logarithms of the
    /// quantities.
    ///
    /// # Errors
    /// If a quantity of the design is out of its range, or there is no oscillation at any velocity.
    pub fn trends(&self, design: &Design) -> Result<Trends, SlidewayError> {
        let reduction = self.reduction_below_one(design)?;
        let bracket_sensitivity = reduction / (1.0 - reduction);
        let polar_share = design.interface.polar / KGF_PER_MM2 / self.strength(&design.interface);
        Ok(Trends {
            viscosity: -self.viscosity - self.bracket_viscosity * bracket_sensitivity,
            weight: self.load - self.bracket_weight * bracket_sensitivity,
            stiffness: -SLOPE_BY_STIFFNESS.exponent * bracket_sensitivity,
            polar: polar_share * bracket_sensitivity,
            lift: self.lift * (1.0 - bracket_sensitivity),
            flank: (1.0 - polar_share) * bracket_sensitivity,
            area: self.bracket_area * bracket_sensitivity - self.load,
        })
    }
}

#[cfg(test)]
mod tests;
