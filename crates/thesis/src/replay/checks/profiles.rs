//! What velocity profiles of the circuits decide: runs in which the command rises and comes back.
//!
//! Critical velocities are those at which swings above 0.25 mm/s within 0.04 s end, or begin. Arguments are the circuit
//! (fig-8-16 where none is named), its parameters in their units, and `rate`, that of the command in m/s2.

use super::super::boundary::{RATE, undisturbed};
use super::super::finding::Finding;
use super::super::given::Given;
use super::super::recipe::Recipe;
use super::super::reversal::{self, Tally};
use super::{Check, CheckError};
use crate::slideway::falling::FallingFriction;
use crate::slideway::stability::SIMULATED_DAMPING;
use crate::slideway::units::MM_PER_S;
use patchcord_analysis::instruments::{CriticalVelocity, NoCriticalVelocity};

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

/// The command goes up to 40 V (8.2), in m/s.
pub(super) const HIGHEST: f64 = 10.16e-3;

/// The velocity of 100 V, in m/s.
const END_OF_SCALES: f64 = 25.4e-3;

/// The circuits that may be named.
const CIRCUITS: [(&str, &str); 4] = [
    ("fig-8-11", "fig-8-11"),
    ("fig-8-14", "fig-8-14"),
    ("fig-8-16", "fig-8-16"),
    ("fig-8-16-lag-last", "fig-8-16-lag-last"),
];
/// The parameters that may be set.
const PARAMETERS: [&str; 6] = ["M", "K", "f", "Fs", "VcL", "Tc"];

/// A circuit with the parameters that are given.
pub(super) fn recipe(given: &Given) -> Result<Recipe, CheckError> {
    let circuit =
        if given.text("circuit").is_some() { given.word("circuit", &CIRCUITS)? } else { "fig-8-16" };
    let mut recipe = Recipe::of(circuit);
    for name in PARAMETERS {
        if given.text(name).is_some() {
            recipe = recipe.set(name, given.number(name)?);
        }
    }
    // At VcL the table would stand at the end of the study's scales.
    let is_beyond = given.number_or("VcL", 0.0)? > END_OF_SCALES;
    Ok(if is_beyond { recipe.scaled(2.0) } else { recipe })
}

/// A profile up to a command and back.
fn profile(recipe: Recipe, rate: f64, highest: f64) -> Result<CriticalVelocity, CheckError> {
    let run = recipe.there_and_back(highest, rate).recording(&["v_i", "v_o"]);
    Ok(run.run("profile", "")?.critical()?)
}

fn given_profile(given: &Given) -> Result<CriticalVelocity, CheckError> {
    profile(recipe(given)?, given.number_or("rate", RATE)?, given.number_or("to", HIGHEST)?)
}

/// Reads one of the two critical velocities.
type Which = fn(&CriticalVelocity) -> Result<f64, NoCriticalVelocity>;

fn which(given: &Given) -> Result<Which, CheckError> {
    let known: [(&str, Which); 2] =
        [("rising", |critical| critical.rising), ("falling", |critical| critical.falling)];
    Ok(given.word("of", &known)?)
}

/// In mm/s.
fn read(velocity: Result<f64, NoCriticalVelocity>) -> Result<f64, CheckError> {
    velocity.map(|velocity| velocity / MM_PER_S).map_err(|none| CheckError::Run(none.to_string()))
}

/// A critical velocity, in mm/s.
fn critical_velocity(given: &Given) -> Result<Finding, CheckError> {
    let of = which(given)?;
    Ok(Finding::Number(read(of(&given_profile(given)?))?))
}

/// Whether oscillation ends, while the command rises, at a velocity at which all friction still falls.
fn ends_while_friction_falls(given: &Given) -> Result<Finding, CheckError> {
    let friction = FallingFriction::simulated(given.number("VcL")?);
    let least = friction.velocity_of_least(given.number_or("f", SIMULATED_DAMPING)?)? / MM_PER_S;
    let ends = read(given_profile(given)?.rising)?;
    Ok(Finding::truth(ends < least, format!("ends at {ends:.2} mm/s; friction is least at {least:.2} mm/s")))
}

/// Whether oscillation ends at a higher command than it begins at again.
fn rising_above_falling(given: &Given) -> Result<Finding, CheckError> {
    let critical = given_profile(given)?;
    let (rising, falling) = (read(critical.rising)?, read(critical.falling)?);
    Ok(Finding::truth(rising > falling, format!("{rising:.2} mm/s rising, {falling:.2} mm/s falling")))
}

/// Whether no settings out of many make the falling critical velocity the higher one, with noise of so many m/s on the command.
fn never_reversed(given: &Given) -> Result<Finding, CheckError> {
    let tally = reversal::tally(given.number("settings")? as u64, given.number("noise")?)?;
    let Tally { settings, comparable, reversed, clearest, not_ended, quiet } = tally;
    let clearest = clearest.map(|(setting, rising, falling)| {
        let [stiffness, damping, memory, friction, mass, limit] = setting[..] else { return String::new() };
        format!(
            "; the clearest, K {:.1} kN/mm, f {:.1} N s/mm, Tc {:.1} ms, Fs {friction:.0} N, M {mass:.0} kg, VcL {:.2} mm/s, ends at {:.2} and \
             begins at {:.2} mm/s",
            stiffness / 1e6,
            damping / 1e3,
            memory * 1e3,
            limit / MM_PER_S,
            rising / MM_PER_S,
            falling / MM_PER_S
        )
    });
    let found = format!(
        "{reversed} of {comparable} that oscillate again as the command falls; {not_ended} still oscillate where it turns, {quiet} not \
         again, of {settings} settings{}",
        clearest.unwrap_or_default()
    );
    Ok(Finding::truth(reversed == 0 && comparable > 0, found))
}

/// Whether a critical velocity moves as stated when one setting goes from one value to another: `vary` names it, `rate` among
/// them.
fn critical_velocity_moves(given: &Given) -> Result<Finding, CheckError> {
    let of = which(given)?;
    let rises = given.word("it", &[("rises", true), ("falls", false)])?;
    let varied = given.need("vary")?;
    let to = given.number_or("to", HIGHEST)?;
    let at = |value: f64| {
        let (recipe, rate) = (recipe(given)?, given.number_or("rate", RATE)?);
        let critical = match varied {
            "rate" => profile(recipe, value, to)?,
            name => profile(recipe.set(name, value), rate, to)?,
        };
        read(of(&critical))
    };
    let (first, then) = (at(given.number("from")?)?, at(given.number("till")?)?);
    let holds = if rises { then > first } else { then < first };
    Ok(Finding::shape(holds, format!("from {first:.2} to {then:.2} mm/s")))
}

/// Whether a ramp ends oscillation beyond the velocity above which small disturbances die away.
fn overruns(given: &Given) -> Result<Finding, CheckError> {
    let (limit, memory) = (given.number("VcL")?, given.number("Tc")?);
    let ramp = read(given_profile(given)?.rising)?;
    let quiet = undisturbed(&[("VcL", limit), ("Tc", memory)], limit)?;
    let quiet = quiet.ok_or_else(|| CheckError::Run("no disturbance grows".to_owned()))? / MM_PER_S;
    Ok(Finding::truth(
        ramp > quiet,
        format!("{ramp:.2} mm/s by the ramp; small disturbances grow below {quiet:.2} mm/s"),
    ))
}

/// How far a critical velocity is moved by putting the lag behind the multiplier, in percent.
fn lag_moved(given: &Given) -> Result<Finding, CheckError> {
    let (of, memory, limit) = (which(given)?, given.number("Tc")?, given.number("VcL")?);
    let at = |circuit| {
        let recipe = Recipe::of(circuit).set("Tc", memory).set("VcL", limit);
        read(of(&profile(recipe, RATE, HIGHEST)?))
    };
    Ok(Finding::Number(100.0 * (at("fig-8-16-lag-last")? / at("fig-8-16")? - 1.0)))
}

/// Whether the jump of velocity as motion begins grows with static friction.
fn first_jump(given: &Given) -> Result<Finding, CheckError> {
    let jump = |friction: f64| -> Result<f64, CheckError> {
        let recipe = recipe(given)?.set("Fs", friction).set("v_rate", RATE).lasting(1.0).recording(&["v_o"]);
        Ok(recipe.run("jump", "")?.measure("most:v_o")? / MM_PER_S)
    };
    let forces = given.numbers("forces")?;
    let jumps = forces.iter().map(|force| jump(*force)).collect::<Result<Vec<_>, _>>()?;
    let told: Vec<_> = jumps.iter().map(|jump| format!("{jump:.2}")).collect();
    let holds = jumps.len() > 1 && jumps.windows(2).all(|pair| pair[1] > pair[0]);
    Ok(Finding::shape(holds, format!("{} mm/s", told.join(", "))))
}

/// Whether a command in the other direction gives the same motion in the other direction.
fn both_directions(given: &Given) -> Result<Finding, CheckError> {
    let velocities = |rate: f64| -> Result<Vec<f64>, CheckError> {
        let recipe = recipe(given)?.set("v_rate", rate).lasting(4.0).recording(&["v_o"]);
        Ok(recipe.run("direction", "")?.values("v_o")?)
    };
    let (one, other) = (velocities(RATE)?, velocities(-RATE)?);
    let apart = one.iter().zip(&other).map(|(one, other)| (one + other).abs()).fold(0.0, f64::max) / MM_PER_S;
    Ok(Finding::truth(apart < 1e-9, format!("mirrored to {apart:.1e} mm/s")))
}
