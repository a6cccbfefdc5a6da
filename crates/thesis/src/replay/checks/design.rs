//! Claims on static friction and on the design equation (9.2, 9.5, 10).
//!
//! Arguments are in the units of chapter 9: `eta` in P, `W` in kgf, `Pw` in kgf/cm2, `H` in um, `KLP` in kgf/mm2.

use super::super::check_arguments::CheckArguments;
use super::super::finding::Finding;
use super::super::series::min_max;
use super::{Check, CheckError};
use crate::slideway::SlidewayError;
use crate::slideway::design::{CONTACT_SHARE, Design, DesignEquation, Interface, Trends, limit_velocity};
use crate::slideway::falling::FallingFriction;
use crate::slideway::measured::TABLE_9_2;
use crate::slideway::units::{KGF, KGF_PER_CM2, KGF_PER_MM2, MM_PER_S, N_S_PER_MM, POISE, UM};

/// The checks of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[
    Check { name: "static-friction", run: static_friction },
    Check { name: "static-friction-factor", run: static_friction_factor },
    Check { name: "design-constant", run: design_constant },
    Check { name: "design-trend", run: design_trend },
    Check { name: "design-trend-smaller", run: design_trend_smaller },
    Check { name: "design-oscillates", run: design_oscillates },
    Check { name: "design-ends", run: design_ends },
    Check { name: "flank-simplified", run: flank_simplified },
    Check { name: "polar-and-thin", run: polar_and_thin },
];

/// The model slideway. KLP in kgf/mm2 replaces that of oil without polar additive. The model has 697 cm2 and a flank of
/// tangent 0.05.
fn interface(given: &CheckArguments) -> Result<Interface, CheckError> {
    let polar = given.number_or("KLP", Interface::MODEL.polar / KGF_PER_MM2)? * KGF_PER_MM2;
    Ok(Interface { polar, ..Interface::MODEL })
}

/// Fs of eq 12-9 in N, for a pressure Pw in kgf/cm2 or a weight W in kgf.
///
/// 10 A (0.009705 Pw^0.82 KLP + 0.05 Pw). The 10 is the thesis's N per kgf. Claims 9-021.a and b.
fn static_friction(given: &CheckArguments) -> Result<Finding, CheckError> {
    let interface = interface(given)?;
    let pressure = match given.text("W") {
        Some(_) => given.number("W")? * KGF / interface.area,
        None => given.number("Pw")? * KGF_PER_CM2,
    };
    Ok(Finding::Number(interface.static_friction(pressure)?))
}

/// A factor of eq 13-9 in N: that of shear or that of climbing.
///
/// Argument `of`: `shear` is the factor of Pw^0.82, `climb` that of Pw. Claims 9-018.a and b.
fn static_friction_factor(given: &CheckArguments) -> Result<Finding, CheckError> {
    let [shear, climb] = interface(given)?.static_friction_factors()?;
    Ok(Finding::Number(given.choice("of", &[("shear", shear), ("climb", climb)])?))
}

/// A constant of eq 93-9 as it follows from the earlier equations.
///
/// Argument `of`: a field of [`DesignEquation`], such as `bracket-viscosity`. "Earlier equations" are eq 11-9, 12-9 and
/// 18-9. Claims 9-241 ... 9-247.c: only the exponent of viscosity in the bracket differs, 0.089 instead of the printed
/// 0.12.
fn design_constant(given: &CheckArguments) -> Result<Finding, CheckError> {
    let equation = DesignEquation::derived();
    let constants = [
        ("load", equation.load),
        ("lift", equation.lift),
        ("divisor", equation.divisor),
        ("viscosity", equation.viscosity),
        ("bracket", equation.bracket),
        ("bracket-weight", equation.bracket_weight),
        ("bracket-viscosity", equation.bracket_viscosity),
        ("bracket-area", equation.bracket_area),
        ("flank", equation.flank),
    ];
    Ok(Finding::Number(given.choice("of", &constants)?))
}

/// The designs of Table T9-2: four oils, three drives, 450 kgf. Oils are without polar additive.
fn designs() -> impl Iterator<Item = Design> {
    TABLE_9_2.iter().map(|cell| Design::model(cell.viscosity, cell.stiffness))
}

/// Reads one trend.
///
/// A trend is the relative change of the critical velocity by that of a quantity.
type Trend = fn(&Trends) -> f64;

/// The trends of eq 93-9, by the name of the quantity.
const TRENDS: [(&str, Trend); 7] = [
    ("viscosity", |trends| trends.viscosity),
    ("weight", |trends| trends.weight),
    ("stiffness", |trends| trends.stiffness),
    ("polar", |trends| trends.polar),
    ("lift", |trends| trends.lift),
    ("flank", |trends| trends.flank),
    ("area", |trends| trends.area),
];

/// Checks whether the critical velocity rises or falls with a quantity of eq 93-9 in every cell of Table T9-2.
///
/// Arguments: `with` and `way` (`rises` or `falls`). All twelve cells must have the sign. Claims 9-012 and 9-249 ...
/// 9-255: of the rules a ... g of 9.5, only b, less load, is contradicted by eq 93-9.
fn design_trend(given: &CheckArguments) -> Result<Finding, CheckError> {
    let part = given.choice("with", &TRENDS)?;
    let sign = given.choice("way", &[("rises", 1.0), ("falls", -1.0)])?;
    let equation = DesignEquation::derived();
    let percents = designs()
        .map(|design| Ok(part(&equation.trends(&design)?)))
        .collect::<Result<Vec<f64>, SlidewayError>>()?;
    let found = format!("a change of 1 % gives {}", format_range(&percents, " %"));
    Ok(Finding::shape(percents.iter().all(|percent| sign * percent > 0.0), found))
}

/// Checks that one quantity of eq 93-9 influences the critical velocity less than another in every cell of Table T9-2.
///
/// Arguments: `of` and `than`. Claim 9-001: weight has more influence than stiffness, contrary to 9.1.
fn design_trend_smaller(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (minor, major) = (given.choice("of", &TRENDS)?, given.choice("than", &TRENDS)?);
    let equation = DesignEquation::derived();
    let ratios = designs()
        .map(|design| equation.trends(&design).map(|trends| (minor(&trends) / major(&trends)).abs()))
        .collect::<Result<Vec<f64>, SlidewayError>>()?;
    let found = format!("{} times as much", format_range(&ratios, ""));
    Ok(Finding::shape(ratios.iter().all(|ratio| *ratio < 1.0), found))
}

/// The minimum and the maximum of numbers, as text.
fn format_range(numbers: &[f64], unit: &str) -> String {
    let (min, max) = min_max(numbers.iter().copied());
    format!("{min:.3}{unit} ... {max:.3}{unit}")
}

/// Checks that the left side of eq 95-9 is larger in every cell of Table T9-2, so that the slideway oscillates at
/// some velocity.
///
/// The ratio of both sides is 1 / T, with T of [`DesignEquation::reduction`]. `KLP` is 22.8 or 7.87 in claims 9-257.a
/// and b: for polar oils the right side is larger.
fn design_oscillates(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (equation, interface) = (DesignEquation::derived(), interface(given)?);
    let ratio = |design: Design| Ok(1.0 / equation.reduction(&Design { interface, ..design })?);
    let ratios = designs().map(ratio).collect::<Result<Vec<f64>, SlidewayError>>()?;
    let found = format!("left side / right side {}", format_range(&ratios, ""));
    Ok(Finding::shape(ratios.iter().all(|ratio| *ratio > 1.0), found))
}

/// Checks that the critical velocity of the printed eq 93-9 is 0 if eq 94-9 holds. KLP is set to this limit in every
/// cell of Table T9-2. A KLP larger by a thousandth gives a critical velocity near 0, a KLP smaller by a thousandth
/// gives none.
///
/// T is inversely proportional to KLP + k tan. It is therefore 1 at KLP = (KLP0 + k tan) T0 - k tan, where KLP0 and T0
/// belong to the cell. "Near 0" is below 0.2 % of VcL. Claim 9-256.
fn design_ends(_: &CheckArguments) -> Result<Finding, CheckError> {
    let (equation, mut holds, mut limits) = (DesignEquation::PRINTED, true, Vec::new());
    for design in designs() {
        let climb = equation.flank * design.interface.flank;
        let strength = design.interface.polar / KGF_PER_MM2 + climb;
        let limit = strength * equation.reduction(&design)? - climb;
        let at = |share: f64| {
            let polar = share * limit * KGF_PER_MM2;
            equation
                .critical_velocity(&Design { interface: Interface { polar, ..design.interface }, ..design })
        };
        let is_small = at(1.001)? < 0.002 * equation.limit(&design)?;
        holds &= is_small && matches!(at(0.999), Err(SlidewayError::NoSolution { .. }));
        limits.push(limit);
    }
    Ok(Finding::truth(holds, format!("at KLP of {}", format_range(&limits, " kgf/mm2"))))
}

/// Checks that Pw^0.82 tan in place of Pw tan changes static friction by at most the machine's accuracy of 2 %, for
/// Pw in kgf/cm2.
///
/// Argument `Pw`. The factors are those of eq 13-9. Claim 9-248.
fn flank_simplified(given: &CheckArguments) -> Result<Finding, CheckError> {
    let pressure = given.number("Pw")?;
    let [shear, climb] = Interface::MODEL.static_friction_factors()?;
    let shared = pressure.powf(CONTACT_SHARE.exponent);
    let percent = 100.0 * ((shear + climb) * shared / (shear * shared + climb * pressure) - 1.0);
    Ok(Finding::truth(percent.abs() <= 2.0, format!("static friction changes by {percent:+.2} %")))
}

/// Checks that a thin polar oil lowers Fs, raises VcL and flattens the curve, compared with the table's thickest oil
/// without additive.
///
/// Arguments: `Pw`, the lift `H` and the viscosity `eta` of the thin oil. The thick oil has 0.595 P and KLP 22.8, the
/// thin one 7.87. Claim 10-005.
fn polar_and_thin(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (pressure, lift) = (given.number("Pw")? * KGF_PER_CM2, given.number("H")? * UM);
    let friction = |polar: f64, poise: f64| -> Result<FallingFriction, SlidewayError> {
        let interface = Interface { polar: polar * KGF_PER_MM2, ..Interface::MODEL };
        let limit = limit_velocity(pressure, lift, poise * POISE)?;
        Ok(FallingFriction { static_friction: interface.static_friction(pressure)?, limit })
    };
    let (thick, thin) = (friction(22.8, 0.595)?, friction(7.87, given.number("eta")?)?);
    let (steep, shallow) = (thick.steepest()? / N_S_PER_MM, thin.steepest()? / N_S_PER_MM);
    let holds = thin.static_friction < thick.static_friction && thin.limit > thick.limit && shallow < steep;
    let found = format!(
        "Fs {:.0} -> {:.0} N, VcL {:.1} -> {:.1} mm/s, steepest slope {steep:.1} -> {shallow:.1} N s/mm",
        thick.static_friction,
        thin.static_friction,
        thick.limit / MM_PER_S,
        thin.limit / MM_PER_S
    );
    Ok(Finding::shape(holds, found))
}
