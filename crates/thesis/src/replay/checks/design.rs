//! The design equations and what was measured (9.2, 9.3, 9.5, 10).

use super::super::finding::Finding;
use super::super::given::Given;
use super::stability::part_of;
use super::{Check, CheckError};
use crate::slideway::design::{CONTACT_SHARE, Design, DesignEquation, Interface, Trends, limit_velocity};
use crate::slideway::falling::FallingFriction;
use crate::slideway::measured::{Measurement, STATIC_FRICTION, TABLE_9_2};
use crate::slideway::power_law::PowerLaw;
use crate::slideway::simulated::{OilLaw, memory_from_critical_velocity};
use crate::slideway::units::{KGF, KGF_PER_CM2, KGF_PER_MM2, MM_PER_S, MS, N_PER_MM, N_S_PER_MM, POISE, UM};
use crate::slideway::{SlidewayError, simulated};

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
fn power_through(given: &Given) -> Result<Finding, CheckError> {
    let points: Vec<_> = given.numbers("x")?.into_iter().zip(given.numbers("y")?).collect();
    part_of(given, &PowerLaw::fit(&points)?)
}

/// Factor or exponent of a power law turned round.
fn inverse_law(given: &Given) -> Result<Finding, CheckError> {
    part_of(given, &PowerLaw::new(given.number("of")?, given.number("power")?).inverse())
}

/// The model slideway, with what is given instead: KLP in kgf/mm2.
fn interface(given: &Given) -> Result<Interface, CheckError> {
    let polar = given.number_or("KLP", Interface::MODEL.polar / KGF_PER_MM2)? * KGF_PER_MM2;
    Ok(Interface { polar, ..Interface::MODEL })
}

/// Fs of eq 12-9 in N: under Pw in kgf/cm2, or a weight W in kgf.
fn static_friction(given: &Given) -> Result<Finding, CheckError> {
    let interface = interface(given)?;
    let pressure = match given.text("W") {
        Some(_) => given.number("W")? * KGF / interface.area,
        None => given.number("Pw")? * KGF_PER_CM2,
    };
    Ok(Finding::Number(interface.static_friction(pressure)?))
}

/// A factor of eq 13-9 in N.
fn static_friction_factor(given: &Given) -> Result<Finding, CheckError> {
    let [shear, climb] = interface(given)?.static_friction_factors()?;
    Ok(Finding::Number(given.word("of", &[("shear", shear), ("climb", climb)])?))
}

/// The laws of a table weight.
fn oil_law(given: &Given) -> Result<OilLaw, CheckError> {
    Ok(given.word("W", &[("450", OilLaw::AT_450_KGF), ("850", OilLaw::AT_850_KGF)])?)
}

/// Tc in s by eq 17-9 or 20-9, for P.
fn oil_memory(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(oil_law(given)?.memory(given.number("eta")? * POISE)?))
}

/// Factor or exponent of eq 18-9 or 21-9, as Tc's law and eq 6-9 make it.
fn oil_slope_law(given: &Given) -> Result<Finding, CheckError> {
    part_of(given, &oil_law(given)?.derived_slope())
}

/// That the constants of eq 24-9 or 25-9 fall from the light table to the heavy one.
fn oil_laws_fall(given: &Given) -> Result<Finding, CheckError> {
    type Law = fn(&OilLaw) -> PowerLaw;
    let laws: [(&str, Law); 2] = [("slope", |law| law.slope), ("memory", |law| law.memory)];
    let law = given.word("of", &laws)?;
    let (light, heavy) = (law(&OilLaw::AT_450_KGF), law(&OilLaw::AT_850_KGF));
    let holds = heavy.factor < light.factor && heavy.exponent < light.exponent;
    let found = format!("{} -> {}, {} -> {}", light.factor, heavy.factor, light.exponent, heavy.exponent);
    Ok(Finding::shape(holds, found))
}

/// That the heavy table bears a smaller slope, with oils of `eta` in P.
fn heavier_bears_less(given: &Given) -> Result<Finding, CheckError> {
    let ratio = |poise: &f64| OilLaw::AT_850_KGF.slope.at(*poise) / OilLaw::AT_450_KGF.slope.at(*poise);
    let ratios: Vec<f64> = given.numbers("eta")?.iter().map(ratio).collect();
    let found = format!("{ratios:.3?} times the slope");
    Ok(Finding::shape(ratios.iter().all(|ratio| *ratio < 1.0), found))
}

/// The law through the cells of Table T9-2, Tc in ms by viscosity in P or the other way round; `without` leaves out the cell with that Tc in s.
fn table_fit(given: &Given) -> Result<Finding, CheckError> {
    let left_out = given.number_or("without", 0.0)?;
    let cells = TABLE_9_2.iter().filter(|cell| cell.memory != left_out);
    let of_memory = given.word("of", &[("Tc", true), ("eta", false)])?;
    let points: Vec<_> = cells
        .map(|cell| (cell.viscosity / POISE, cell.memory / MS))
        .map(|(viscosity, memory)| if of_memory { (viscosity, memory) } else { (memory, viscosity) })
        .collect();
    part_of(given, &PowerLaw::fit(&points)?)
}

/// The cell of Table T9-2 for a viscosity in P and a stiffness in N/mm.
fn cell(given: &Given) -> Result<Measurement, CheckError> {
    let (viscosity, stiffness) = (given.number("eta")? * POISE, given.number("K")? * N_PER_MM);
    let near = |one: f64, other: f64| (one / other - 1.0).abs() < 1e-9;
    let found =
        TABLE_9_2.iter().find(|cell| near(cell.viscosity, viscosity) && near(cell.stiffness, stiffness));
    found.copied().ok_or_else(|| {
        let because = format!("the table has none for {viscosity} Pa s and {stiffness} N/m");
        SlidewayError::NoSolution { sought: "cell of Table T9-2", because }.into()
    })
}

/// Cn in N s/mm behind a cell of Table T9-2, by eq 6-9.
fn table_slope(given: &Given) -> Result<Finding, CheckError> {
    let cell = cell(given)?;
    Ok(Finding::Number(simulated::slope(cell.memory, cell.stiffness)? / N_S_PER_MM))
}

/// The measured critical velocity in mm/s behind a cell of Table T9-2, by eq 7-9.
fn table_velocity(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(cell(given)?.critical_velocity()? / MM_PER_S))
}

/// Tc in s by eq 15-9 of a critical velocity in mm/s in a cell of Table T9-2.
fn table_memory(given: &Given) -> Result<Finding, CheckError> {
    let (cell, velocity) = (cell(given)?, given.number("Vc")? * MM_PER_S);
    Ok(Finding::Number(memory_from_critical_velocity(&cell.friction(), velocity, cell.stiffness)?))
}

/// That eq 15-9 gives every cell of Table T9-2 back from its critical velocity.
fn table_and_back(_: &Given) -> Result<Finding, CheckError> {
    let mut worst: f64 = 0.0;
    for cell in &TABLE_9_2 {
        let velocity = cell.critical_velocity()?;
        let memory = memory_from_critical_velocity(&cell.friction(), velocity, cell.stiffness)?;
        worst = worst.max((memory / cell.memory - 1.0).abs());
    }
    Ok(Finding::truth(worst < 1e-9, format!("all {} cells", TABLE_9_2.len())))
}

/// That every stiffness tells the oils of Table T9-2 apart by Tc: the largest of an oil is below the least of the next thicker one.
fn oils_apart(_: &Given) -> Result<Finding, CheckError> {
    let rows: Vec<[f64; 3]> =
        (0..4).map(|oil| [0, 4, 8].map(|drive| TABLE_9_2[oil + drive].memory / MS)).collect();
    let most = |row: &[f64; 3]| row.iter().copied().fold(0.0, f64::max);
    let least = |row: &[f64; 3]| row.iter().copied().fold(f64::INFINITY, f64::min);
    let spreads: Vec<f64> = rows.iter().map(|row| 100.0 * (most(row) / least(row) - 1.0)).collect();
    let holds = rows.windows(2).all(|pair| most(&pair[0]) < least(&pair[1]));
    Ok(Finding::shape(holds, format!("stiffness spreads Tc by {spreads:.1?} %, thinnest oil first")))
}

/// A constant of eq 93-9 as it follows from those before.
fn design_constant(given: &Given) -> Result<Finding, CheckError> {
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
    Ok(Finding::Number(given.word("of", &constants)?))
}

/// The designs of Table T9-2: four oils, three drives, 450 kgf.
fn designs() -> impl Iterator<Item = Design> {
    TABLE_9_2.iter().map(|cell| Design::model(cell.viscosity, cell.stiffness))
}

/// One of the trends.
type Trend = fn(&Trends) -> f64;

/// What a trend of eq 93-9 is by.
const TRENDS: [(&str, Trend); 7] = [
    ("viscosity", |trends| trends.viscosity),
    ("weight", |trends| trends.weight),
    ("stiffness", |trends| trends.stiffness),
    ("polar", |trends| trends.polar),
    ("lift", |trends| trends.lift),
    ("flank", |trends| trends.flank),
    ("area", |trends| trends.area),
];

/// Whether the critical velocity rises or falls with a quantity of eq 93-9 in every cell of Table T9-2.
fn design_trend(given: &Given) -> Result<Finding, CheckError> {
    let part = given.word("with", &TRENDS)?;
    let sign = given.word("way", &[("rises", 1.0), ("falls", -1.0)])?;
    let equation = DesignEquation::derived();
    let percents = designs()
        .map(|design| Ok(part(&equation.trends(&design)?)))
        .collect::<Result<Vec<f64>, SlidewayError>>()?;
    let found = format!("1 % of it makes {}", spanned(&percents, " %"));
    Ok(Finding::shape(percents.iter().all(|percent| sign * percent > 0.0), found))
}

/// That one quantity of eq 93-9 moves the critical velocity less than another in every cell of Table T9-2.
fn design_trend_smaller(given: &Given) -> Result<Finding, CheckError> {
    let (minor, major) = (given.word("of", &TRENDS)?, given.word("than", &TRENDS)?);
    let equation = DesignEquation::derived();
    let ratios = designs()
        .map(|design| equation.trends(&design).map(|trends| (minor(&trends) / major(&trends)).abs()))
        .collect::<Result<Vec<f64>, SlidewayError>>()?;
    let found = format!("{} times as much", spanned(&ratios, ""));
    Ok(Finding::shape(ratios.iter().all(|ratio| *ratio < 1.0), found))
}

/// Least and most of numbers, in words.
fn spanned(numbers: &[f64], unit: &str) -> String {
    let least = numbers.iter().copied().fold(f64::INFINITY, f64::min);
    let most = numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    format!("{least:.3}{unit} ... {most:.3}{unit}")
}

/// That the left side of eq 95-9 is the larger one in every cell of Table T9-2: that the slideway oscillates at some velocity.
fn design_oscillates(given: &Given) -> Result<Finding, CheckError> {
    let (equation, interface) = (DesignEquation::derived(), interface(given)?);
    let ratio = |design: Design| Ok(1.0 / equation.taken_off(&Design { interface, ..design })?);
    let ratios = designs().map(ratio).collect::<Result<Vec<f64>, SlidewayError>>()?;
    let found = format!("left by right side {}", spanned(&ratios, ""));
    Ok(Finding::shape(ratios.iter().all(|ratio| *ratio > 1.0), found))
}

/// That the printed eq 93-9 comes to 0 where eq 94-9 holds, in every cell of Table T9-2 whose KLP is made so: a thousandth above it there
/// is a critical velocity near 0, a thousandth below none.
fn design_ends(_: &Given) -> Result<Finding, CheckError> {
    let (equation, mut holds, mut strengths) = (DesignEquation::PRINTED, true, Vec::new());
    for design in designs() {
        let climb = equation.flank * design.interface.flank;
        let hold = design.interface.polar / KGF_PER_MM2 + climb;
        let edge = hold * equation.taken_off(&design)? - climb;
        let at = |share: f64| {
            let polar = share * edge * KGF_PER_MM2;
            equation
                .critical_velocity(&Design { interface: Interface { polar, ..design.interface }, ..design })
        };
        let is_small = at(1.001)? < 0.002 * equation.limit(&design)?;
        holds &= is_small && matches!(at(0.999), Err(SlidewayError::NoSolution { .. }));
        strengths.push(edge);
    }
    Ok(Finding::truth(holds, format!("where KLP is {}", spanned(&strengths, " kgf/mm2"))))
}

/// That Pw^0.82 tan for Pw tan changes static friction by no more than the machine's 2 %, under Pw in kgf/cm2.
fn flank_simplified(given: &Given) -> Result<Finding, CheckError> {
    let pressure = given.number("Pw")?;
    let [shear, climb] = Interface::MODEL.static_friction_factors()?;
    let shared = pressure.powf(CONTACT_SHARE.exponent);
    let percent = 100.0 * ((shear + climb) * shared / (shear * shared + climb * pressure) - 1.0);
    Ok(Finding::truth(percent.abs() <= 2.0, format!("static friction {percent:+.2} %")))
}

/// That a thin polar oil lowers Fs, raises VcL and makes the curve shallower, against the table's thickest without additive.
fn polar_and_thin(given: &Given) -> Result<Finding, CheckError> {
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

/// That eq 7-9 lets the critical velocity fall with what is asked for, on the measured slideway: less Fs, more Tc, more K.
fn simulated_trend(given: &Given) -> Result<Finding, CheckError> {
    type Change = fn(f64) -> [f64; 3];
    let changes: [(&str, Change); 3] = [
        ("Fs", |factor| [1.0 / factor, 1.0, 1.0]),
        ("Tc", |factor| [1.0, factor, 1.0]),
        ("K", |factor| [1.0, 1.0, factor]),
    ];
    let change = given.word("by", &changes)?;
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
