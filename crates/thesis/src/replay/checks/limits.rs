//! What many critical velocities together decide: slopes of friction at which oscillation ends, and the laws that fit them.

use super::super::boundary::{self, RATE, undisturbed};
use super::super::finding::Finding;
use super::super::given::Given;
use super::{Check, CheckError};
use crate::slideway::falling::FallingFriction;
use crate::slideway::power_law::PowerLaw;
use crate::slideway::stability::DrivenTable;
use crate::slideway::units::{MM_PER_S, N_S_PER_MM};
use patchcord_analysis::instruments::Criterion;

pub(super) const CHECKS: &[Check] = &[
    Check { name: "slope-law", run: slope_law },
    Check { name: "slope-where-it-ends", run: slope_where_it_ends },
    Check { name: "slope-by-disturbance", run: slope_by_disturbance },
    Check { name: "slope-spread", run: slope_spread },
    Check { name: "slope-exponent-by-stiffness", run: slope_exponent_by_stiffness },
    Check { name: "tops-fall", run: tops_fall },
];

/// Exponent of Cn against Tc, or the factor in s and N s/mm, from ramps, at the top of each time constant's curve.
fn slope_law(given: &Given) -> Result<Finding, CheckError> {
    type Part = fn(&PowerLaw) -> f64;
    let parts: [(&str, Part); 2] = [("exponent", |law| law.exponent), ("factor", |law| law.factor)];
    let part = given.word("part", &parts)?;
    Ok(Finding::Number(part(&boundary::slopes_at_tops()?.1)))
}

/// Cn in N s/mm at the top of the curve of one time constant, from ramps.
fn slope_where_it_ends(given: &Given) -> Result<Finding, CheckError> {
    let memory = given.number("Tc")?;
    let (slopes, _) = boundary::slopes_at_tops()?;
    let slope = slopes.iter().find(|(other, _)| *other == memory);
    slope
        .map(|(_, slope)| Finding::Number(*slope))
        .ok_or_else(|| CheckError::Run(format!("no ramp was made with Tc = {memory} s")))
}

/// Whether small disturbances of steady sliding stop growing at the slope of Routh-Hurwitz, to 2 %.
fn slope_by_disturbance(given: &Given) -> Result<Finding, CheckError> {
    let memory = given.number("Tc")?;
    let theory = DrivenTable::simulated(memory).critical_slope()? / N_S_PER_MM;
    let run = disturbed_slope(memory, given.number("VcL")?)?;
    let holds = (run / theory - 1.0).abs() <= 0.02;
    Ok(Finding::truth(holds, format!("{run:.1} N s/mm by the circuit, {theory:.1} by Routh-Hurwitz")))
}

fn disturbed_slope(memory: f64, limit: f64) -> Result<f64, CheckError> {
    let velocity = undisturbed(&[("VcL", limit), ("Tc", memory)], limit)?;
    let velocity = velocity.ok_or_else(|| CheckError::Run("no disturbance grows".to_owned()))?;
    Ok(FallingFriction::simulated(limit).slope(velocity)? / N_S_PER_MM)
}

/// How far Cn at one time constant lies apart at different VcL, in percent of its mean.
fn slope_spread(given: &Given) -> Result<Finding, CheckError> {
    let (memory, limits) = (given.number("Tc")?, given.numbers("VcL")?);
    let by_ramp = given.word("by", &[("ramp", true), ("disturbance", false)])?;
    let slopes: Vec<f64> = if by_ramp {
        let settings: Vec<_> = limits.iter().map(|limit| (memory, *limit)).collect();
        let read = boundary::ramps(&settings, RATE, &[Criterion::USUAL.threshold])?;
        read[0].iter().filter_map(boundary::Ceased::slope).collect()
    } else {
        limits.iter().map(|limit| disturbed_slope(memory, *limit)).collect::<Result<_, _>>()?
    };
    if slopes.len() < 3 {
        return Err(CheckError::Run(format!("{} slopes are left of {}", slopes.len(), limits.len())));
    }
    let mean = slopes.iter().sum::<f64>() / slopes.len() as f64;
    let (least, most) = slopes
        .iter()
        .fold((f64::INFINITY, 0.0_f64), |(least, most), slope| (least.min(*slope), most.max(*slope)));
    Ok(Finding::Number(100.0 * (most - least) / mean))
}

/// Exponent of Cn against K, from ramps at VcL = 40 mm/s and Tc = 7.1 ms.
fn slope_exponent_by_stiffness(given: &Given) -> Result<Finding, CheckError> {
    let velocities = boundary::by_stiffness(&given.numbers("K")?)?;
    Ok(Finding::Number(boundary::slope_by_stiffness(&velocities)?.1.exponent))
}

/// Whether the highest critical velocity falls from each time constant to the next.
fn tops_fall(_: &Given) -> Result<Finding, CheckError> {
    let tops = boundary::highest()?.into_iter().map(|velocity| velocity / MM_PER_S).collect::<Vec<_>>();
    let told: Vec<_> = tops.iter().map(|top| format!("{top:.1}")).collect();
    Ok(Finding::shape(
        tops.len() == boundary::MEMORIES.len() && tops.windows(2).all(|pair| pair[1] < pair[0]),
        format!("{} mm/s", told.join(", ")),
    ))
}
