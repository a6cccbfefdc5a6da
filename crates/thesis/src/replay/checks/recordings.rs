//! Claims that are decided by recordings of the circuits at a steady command.
//!
//! The arguments are those of the profiles, and `at`, the command in m/s.
//!
//! A run lasts four seconds. The first three let the oscillation become periodic; only the last one is read.

use super::super::boundary::RATE;
use super::super::check_arguments::CheckArguments;
use super::super::finding::Finding;
use super::super::frequency;
use super::super::recipe::{Recipe, max_run_difference};
use super::super::run_record::ReplayedRun;
use super::super::series::{format_list, is_rising, min_max};
use super::profiles::recipe;
use super::{Check, CheckError};
use crate::slideway::falling::FallingFriction;
use crate::slideway::stability::SIMULATED_DAMPING;
use crate::slideway::units::MM_PER_S;
use patchcord_analysis::instruments::Criterion;

/// The checks of this file, by the name that the ledger uses.
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

/// A larger peak-to-peak swing of velocity, in mm/s, counts as oscillation.
///
/// It is 0.25 mm/s, the threshold of the usual criterion.
pub(super) const OSCILLATION_THRESHOLD: f64 = 1e3 * Criterion::USUAL.threshold;

/// A run of four seconds at a steady command in m/s.
///
/// Samples are 0.2 ms apart. `v_o`, the velocity in m/s, and `spring_force` in N are recorded.
///
/// # Errors
/// If the recipe is wrong, the run fails, or an amplifier was overloaded.
pub(super) fn steady(recipe: Recipe, command: f64) -> Result<ReplayedRun, CheckError> {
    let recipe = recipe.steady_command(command).run_time(4.0).sample_interval(2e-4);
    Ok(recipe.record(&["v_o", "spring_force"]).run("steady", "")?.without_overload()?)
}

/// The minimum and the maximum velocity of the last second of a run, in mm/s. Their difference is the peak-to-peak
/// swing.
pub(super) fn range(run: &ReplayedRun) -> Result<(f64, f64), CheckError> {
    let velocity = run.record.values("v_o")?;
    let (min, max) = min_max(velocity[3 * velocity.len() / 4..].iter().copied());
    Ok((min / MM_PER_S, max / MM_PER_S))
}

/// The frequency of the spring force in the last second of a run, in Hz.
pub(super) fn hertz(run: &ReplayedRun) -> Result<f64, CheckError> {
    Ok(run.record.measure("frequency:spring_force,last=1")?)
}

/// The largest distance of the spring force from the steady curve, in percent of Fs, for a ramp of one minute to VcL.
/// The first five time constants are omitted, because the lag still contains the state of rest.
///
/// Arguments: `VcL` in m/s, `Tc` in s and those of the circuit. The curve is Fs (1 - v / VcL)^2 + f v with 771 N and
/// 10.7 N s/mm. Fig 8.18: claims 8-120 and 8-120.b with Tc = 0.5 s. Claim 9-002.b: a softer drive does not change the
/// curve.
fn steady_curve(given: &CheckArguments) -> Result<Finding, CheckError> {
    let limit = given.number("VcL")?;
    let run = recipe(given)?.set("v_rate", limit / 60.0).run_time(60.0).sample_interval(2e-3);
    let run = run.record(&["v_o", "spring_force"]).run("steady", "")?;
    let friction = FallingFriction::simulated(limit);
    let (mut largest, settled) = (0.0_f64, 5.0 * given.number("Tc")?);
    for (time, (velocity, force)) in
        run.record.trace.time.iter().zip(run.record.points(("v_o", 1.0), ("spring_force", 1.0))?)
    {
        if *time > settled {
            largest = largest.max((force - friction.total(velocity, SIMULATED_DAMPING)?).abs());
        }
    }
    Ok(Finding::Number(100.0 * largest / friction.static_friction))
}

/// The frequency of the spring force, in Hz.
///
/// Fig 8.34: claims 8-152.a ... d.
fn oscillation_frequency(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(hertz(&steady(recipe(given)?, given.number("at")?)?)?))
}

/// Checks whether the frequency rises from each command to the next.
///
/// Argument `at`: commands in m/s, ascending. Fig 8.26, claim 8-123.
fn frequency_rises(given: &CheckArguments) -> Result<Finding, CheckError> {
    let at = |command: &f64| hertz(&steady(recipe(given)?, *command)?);
    let frequencies = given.numbers("at")?.iter().map(at).collect::<Result<Vec<_>, _>>()?;
    let holds = frequencies.len() > 1 && is_rising(&frequencies);
    Ok(Finding::shape(holds, format_list(&frequencies, 1, "Hz")))
}

/// Checks whether the table still oscillates in the fourth second, by more than 0.25 mm/s.
///
/// Claims 4-126 and 8-078.a.
fn keeps_oscillating(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (min, max) = range(&steady(recipe(given)?, given.number("at")?)?)?;
    Ok(Finding::truth(max - min > OSCILLATION_THRESHOLD, format!("{min:.2} ... {max:.2} mm/s")))
}

/// Checks whether the table oscillates and reaches rest (1 % of the command) in every cycle, or never reaches it, as
/// `it` states.
///
/// `it` is `rests` or `slides`. Claims 8-148.a, 8-148.b, 8-157.a, 8-162, 9-235.a and 9-235.b.
fn comes_to_rest(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (rests, command) = (given.choice("it", &[("rests", true), ("slides", false)])?, given.number("at")?);
    let (min, max) = range(&steady(recipe(given)?, command)?)?;
    let reaches_rest = min <= 0.01 * command / MM_PER_S;
    Ok(Finding::truth(
        max - min > OSCILLATION_THRESHOLD && reaches_rest == rests,
        format!("{min:.2} ... {max:.2} mm/s"),
    ))
}

/// Checks whether the velocity never reverses by more than 1 % of the command.
///
/// Fig 8.12, claim 8-078.b: the table sticks, so its velocity is never negative for long.
fn never_turns_back(given: &CheckArguments) -> Result<Finding, CheckError> {
    let command = given.number("at")?;
    let (min, max) = range(&steady(recipe(given)?, command)?)?;
    Ok(Finding::truth(min > -0.01 * command / MM_PER_S, format!("{min:.2} ... {max:.2} mm/s")))
}

/// Checks whether velocity oscillates, and whether its swings above and below the command are equal to 5 % of the
/// total swing, as `halves` states.
///
/// `halves` is `even` or `uneven`. Claims 4-025, 8-151 and 8-151.b.
fn even_halves(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (even, command) =
        (given.choice("halves", &[("even", true), ("uneven", false)])?, given.number("at")?);
    let (min, max) = range(&steady(recipe(given)?, command)?)?;
    let (below, above) = (command / MM_PER_S - min, max - command / MM_PER_S);
    let is_even = (above - below).abs() <= 0.05 * (above + below);
    Ok(Finding::truth(
        max - min > OSCILLATION_THRESHOLD && is_even == even,
        format!("{above:.2} mm/s above and {below:.2} mm/s below"),
    ))
}

/// Checks whether the loop of force against velocity is smaller at the higher command, and both loops contain the
/// force of steady sliding.
///
/// Arguments: `VcL` and `at`, a list of commands in m/s. "Smaller" means a smaller range of velocity and a smaller
/// range of force. Figs 8.22 and 8.23, claim 8-121.
fn loops_shrink(given: &CheckArguments) -> Result<Finding, CheckError> {
    let friction = FallingFriction::simulated(given.number("VcL")?);
    let mut swings = Vec::new();
    let mut contains_steady = true;
    for command in given.numbers("at")? {
        let run = steady(recipe(given)?, command)?;
        let force = run.record.values("spring_force")?;
        let (min_force, max_force) = min_max(force[3 * force.len() / 4..].iter().copied());
        let (min, max) = range(&run)?;
        contains_steady &= (min_force..max_force).contains(&friction.total(command, SIMULATED_DAMPING)?);
        swings.push((max - min, max_force - min_force));
    }
    let texts: Vec<_> = swings.iter().map(|(v, force)| format!("{v:.2} mm/s by {force:.0} N")).collect();
    let shrinks =
        swings.len() > 1 && swings.windows(2).all(|pair| pair[1].0 < pair[0].0 && pair[1].1 < pair[0].1);
    Ok(Finding::shape(shrinks && contains_steady, texts.join(", then ")))
}

/// Checks whether the block form gives the motion of the final circuit to rounding, a millionth of a mm/s.
///
/// Fig 8.17, claim 8-161.
fn blocks_move_alike(_: &CheckArguments) -> Result<Finding, CheckError> {
    let distance = max_run_difference(["fig-8-17", "fig-8-16"].map(Recipe::new), "v_o")? / MM_PER_S;
    Ok(Finding::truth(distance < 1e-6, format!("at most {distance:.1e} mm/s apart")))
}

/// The largest VcL, in mm/s, at which the table oscillates with a frequency of `Hz` at a command.
///
/// Arguments: `at` in m/s and `Hz`. VcL is interpolated between runs 0.5 mm/s apart. Fig 8.34.
fn limit_of_frequency(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (command, hertz) = (given.number("at")?, given.number("Hz")?);
    let limits = frequency::limits_at_frequency(command, &frequency::swings_by_limit(command)?, hertz)?;
    let largest = limits.last().ok_or_else(|| CheckError::Run("no VcL gives this frequency".to_owned()))?;
    Ok(Finding::Number(largest.0 / MM_PER_S))
}

/// The largest distance between velocity and command of a table without solid friction, in percent of the command.
/// The first eighth of the run, with the transient at the start, is omitted.
///
/// The command rises for 8 s at 1.2 mm/s2. Figs 4.6 and 4.7, claim 4-021.
fn follows_linearly(_: &CheckArguments) -> Result<Finding, CheckError> {
    let recipe = Recipe::new("fig-8-04").set("x_step", 0.0).set("v_rate", RATE).run_time(8.0);
    let run = recipe.sample_interval(1e-3).record(&["v_i", "v_o"]).run("linear", "")?;
    let points = run.record.points(("v_i", 1.0), ("v_o", 1.0))?;
    let settled = points.iter().skip(points.len() / 8);
    let largest = settled.map(|(command, velocity)| (velocity / command - 1.0).abs()).fold(0.0, f64::max);
    Ok(Finding::Number(100.0 * largest))
}
