//! What many critical velocities together decide: slopes of friction at which oscillation ends, and the laws that fit them.

use super::super::boundary::{self, RATE, undisturbed};
use super::super::finding::Finding;
use super::super::given::Given;
use super::super::recipe::{Recipe, first_number};
use super::{Check, CheckError};
use crate::slideway::falling::FallingFriction;
use crate::slideway::power_law::PowerLaw;
use crate::slideway::stability::DrivenTable;
use crate::slideway::units::{N_PER_MM, N_S_PER_MM};

pub(super) const CHECKS: &[Check] = &[
    Check { name: "slope-exponent", run: slope_exponent },
    Check { name: "slope-where-it-ends", run: slope_where_it_ends },
    Check { name: "slope-by-disturbance", run: slope_by_disturbance },
    Check { name: "slope-spread", run: slope_spread },
    Check { name: "slope-exponent-by-stiffness", run: slope_exponent_by_stiffness },
    Check { name: "tops-fall", run: tops_fall },
];

/// Exponent of Cn against Tc, from ramps, at the top of each time constant's curve.
fn slope_exponent(_: &Given) -> Result<Finding, CheckError> {
    let (_, law) = boundary::slopes_at_tops(boundary::sweep()?)?;
    Ok(Finding::Number(law.exponent))
}

/// Cn in N s/mm at the top of the curve of one time constant, from ramps.
fn slope_where_it_ends(given: &Given) -> Result<Finding, CheckError> {
    let memory = given.number("Tc")?;
    let top = boundary::top(boundary::sweep()?, memory);
    let slope = top.and_then(|top| top.slope());
    slope
        .map(Finding::Number)
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
        boundary::ramps(&settings, RATE)?.iter().filter_map(boundary::Ceased::slope).collect()
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

/// Exponent of Cn against K, from ramps at VcL = 40 mm/s and Tc = 7.1 ms, of the stiffnesses at which oscillation ends within the
/// range of A3.
fn slope_exponent_by_stiffness(given: &Given) -> Result<Finding, CheckError> {
    let limit = 40e-3;
    let recipe = Recipe::of("fig-8-16").set("VcL", limit).set("Tc", 0.0071).lasting(20.0);
    let rows = recipe.sweep(&[boundary::axis("K", &given.numbers("K")?)], &["critical_velocity"])?;
    let mut points = Vec::new();
    for row in rows {
        if let Some(velocity) = first_number(&row) {
            let slope = FallingFriction::simulated(limit).slope(velocity)? / N_S_PER_MM;
            points.push((row.values[0] / N_PER_MM, slope));
        }
    }
    Ok(Finding::Number(PowerLaw::fit(&points)?.exponent))
}

/// Whether the highest critical velocity falls from each time constant to the next.
fn tops_fall(_: &Given) -> Result<Finding, CheckError> {
    let ceased = boundary::sweep()?;
    let tops = boundary::MEMORIES.iter().filter_map(|memory| boundary::top(ceased, *memory)?.velocity);
    let tops: Vec<_> = tops.map(|velocity| velocity * 1e3).collect();
    let told: Vec<_> = tops.iter().map(|top| format!("{top:.1}")).collect();
    Ok(Finding::shape(tops.windows(2).all(|pair| pair[1] < pair[0]), format!("{} mm/s", told.join(", "))))
}
