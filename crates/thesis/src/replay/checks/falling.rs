//! Claims on solid friction that falls with velocity (4.6, 8.2 ... 8.5).
//!
//! Common arguments: `VcL` in m/s is required, `Fs` in N is 771 and `f` in N s/m is 10700 unless given. Solid friction
//! is Fs (1 - v / VcL)^2 up to VcL and 0 above it (eq 8-4, 30-8).

use super::super::check_arguments::CheckArguments;
use super::super::finding::Finding;
use super::{Check, CheckError};
use crate::slideway::falling::{FallingFriction, stable_limit, worst_limit};
use crate::slideway::stability::SIMULATED_DAMPING;
use crate::slideway::units::{MM_PER_S, N_S_PER_MM};

/// The checks of this file, by the name that the ledger uses.
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

/// The friction of the simulation with VcL in m/s. Fs in N replaces its static friction of 771 N.
fn friction(given: &CheckArguments) -> Result<FallingFriction, CheckError> {
    let thesis = FallingFriction::simulated(given.number("VcL")?);
    Ok(FallingFriction { static_friction: given.number_or("Fs", thesis.static_friction)?, ..thesis })
}

/// The viscous coefficient f in N s/m. The default is that of the simulation.
fn damping(given: &CheckArguments) -> Result<f64, CheckError> {
    Ok(given.number_or("f", SIMULATED_DAMPING)?)
}

/// Solid friction by the square law as a share of Fs, at the share `at` of VcL.
///
/// Argument `at` is v / VcL. Claims 4-116 ... 4-118: a quarter at half of VcL, 1 at rest, 0 above VcL.
fn solid(given: &CheckArguments) -> Result<Finding, CheckError> {
    let friction = friction(given)?;
    let force = friction.solid(given.number("at")? * friction.limit)?;
    Ok(Finding::Number(force / friction.static_friction))
}

/// The velocity in mm/s at which the slope of friction is Cn in N s/m.
///
/// v = VcL - Cn VcL^2 / (2 Fs) (eq 41-8, 64-9). Claims 8-143.a and b use Cn = f, the slope without lag. Claims
/// 9-203.own ... 9-228.own use the slopes of Table T9-6.
fn velocity_at_slope(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(friction(given)?.velocity_at_slope(given.number("Cn")?)? / MM_PER_S))
}

/// f / (2 Fs) in s/mm: the reduction by eq 49-8 for every mm/s of VcL.
///
/// Claim 8-145: 0.00694 s/mm. The result does not depend on VcL.
fn least_share(given: &CheckArguments) -> Result<Finding, CheckError> {
    let friction = friction(given)?;
    let reduction = 1.0 - friction.velocity_of_least(damping(given)?)? / friction.limit;
    Ok(Finding::Number(reduction / (friction.limit / MM_PER_S)))
}

/// Checks that total friction is least at the velocity of eq 48-8, by a search over all velocities.
///
/// The velocity is VcL (1 - f VcL / (2 Fs)). The search takes 20 000 velocities up to VcL, and the agreement must be
/// within one of them. Claim 8-144.
fn least_friction(given: &CheckArguments) -> Result<Finding, CheckError> {
    const STEPS: usize = 20_000;
    let (friction, damping) = (friction(given)?, damping(given)?);
    let predicted = friction.velocity_of_least(damping)?;
    let mut least = (f64::INFINITY, 0.0);
    for step in 1..=STEPS {
        let velocity = friction.limit * step as f64 / STEPS as f64;
        let force = friction.total(velocity, damping)?;
        least = if force < least.0 { (force, velocity) } else { least };
    }
    let found =
        format!("least at {:.3} mm/s, by the equation {:.3}", least.1 / MM_PER_S, predicted / MM_PER_S);
    Ok(Finding::truth((least.1 - predicted).abs() <= friction.limit / STEPS as f64, found))
}

/// Checks that eq 40-8 is the derivative of eq 30-8, at half of VcL.
///
/// The derivative is a central difference over two millionths of VcL, and must agree to 1e-6. Cn is positive while
/// friction falls. Claims 8-134 and 10-001.
fn slope_is_derivative(given: &CheckArguments) -> Result<Finding, CheckError> {
    let friction = friction(given)?;
    let (velocity, small) = (0.5 * friction.limit, 1e-6 * friction.limit);
    let fall = friction.solid(velocity - small)? - friction.solid(velocity + small)?;
    let (measured, predicted) = (fall / (2.0 * small), friction.slope(velocity)?);
    let found = format!("{:.4} N s/mm, measured {:.4}", predicted / N_S_PER_MM, measured / N_S_PER_MM);
    Ok(Finding::truth((measured / predicted - 1.0).abs() < 1e-6, found))
}

/// The highest critical velocity for a critical slope Cn in N s/m, by a search over all VcL. The result is its share
/// of VcL, or its VcL as a share of Fs / Cn.
///
/// Argument `part`: `velocity` is Vc / VcL at the maximum, 0.5 by eq 44-8; `limit` is its VcL by Fs / Cn, 1 by eq 45-8.
/// The search takes 100 000 values of VcL up to 2 Fs / Cn, above which nothing oscillates. Claims 8-141.a and b.
fn highest(given: &CheckArguments) -> Result<Finding, CheckError> {
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
    Ok(Finding::Number(given.choice("part", &parts)?))
}

/// The critical velocity as a share of VcL, for VcL = 2 Fs / Cn.
///
/// Claim 8-147 (eq 50-8, 51-8): the result is 0. For a larger VcL friction is nowhere steep enough.
fn stable(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (friction, slope) = (friction(given)?, given.number("Cn")?);
    let limit = stable_limit(friction.static_friction, slope)?;
    let edge = FallingFriction { limit, ..friction };
    // Rounding may make the slope at the edge slightly too steep.
    Ok(Finding::Number(edge.velocity_at_slope(slope.min(edge.steepest()?))? / limit))
}

/// Checks that friction in steady sliding stays below Fs up to VcL.
///
/// Total friction is read at 1, 10, 50 and 100 % of VcL and must be below Fs. At rest it is Fs itself. Claims 4-124.a
/// and b (eq 14-4).
fn falls_below_static(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (friction, damping) = (friction(given)?, damping(given)?);
    let shares = [0.01, 0.1, 0.5, 1.0].map(|share| friction.total(share * friction.limit, damping));
    let mut most: f64 = 0.0;
    for force in shares {
        most = most.max(force? / friction.static_friction);
    }
    Ok(Finding::truth(most < 1.0, format!("at most {most:.4} of Fs from 1 % of VcL on")))
}

/// Checks that friction is positive at every velocity up to twice VcL, while its slope is negative, 0 and positive in
/// turn.
///
/// The slope of total friction is f - Cn: negative at rest, 0 at the velocity of least friction, and f above VcL. Fig
/// 4.2, claim 4-040.
fn slope_of_any_sign(given: &CheckArguments) -> Result<Finding, CheckError> {
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

/// Checks that friction by the straight line falls just below VcL and rises just above it.
///
/// The straight line is Fs (1 - v / VcL) (eq 28-8). Slopes are differences from 0.98 to 0.99 VcL and from 1.01 to 1.02
/// VcL, with viscous friction included. Claim 8-083.
fn straight_slope_turns(given: &CheckArguments) -> Result<Finding, CheckError> {
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

/// The largest difference between the square law and a law with another index, in percent of Fs.
///
/// The other law is Fs (1 - v / VcL)^index. Claim 7-200 (eq 181-7): the thesis replaces its index 2.18 by 2. The
/// difference is largest at 0.38 VcL.
fn index_of_two(given: &CheckArguments) -> Result<Finding, CheckError> {
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
