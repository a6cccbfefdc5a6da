//! Claims on the design equations and on the measurements (9.2, 9.3, 9.5, 10).
//!
//! Arguments are in the units of chapter 9: `eta` in P, `W` in kgf, `Pw` in kgf/cm2, `H` in um, `KLP` in kgf/mm2, `K`
//! in N/mm. [`simulated_trend`] takes SI units.

use super::super::check_arguments::CheckArguments;
use super::super::finding::Finding;
use super::stability::part_of;
use super::{Check, CheckError};
use crate::slideway::design::{CONTACT_SHARE, Design, DesignEquation, Interface, Trends, limit_velocity};
use crate::slideway::falling::FallingFriction;
use crate::slideway::measured::{Measurement, STATIC_FRICTION, TABLE_9_2};
use crate::slideway::power_law::PowerLaw;
use crate::slideway::simulated::{OilLaw, memory_from_critical_velocity};
use crate::slideway::units::{KGF, KGF_PER_CM2, KGF_PER_MM2, MM_PER_S, MS, N_PER_MM, N_S_PER_MM, POISE, UM};
use crate::slideway::{SlidewayError, simulated};

/// The checks of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[
    Check { name: "power-through", run: power_through },
    Check { name: "inverse-law", run: inverse_law },
    Check { name: "static-friction", run: static_friction },
    Check { name: "static-friction-factor", run: static_friction_factor },
    Check { name: "oil-memory", run: oil_memory },
    Check { name: "oil-slope-law", run: oil_slope_law },
    Check { name: "oil-laws-fall-with-weight", run: oil_laws_fall },
    Check { name: "heavier-bears-less", run: heavier_bears_less },
    Check { name: "t92-fit", run: table_fit },
    Check { name: "t92-slope", run: table_slope },
    Check { name: "t92-velocity", run: table_velocity },
    Check { name: "t92-memory", run: table_memory },
    Check { name: "t92-and-back", run: table_and_back },
    Check { name: "t92-tells-oils-apart", run: oils_apart },
    Check { name: "design-constant", run: design_constant },
    Check { name: "design-trend", run: design_trend },
    Check { name: "design-trend-smaller", run: design_trend_smaller },
    Check { name: "design-oscillates", run: design_oscillates },
    Check { name: "design-ends", run: design_ends },
    Check { name: "flank-simplified", run: flank_simplified },
    Check { name: "polar-and-thin", run: polar_and_thin },
    Check { name: "simulated-trend", run: simulated_trend },
];

/// Factor or exponent of the power law through the points (x, y).
///
/// Arguments: `x`, `y`, both lists, and `part`. Claims 9-015.a and b: KL = 18.7 eta^-0.819 through both oils (eq 10-9).
fn power_through(given: &CheckArguments) -> Result<Finding, CheckError> {
    let points: Vec<_> = given.numbers("x")?.into_iter().zip(given.numbers("y")?).collect();
    part_of(given, &PowerLaw::fit(&points)?)
}

/// Factor or exponent of the inverse of a power law.
///
/// Arguments: `of` the factor, `power` the exponent, and `part`. The inverse of y = c x^n is x = c^(-1/n) y^(1/n).
/// Claims 9-043.c, 9-043.d, 9-045 and 9-046.
fn inverse_law(given: &CheckArguments) -> Result<Finding, CheckError> {
    part_of(given, &PowerLaw::new(given.number("of")?, given.number("power")?).inverse())
}

/// The model slideway. KLP in kgf/mm2 replaces that of oil without polar additive. The model has 697 cm2 and a flank of
/// tangent 0.05.
fn interface(given: &CheckArguments) -> Result<Interface, CheckError> {
    let polar = given.number_or("KLP", Interface::MODEL.polar / KGF_PER_MM2)? * KGF_PER_MM2;
    Ok(Interface { polar, ..Interface::MODEL })
}

/// Fs of eq 12-9 in N, for a pressure Pw in kgf/cm2 or a weight W in kgf.
///
/// 10 A (0.009705 Pw^0.82 KLP + 0.05 Pw). The 10 is the study's N per kgf. Claims 9-021.a and b.
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

/// The laws for a table weight W of 450 or 850 kgf. The argument `W` is required.
fn oil_law(given: &CheckArguments) -> Result<OilLaw, CheckError> {
    Ok(given.choice("W", &[("450", OilLaw::AT_450_KGF), ("850", OilLaw::AT_850_KGF)])?)
}

/// Tc in s by eq 17-9 or 20-9, for a viscosity eta in P.
///
/// 11.16 eta^0.236 ms at 450 kgf, 8.3 eta^0.183 ms at 850 kgf. Claims 9-028 ... 9-039 compare it with Table T9-2.
fn oil_memory(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(oil_law(given)?.memory(given.number("eta")? * POISE)?))
}

/// Factor or exponent of eq 18-9 or 21-9, as it follows from the law of Tc and eq 6-9.
///
/// Cn = 3.3e4 Tc^1.54 K^0.077 (eq 6-9); the factor K^0.077 is left out. Claims 9-044 and 9-047.
fn oil_slope_law(given: &CheckArguments) -> Result<Finding, CheckError> {
    part_of(given, &oil_law(given)?.derived_slope())
}

/// Checks that the constants of eq 24-9 or 25-9 are smaller for the heavy table than for the light one.
///
/// Argument `of`: `slope` or `memory`. Both factor and exponent must be smaller. Claims 9-051 and 9-052.
fn oil_laws_fall(given: &CheckArguments) -> Result<Finding, CheckError> {
    type Law = fn(&OilLaw) -> PowerLaw;
    let laws: [(&str, Law); 2] = [("slope", |law| law.slope), ("memory", |law| law.memory)];
    let law = given.choice("of", &laws)?;
    let (light, heavy) = (law(&OilLaw::AT_450_KGF), law(&OilLaw::AT_850_KGF));
    let holds = heavy.factor < light.factor && heavy.exponent < light.exponent;
    let found = format!("{} -> {}, {} -> {}", light.factor, heavy.factor, light.exponent, heavy.exponent);
    Ok(Finding::shape(holds, found))
}

/// Checks that the heavy table has a smaller critical slope, for oils of `eta` in P.
///
/// The finding lists the ratios of heavy to light. Claim 9-053.
fn heavier_bears_less(given: &CheckArguments) -> Result<Finding, CheckError> {
    let ratio = |poise: &f64| OilLaw::AT_850_KGF.slope.at(*poise) / OilLaw::AT_450_KGF.slope.at(*poise);
    let ratios: Vec<f64> = given.numbers("eta")?.iter().map(ratio).collect();
    let found = format!("{ratios:.3?} times the slope");
    Ok(Finding::shape(ratios.iter().all(|ratio| *ratio < 1.0), found))
}

/// Factor or exponent of the law through the cells of Table T9-2: Tc in ms against viscosity in P, or the reverse.
/// `without` omits the cell with this Tc in s.
///
/// Arguments: `of` (`Tc` or `eta`), `without`, `part`. The study drew its lines by eye: 36e-6 Tc^4.238 (eq 16-9) and
/// 11.16 eta^0.236 (eq 17-9). Claims 9-042 and 9-043.
fn table_fit(given: &CheckArguments) -> Result<Finding, CheckError> {
    let omitted = given.number_or("without", 0.0)?;
    let cells = TABLE_9_2.iter().filter(|cell| cell.memory != omitted);
    let of_memory = given.choice("of", &[("Tc", true), ("eta", false)])?;
    let points: Vec<_> = cells
        .map(|cell| (cell.viscosity / POISE, cell.memory / MS))
        .map(|(viscosity, memory)| if of_memory { (viscosity, memory) } else { (memory, viscosity) })
        .collect();
    part_of(given, &PowerLaw::fit(&points)?)
}

/// The cell of Table T9-2 for a viscosity in P and a stiffness in N/mm.
///
/// # Errors
/// If the table has no such cell.
fn cell(given: &CheckArguments) -> Result<Measurement, CheckError> {
    let (viscosity, stiffness) = (given.number("eta")? * POISE, given.number("K")? * N_PER_MM);
    let is_equal = |one: f64, other: f64| (one / other - 1.0).abs() < 1e-9;
    let found = TABLE_9_2
        .iter()
        .find(|cell| is_equal(cell.viscosity, viscosity) && is_equal(cell.stiffness, stiffness));
    found.copied().ok_or_else(|| {
        let reason = format!("the table has none for {viscosity} Pa s and {stiffness} N/m");
        SlidewayError::NoSolution { sought: "cell of Table T9-2", reason }.into()
    })
}

/// Cn in N s/mm for a cell of Table T9-2, by eq 6-9.
///
/// 3.3e4 Tc^1.54 K^0.077. Claims 9-028.c ... 9-039.c: the scan lost Table T9-1.
fn table_slope(given: &CheckArguments) -> Result<Finding, CheckError> {
    let cell = cell(given)?;
    Ok(Finding::Number(simulated::slope(cell.memory, cell.stiffness)? / N_S_PER_MM))
}

/// The measured critical velocity in mm/s of a cell of Table T9-2, by eq 7-9.
///
/// VcL - Cn VcL^2 / (2 Fs) with Fs = 1249 N. Claims 9-028.v ... 9-039.v and 9-036.d.
fn table_velocity(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(cell(given)?.critical_velocity()? / MM_PER_S))
}

/// Tc in s by eq 15-9, for a critical velocity Vc in mm/s and the conditions of a cell of Table T9-2.
///
/// Eq 15-9 is the inverse of eq 6-9 for the slope of friction at Vc. Claim 9-036.e: 16 mm/s give 6.8 ms, not 5.9.
fn table_memory(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (cell, velocity) = (cell(given)?, given.number("Vc")? * MM_PER_S);
    Ok(Finding::Number(memory_from_critical_velocity(&cell.friction(), velocity, cell.stiffness)?))
}

/// Checks that eq 15-9 recovers every cell of Table T9-2 from its critical velocity.
///
/// To 1e-9. Claim 9-036.f.
fn table_and_back(_: &CheckArguments) -> Result<Finding, CheckError> {
    let mut worst: f64 = 0.0;
    for cell in &TABLE_9_2 {
        let velocity = cell.critical_velocity()?;
        let memory = memory_from_critical_velocity(&cell.friction(), velocity, cell.stiffness)?;
        worst = worst.max((memory / cell.memory - 1.0).abs());
    }
    Ok(Finding::truth(worst < 1e-9, format!("all {} cells", TABLE_9_2.len())))
}

/// Checks that Tc distinguishes the oils of Table T9-2 at every stiffness: the largest Tc of an oil is below the
/// smallest of the next thicker oil.
///
/// Claim 9-041. The finding states by how much Tc of each oil varies between the three drives.
fn oils_apart(_: &CheckArguments) -> Result<Finding, CheckError> {
    let rows: Vec<[f64; 3]> =
        (0..4).map(|oil| [0, 4, 8].map(|drive| TABLE_9_2[oil + drive].memory / MS)).collect();
    let most = |row: &[f64; 3]| row.iter().copied().fold(0.0, f64::max);
    let least = |row: &[f64; 3]| row.iter().copied().fold(f64::INFINITY, f64::min);
    let spreads: Vec<f64> = rows.iter().map(|row| 100.0 * (most(row) / least(row) - 1.0)).collect();
    let holds = rows.windows(2).all(|pair| most(&pair[0]) < least(&pair[1]));
    Ok(Finding::shape(holds, format!("Tc varies with stiffness by {spreads:.1?} %, thinnest oil first")))
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
    let found = format!("a change of 1 % gives {}", spanned(&percents, " %"));
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
    let found = format!("{} times as much", spanned(&ratios, ""));
    Ok(Finding::shape(ratios.iter().all(|ratio| *ratio < 1.0), found))
}

/// The minimum and the maximum of numbers, as text.
fn spanned(numbers: &[f64], unit: &str) -> String {
    let least = numbers.iter().copied().fold(f64::INFINITY, f64::min);
    let most = numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    format!("{least:.3}{unit} ... {most:.3}{unit}")
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
    let found = format!("left side / right side {}", spanned(&ratios, ""));
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
    Ok(Finding::truth(holds, format!("at KLP of {}", spanned(&limits, " kgf/mm2"))))
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

/// Checks that by eq 7-9 the critical velocity of the measured slideway falls with the change named by `by`: less Fs,
/// more Tc or more K.
///
/// Arguments: `by`, `Tc` in s and `K` in N/m. VcL is 40 mm/s and Fs 1249 N. The changes are steps of 10 %. Claims
/// 9-007.a ... c.
fn simulated_trend(given: &CheckArguments) -> Result<Finding, CheckError> {
    type Change = fn(f64) -> [f64; 3];
    let changes: [(&str, Change); 3] = [
        ("Fs", |factor| [1.0 / factor, 1.0, 1.0]),
        ("Tc", |factor| [1.0, factor, 1.0]),
        ("K", |factor| [1.0, 1.0, factor]),
    ];
    let change = given.choice("by", &changes)?;
    let velocity = |factor: f64| -> Result<f64, CheckError> {
        let [static_friction, memory, stiffness] = change(factor);
        let friction = FallingFriction { static_friction: STATIC_FRICTION * static_friction, limit: 0.04 };
        let slope = simulated::slope(memory * given.number("Tc")?, stiffness * given.number("K")?)?;
        Ok(friction.velocity_at_slope(slope)? / MM_PER_S)
    };
    let velocities = [velocity(1.0)?, velocity(1.1)?, velocity(1.2)?];
    let falls = velocities.windows(2).all(|pair| pair[1] < pair[0]);
    Ok(Finding::shape(falls, format!("{velocities:.2?} mm/s in steps of 10 %, at VcL = 40 mm/s")))
}
