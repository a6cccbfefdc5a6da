//! Solid friction that falls with velocity (4.6, 8.2 ... 8.5).

use super::super::finding::Finding;
use super::super::given::Given;
use super::{Check, CheckError};
use crate::slideway::falling::{FallingFriction, stable_limit, worst_limit};
use crate::slideway::stability::SIMULATED_DAMPING;
use crate::slideway::units::{MM_PER_S, N_S_PER_MM};

pub(super) const CHECKS: &[Check] = &[
    Check { name: "solid-friction", run: solid },
    Check { name: "velocity-at-slope", run: velocity_at_slope },
    Check { name: "least-share", run: least_share },
    Check { name: "least-friction", run: least_friction },
    Check { name: "slope-is-derivative", run: slope_is_derivative },
    Check { name: "highest-critical-velocity", run: highest },
    Check { name: "stable-limit", run: stable },
    Check { name: "falls-below-static", run: falls_below_static },
    Check { name: "slope-of-any-sign", run: slope_of_any_sign },
    Check { name: "straight-slope-turns", run: straight_slope_turns },
    Check { name: "index-of-two", run: index_of_two },
];

/// The friction of the simulation, 771 N, or Fs, with VcL in m/s.
fn friction(given: &Given) -> Result<FallingFriction, CheckError> {
    let study = FallingFriction::simulated(given.number("VcL")?);
    Ok(FallingFriction { static_friction: given.number_or("Fs", study.static_friction)?, ..study })
}

/// f in N s/m, by default that of the simulation.
fn damping(given: &Given) -> Result<f64, CheckError> {
    Ok(given.number_or("f", SIMULATED_DAMPING)?)
}

/// Solid friction by the square law, as a share of Fs, at a share of VcL.
fn solid(given: &Given) -> Result<Finding, CheckError> {
    let friction = friction(given)?;
    let force = friction.solid(given.number("at")? * friction.limit)?;
    Ok(Finding::Number(force / friction.static_friction))
}

/// The velocity in mm/s at which friction falls by Cn in N s/m.
fn velocity_at_slope(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(friction(given)?.velocity_at_slope(given.number("Cn")?)? / MM_PER_S))
}

/// f / (2 Fs) in s/mm: what eq 49-8 takes off for every mm/s of VcL.
fn least_share(given: &Given) -> Result<Finding, CheckError> {
    let friction = friction(given)?;
    let taken_off = 1.0 - friction.velocity_of_least(damping(given)?)? / friction.limit;
    Ok(Finding::Number(taken_off / (friction.limit / MM_PER_S)))
}

/// That all friction is least where eq 48-8 says, by going through all velocities.
fn least_friction(given: &Given) -> Result<Finding, CheckError> {
    const STEPS: usize = 20_000;
    let (friction, damping) = (friction(given)?, damping(given)?);
    let told = friction.velocity_of_least(damping)?;
    let mut least = (f64::INFINITY, 0.0);
    for step in 1..=STEPS {
        let velocity = friction.limit * step as f64 / STEPS as f64;
        let force = friction.total(velocity, damping)?;
        least = if force < least.0 { (force, velocity) } else { least };
    }
    let found = format!("least at {:.3} mm/s, by the equation {:.3}", least.1 / MM_PER_S, told / MM_PER_S);
    Ok(Finding::truth((least.1 - told).abs() <= friction.limit / STEPS as f64, found))
}

/// That eq 40-8 is the derivative of eq 30-8, at half of VcL.
fn slope_is_derivative(given: &Given) -> Result<Finding, CheckError> {
    let friction = friction(given)?;
    let (velocity, small) = (0.5 * friction.limit, 1e-6 * friction.limit);
    let fall = friction.solid(velocity - small)? - friction.solid(velocity + small)?;
    let (measured, told) = (fall / (2.0 * small), friction.slope(velocity)?);
    let found = format!("{:.4} N s/mm, measured {:.4}", told / N_S_PER_MM, measured / N_S_PER_MM);
    Ok(Finding::truth((measured / told - 1.0).abs() < 1e-6, found))
}

/// The highest critical velocity for a slope Cn in N s/m that is borne, by going through all VcL: as a share of its VcL, or its VcL as a
/// share of Fs / Cn.
fn highest(given: &Given) -> Result<Finding, CheckError> {
    const STEPS: usize = 100_000;
    let (friction, slope) = (friction(given)?, given.number("Cn")?);
    let widest = stable_limit(friction.static_friction, slope)?;
    let mut highest = (0.0, 0.0);
    for step in 1..STEPS {
        let limit = widest * step as f64 / STEPS as f64;
        let velocity = FallingFriction { limit, ..friction }.velocity_at_slope(slope)?;
        highest = if velocity > highest.0 { (velocity, limit) } else { highest };
    }
    let worst = worst_limit(friction.static_friction, slope)?;
    let parts = [("velocity", highest.0 / highest.1), ("limit", highest.1 / worst)];
    Ok(Finding::Number(given.word("part", &parts)?))
}

/// The critical velocity as a share of VcL where VcL = 2 Fs / Cn.
fn stable(given: &Given) -> Result<Finding, CheckError> {
    let (friction, slope) = (friction(given)?, given.number("Cn")?);
    let limit = stable_limit(friction.static_friction, slope)?;
    let edge = FallingFriction { limit, ..friction };
    // At the edge rounding may leave the slope a trifle too steep.
    Ok(Finding::Number(edge.velocity_at_slope(slope.min(edge.steepest()?))? / limit))
}

/// That friction in steady sliding stays below Fs up to VcL.
fn falls_below_static(given: &Given) -> Result<Finding, CheckError> {
    let (friction, damping) = (friction(given)?, damping(given)?);
    let shares = [0.01, 0.1, 0.5, 1.0].map(|share| friction.total(share * friction.limit, damping));
    let mut most: f64 = 0.0;
    for force in shares {
        most = most.max(force? / friction.static_friction);
    }
    Ok(Finding::truth(most < 1.0, format!("at most {most:.4} of Fs from 1 % of VcL on")))
}

/// That friction is above 0 at every velocity up to twice VcL, while its slope is below 0, 0 and above 0 in turn.
fn slope_of_any_sign(given: &Given) -> Result<Finding, CheckError> {
    let (friction, damping) = (friction(given)?, damping(given)?);
    let least = friction.velocity_of_least(damping)?;
    let slope = |velocity: f64| friction.slope(velocity).map(|falling| (damping - falling) * 1e-3);
    let (first, turning, last) = (slope(0.0)?, slope(least)?, slope(2.0 * friction.limit)?);
    let mut is_above = true;
    for step in 0..=200 {
        is_above &= friction.total(friction.limit * f64::from(step) / 100.0, damping)? > 0.0;
    }
    let holds = is_above && first < 0.0 && turning.abs() < 1e-9 && last > 0.0;
    Ok(Finding::truth(holds, format!("slope {first:.1}, 0 and {last:.1} N s/mm, friction above 0")))
}

/// That the straight line's friction falls just below VcL and rises just above.
fn straight_slope_turns(given: &Given) -> Result<Finding, CheckError> {
    let (friction, damping) = (friction(given)?, damping(given)?);
    let total = |share: f64| -> Result<f64, CheckError> {
        let velocity = share * friction.limit;
        Ok(friction.solid_straight(velocity)? + damping * velocity)
    };
    let rise = |from: f64, to: f64| -> Result<f64, CheckError> {
        Ok((total(to)? - total(from)?) / ((to - from) * friction.limit) / N_S_PER_MM)
    };
    let (below, above) = (rise(0.98, 0.99)?, rise(1.01, 1.02)?);
    let found = format!("{below:.1} N s/mm just below, {above:.1} just above");
    Ok(Finding::truth(below < 0.0 && above > 0.0, found))
}

/// By how much the square law differs at most from one with another index, in percent of Fs.
fn index_of_two(given: &Given) -> Result<Finding, CheckError> {
    const STEPS: i32 = 10_000;
    let (friction, index) = (friction(given)?, given.number("index")?);
    let mut most = 0.0_f64;
    for step in 0..STEPS {
        let share = f64::from(step) / f64::from(STEPS);
        let squared = friction.solid(share * friction.limit)? / friction.static_friction;
        most = most.max((squared - (1.0 - share).powf(index)).abs());
    }
    Ok(Finding::Number(100.0 * most))
}
