//! Small motions of the slideway: natural frequencies, Routh-Hurwitz (8.2, 8.5, 9.4 (i)).

use nalgebra::Matrix3;

use super::super::finding::Finding;
use super::super::given::Given;
use super::{Check, CheckError};
use crate::slideway::SlidewayError;
use crate::slideway::falling::{FallingFriction, worst_limit};
use crate::slideway::power_law::PowerLaw;
use crate::slideway::simulated::SLOPE_BY_MEMORY;
use crate::slideway::stability::{DrivenTable, Groups, PRINTED_BY_MEMORY};
use crate::slideway::units::{MM_PER_S, N_S_PER_MM};

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

/// The study's final setting (8.4), with what is given instead: M, K, f, Tc.
pub(super) fn table(given: &Given) -> Result<DrivenTable, CheckError> {
    let study = DrivenTable::simulated(0.0);
    Ok(DrivenTable {
        mass: given.number_or("M", study.mass)?,
        stiffness: given.number_or("K", study.stiffness)?,
        damping: given.number_or("f", study.damping)?,
        memory: given.number_or("Tc", study.memory)?,
    })
}

/// wn in rad/s.
fn natural_frequency(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(table(given)?.natural_frequency()?))
}

/// wn in Hz.
fn natural_hertz(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(table(given)?.natural_frequency()? / std::f64::consts::TAU))
}

/// zeta of the table without solid friction.
fn damping_ratio(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(table(given)?.damping_ratio()?))
}

/// Cn of eq 32-9 in N s/mm.
fn critical_slope(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(table(given)?.critical_slope()? / N_S_PER_MM))
}

/// The frequency of eq 40-9 in rad/s.
fn boundary_frequency(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(table(given)?.boundary_frequency()?))
}

/// Factor or exponent of the power law through eq 32-9, over time constants in s or stiffnesses in N/m.
fn slope_fit(given: &Given) -> Result<Finding, CheckError> {
    type Fit = fn(&DrivenTable, &[f64]) -> Result<PowerLaw, SlidewayError>;
    let fits: [(&str, Fit); 2] =
        [("Tc", DrivenTable::slope_by_memory), ("K", DrivenTable::slope_by_stiffness)];
    let fit = given.word("by", &fits)?;
    let law = fit(&table(given)?, &given.numbers("over")?)?;
    part_of(given, &law)
}

/// The part of a power law that is asked for: factor or exponent.
pub(super) fn part_of(given: &Given, law: &PowerLaw) -> Result<Finding, CheckError> {
    let parts = [("factor", law.factor), ("exponent", law.exponent)];
    Ok(Finding::Number(given.word("part", &parts)?))
}

/// That eq 27-9 turns where the roots of the denominator of eq 26-9 pass the imaginary axis.
fn routh_and_roots(given: &Given) -> Result<Finding, CheckError> {
    let table = table(given)?;
    let critical = table.critical_slope()?;
    let [below, above] = [0.99, 1.01].map(|share| growth(&table, share * critical));
    let (below, above) = (below?, above?);
    let holds = table.is_stable(0.99 * critical)? && !table.is_stable(1.01 * critical)?;
    let found = format!("largest real part {below:.3} 1/s 1 % below the boundary, {above:.3} 1/s 1 % above");
    Ok(Finding::truth(holds && below < 0.0 && above > 0.0, found))
}

/// The largest real part of the roots, in 1/s.
fn growth(table: &DrivenTable, slope: f64) -> Result<f64, SlidewayError> {
    let [cube, square, line, constant] = table.characteristic(slope)?;
    // In units of the natural frequency, so that the companion matrix is balanced.
    let unit = table.natural_frequency()?;
    let row = [square / cube / unit, line / cube / unit.powi(2), constant / cube / unit.powi(3)];
    let companion = Matrix3::new(-row[0], -row[1], -row[2], 1.0, 0.0, 0.0, 0.0, 1.0, 0.0);
    let roots = companion.complex_eigenvalues();
    Ok(unit * roots.iter().map(|root| root.re).fold(f64::NEG_INFINITY, f64::max))
}

/// That eq 36-9 is eq 32-9 in the numbers of eq 33-9 ... 35-9.
fn routh_in_groups(given: &Given) -> Result<Finding, CheckError> {
    let table = table(given)?;
    let groups = table.groups(table.critical_slope()?)?;
    let boundary = Groups::boundary(groups.stiffness, groups.damping);
    let found = format!("A = {:.4}, C = {:.4}, B = {:.4}", groups.stiffness, groups.damping, groups.slope);
    Ok(Finding::truth((boundary / groups.slope - 1.0).abs() < 1e-9, found))
}

/// That sliding is stable at velocities at which all friction still falls.
fn stable_while_falling(given: &Given) -> Result<Finding, CheckError> {
    let table = table(given)?;
    let friction = FallingFriction::simulated(given.number("VcL")?);
    let critical = table.critical_velocity(&friction)?;
    let least = friction.velocity_of_least(table.damping)?;
    let found = format!("stable from {:.2} mm/s, falling until {:.2}", critical / MM_PER_S, least / MM_PER_S);
    Ok(Finding::shape(critical < least, found))
}

/// A setting of the table.
type Setting = fn(&mut DrivenTable) -> &mut f64;

/// The setting that a trend is by.
fn turned(given: &Given) -> Result<Setting, CheckError> {
    let parts: [(&str, Setting); 4] = [
        ("M", |table| &mut table.mass),
        ("K", |table| &mut table.stiffness),
        ("f", |table| &mut table.damping),
        ("Tc", |table| &mut table.memory),
    ];
    Ok(given.word("by", &parts)?)
}

/// Values of a quantity at half, once and twice a setting.
fn over_settings(
    given: &Given,
    value: impl Fn(&DrivenTable) -> Result<f64, SlidewayError>,
) -> Result<[f64; 3], CheckError> {
    let (table, turned) = (table(given)?, turned(given)?);
    let at = |factor: f64| {
        let mut changed = table;
        *turned(&mut changed) *= factor;
        value(&changed)
    };
    Ok([at(0.5)?, at(1.0)?, at(2.0)?])
}

/// Whether values rise or fall, as `way` says, told in a unit.
fn trend(given: &Given, values: [f64; 3], unit: &str) -> Result<Finding, CheckError> {
    let sign = given.word("way", &[("rises", 1.0), ("falls", -1.0)])?;
    let holds = values.windows(2).all(|pair| sign * (pair[1] - pair[0]) > 0.0);
    let [half, once, twice] = values;
    Ok(Finding::shape(
        holds,
        format!("{half:.3}, {once:.3}, {twice:.3} {unit} at half, once and twice of it"),
    ))
}

/// Whether the critical slope rises or falls with M, K, f or Tc.
fn slope_trend(given: &Given) -> Result<Finding, CheckError> {
    let values = over_settings(given, |table| Ok(table.critical_slope()? / N_S_PER_MM))?;
    trend(given, values, "N s/mm")
}

/// Whether the critical velocity rises or falls with M, K, f or Tc, at one VcL.
fn critical_velocity_trend(given: &Given) -> Result<Finding, CheckError> {
    let friction = FallingFriction::simulated(given.number("VcL")?);
    let values = over_settings(given, |table| Ok(table.critical_velocity(&friction)? / MM_PER_S))?;
    trend(given, values, "mm/s")
}

/// Whether the highest critical velocity that any VcL gives rises or falls with M, K, f or Tc.
fn highest_velocity_trend(given: &Given) -> Result<Finding, CheckError> {
    let static_friction = FallingFriction::simulated(1.0).static_friction;
    let values = over_settings(given, |table| {
        let limit = worst_limit(static_friction, table.critical_slope()?)?;
        Ok(table.critical_velocity(&FallingFriction { static_friction, limit })? / MM_PER_S)
    })?;
    trend(given, values, "mm/s")
}

/// That the critical slope follows Tc more closely than any other setting.
fn memory_leads(given: &Given) -> Result<Finding, CheckError> {
    let study = table(given)?;
    let percent = |turn: fn(&mut DrivenTable, f64)| -> Result<f64, SlidewayError> {
        let mut changed = study;
        turn(&mut changed, 1.0001);
        Ok((changed.critical_slope()? / study.critical_slope()?).ln() / 1.0001f64.ln())
    };
    let memory = percent(|table, factor| table.memory *= factor)?;
    let stiffness = percent(|table, factor| table.stiffness *= factor)?;
    let mass = percent(|table, factor| table.mass *= factor)?;
    let found = format!("1 % of Tc makes {memory:+.2} %, of K {stiffness:+.2} %, of M {mass:+.2} %");
    Ok(Finding::shape(memory > stiffness.abs().max(mass.abs()), found))
}

/// That eq 37-9 lies above eq 1-9 at all time constants given.
fn theory_above_simulation(given: &Given) -> Result<Finding, CheckError> {
    let ratio = |memory: &f64| PRINTED_BY_MEMORY.at(*memory) / SLOPE_BY_MEMORY.at(*memory);
    let ratios: Vec<f64> = given.numbers("Tc")?.iter().map(ratio).collect();
    let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
    let most = ratios.iter().copied().fold(0.0, f64::max);
    Ok(Finding::shape(least > 1.0, format!("{least:.2} ... {most:.2} times as steep")))
}
