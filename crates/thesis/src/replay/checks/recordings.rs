//! What recordings of the circuits at a steady command decide.
//!
//! Arguments are those of the profiles, and `at`, the command in m/s.

use super::super::boundary::RATE;
use super::super::finding::Finding;
use super::super::frequency;
use super::super::given::Given;
use super::super::recipe::{Recipe, Replayed, apart};
use super::profiles::recipe;
use super::{Check, CheckError};
use crate::slideway::falling::FallingFriction;
use crate::slideway::stability::SIMULATED_DAMPING;
use crate::slideway::units::MM_PER_S;
use patchcord_analysis::instruments::Criterion;

pub(super) const CHECKS: &[Check] = &[
    Check { name: "steady-curve", run: steady_curve },
    Check { name: "oscillation-frequency", run: oscillation_frequency },
    Check { name: "frequency-rises", run: frequency_rises },
    Check { name: "keeps-oscillating", run: keeps_oscillating },
    Check { name: "comes-to-rest", run: comes_to_rest },
    Check { name: "never-turns-back", run: never_turns_back },
    Check { name: "even-halves", run: even_halves },
    Check { name: "loops-shrink", run: loops_shrink },
    Check { name: "follows-linearly", run: follows_linearly },
    Check { name: "limit-of-frequency", run: limit_of_frequency },
    Check { name: "blocks-move-alike", run: blocks_move_alike },
];

/// A swing of velocity above this, peak to peak in mm/s, is oscillation.
pub(super) const OSCILLATES: f64 = 1e3 * Criterion::USUAL.threshold;

/// A run at a steady command, four seconds long.
pub(super) fn steady(recipe: Recipe, command: f64) -> Result<Replayed, CheckError> {
    let recipe = recipe.steady(command).lasting(4.0).every(2e-4);
    Ok(recipe.recording(&["v_o", "spring_force"]).run("steady", "")?.within_range()?)
}

/// Least and largest velocity of its last second, in mm/s.
pub(super) fn range(run: &Replayed) -> Result<(f64, f64), CheckError> {
    let velocity = run.values("v_o")?;
    let settled = &velocity[3 * velocity.len() / 4..];
    let (least, most) = settled.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| {
        (f64::min(least, *value), f64::max(most, *value))
    });
    Ok((least / MM_PER_S, most / MM_PER_S))
}

pub(super) fn hertz(run: &Replayed) -> Result<f64, CheckError> {
    Ok(run.measure("frequency:spring_force,last=1")?)
}

/// How far the spring force of a minute's way to VcL lies from the steady curve at most, in percent of Fs: after five time
/// constants, when the lag has forgotten that the table stood.
fn steady_curve(given: &Given) -> Result<Finding, CheckError> {
    let limit = given.number("VcL")?;
    let run = recipe(given)?.set("v_rate", limit / 60.0).lasting(60.0).every(2e-3);
    let run = run.recording(&["v_o", "spring_force"]).run("steady", "")?;
    let friction = FallingFriction::simulated(limit);
    let (mut furthest, settled) = (0.0_f64, 5.0 * given.number("Tc")?);
    for (time, (velocity, force)) in
        run.trace.time.iter().zip(run.points(("v_o", 1.0), ("spring_force", 1.0))?)
    {
        if *time > settled {
            furthest = furthest.max((force - friction.total(velocity, SIMULATED_DAMPING)?).abs());
        }
    }
    Ok(Finding::Number(100.0 * furthest / friction.static_friction))
}

/// Cycles a second of the spring force, in Hz.
fn oscillation_frequency(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(hertz(&steady(recipe(given)?, given.number("at")?)?)?))
}

/// Whether the frequency rises from each command to the next.
fn frequency_rises(given: &Given) -> Result<Finding, CheckError> {
    let at = |command: &f64| hertz(&steady(recipe(given)?, *command)?);
    let frequencies = given.numbers("at")?.iter().map(at).collect::<Result<Vec<_>, _>>()?;
    let told: Vec<_> = frequencies.iter().map(|frequency| format!("{frequency:.1}")).collect();
    let holds = frequencies.len() > 1 && frequencies.windows(2).all(|pair| pair[1] > pair[0]);
    Ok(Finding::shape(holds, format!("{} Hz", told.join(", "))))
}

/// Whether it still oscillates, by more than 0.25 mm/s, in the fourth second.
fn keeps_oscillating(given: &Given) -> Result<Finding, CheckError> {
    let (least, most) = range(&steady(recipe(given)?, given.number("at")?)?)?;
    Ok(Finding::truth(most - least > OSCILLATES, format!("{least:.2} ... {most:.2} mm/s")))
}

/// Whether it oscillates and comes to rest in every cycle, to 1 % of the command, or never does, as stated.
fn comes_to_rest(given: &Given) -> Result<Finding, CheckError> {
    let (rests, command) = (given.word("it", &[("rests", true), ("slides", false)])?, given.number("at")?);
    let (least, most) = range(&steady(recipe(given)?, command)?)?;
    let comes_to_rest = least <= 0.01 * command / MM_PER_S;
    Ok(Finding::truth(
        most - least > OSCILLATES && comes_to_rest == rests,
        format!("{least:.2} ... {most:.2} mm/s"),
    ))
}

/// Whether it never moves against the command, by 1 % of it.
fn never_turns_back(given: &Given) -> Result<Finding, CheckError> {
    let command = given.number("at")?;
    let (least, most) = range(&steady(recipe(given)?, command)?)?;
    Ok(Finding::truth(least > -0.01 * command / MM_PER_S, format!("{least:.2} ... {most:.2} mm/s")))
}

/// Whether velocity oscillates, and swings as far above the command as below it, to 5 % of the swing, as stated.
fn even_halves(given: &Given) -> Result<Finding, CheckError> {
    let (even, command) = (given.word("halves", &[("even", true), ("uneven", false)])?, given.number("at")?);
    let (least, most) = range(&steady(recipe(given)?, command)?)?;
    let (below, above) = (command / MM_PER_S - least, most - command / MM_PER_S);
    let is_even = (above - below).abs() <= 0.05 * (above + below);
    Ok(Finding::truth(
        most - least > OSCILLATES && is_even == even,
        format!("{above:.2} mm/s above and {below:.2} mm/s below"),
    ))
}

/// Whether the loop of force against velocity is the smaller at the higher command, and the force of steady sliding lies within both.
fn loops_shrink(given: &Given) -> Result<Finding, CheckError> {
    let friction = FallingFriction::simulated(given.number("VcL")?);
    let mut swings = Vec::new();
    let mut surrounds = true;
    for command in given.numbers("at")? {
        let run = steady(recipe(given)?, command)?;
        let force = run.values("spring_force")?;
        let settled = &force[3 * force.len() / 4..];
        let least = settled.iter().copied().fold(f64::INFINITY, f64::min);
        let most = settled.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let (low, high) = range(&run)?;
        surrounds &= (least..most).contains(&friction.total(command, SIMULATED_DAMPING)?);
        swings.push((high - low, most - least));
    }
    let told: Vec<_> = swings.iter().map(|(v, force)| format!("{v:.2} mm/s by {force:.0} N")).collect();
    let shrinks =
        swings.len() > 1 && swings.windows(2).all(|pair| pair[1].0 < pair[0].0 && pair[1].1 < pair[0].1);
    Ok(Finding::shape(shrinks && surrounds, told.join(", then ")))
}

/// Whether the block form makes the motion of the final circuit, to what rounding leaves: a millionth of a mm/s.
fn blocks_move_alike(_: &Given) -> Result<Finding, CheckError> {
    let apart = apart(["fig-8-17", "fig-8-16"].map(Recipe::of), "v_o")? / MM_PER_S;
    Ok(Finding::truth(apart < 1e-6, format!("never further apart than {apart:.1e} mm/s")))
}

/// The largest VcL, in mm/s, at which the table swings so many times a second at a command.
fn limit_of_frequency(given: &Given) -> Result<Finding, CheckError> {
    let (command, hertz) = (given.number("at")?, given.number("Hz")?);
    let limits = frequency::limits_at(command, &frequency::by_limit(command)?, hertz)?;
    let largest =
        limits.last().ok_or_else(|| CheckError::Run("that frequency does not come out".to_owned()))?;
    Ok(Finding::Number(largest.0 / MM_PER_S))
}

/// How far velocity lies from the command of a table without solid friction, once its first swings are over, in percent of the
/// command.
fn follows_linearly(_: &Given) -> Result<Finding, CheckError> {
    let recipe = Recipe::of("fig-8-04").set("x_step", 0.0).set("v_rate", RATE).lasting(8.0);
    let run = recipe.every(1e-3).recording(&["v_i", "v_o"]).run("linear", "")?;
    let points = run.points(("v_i", 1.0), ("v_o", 1.0))?;
    let settled = points.iter().skip(points.len() / 8);
    let furthest = settled.map(|(command, velocity)| (velocity / command - 1.0).abs()).fold(0.0, f64::max);
    Ok(Finding::Number(100.0 * furthest))
}
