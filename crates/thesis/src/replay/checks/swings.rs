//! Claims on the amplitude of oscillation, and on the influence of settings and rates on its end.
//!
//! The arguments are those of the profiles. Oscillation is a swing of velocity above 0.25 mm/s within 0.04 s.
//!
//! A ramp raises the command from rest at a steady rate, 1.2 mm/s2 unless given. Three quantities are read from it: the
//! largest swing, the command at which oscillation ends, and the swing between two times. Arguments of series are
//! `vary`, the name of a setting, and `over`, its values.

use serde_json::json;

use super::super::boundary::{RATE, disturbance_boundary, disturbance_growth};
use super::super::check_arguments::CheckArguments;
use super::super::finding::Finding;
use super::super::recipe::{Recipe, ReplayedRun};
use super::profiles::{HIGHEST, recipe};
use super::recordings::{OSCILLATES, hertz, range, steady};
use super::shipped::setting;
use super::{Check, CheckError};
use crate::chain::Parameters;
use crate::slideway::design::{Design, Interface};
use crate::slideway::falling::{FallingFriction, SIMULATED_STATIC, stable_limit};
use crate::slideway::simulated::SLOPE_BY_MEMORY;
use crate::slideway::stability::DrivenTable;
use crate::slideway::units::{KGF_PER_MM2, MM_PER_S, N_S_PER_MM, POISE};
use patchcord_analysis::instruments::{
    AbsenceReason, Criterion, CyclesError, ProfileCriterion, RampDirection, cycles, velocity_profile,
};

/// The checks of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[
    Check { name: "swing-rises-and-falls", run: swing_rises_and_falls },
    Check { name: "largest-swing-moves", run: largest_swing_moves },
    Check { name: "critical-velocities-move", run: critical_velocities_move },
    Check { name: "critical-slopes-move", run: critical_slopes_move },
    Check { name: "slower-ramps-move-less", run: slower_ramps_move_less },
    Check { name: "quiet-at-one-rate", run: quiet_at_one_rate },
    Check { name: "quiet-at-one-command", run: quiet_at_one_command },
    Check { name: "fast-fall-is-quiet", run: fast_fall_is_quiet },
    Check { name: "grows-where-friction-falls", run: grows_where_friction_falls },
    Check { name: "begins-at-speed", run: begins_at_speed },
    Check { name: "printed-boundary-divides", run: printed_boundary_divides },
    Check { name: "oils-quieten", run: oils_quieten },
    Check { name: "even-halves-near-the-end", run: even_halves_near_the_end },
    Check { name: "frequency-near-the-end", run: frequency_near_the_end },
    Check { name: "pots-move-frequency", run: pots_move_frequency },
];

/// A run in which the command rises steadily from rest to `highest` in m/s, at a rate in m/s2.
///
/// # Errors
/// If the recipe is wrong, the run fails, or an amplifier was overloaded.
fn ramp(recipe: Recipe, rate: f64, highest: f64) -> Result<ReplayedRun, CheckError> {
    let recipe = recipe.set("v_rate", rate).run_time(highest / rate).record(&["v_i", "v_o"]);
    Ok(recipe.run("ramp", "")?.without_overload()?)
}

/// The largest peak-to-peak swing in a ramp, in mm/s; 0 if there is no whole cycle. A swing is twice the amplitude of a
/// cycle of `v_o`.
fn largest_swing(run: &ReplayedRun) -> Result<f64, CheckError> {
    let found = cycles(
        &run.record.trace.time,
        &run.record.values("v_i")?,
        &run.record.values("v_o")?,
        Criterion::USUAL,
    );
    match found {
        Ok(cycles) => Ok(cycles.iter().map(|cycle| 2.0 * cycle.amplitude).fold(0.0, f64::max) / MM_PER_S),
        Err(CyclesError::NoOscillation) => Ok(0.0),
        Err(error) => Err(CheckError::Run(error.to_string())),
    }
}

/// The command in m/s at which oscillation ends while it rises. `None` if only ringing at breakaway or no oscillation
/// is seen. The end is the fifth point of the profile.
fn end_of_oscillation(run: &ReplayedRun) -> Result<Option<f64>, CheckError> {
    let criterion = ProfileCriterion::usual(Criterion::USUAL);
    let (time, command, velocity) =
        (&run.record.trace.time, run.record.values("v_i")?, run.record.values("v_o")?);
    let profile = velocity_profile(time, &command, &velocity, criterion, RampDirection::Rising);
    match profile.map_err(|error| CheckError::Run(error.to_string()))?.points[4] {
        Ok(end) => Ok(Some(end.command)),
        Err(AbsenceReason::NoOscillation | AbsenceReason::RingsOnly) => Ok(None),
        Err(error) => Err(CheckError::Run(error.to_string())),
    }
}

/// The command in m/s at which oscillation ends.
///
/// # Errors
/// If there is no oscillation.
fn required_end(run: &ReplayedRun) -> Result<f64, CheckError> {
    end_of_oscillation(run)?.ok_or_else(|| CheckError::Run("no oscillation is seen".to_owned()))
}

/// Results of ramps, one for each value of the setting that varies.
///
/// Arguments: `vary`, `over`, `rate` in m/s2 (1.2e-3) and `to`, the highest command in m/s (10.16e-3).
fn ramps_over(
    given: &CheckArguments,
    read: impl Fn(&ReplayedRun) -> Result<f64, CheckError>,
) -> Result<Vec<f64>, CheckError> {
    let (recipe, varied) = (recipe(given)?, given.require("vary")?);
    let (rate, highest) = (given.number_or("rate", RATE)?, given.number_or("to", HIGHEST)?);
    let at = |value: &f64| read(&ramp(recipe.clone().set(varied, *value), rate, highest)?);
    given.numbers("over")?.iter().map(at).collect()
}

/// Checks whether numbers rise or fall steadily, as `it` states. `it` is `rises` or `falls`, and a single number never
/// holds.
fn trend(given: &CheckArguments, numbers: &[f64], unit: &str) -> Result<Finding, CheckError> {
    let sign = given.choice("it", &[("rises", 1.0), ("falls", -1.0)])?;
    let holds = numbers.len() > 1 && numbers.windows(2).all(|pair| sign * (pair[1] - pair[0]) > 0.0);
    Ok(Finding::shape(holds, list(numbers, unit)))
}

/// Numbers with two decimals and their unit.
fn list(numbers: &[f64], unit: &str) -> String {
    let texts: Vec<_> = numbers.iter().map(|number| format!("{number:.2}")).collect();
    format!("{} {unit}", texts.join(", "))
}

/// Checks whether the swing at steady commands rises to a maximum between the ends, and falls from there on.
///
/// Argument `at`: commands in m/s, ascending. Fig 4.8, sections B to D, claim 4-104.
fn swing_rises_and_falls(given: &CheckArguments) -> Result<Finding, CheckError> {
    let swing = |command: &f64| {
        let (least, most) = range(&steady(recipe(given)?, *command)?)?;
        Ok(most - least)
    };
    let swings = given.numbers("at")?.iter().map(swing).collect::<Result<Vec<_>, CheckError>>()?;
    let rising = swings.windows(2).take_while(|pair| pair[1] > pair[0]).count();
    let falls = swings[rising..].windows(2).all(|pair| pair[1] < pair[0]);
    Ok(Finding::shape(rising > 0 && rising + 1 < swings.len() && falls, list(&swings, "mm/s peak to peak")))
}

/// Checks whether the largest swing of ramps rises or falls with a setting.
///
/// Fig 4.8: claims 4-105 ... 4-108, with K, Fs, VcL and Tc.
fn largest_swing_moves(given: &CheckArguments) -> Result<Finding, CheckError> {
    trend(given, &ramps_over(given, largest_swing)?, "mm/s peak to peak")
}

/// Checks whether the command at which oscillation ends in ramps rises or falls with a setting.
///
/// Fig 8.35: claims 8-155 and 9-002.a, with K.
fn critical_velocities_move(given: &CheckArguments) -> Result<Finding, CheckError> {
    trend(given, &ramps_over(given, |run| Ok(required_end(run)? / MM_PER_S))?, "mm/s")
}

/// Checks whether the slope of solid friction at the command at which oscillation ends rises or falls with a setting.
///
/// The slope is 2 Fs (VcL - Vc) / VcL^2 with Fs = 771 N. Claim 8-137, with Tc.
fn critical_slopes_move(given: &CheckArguments) -> Result<Finding, CheckError> {
    let friction = FallingFriction::simulated(given.number("VcL")?);
    let slopes = ramps_over(given, |run| Ok(friction.slope(required_end(run)?)? / N_S_PER_MM))?;
    trend(given, &slopes, "N s/mm")
}

/// Checks whether the critical velocity rises from each rate to the next, and by less at the slower rates.
///
/// Argument `rates`: in m/s2, ascending. Claim 8-131.
fn slower_ramps_move_less(given: &CheckArguments) -> Result<Finding, CheckError> {
    let at = |rate: &f64| Ok(required_end(&ramp(recipe(given)?, *rate, HIGHEST)?)? / MM_PER_S);
    let velocities = given.numbers("rates")?.iter().map(at).collect::<Result<Vec<f64>, CheckError>>()?;
    let changes: Vec<_> = velocities.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let holds = changes.len() > 1 && changes[0] > 0.0 && changes.windows(2).all(|pair| pair[1] > pair[0]);
    Ok(Finding::shape(holds, format!("{}, changes {}", list(&velocities, "mm/s"), list(&changes, "mm/s"))))
}

/// Checks whether a ramp at the slower of two rates does not oscillate, and a ramp at the faster rate does.
///
/// Arguments: `rate` and `faster` in m/s2. Ringing at breakaway does not count as oscillation. Claim 8-132.b.
fn quiet_at_one_rate(given: &CheckArguments) -> Result<Finding, CheckError> {
    let end = |rate: f64| end_of_oscillation(&ramp(recipe(given)?, rate, HIGHEST)?);
    let (slow, fast) = (end(given.number("rate")?)?, end(given.number("faster")?)?);
    let text = |end: Option<f64>| match end {
        Some(velocity) => format!("oscillates up to {:.2} mm/s", velocity / MM_PER_S),
        None => "is quiet".to_owned(),
    };
    let found = format!("the slower ramp {}; the faster ramp {}", text(slow), text(fast));
    Ok(Finding::truth(slow.is_none() && fast.is_some(), found))
}

/// Checks whether the slower of two ramps does not oscillate from a command on, while the faster one still oscillates.
///
/// Arguments: `at` in m/s, `rate` and `faster` in m/s2. Fig 8.29, claim 8-132.
fn quiet_at_one_command(given: &CheckArguments) -> Result<Finding, CheckError> {
    let command = given.number("at")?;
    let swing =
        |rate: f64| swing_within(&ramp(recipe(given)?, rate, HIGHEST)?, command / rate, HIGHEST / rate);
    let (slow, fast) = (swing(given.number("rate")?)?, swing(given.number("faster")?)?);
    let found = format!("swings of {slow:.2} mm/s, and of {fast:.2} mm/s in the faster ramp");
    Ok(Finding::truth(slow < OSCILLATES && fast > OSCILLATES, found))
}

/// The largest swing of velocity minus command within 0.04 s, in mm/s, between two times in s.
///
/// The swing is maximum minus minimum in a window of 0.04 s that moves by one sample.
///
/// # Errors
/// If the time between `from` and `till` is shorter than a window.
fn swing_within(run: &ReplayedRun, from: f64, till: f64) -> Result<f64, CheckError> {
    let time = &run.record.trace.time;
    let errors: Vec<f64> =
        run.record.points(("v_i", MM_PER_S), ("v_o", MM_PER_S))?.iter().map(|(v_i, v_o)| v_o - v_i).collect();
    let window = (Criterion::USUAL.window / (time[1] - time[0])).round() as usize;
    let first = time.partition_point(|time| *time < from);
    let last = time.partition_point(|time| *time <= till);
    let swing = |part: &[f64]| {
        let least = part.iter().copied().fold(f64::INFINITY, f64::min);
        part.iter().copied().fold(f64::NEG_INFINITY, f64::max) - least
    };
    if first + window > last {
        return Err(CheckError::Run(format!("the time from {from} to {till} s is shorter than a window")));
    }
    Ok(errors[first..last].windows(window).map(swing).fold(0.0, f64::max))
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
    Ok(Finding::truth(falling < OSCILLATES && after > OSCILLATES && slowly > OSCILLATES, found))
}

/// Swings in mm/s while the command falls at a rate in m/s2, and three seconds later.
///
/// The command rises to `from` in 1 s, holds for 1 s, falls to `to` and holds for 4 s.
fn fall(given: &CheckArguments, rate: f64) -> Result<(f64, f64), CheckError> {
    let (from, to) = (given.number("from")?, given.number("to")?);
    let (begin, ends) = (2.0, 2.0 + (from - to) / rate);
    let points = json!([[0, 0], [1, from], [begin, from], [ends, to]]);
    let drive = json!({"kind": "table", "scale": "velocity", "points": points});
    let recipe = recipe(given)?.edit("drives/v_i", drive).run_time(ends + 4.0).sample_interval(1e-3);
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
/// friction. The study has no such curve; it is chosen here. Claim 8-158 (8.6).
fn begins_at_speed(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (limit, crest) = (given.number("VcL")?, given.number("crest")?);
    let points = json!([[-100, 10], [-1, 10], [-crest, 0], [0, 0.5], [1, 0.5]]);
    let curve = json!({"kind": "function-generator", "in": "PC2", "points": points});
    let recipe = recipe(given)?.edit("machine", "unlimited").edit("elements/B2", curve);
    let run = ramp(recipe.edit("elements/A1/initial", 95), RATE, HIGHEST)?;
    let turns = crest * limit / RATE;
    let (slow, fast) =
        (swing_within(&run, turns / 3.0, 0.9 * turns)?, swing_within(&run, turns, HIGHEST / RATE)?);
    let found = format!(
        "swings of {slow:.2} mm/s while friction rises, of {fast:.2} mm/s from {:.2} mm/s on",
        crest * limit / MM_PER_S
    );
    Ok(Finding::shape(slow < OSCILLATES && fast > OSCILLATES, found))
}

/// Checks whether the circuit oscillates for a VcL below that of eq 3-9 by the share `within`, and does not for a VcL
/// above it by this share. `by` selects ramps or small disturbances.
///
/// Arguments: `Tc` in s, `within` and `by`, which is `ramp` or `disturbance`. The boundary is VcL = 2 Fs / Cn with Cn =
/// 7.5e4 Tc^1.54. Claims 9-005.a ... d: ramps show the ringing at breakaway on both sides.
fn printed_boundary_divides(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (memory, share) = (given.number("Tc")?, given.number("within")?);
    let boundary = stable_limit(SIMULATED_STATIC, SLOPE_BY_MEMORY.at(memory) * N_S_PER_MM)?;
    let by_ramp = given.choice("by", &[("ramp", true), ("disturbance", false)])?;
    let at = |share: f64| {
        let set = [("Tc", memory), ("VcL", share * boundary)];
        if by_ramp {
            end_of_oscillation(&ramp(Recipe::new("fig-8-16").set_all(&set), RATE, HIGHEST)?)
        } else {
            Ok(disturbance_boundary(&set, share * boundary)?)
        }
    };
    let (below, above) = (at(1.0 - share)?, at(1.0 + share)?);
    let text =
        |end: Option<f64>| end.map_or("quiet".to_owned(), |end| format!("up to {:.2} mm/s", end / MM_PER_S));
    let found =
        format!("VcL = {:.1} mm/s; below it {}, above it {}", boundary / MM_PER_S, text(below), text(above));
    Ok(Finding::truth(below.is_some() && above.is_none(), found))
}

/// Checks whether the swing of the table of 450 kgf, and the command at which it ends, fall from each oil to the
/// next. `eta` is in P, KLP in kgf/mm2.
///
/// Arguments: `K` in N/m, `to` in m/s, and the lists `eta` and `KLP` with one value per oil. Friction and Tc follow the
/// laws of chapter 9. Claims 4-028.a, 4-028.b, 4-028.c and 10-007.
fn oils_quieten(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (stiffness, viscosities, strengths) =
        (given.number("K")?, given.numbers("eta")?, given.numbers("KLP")?);
    if viscosities.len() != strengths.len() {
        return Err(CheckError::Run("eta and KLP must have the same number of values".to_owned()));
    }
    let (mut swings, mut ends) = (Vec::new(), Vec::new());
    for (viscosity, polar) in viscosities.into_iter().zip(strengths) {
        let run =
            ramp(with_oil(viscosity * POISE, polar * KGF_PER_MM2, stiffness)?, RATE, given.number("to")?)?;
        swings.push(largest_swing(&run)?);
        ends.push(end_of_oscillation(&run)?.unwrap_or(0.0) / MM_PER_S);
    }
    let falls = |numbers: &[f64]| numbers.len() > 1 && numbers.windows(2).all(|pair| pair[1] < pair[0]);
    let found = format!("swings of {}, up to {}", list(&swings, "mm/s"), list(&ends, "mm/s"));
    Ok(Finding::shape(falls(&swings) && falls(&ends), found))
}

/// The final circuit with the friction and the time constant of an oil by chapter 9.
///
/// Arguments are viscosity in Pa s, KLP in Pa and stiffness in N/m. The weight is 450 kgf.
fn with_oil(viscosity: f64, polar: f64, stiffness: f64) -> Result<Recipe, CheckError> {
    let interface = Interface { polar, ..Interface::MODEL };
    let design = Design { interface, ..Design::model(viscosity, stiffness) };
    // The thinnest oils have a VcL above the range of the patch.
    let recipe = Recipe::new("fig-8-16").edit("parameters/VcL/range", json!([0, 0.06]));
    Ok(recipe.set_all(&Parameters::of_design(&design)?.named()))
}

/// The largest steady command at which the table still swings after three seconds, and its run. The command is found
/// to 1 % of the critical velocity of the ramp.
///
/// Commands are tried from 100 % of the critical velocity downward, so the result is the first one that swings.
fn near_the_end(given: &CheckArguments) -> Result<(f64, ReplayedRun), CheckError> {
    let highest = required_end(&ramp(recipe(given)?, RATE, HIGHEST)?)?;
    for percent in (1..=100).rev() {
        let command = highest * f64::from(percent) / 100.0;
        let run = steady(recipe(given)?, command)?;
        let (least, most) = range(&run)?;
        if most - least > OSCILLATES {
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
    let (least, most) = range(&run)?;
    let (below, above) = (command / MM_PER_S - least, most - command / MM_PER_S);
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
