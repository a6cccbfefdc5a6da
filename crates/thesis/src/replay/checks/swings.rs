//! Claims on the amplitude and the frequency of oscillation at steady commands and at commands that change.
//!
//! The arguments are those of the profiles. Oscillation is a swing of velocity above 0.25 mm/s within 0.04 s.

use super::super::boundary::{RATE, disturbance_growth};
use super::super::check_arguments::CheckArguments;
use super::super::finding::Finding;
use super::super::recipe::Recipe;
use super::super::run_record::ReplayedRun;
use super::super::series::{format_list, is_falling, is_rising};
use super::profiles::{MAX_COMMAND, recipe};
use super::ramps::{ramp, required_end, swing_within};
use super::recordings::{OSCILLATION_THRESHOLD, hertz, range, steady};
use super::shipped::setting;
use super::{Check, CheckError};
use crate::slideway::falling::FallingFriction;
use crate::slideway::stability::DrivenTable;
use crate::slideway::units::MM_PER_S;
use patchcord_core::patch::ElementBuilder;

/// The checks of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[
    Check { name: "swing-rises-and-falls", run: swing_rises_and_falls },
    Check { name: "fast-fall-is-quiet", run: fast_fall_is_quiet },
    Check { name: "grows-where-friction-falls", run: grows_where_friction_falls },
    Check { name: "begins-at-speed", run: begins_at_speed },
    Check { name: "even-halves-near-the-end", run: even_halves_near_the_end },
    Check { name: "frequency-near-the-end", run: frequency_near_the_end },
    Check { name: "pots-move-frequency", run: pots_move_frequency },
];

/// Checks whether the swing at steady commands rises to a maximum between the ends, and falls from there on.
///
/// Argument `at`: commands in m/s, ascending. Fig 4.8, sections B to D, claim 4-104.
fn swing_rises_and_falls(given: &CheckArguments) -> Result<Finding, CheckError> {
    let swing = |command: &f64| {
        let (min, max) = range(&steady(recipe(given)?, *command)?)?;
        Ok(max - min)
    };
    let swings = given.numbers("at")?.iter().map(swing).collect::<Result<Vec<_>, CheckError>>()?;
    let rising = swings.windows(2).take_while(|pair| is_rising(pair)).count();
    let holds = rising > 0 && rising + 1 < swings.len() && is_falling(&swings[rising..]);
    Ok(Finding::shape(holds, format_list(&swings, 2, "mm/s peak to peak")))
}

/// Checks whether oscillation is suppressed while the command falls at `rate` from a high to a low value, and
/// reappears at the low value. A fall at the rate `slower` must not suppress it.
///
/// Arguments: `from` and `to` in m/s, `rate` and `slower` in m/s2. Claim 4-113 (4.5, observation 3).
fn fast_fall_is_quiet(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (falling, after) = fall(given, given.number("rate")?)?;
    let (slowly, _) = fall(given, given.number("slower")?)?;
    let found = format!(
        "swings of {falling:.2} mm/s during the fall, {after:.2} mm/s three seconds later; {slowly:.2} mm/s during the \
         slow fall"
    );
    Ok(Finding::truth(
        falling < OSCILLATION_THRESHOLD && after > OSCILLATION_THRESHOLD && slowly > OSCILLATION_THRESHOLD,
        found,
    ))
}

/// Swings in mm/s while the command falls at a rate in m/s2, and three seconds later.
///
/// The command rises to `from` in 1 s, holds for 1 s, falls to `to` and holds for 4 s.
fn fall(given: &CheckArguments, rate: f64) -> Result<(f64, f64), CheckError> {
    let (from, to) = (given.number("from")?, given.number("to")?);
    let (begin, ends) = (2.0, 2.0 + (from - to) / rate);
    let points = [[0.0, 0.0], [1.0, from], [begin, from], [ends, to]];
    let drive = ElementBuilder::new("table").set("scale", "velocity").set("points", points);
    let recipe = recipe(given)?.drive("v_i", drive).run_time(ends + 4.0).sample_interval(1e-3);
    let run = recipe.record(&["v_i", "v_o"]).run("fall", "")?;
    Ok((swing_within(&run, begin, ends)?, swing_within(&run, ends + 3.0, ends + 4.0)?))
}

/// Checks whether without lag a small disturbance of steady sliding grows at velocities below that of least friction,
/// and decays above it. `shares` are the velocities relative to that of least friction.
///
/// Arguments: `VcL` in m/s and `shares`. The circuit is that of Fig 8.14, without lag. A growth factor above 1 within
/// 0.3 s means growth. Claim 4-102.
fn grows_where_friction_falls(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (limit, damping) = (given.number("VcL")?, DrivenTable::simulated(0.0).damping);
    let least = FallingFriction::simulated(limit).velocity_of_least(damping)?;
    let (mut holds, mut texts) = (true, Vec::new());
    for share in given.numbers("shares")? {
        let grown = disturbance_growth(Recipe::new("fig-8-14").set("VcL", limit), share * least)?;
        holds &= (grown > 1.0) == (share < 1.0);
        texts.push(format!("x {grown:.2} at {share} times this velocity"));
    }
    Ok(Finding::truth(
        holds,
        format!("friction is least at {:.2} mm/s: {}", least / MM_PER_S, texts.join(", ")),
    ))
}

/// Checks whether oscillation begins well above rest if friction rises slightly before it falls: from 90 % of Fs at
/// rest to a maximum at the share `crest` of VcL. The ringing at breakaway ends before a third of this velocity.
///
/// Arguments: `VcL` in m/s and `crest`. A function generator replaces the limiter B2, whose output sets the level of
/// friction. The thesis has no such curve; it is chosen here. Claim 8-158 (8.6).
fn begins_at_speed(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (limit, crest) = (given.number("VcL")?, given.number("crest")?);
    let points = [[-100.0, 10.0], [-1.0, 10.0], [-crest, 0.0], [0.0, 0.5], [1.0, 0.5]];
    let curve = ElementBuilder::new("function-generator").cord("in", "PC2").set("points", points);
    let recipe = recipe(given)?.edit("machine", "unlimited").element("B2", curve);
    let run = ramp(recipe.edit("elements/A1/initial", 95), RATE, MAX_COMMAND)?;
    let turns = crest * limit / RATE;
    let (slow, fast) =
        (swing_within(&run, turns / 3.0, 0.9 * turns)?, swing_within(&run, turns, MAX_COMMAND / RATE)?);
    let found = format!(
        "swings of {slow:.2} mm/s while friction rises, of {fast:.2} mm/s from {:.2} mm/s on",
        crest * limit / MM_PER_S
    );
    Ok(Finding::shape(slow < OSCILLATION_THRESHOLD && fast > OSCILLATION_THRESHOLD, found))
}

/// The largest steady command at which the table still swings after three seconds, and its run. The command is found
/// to 1 % of the critical velocity of the ramp.
///
/// Commands are tried from 100 % of the critical velocity downward, so the result is the first one that swings.
fn near_the_end(given: &CheckArguments) -> Result<(f64, ReplayedRun), CheckError> {
    let highest = required_end(&ramp(recipe(given)?, RATE, MAX_COMMAND)?)?;
    for percent in (1..=100).rev() {
        let command = highest * f64::from(percent) / 100.0;
        let run = steady(recipe(given)?, command)?;
        let (min, max) = range(&run)?;
        if max - min > OSCILLATION_THRESHOLD {
            return Ok((command, run));
        }
    }
    Err(CheckError::Run("no oscillation is seen".to_owned()))
}

/// Checks whether the swings above and below the command are equal to 5 %, at the largest command at which the table
/// still swings.
///
/// Fig 8.33: claims 8-149 and 8-149.b.
fn even_halves_near_the_end(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (command, run) = near_the_end(given)?;
    let (min, max) = range(&run)?;
    let (below, above) = (command / MM_PER_S - min, max - command / MM_PER_S);
    let found = format!("{above:.2} mm/s above and {below:.2} mm/s below {:.2} mm/s", command / MM_PER_S);
    Ok(Finding::truth((above - below).abs() <= 0.05 * (above + below), found))
}

/// The frequency of the spring force in Hz, at the largest command at which the table still swings.
///
/// Fig 8.33: claims 8-150.a and b compare it with the natural frequency, 51.3 Hz.
fn frequency_near_the_end(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(hertz(&near_the_end(given)?.1)?))
}

/// The change of the frequency of oscillation in percent if every potentiometer is off by 1 %: the root of the sum of
/// the squared single changes.
///
/// Argument `at`: the command in m/s. The eight pots are those of the final circuit. Claim 8-008 (8.1).
fn pots_move_frequency(given: &CheckArguments) -> Result<Finding, CheckError> {
    /// Ratio of the wrong setting to the correct one.
    const WRONG: f64 = 0.99;
    let (command, pots) = (given.number("at")?, ["PC5", "PA5", "PA4", "PA3", "PC2", "PA2", "PA1", "PC1"]);
    let plain = frequency_of(recipe(given)?, command)?;
    let circuit = recipe(given)?.circuit("pots", "")?;
    let mut squares = 0.0;
    for pot in pots {
        let wrong = WRONG * setting(&circuit, pot)?;
        let changed = frequency_of(recipe(given)?.edit(&format!("elements/{pot}/setting"), wrong), command)?;
        squares += (100.0 * (changed / plain - 1.0)).powi(2);
    }
    Ok(Finding::Number(squares.sqrt()))
}

/// The frequency of oscillation of a circuit at a steady command, in Hz.
fn frequency_of(recipe: Recipe, command: f64) -> Result<f64, CheckError> {
    hertz(&steady(recipe, command)?)
}
