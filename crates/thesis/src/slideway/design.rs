//! Critical velocity for those who design: from the slope that the simulation found to an equation in oil, load, area, stiffness and
//! surface (9.2, 9.3, 9.5).
//!
//! The constants are the study's, fitted to its simulation and to measurements by others on one pair of cast-iron slideways: two
//! table weights (450 and 850 kgf), oils of 0.13 ... 0.595 P without polar additive, drives of 11 ... 45 kN/mm.

use super::power_law::PowerLaw;
use super::simulated::{OilLaw, SLOPE_BY_STIFFNESS, by_stiffness};
use super::units::{CM_PER_S, CM2, KGF, KGF_PER_CM2, KGF_PER_MM2, MM_PER_S, POISE, UM};
use super::{Range, SlidewayError};

const STIFFNESS: Range = Range::positive("stiffness K", "N/m");
const VISCOSITY: Range = Range::positive("viscosity", "Pa s");
const PRESSURE: Range = Range::positive("mean pressure Pw", "Pa");
/// What a lift may be.
pub(crate) const LIFT: Range = Range::positive("lift Ho + hd", "m");
const AREA: Range = Range::positive("apparent area A", "m2");
const WEIGHT: Range = Range::positive("weight W", "N");
const POLAR: Range = Range::not_negative("oil constant KLP", "Pa");
const FLANK: Range = Range::not_negative("tangent of the flank", "");

/// Exponent of eq 9-9: the mean of 1/0.624 and 1/0.7, those of both oils of chapter 7.
pub const LIMIT_EXPONENT: f64 = 1.515;
/// Exponent of the lift in eq 8-9.
pub const LIFT_EXPONENT: f64 = 2.478;
/// KL of eq 8-9 by viscosity in P (eq 10-9).
pub const LIMIT_COEFFICIENT: PowerLaw = PowerLaw::new(18.7, -0.819);

/// The velocity VcL in m/s from which an oil carries the table alone, for a mean pressure in Pa, a lift Ho + hd in m and a viscosity in
/// Pa s: [Pw (Ho + hd)^2.478 / (18.7 eta^0.181)]^1.515 cm/s, with kgf/cm2, um and P (eq 11-9).
///
/// # Errors
/// Where one of them is not above 0.
pub fn limit_velocity(pressure: f64, lift: f64, viscosity: f64) -> Result<f64, SlidewayError> {
    let (pressure, lift) = (PRESSURE.check(pressure)? / KGF_PER_CM2, LIFT.check(lift)? / UM);
    let viscosity = VISCOSITY.check(viscosity)? / POISE;
    let base = pressure * lift.powf(LIFT_EXPONENT) / (LIMIT_COEFFICIENT.at(viscosity) * viscosity);
    Ok(base.powf(LIMIT_EXPONENT) * CM_PER_S)
}

/// Contact area by pressure in eq 164-7: the share of the apparent area by kgf/cm2, in cm2/mm2.
pub const CONTACT_SHARE: PowerLaw = PowerLaw::new(0.009705, 0.82);
/// N in a kgf, as eq 12-9 rounds it.
pub const ROUND_KGF: f64 = 10.0;

/// What presses and shears under a table.
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
/// KLP of oil with it, 7.87 kgf/mm2 (eq 165-7), in Pa.
pub const POLAR_ADDITIVE: f64 = 7.87 * KGF_PER_MM2;

impl Interface {
    /// The study's model slideway with oil without polar additive: 697 cm2, tangent 0.05 (9.3).
    pub const MODEL: Interface = Interface { area: 697.0 * CM2, polar: NON_POLAR, flank: 0.05 };

    fn checked(&self) -> Result<&Self, SlidewayError> {
        AREA.check(self.area)?;
        POLAR.check(self.polar)?;
        FLANK.check(self.flank)?;
        Ok(self)
    }

    /// Static friction Fs in N under a mean pressure in Pa: 10 A (0.009705 Pw^0.82 KLP + Pw tan), with cm2, kgf/cm2 and kgf/mm2
    /// (eq 12-9). The 10 stands for 9.80665 N in a kgf, and makes it 2 % too large.
    ///
    /// # Errors
    /// Where area or pressure is not above 0, or one of the others below 0.
    pub fn static_friction(&self, pressure: f64) -> Result<f64, SlidewayError> {
        let [shear, climb] = self.static_friction_factors()?;
        let pressure = PRESSURE.check(pressure)? / KGF_PER_CM2;
        Ok(shear * pressure.powf(CONTACT_SHARE.exponent) + climb * pressure)
    }

    /// The factors of Pw^0.82 and of Pw in it, in N, with Pw in kgf/cm2 (eq 13-9).
    ///
    /// # Errors
    /// Where the area is not above 0, or one of the others below 0.
    pub fn static_friction_factors(&self) -> Result<[f64; 2], SlidewayError> {
        let area = ROUND_KGF * self.checked()?.area / CM2;
        Ok([area * CONTACT_SHARE.factor * self.polar / KGF_PER_MM2, area * self.flank])
    }
}

/// What a designer can choose (eq 93-9).
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
    /// What presses and shears.
    pub interface: Interface,
}

impl Design {
    /// A table of 450 kgf on the model slideway, with the lift of chapter 7, 4.64 + 0.84 um (9.3).
    ///
    /// Viscosity in Pa s, stiffness in N/m.
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

/// By how many percent the critical velocity rises where a quantity rises by one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trends {
    /// By viscosity: advice a of 9.5.
    pub viscosity: f64,
    /// By weight: advice b.
    pub weight: f64,
    /// By stiffness: advice c.
    pub stiffness: f64,
    /// By KLP: advice d.
    pub polar: f64,
    /// By the lift Ho + hd: advice e.
    pub lift: f64,
    /// By the tangent of the flank: advice f.
    pub flank: f64,
    /// By area: advice g.
    pub area: f64,
}

impl DesignEquation {
    /// As it is printed, with 0.12 for the last exponent of viscosity (eq 93-9, 94-9, 95-9).
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

    /// As it follows from eq 11-9, 12-9 and 18-9, with Pw^0.82 for Pw beside the flank as in the text. The last exponent of viscosity
    /// is 0.363 - 0.274 = 0.089.
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

    /// VcL in m/s: what stands before the bracket.
    ///
    /// # Errors
    /// Where a quantity of the design is out of its range.
    pub fn limit(&self, design: &Design) -> Result<f64, SlidewayError> {
        let design = design.checked()?;
        let pressed = design.weight / KGF / (design.interface.area / CM2);
        let thinned = (design.viscosity / POISE).powf(self.viscosity);
        Ok(pressed.powf(self.load) * (design.lift / UM).powf(self.lift) / (self.divisor * thinned) * MM_PER_S)
    }

    /// T, what the bracket takes off 1; from 1 on there is no oscillation at any velocity (eq 94-9). It is the right side of eq 95-9 by
    /// its left.
    ///
    /// # Errors
    /// Where a quantity of the design is out of its range.
    pub fn taken_off(&self, design: &Design) -> Result<f64, SlidewayError> {
        let design = design.checked()?;
        let interface = design.interface;
        let above = self.bracket
            * (design.weight / KGF).powf(self.bracket_weight)
            * (design.lift / UM).powf(self.lift)
            * by_stiffness(design.stiffness)?
            * (design.viscosity / POISE).powf(self.bracket_viscosity);
        let below = (interface.area / CM2).powf(self.bracket_area) * self.hold(&interface);
        Ok(above / Range::positive("KLP + 103 tan", "kgf/mm2").check(below)?)
    }

    /// KLP + k tan, in kgf/mm2.
    fn hold(&self, interface: &Interface) -> f64 {
        interface.polar / KGF_PER_MM2 + self.flank * interface.flank
    }

    /// The critical velocity in m/s.
    ///
    /// # Errors
    /// Where a quantity of the design is out of its range, or there is no oscillation at any velocity.
    pub fn critical_velocity(&self, design: &Design) -> Result<f64, SlidewayError> {
        Ok(self.limit(design)? * (1.0 - self.oscillating(design)?))
    }

    /// T, where it leaves something.
    fn oscillating(&self, design: &Design) -> Result<f64, SlidewayError> {
        let taken_off = self.taken_off(design)?;
        if taken_off >= 1.0 {
            let because = format!("the bracket of eq 93-9 is 1 - {taken_off:.4}: it never oscillates");
            return Err(SlidewayError::NoSolution { sought: "critical velocity", because });
        }
        Ok(taken_off)
    }

    /// What makes the critical velocity rise and fall (9.5, a ... g): derivatives of its logarithm by those of the quantities.
    ///
    /// # Errors
    /// Where a quantity of the design is out of its range, or there is no oscillation at any velocity.
    pub fn trends(&self, design: &Design) -> Result<Trends, SlidewayError> {
        let taken_off = self.oscillating(design)?;
        let weight_of_bracket = taken_off / (1.0 - taken_off);
        let polar_share = design.interface.polar / KGF_PER_MM2 / self.hold(&design.interface);
        Ok(Trends {
            viscosity: -self.viscosity - self.bracket_viscosity * weight_of_bracket,
            weight: self.load - self.bracket_weight * weight_of_bracket,
            stiffness: -SLOPE_BY_STIFFNESS.exponent * weight_of_bracket,
            polar: polar_share * weight_of_bracket,
            lift: self.lift * (1.0 - weight_of_bracket),
            flank: (1.0 - polar_share) * weight_of_bracket,
            area: self.bracket_area * weight_of_bracket - self.load,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slideway::falling::FallingFriction;
    use crate::slideway::near;

    #[test]
    fn figures_of_the_study_come_out() {
        let pressure = 0.615 * KGF_PER_CM2;
        for (poise, limit) in [(0.13, 58.97), (0.34, 45.31), (0.455, 41.83), (0.595, 38.86)] {
            // eq 14-9 rounds the base to 2.23.
            near(limit_velocity(pressure, 5.48 * UM, poise * POISE).unwrap() / MM_PER_S, limit, 3e-3);
        }
        near(Interface::MODEL.static_friction(pressure).unwrap(), 1249.0, 1e-3);
        let derived = DesignEquation::derived();
        near(derived.bracket, 19.8, 2e-3);
        near(derived.bracket_viscosity, 0.0888, 1e-3);
    }

    #[test]
    fn the_equation_is_the_chain_it_was_made_of() {
        let design = Design::model(0.034, 27.6e6);
        let pressure = design.weight / design.interface.area;
        let limit = limit_velocity(pressure, design.lift, design.viscosity).unwrap();
        let equation = DesignEquation::derived();
        near(equation.limit(&design).unwrap(), limit, 1e-9);
        // The text puts Pw^0.82 for Pw beside the flank.
        let [shear, climb] = design.interface.static_friction_factors().unwrap();
        let static_friction = (shear + climb) * (pressure / KGF_PER_CM2).powf(CONTACT_SHARE.exponent);
        let slope = OilLaw::AT_450_KGF.slope(design.viscosity, design.stiffness).unwrap();
        let velocity = FallingFriction { static_friction, limit }.velocity_at_slope(slope).unwrap();
        near(equation.critical_velocity(&design).unwrap(), velocity, 1e-9);
    }

    #[test]
    fn trends_are_derivatives() {
        let (equation, design) = (DesignEquation::derived(), Design::model(0.034, 27.6e6));
        let trends = equation.trends(&design).unwrap();
        let rise = |change: fn(&mut Design, f64)| {
            let at = |factor: f64| {
                let mut changed = design;
                change(&mut changed, factor);
                equation.critical_velocity(&changed).unwrap().ln()
            };
            (at(1.0 + 1e-5) - at(1.0 - 1e-5)) / 2e-5
        };
        let pairs = [
            (trends.viscosity, rise(|design, factor| design.viscosity *= factor)),
            (trends.weight, rise(|design, factor| design.weight *= factor)),
            (trends.stiffness, rise(|design, factor| design.stiffness *= factor)),
            (trends.polar, rise(|design, factor| design.interface.polar *= factor)),
            (trends.lift, rise(|design, factor| design.lift *= factor)),
            (trends.flank, rise(|design, factor| design.interface.flank *= factor)),
            (trends.area, rise(|design, factor| design.interface.area *= factor)),
        ];
        for (told, found) in pairs {
            assert!((told - found).abs() < 1e-6 * (1.0 + told.abs()), "{told}, not {found}");
        }
    }

    #[test]
    fn polar_oil_leaves_no_critical_velocity() {
        let mut design = Design::model(0.034, 45e6);
        design.interface.polar = POLAR_ADDITIVE;
        let error = DesignEquation::PRINTED.critical_velocity(&design).unwrap_err();
        assert!(error.to_string().contains("it never oscillates"), "{error}");
        assert!(DesignEquation::PRINTED.limit(&Design { lift: 0.0, ..design }).is_err());
    }
}
