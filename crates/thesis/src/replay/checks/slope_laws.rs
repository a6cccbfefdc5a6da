//! Claims that are decided by many critical velocities: slopes of friction at which oscillation ends, and their
//! fitted laws.
//!
//! Cn is the slope of solid friction at the command at which oscillation ends, 2 Fs (VcL - Vc) / VcL^2. Two methods
//! find this command: a rising ramp, and small disturbances of steady sliding ([`boundary`](super::super::boundary)). A
//! ramp overruns the stability boundary, so it gives smaller slopes.

use super::super::boundary::{self, RATE, disturbance_boundary};
use super::super::check_arguments::CheckArguments;
use super::super::finding::Finding;
use super::super::series::{format_list, is_falling, min_max};
use super::{Check, CheckError};
use crate::slideway::falling::FallingFriction;
use crate::slideway::power_law::PowerLaw;
use crate::slideway::stability::DrivenTable;
use crate::slideway::units::{MM_PER_S, N_S_PER_MM};
use patchcord_analysis::instruments::Criterion;

/// The checks of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[
    Check { name: "slope-law", run: slope_law },
    Check { name: "slope-where-it-ends", run: slope_where_it_ends },
    Check { name: "slope-by-disturbance", run: slope_by_disturbance },
    Check { name: "slope-spread", run: slope_spread },
    Check { name: "slope-exponent-by-stiffness", run: slope_exponent_by_stiffness },
    Check { name: "highest-critical-velocity-falls", run: highest_critical_velocity_falls },
];

/// Exponent of Cn against Tc, or the factor in s and N s/mm. The slopes are from ramps, at the maximum of the curve
/// of each time constant.
///
/// The thesis has 7.5e4 Tc^1.54 (eq 1-9). Claims 9-003.a and b. VcL at the maxima is found once per process, from ramps
/// over the whole sweep, and cached.
fn slope_law(given: &CheckArguments) -> Result<Finding, CheckError> {
    type LawQuantity = fn(&PowerLaw) -> f64;
    let parts: [(&str, LawQuantity); 2] = [("exponent", |law| law.exponent), ("factor", |law| law.factor)];
    let part = given.choice("part", &parts)?;
    Ok(Finding::Number(part(&boundary::slopes_at_worst_limits()?.1)))
}

/// Cn in N s/mm from ramps, at the maximum of the curve of one time constant.
///
/// `Tc` in s must be one of the time constants of the sweep. Claims 9-003.c ... f.
fn slope_where_it_ends(given: &CheckArguments) -> Result<Finding, CheckError> {
    let memory = given.number("Tc")?;
    let (slopes, _) = boundary::slopes_at_worst_limits()?;
    let slope = slopes.iter().find(|(other, _)| *other == memory);
    slope
        .map(|(_, slope)| Finding::Number(*slope))
        .ok_or_else(|| CheckError::Run(format!("there is no ramp with Tc = {memory} s")))
}

/// Checks whether small disturbances of steady sliding stop growing at the slope of Routh-Hurwitz, to 2 %.
///
/// Arguments: `Tc` in s and `VcL` in m/s. Claims 9-003.g and h (eq 32-9).
fn slope_by_disturbance(given: &CheckArguments) -> Result<Finding, CheckError> {
    let memory = given.number("Tc")?;
    let theory = DrivenTable::simulated(memory).critical_slope()? / N_S_PER_MM;
    let run = disturbed_slope(memory, given.number("VcL")?)?;
    let holds = (run / theory - 1.0).abs() <= 0.02;
    Ok(Finding::truth(holds, format!("{run:.1} N s/mm by the circuit, {theory:.1} by Routh-Hurwitz")))
}

/// Cn in N s/mm at which small disturbances stop growing.
///
/// Arguments are Tc in s and VcL in m/s. The velocity between growth and decay is found to 0.05 % of VcL.
///
/// # Errors
/// If disturbances decay at every velocity.
fn disturbed_slope(memory: f64, limit: f64) -> Result<f64, CheckError> {
    let velocity = disturbance_boundary(&[("VcL", limit), ("Tc", memory)], limit)?;
    let velocity = velocity.ok_or_else(|| CheckError::Run("no disturbance grows".to_owned()))?;
    Ok(FallingFriction::simulated(limit).slope(velocity)? / N_S_PER_MM)
}

/// The spread of Cn over different VcL at one time constant, in percent of its mean.
///
/// Arguments: `Tc` in s, `VcL` in m/s as a list, and `by`, `ramp` or `disturbance`. Claims 8-136.a and b: by ramps the
/// spread is large, because a ramp overruns more for a smaller VcL.
///
/// # Errors
/// If fewer than three slopes were found.
fn slope_spread(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (memory, limits) = (given.number("Tc")?, given.numbers("VcL")?);
    let by_ramp = given.choice("by", &[("ramp", true), ("disturbance", false)])?;
    let slopes: Vec<f64> = if by_ramp {
        let settings: Vec<_> = limits.iter().map(|limit| (memory, *limit)).collect();
        let read = boundary::ramps(&settings, RATE, &[Criterion::USUAL.threshold])?;
        read[0].iter().filter_map(boundary::RampResult::slope).collect()
    } else {
        limits.iter().map(|limit| disturbed_slope(memory, *limit)).collect::<Result<_, _>>()?
    };
    if slopes.len() < 3 {
        return Err(CheckError::Run(format!("only {} of {} slopes were found", slopes.len(), limits.len())));
    }
    let mean = slopes.iter().sum::<f64>() / slopes.len() as f64;
    let (min, max) = min_max(slopes);
    Ok(Finding::Number(100.0 * (max - min) / mean))
}

/// Exponent of Cn against K, from ramps at VcL = 40 mm/s and Tc = 7.1 ms.
///
/// Argument `K`: stiffnesses in N/m. The thesis has 0.077 (eq 5-9, Fig 9.3). Claim 9-009.
fn slope_exponent_by_stiffness(given: &CheckArguments) -> Result<Finding, CheckError> {
    let velocities = boundary::velocities_by_stiffness(&given.numbers("K")?)?;
    Ok(Finding::Number(boundary::slopes_by_stiffness(&velocities)?.1.exponent))
}

/// Checks whether the highest critical velocity falls from each time constant to the next longer one.
///
/// Fig 8.30, claim 8-142.b. A time constant without a critical velocity is an error of the sweep, not a pass.
fn highest_critical_velocity_falls(_: &CheckArguments) -> Result<Finding, CheckError> {
    let velocities = boundary::max_critical_velocities()?
        .into_iter()
        .map(|velocity| velocity / MM_PER_S)
        .collect::<Vec<_>>();
    let holds = velocities.len() == boundary::MEMORIES.len() && is_falling(&velocities);
    Ok(Finding::shape(holds, format_list(&velocities, 1, "mm/s")))
}
