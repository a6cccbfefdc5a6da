//! Claims on the laws of the thesis's simulation, and on the measurements of Table T9-2 (9.2, 9.3).
//!
//! Arguments are in the units of chapter 9: `eta` in P, `W` in kgf, `K` in N/mm. [`simulated_trend`] takes SI units.

use super::super::check_arguments::CheckArguments;
use super::super::finding::Finding;
use super::super::series::{is_falling, min_max};
use super::stability::part_of;
use super::{Check, CheckError};
use crate::slideway::falling::FallingFriction;
use crate::slideway::measured::{Measurement, STATIC_FRICTION, TABLE_9_2};
use crate::slideway::power_law::PowerLaw;
use crate::slideway::simulated::{OilLaw, memory_from_critical_velocity};
use crate::slideway::units::{MM_PER_S, MS, N_PER_MM, N_S_PER_MM, POISE};
use crate::slideway::{SlidewayError, simulated};

/// The checks of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[
    Check { name: "power-through", run: power_through },
    Check { name: "inverse-law", run: inverse_law },
    Check { name: "oil-memory", run: oil_memory },
    Check { name: "oil-slope-law", run: oil_slope_law },
    Check { name: "oil-laws-fall-with-weight", run: oil_laws_fall },
    Check { name: "heavier-bears-less", run: heavier_bears_less },
    Check { name: "t92-fit", run: table_fit },
    Check { name: "t92-slope", run: table_slope },
    Check { name: "t92-velocity", run: table_velocity },
    Check { name: "t92-memory", run: table_memory },
    Check { name: "t92-and-back", run: table_and_back },
    Check { name: "t92-distinguishes-oils", run: distinguishes_oils },
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
/// Arguments: `of` (`Tc` or `eta`), `without`, `part`. The thesis drew its lines by eye: 36e-6 Tc^4.238 (eq 16-9) and
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
fn distinguishes_oils(_: &CheckArguments) -> Result<Finding, CheckError> {
    let rows = (0..4).map(|oil| [0, 4, 8].map(|drive| TABLE_9_2[oil + drive].memory / MS));
    let ranges: Vec<(f64, f64)> = rows.map(min_max).collect();
    let spreads: Vec<f64> = ranges.iter().map(|(min, max)| 100.0 * (max / min - 1.0)).collect();
    let holds = ranges.windows(2).all(|pair| pair[0].1 < pair[1].0);
    Ok(Finding::shape(holds, format!("Tc varies with stiffness by {spreads:.1?} %, thinnest oil first")))
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
    Ok(Finding::shape(
        is_falling(&velocities),
        format!("{velocities:.2?} mm/s in steps of 10 %, at VcL = 40 mm/s"),
    ))
}
