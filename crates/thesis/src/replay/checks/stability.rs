//! Claims on small motions of the slideway: natural frequencies and Routh-Hurwitz (8.2, 8.5, 9.4 (i)).
//!
//! The characteristic equation is M s^2 + f s - Cn s / (1 + Tc s) + K = 0. Its solutions decay as long as (M + f Tc)(K
//! Tc + f - Cn) is larger than M K Tc (eq 27-9). Cn is positive while friction falls.

use nalgebra::Matrix3;

use super::super::check_arguments::CheckArguments;
use super::super::finding::Finding;
use super::super::series::{TRENDS, format_list, min_max};
use super::{Check, CheckError};
use crate::slideway::SlidewayError;
use crate::slideway::falling::{FallingFriction, worst_limit};
use crate::slideway::power_law::PowerLaw;
use crate::slideway::simulated::SLOPE_BY_MEMORY;
use crate::slideway::stability::{DrivenTable, Groups, PRINTED_BY_MEMORY};
use crate::slideway::units::{MM_PER_S, N_S_PER_MM};

/// The checks of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[
    Check { name: "natural-frequency", run: natural_frequency },
    Check { name: "natural-hertz", run: natural_hertz },
    Check { name: "damping-ratio", run: damping_ratio },
    Check { name: "critical-slope", run: critical_slope },
    Check { name: "boundary-frequency", run: boundary_frequency },
    Check { name: "slope-fit", run: slope_fit },
    Check { name: "routh-and-roots", run: routh_and_roots },
    Check { name: "routh-in-groups", run: routh_in_groups },
    Check { name: "stable-while-falling", run: stable_while_falling },
    Check { name: "slope-trend", run: slope_trend },
    Check { name: "memory-leads", run: memory_leads },
    Check { name: "theory-above-simulation", run: theory_above_simulation },
    Check { name: "critical-velocity-trend", run: critical_velocity_trend },
    Check { name: "highest-velocity-trend", run: highest_velocity_trend },
];

/// The table of the thesis's final setting (8.4) without lag. M, K, f and Tc in SI units replace its values.
///
/// Defaults are M = 433 kg, K = 45 kN/mm, f = 10.7 N s/mm and Tc = 0. The thesis analyses with f = 10.71 N s/mm, so
/// those rows give `f`.
pub(super) fn table(given: &CheckArguments) -> Result<DrivenTable, CheckError> {
    let thesis = DrivenTable::simulated(0.0);
    Ok(DrivenTable {
        mass: given.number_or("M", thesis.mass)?,
        stiffness: given.number_or("K", thesis.stiffness)?,
        damping: given.number_or("f", thesis.damping)?,
        memory: given.number_or("Tc", thesis.memory)?,
    })
}

/// Natural frequency wn in rad/s.
///
/// wn = sqrt(K / M) (eq 11-8). Claims 8-026, 9-169.a and b.
fn natural_frequency(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(table(given)?.natural_frequency()?))
}

/// Natural frequency wn in Hz.
///
/// Claims 4-004.a, 4-004.b and 8-153: 51.3 Hz for the final circuit, where the caption of Fig 8.34 has 51.9.
fn natural_hertz(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(table(given)?.natural_frequency()? / std::f64::consts::TAU))
}

/// Damping ratio zeta of the table without solid friction.
///
/// zeta = f / (2 sqrt(M K)) (eq 12-8). Claim 8-027.
fn damping_ratio(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(table(given)?.damping_ratio()?))
}

/// Cn of eq 32-9 in N s/mm.
///
/// Cn = f + f K Tc^2 / (M + f Tc). Without lag it is f. Claims 8-146, 9-008, 9-064.c and 9-066.c.
fn critical_slope(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(table(given)?.critical_slope()? / N_S_PER_MM))
}

/// The frequency of eq 40-9 in rad/s.
///
/// w = sqrt(K / (M + f Tc)): f Tc adds to the mass, so it is below the natural frequency. Claims 4-110, 9-069.a and b.
fn boundary_frequency(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(table(given)?.boundary_frequency()?))
}

/// Factor or exponent of the power law fitted to eq 32-9, over time constants in s or stiffnesses in N/m.
///
/// Arguments: `by` (`Tc` or `K`), `over`, `part`. Slopes are in N s/mm, time constants in s, stiffnesses in N/mm. The
/// thesis drew 12.95e4 Tc^1.55 (eq 37-9) and 0.0385 K^0.685 (eq 38-9) and does not print its points. Claims 9-064.a,
/// 9-064.b, 9-064.d, 9-066.a and 9-066.b.
fn slope_fit(given: &CheckArguments) -> Result<Finding, CheckError> {
    type Fit = fn(&DrivenTable, &[f64]) -> Result<PowerLaw, SlidewayError>;
    let fits: [(&str, Fit); 2] =
        [("Tc", DrivenTable::slope_by_memory), ("K", DrivenTable::slope_by_stiffness)];
    let fit = given.choice("by", &fits)?;
    let law = fit(&table(given)?, &given.numbers("over")?)?;
    part_of(given, &law)
}

/// Factor or exponent of a power law, as `part` selects.
///
/// Argument `part`: `factor` or `exponent` of y = factor x^exponent. Other files use this function too.
pub(super) fn part_of(given: &CheckArguments, law: &PowerLaw) -> Result<Finding, CheckError> {
    let parts = [("factor", law.factor), ("exponent", law.exponent)];
    Ok(Finding::Number(given.choice("part", &parts)?))
}

/// Checks that the boundary of eq 27-9 is where the roots of the denominator of eq 26-9 cross the imaginary axis.
///
/// The largest real part of the roots must be negative 1 % below the critical slope and positive 1 % above it. Claim
/// 9-055.
fn routh_and_roots(given: &CheckArguments) -> Result<Finding, CheckError> {
    let table = table(given)?;
    let critical = table.critical_slope()?;
    let [below, above] = [0.99, 1.01].map(|share| growth(&table, share * critical));
    let (below, above) = (below?, above?);
    let holds = table.is_stable(0.99 * critical)? && !table.is_stable(1.01 * critical)?;
    let found = format!("largest real part {below:.3} 1/s 1 % below the boundary, {above:.3} 1/s 1 % above");
    Ok(Finding::truth(holds && below < 0.0 && above > 0.0, found))
}

/// The largest real part of the roots, in 1/s.
///
/// The roots of the cubic M Tc s^3 + (M + f Tc) s^2 + (K Tc + f - Cn) s + K are the eigenvalues of its companion
/// matrix. `slope` is Cn in N s/m. A positive result means that small motions grow.
fn growth(table: &DrivenTable, slope: f64) -> Result<f64, SlidewayError> {
    let [cube, square, line, constant] = table.characteristic(slope)?;
    // In units of the natural frequency, so that the companion matrix is balanced.
    let unit = table.natural_frequency()?;
    let row = [square / cube / unit, line / cube / unit.powi(2), constant / cube / unit.powi(3)];
    let companion = Matrix3::new(-row[0], -row[1], -row[2], 1.0, 0.0, 0.0, 0.0, 1.0, 0.0);
    let roots = companion.complex_eigenvalues();
    Ok(unit * roots.iter().map(|root| root.re).fold(f64::NEG_INFINITY, f64::max))
}

/// Checks that eq 36-9 is eq 32-9 in the dimensionless groups of eq 33-9 ... 35-9.
///
/// A = K Tc^2 / M, B = Cn Tc / M, C = f Tc / M, and on the boundary B = C + A C / (1 + C). The thesis has the opposite
/// sign of B. Claim 9-060.
fn routh_in_groups(given: &CheckArguments) -> Result<Finding, CheckError> {
    let table = table(given)?;
    let groups = table.groups(table.critical_slope()?)?;
    let boundary = Groups::boundary(groups.stiffness, groups.damping);
    let found = format!("A = {:.4}, C = {:.4}, B = {:.4}", groups.stiffness, groups.damping, groups.slope);
    Ok(Finding::truth((boundary / groups.slope - 1.0).abs() < 1e-9, found))
}

/// Checks that sliding is stable at velocities at which total friction still falls.
///
/// Claims 2-034, 4-024 and 9-061. The critical velocity must be below the velocity of least friction.
fn stable_while_falling(given: &CheckArguments) -> Result<Finding, CheckError> {
    let table = table(given)?;
    let friction = FallingFriction::simulated(given.number("VcL")?);
    let critical = table.critical_velocity(&friction)?;
    let least = friction.velocity_of_least(table.damping)?;
    let found = format!("stable from {:.2} mm/s, falling until {:.2}", critical / MM_PER_S, least / MM_PER_S);
    Ok(Finding::shape(critical < least, found))
}

/// Selects a parameter of the table.
type TableParameter = fn(&mut DrivenTable) -> &mut f64;

/// The parameter of the table that `by` selects.
///
/// `M`, `K`, `f` or `Tc`. The returned function gives write access to this field of a table.
fn varied(given: &CheckArguments) -> Result<TableParameter, CheckError> {
    let parts: [(&str, TableParameter); 4] = [
        ("M", |table| &mut table.mass),
        ("K", |table| &mut table.stiffness),
        ("f", |table| &mut table.damping),
        ("Tc", |table| &mut table.memory),
    ];
    Ok(given.choice("by", &parts)?)
}

/// Values of a quantity at 0.5, 1 and 2 times a parameter.
///
/// The other parameters keep the values of the claim.
fn over_parameter(
    given: &CheckArguments,
    value: impl Fn(&DrivenTable) -> Result<f64, SlidewayError>,
) -> Result<[f64; 3], CheckError> {
    let (table, varied) = (table(given)?, varied(given)?);
    let at = |factor: f64| {
        let mut changed = table;
        *varied(&mut changed) *= factor;
        value(&changed)
    };
    Ok([at(0.5)?, at(1.0)?, at(2.0)?])
}

/// Checks whether values rise or fall, as `way` states.
///
/// `way` is `rises` or `falls`. Both steps, from half to once and from once to twice, must have that sign.
fn trend(given: &CheckArguments, values: [f64; 3], unit: &str) -> Result<Finding, CheckError> {
    let has_trend = given.choice("way", &TRENDS)?;
    let found = format!("{} at 0.5, 1 and 2 times the value", format_list(&values, 3, unit));
    Ok(Finding::shape(has_trend(&values), found))
}

/// Checks whether the critical slope rises or falls with M, K, f or Tc.
///
/// Eq 32-9. Claims 8-137.b, 9-062, 9-063.a, 9-063.b and 9-070.
fn slope_trend(given: &CheckArguments) -> Result<Finding, CheckError> {
    let values = over_parameter(given, |table| Ok(table.critical_slope()? / N_S_PER_MM))?;
    trend(given, values, "N s/mm")
}

/// Checks whether the critical velocity rises or falls with M, K, f or Tc, at one VcL.
///
/// The critical velocity is VcL - Cn VcL^2 / (2 Fs) with Cn of eq 32-9. Claims 8-155.b, 9-068, 9-198.c and 10-006.
fn critical_velocity_trend(given: &CheckArguments) -> Result<Finding, CheckError> {
    let friction = FallingFriction::simulated(given.number("VcL")?);
    let values = over_parameter(given, |table| Ok(table.critical_velocity(&friction)? / MM_PER_S))?;
    trend(given, values, "mm/s")
}

/// Checks whether the highest critical velocity over all VcL rises or falls with M, K, f or Tc.
///
/// The highest critical velocity is Fs / (2 Cn), at VcL = Fs / Cn (eq 44-8, 45-8). The static friction is that of the
/// simulation. Claim 8-142.
fn highest_velocity_trend(given: &CheckArguments) -> Result<Finding, CheckError> {
    let static_friction = FallingFriction::simulated(1.0).static_friction;
    let values = over_parameter(given, |table| {
        let limit = worst_limit(static_friction, table.critical_slope()?)?;
        Ok(table.critical_velocity(&FallingFriction { static_friction, limit })? / MM_PER_S)
    })?;
    trend(given, values, "mm/s")
}

/// Checks that Tc has a larger relative influence on the critical slope than K and M.
///
/// Influence is the relative change of Cn by the relative change of a parameter, from a step of 0.01 %. Claim 9-063.c.
fn memory_leads(given: &CheckArguments) -> Result<Finding, CheckError> {
    let thesis = table(given)?;
    let percent = |change: fn(&mut DrivenTable, f64)| -> Result<f64, SlidewayError> {
        let mut changed = thesis;
        change(&mut changed, 1.0001);
        Ok((changed.critical_slope()? / thesis.critical_slope()?).ln() / 1.0001f64.ln())
    };
    let memory = percent(|table, factor| table.memory *= factor)?;
    let stiffness = percent(|table, factor| table.stiffness *= factor)?;
    let mass = percent(|table, factor| table.mass *= factor)?;
    let found = format!(
        "1 % of Tc changes it by {memory:+.2} %, 1 % of K by {stiffness:+.2} %, 1 % of M by {mass:+.2} %"
    );
    Ok(Finding::shape(memory > stiffness.abs().max(mass.abs()), found))
}

/// Checks that eq 37-9 gives steeper slopes than eq 1-9 at all time constants.
///
/// Eq 37-9 is the thesis's fit to Routh-Hurwitz, eq 1-9 its fit to the simulation. Claim 9-065.
fn theory_above_simulation(given: &CheckArguments) -> Result<Finding, CheckError> {
    let ratio = |memory: &f64| PRINTED_BY_MEMORY.at(*memory) / SLOPE_BY_MEMORY.at(*memory);
    let ratios: Vec<f64> = given.numbers("Tc")?.iter().map(ratio).collect();
    let (min, max) = min_max(ratios);
    Ok(Finding::shape(min > 1.0, format!("{min:.2} ... {max:.2} times as steep")))
}
