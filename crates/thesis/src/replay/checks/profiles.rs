//! Claims that are decided by velocity profiles of the circuits: runs in which the command rises and falls again.
//!
//! The critical velocities are the commands at which swings above 0.25 mm/s within 0.04 s end or begin. The arguments
//! are the circuit (fig-8-16 by default), its parameters in their units, and `rate`, the rate of the command in m/s2.
//!
//! Another common argument is `to`, the maximum of the command in m/s. A VcL above full scale, 25.4 mm/s, doubles the
//! scales of the circuit; the motion in physical units does not change.

use super::super::boundary::{RATE, disturbance_boundary};
use super::super::check_arguments::CheckArguments;
use super::super::finding::Finding;
use super::super::recipe::Recipe;
use super::super::reversal::{self, ReversalTally};
use super::super::series::{format_list, is_rising};
use super::{Check, CheckError};
use crate::slideway::falling::FallingFriction;
use crate::slideway::stability::SIMULATED_DAMPING;
use crate::slideway::units::MM_PER_S;
use patchcord_analysis::instruments::{CriticalVelocity, CriticalVelocityError};

/// The checks of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[
    Check { name: "critical-velocity", run: critical_velocity },
    Check { name: "ends-while-friction-falls", run: ends_while_friction_falls },
    Check { name: "rising-above-falling", run: rising_above_falling },
    Check { name: "never-reversed", run: never_reversed },
    Check { name: "critical-velocity-moves", run: critical_velocity_moves },
    Check { name: "overruns", run: overruns },
    Check { name: "lag-moved", run: lag_moved },
    Check { name: "first-jump", run: first_jump },
    Check { name: "both-directions", run: both_directions },
];

/// Maximum of the command, in m/s: 40 V (8.2).
pub(super) const MAX_COMMAND: f64 = 10.16e-3;

/// The velocity that 100 V represents, in m/s.
const FULL_SCALE: f64 = 25.4e-3;

/// The permitted circuits.
///
/// Figs 8.11 and 8.14 have no lag; `fig-8-16-lag-last` has the lag behind the multiplier.
const CIRCUITS: [(&str, &str); 4] = [
    ("fig-8-11", "fig-8-11"),
    ("fig-8-14", "fig-8-14"),
    ("fig-8-16", "fig-8-16"),
    ("fig-8-16-lag-last", "fig-8-16-lag-last"),
];
/// The permitted parameters.
///
/// Units: kg, N/m, N s/m, N, m/s and s, in this order.
const PARAMETERS: [&str; 6] = ["M", "K", "f", "Fs", "VcL", "Tc"];

/// The circuit of a claim with its parameters.
pub(super) fn recipe(given: &CheckArguments) -> Result<Recipe, CheckError> {
    let circuit =
        if given.text("circuit").is_some() { given.choice("circuit", &CIRCUITS)? } else { "fig-8-16" };
    let mut recipe = Recipe::new(circuit);
    for name in PARAMETERS {
        if given.text(name).is_some() {
            recipe = recipe.set(name, given.number(name)?);
        }
    }
    // VcL would be outside the thesis's scales.
    let is_beyond = given.number_or("VcL", 0.0)? > FULL_SCALE;
    Ok(if is_beyond { recipe.scale_by(2.0) } else { recipe })
}

/// The critical velocities of a profile up to a command in m/s and back, at a rate in m/s2.
///
/// # Errors
/// If the run fails or an amplifier was overloaded. A profile without a critical velocity is not an error here.
fn profile(recipe: Recipe, rate: f64, highest: f64) -> Result<CriticalVelocity, CheckError> {
    let run = recipe.triangle_command(highest, rate).record(&["v_i", "v_o"]);
    Ok(run.run("profile", "")?.record.critical_velocity()?)
}

/// The profile with the rate and the maximum of the claim.
fn given_profile(given: &CheckArguments) -> Result<CriticalVelocity, CheckError> {
    profile(recipe(given)?, given.number_or("rate", RATE)?, given.number_or("to", MAX_COMMAND)?)
}

/// Reads one of the two critical velocities.
type CriticalSide = fn(&CriticalVelocity) -> Result<f64, CriticalVelocityError>;

/// The critical velocity that `of` selects.
///
/// `rising` is the command at which oscillation ends, `falling` the one at which it begins again.
fn critical_side(given: &CheckArguments) -> Result<CriticalSide, CheckError> {
    let known: [(&str, CriticalSide); 2] =
        [("rising", |critical| critical.rising), ("falling", |critical| critical.falling)];
    Ok(given.choice("of", &known)?)
}

/// A critical velocity in mm/s.
///
/// # Errors
/// If there is none.
fn read(velocity: Result<f64, CriticalVelocityError>) -> Result<f64, CheckError> {
    velocity.map(|velocity| velocity / MM_PER_S).map_err(|none| CheckError::Run(none.to_string()))
}

/// The critical velocity of the profile, in mm/s.
///
/// Claims 8-079.a, 8-079.b and 8-127.a ... c, on the circuits without lag.
fn critical_velocity(given: &CheckArguments) -> Result<Finding, CheckError> {
    let of = critical_side(given)?;
    Ok(Finding::Number(read(of(&given_profile(given)?))?))
}

/// Checks whether oscillation ends at a rising command at which total friction still falls.
///
/// Arguments: `VcL` in m/s and `f` in N s/m. Friction is least at VcL (1 - f VcL / (2 Fs)) (eq 48-8). Claims 4-022 and
/// 8-122.a ... c.
fn ends_while_friction_falls(given: &CheckArguments) -> Result<Finding, CheckError> {
    let friction = FallingFriction::simulated(given.number("VcL")?);
    let least = friction.velocity_of_least(given.number_or("f", SIMULATED_DAMPING)?)? / MM_PER_S;
    let ends = read(given_profile(given)?.rising)?;
    Ok(Finding::truth(ends < least, format!("ends at {ends:.2} mm/s; friction is least at {least:.2} mm/s")))
}

/// Checks whether the command at which oscillation ends is higher than that at which it begins again.
///
/// Fig 8.27: claims 4-027 and 8-124.
fn rising_above_falling(given: &CheckArguments) -> Result<Finding, CheckError> {
    let critical = given_profile(given)?;
    let (rising, falling) = (read(critical.rising)?, read(critical.falling)?);
    Ok(Finding::truth(rising > falling, format!("{rising:.2} mm/s rising, {falling:.2} mm/s falling")))
}

/// Checks whether the falling critical velocity is never the higher one, for `settings` settings and noise of `noise`
/// m/s rms on the command.
///
/// Claims 8-125, 8-125.b and 8-125.c. The finding states the counts and the clearest contradiction. The statement also
/// fails if no setting oscillates again as the command falls.
fn never_reversed(given: &CheckArguments) -> Result<Finding, CheckError> {
    let tally = reversal::count_reversals(given.number("settings")? as u64, given.number("noise")?)?;
    let ReversalTally { settings, comparable, reversed, clearest, not_ended, quiet } = tally;
    let clearest = clearest.map(|(setting, rising, falling)| {
        let [stiffness, damping, memory, friction, mass, limit] = setting[..] else { return String::new() };
        format!(
            "; the clearest case, K {:.1} kN/mm, f {:.1} N s/mm, Tc {:.1} ms, Fs {friction:.0} N, M {mass:.0} kg, \
             VcL {:.2} mm/s, ends at {:.2} and begins at {:.2} mm/s",
            stiffness / 1e6,
            damping / 1e3,
            memory * 1e3,
            limit / MM_PER_S,
            rising / MM_PER_S,
            falling / MM_PER_S
        )
    });
    let found = format!(
        "{reversed} of {comparable} settings that oscillate again as the command falls; of all {settings} settings \
         {not_ended} still oscillate at the turn and {quiet} do not oscillate again{}",
        clearest.unwrap_or_default()
    );
    Ok(Finding::truth(reversed == 0 && comparable > 0, found))
}

/// Checks whether a critical velocity rises or falls, as `it` states, when one setting changes. `vary` names the
/// setting, which may be `rate`.
///
/// Arguments: `of`, `it`, `vary`, and the values `from` and `till`. Claims 4-026, 8-126.a ... c, 8-129, 8-130 and
/// 8-159.
fn critical_velocity_moves(given: &CheckArguments) -> Result<Finding, CheckError> {
    let of = critical_side(given)?;
    let rises = given.choice("it", &[("rises", true), ("falls", false)])?;
    let varied = given.require("vary")?;
    let to = given.number_or("to", MAX_COMMAND)?;
    let at = |value: f64| {
        let (recipe, rate) = (recipe(given)?, given.number_or("rate", RATE)?);
        let critical = match varied {
            "rate" => profile(recipe, value, to)?,
            name => profile(recipe.set(name, value), rate, to)?,
        };
        read(of(&critical))
    };
    let (first, second) = (at(given.number("from")?)?, at(given.number("till")?)?);
    let holds = if rises { second > first } else { second < first };
    Ok(Finding::shape(holds, format!("from {first:.2} to {second:.2} mm/s")))
}

/// Checks whether oscillation in a ramp ends above the velocity from which small disturbances decay.
///
/// Arguments: `VcL` in m/s and `Tc` in s. Claim 8-128.
fn overruns(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (limit, memory) = (given.number("VcL")?, given.number("Tc")?);
    let ramp = read(given_profile(given)?.rising)?;
    let quiet = disturbance_boundary(&[("VcL", limit), ("Tc", memory)], limit)?;
    let quiet = quiet.ok_or_else(|| CheckError::Run("no disturbance grows".to_owned()))? / MM_PER_S;
    Ok(Finding::truth(
        ramp > quiet,
        format!("{ramp:.2} mm/s by the ramp; small disturbances grow below {quiet:.2} mm/s"),
    ))
}

/// The change of a critical velocity in percent if the lag is behind the multiplier.
///
/// Arguments: `of`, `Tc` in s and `VcL` in m/s. The reference is the final circuit, whose lag is before the multiplier.
/// Claims 8-105.a ... d.
fn lag_moved(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (of, memory, limit) = (critical_side(given)?, given.number("Tc")?, given.number("VcL")?);
    let at = |circuit| {
        let recipe = Recipe::new(circuit).set("Tc", memory).set("VcL", limit);
        read(of(&profile(recipe, RATE, MAX_COMMAND)?))
    };
    Ok(Finding::Number(100.0 * (at("fig-8-16-lag-last")? / at("fig-8-16")? - 1.0)))
}

/// Checks whether the jump of velocity at the start of motion grows with static friction.
///
/// Argument `forces`: values of Fs in N, ascending. The jump is the largest velocity in the first second. Fig 4.8,
/// claim 4-023.
fn first_jump(given: &CheckArguments) -> Result<Finding, CheckError> {
    let jump = |friction: f64| -> Result<f64, CheckError> {
        let recipe = recipe(given)?.set("Fs", friction).set("v_rate", RATE).run_time(1.0).record(&["v_o"]);
        Ok(recipe.run("jump", "")?.record.measure("most:v_o")? / MM_PER_S)
    };
    let forces = given.numbers("forces")?;
    let jumps = forces.iter().map(|force| jump(*force)).collect::<Result<Vec<_>, _>>()?;
    let holds = jumps.len() > 1 && is_rising(&jumps);
    Ok(Finding::shape(holds, format_list(&jumps, 2, "mm/s")))
}

/// Checks whether a command in the opposite direction gives the mirrored motion.
///
/// Both runs last 4 s. The sum of both velocities must be below 1e-9 mm/s at every sample. Claim 8-106.
fn both_directions(given: &CheckArguments) -> Result<Finding, CheckError> {
    let velocities = |rate: f64| -> Result<Vec<f64>, CheckError> {
        let recipe = recipe(given)?.set("v_rate", rate).run_time(4.0).record(&["v_o"]);
        Ok(recipe.run("direction", "")?.record.values("v_o")?)
    };
    let (one, other) = (velocities(RATE)?, velocities(-RATE)?);
    let distance =
        one.iter().zip(&other).map(|(one, other)| (one + other).abs()).fold(0.0, f64::max) / MM_PER_S;
    Ok(Finding::truth(distance < 1e-9, format!("mirrored to {distance:.1e} mm/s")))
}
