//! Claims on the amplitude and on the end of oscillation while the command rises, and on the influence of settings and
//! rates.
//!
//! A ramp raises the command from rest at a steady rate, 1.2 mm/s2 unless given. Three quantities are read from it: the
//! largest swing, the command at which oscillation ends, and the swing between two times. The arguments are those of
//! the profiles. Arguments of series are `vary`, the name of a setting, and `over`, its values.
//!
//! Oscillation is a swing of velocity above 0.25 mm/s within 0.04 s.

use super::super::boundary::{RATE, disturbance_boundary};
use super::super::check_arguments::CheckArguments;
use super::super::finding::Finding;
use super::super::recipe::Recipe;
use super::super::run_record::ReplayedRun;
use super::super::series::{TRENDS, format_list, is_falling, is_rising, min_max};
use super::profiles::{MAX_COMMAND, recipe};
use super::recordings::OSCILLATION_THRESHOLD;
use super::{Check, CheckError};
use crate::chain::Parameters;
use crate::slideway::design::{Design, Interface};
use crate::slideway::falling::{FallingFriction, SIMULATED_STATIC, stable_limit};
use crate::slideway::simulated::SLOPE_BY_MEMORY;
use crate::slideway::units::{KGF_PER_MM2, MM_PER_S, N_S_PER_MM, POISE};
use patchcord_analysis::instruments::{
    Criterion, CyclesError, MissingPointError, ProfileCriterion, RampDirection, cycles, velocity_profile,
};

/// The checks of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[
    Check { name: "largest-swing-moves", run: largest_swing_moves },
    Check { name: "critical-velocities-move", run: critical_velocities_move },
    Check { name: "critical-slopes-move", run: critical_slopes_move },
    Check { name: "slower-ramps-move-less", run: slower_ramps_move_less },
    Check { name: "quiet-at-one-rate", run: quiet_at_one_rate },
    Check { name: "quiet-at-one-command", run: quiet_at_one_command },
    Check { name: "printed-boundary-divides", run: printed_boundary_divides },
    Check { name: "oils-quieten", run: oils_quieten },
];

/// A run in which the command rises steadily from rest to `highest` in m/s, at a rate in m/s2.
///
/// # Errors
/// If the recipe is wrong, the run fails, or an amplifier was overloaded.
pub(super) fn ramp(recipe: Recipe, rate: f64, highest: f64) -> Result<ReplayedRun, CheckError> {
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
        Err(MissingPointError::NoOscillation | MissingPointError::RingsOnly) => Ok(None),
        Err(error) => Err(CheckError::Run(error.to_string())),
    }
}

/// The command in m/s at which oscillation ends.
///
/// # Errors
/// If there is no oscillation.
pub(super) fn required_end(run: &ReplayedRun) -> Result<f64, CheckError> {
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
    let (rate, highest) = (given.number_or("rate", RATE)?, given.number_or("to", MAX_COMMAND)?);
    let at = |value: &f64| read(&ramp(recipe.clone().set(varied, *value), rate, highest)?);
    given.numbers("over")?.iter().map(at).collect()
}

/// Checks whether numbers rise or fall steadily, as `it` states. `it` is `rises` or `falls`, and a single number never
/// holds.
fn trend(given: &CheckArguments, numbers: &[f64], unit: &str) -> Result<Finding, CheckError> {
    let has_trend = given.choice("it", &TRENDS)?;
    let holds = numbers.len() > 1 && has_trend(numbers);
    Ok(Finding::shape(holds, format_list(numbers, 2, unit)))
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
    let at = |rate: &f64| Ok(required_end(&ramp(recipe(given)?, *rate, MAX_COMMAND)?)? / MM_PER_S);
    let velocities = given.numbers("rates")?.iter().map(at).collect::<Result<Vec<f64>, CheckError>>()?;
    let changes: Vec<_> = velocities.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let holds = changes.len() > 1 && changes[0] > 0.0 && is_rising(&changes);
    let [velocities, changes] = [velocities, changes].map(|numbers| format_list(&numbers, 2, "mm/s"));
    Ok(Finding::shape(holds, format!("{velocities}, changes {changes}")))
}

/// Checks whether a ramp at the slower of two rates does not oscillate, and a ramp at the faster rate does.
///
/// Arguments: `rate` and `faster` in m/s2. Ringing at breakaway does not count as oscillation. Claim 8-132.b.
fn quiet_at_one_rate(given: &CheckArguments) -> Result<Finding, CheckError> {
    let end = |rate: f64| end_of_oscillation(&ramp(recipe(given)?, rate, MAX_COMMAND)?);
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
    let swing = |rate: f64| {
        swing_within(&ramp(recipe(given)?, rate, MAX_COMMAND)?, command / rate, MAX_COMMAND / rate)
    };
    let (slow, fast) = (swing(given.number("rate")?)?, swing(given.number("faster")?)?);
    let found = format!("swings of {slow:.2} mm/s, and of {fast:.2} mm/s in the faster ramp");
    Ok(Finding::truth(slow < OSCILLATION_THRESHOLD && fast > OSCILLATION_THRESHOLD, found))
}

/// The largest swing of velocity minus command within 0.04 s, in mm/s, between two times in s.
///
/// The swing is maximum minus minimum in a window of 0.04 s that moves by one sample.
///
/// # Errors
/// If the time between `from` and `till` is shorter than a window.
pub(super) fn swing_within(run: &ReplayedRun, from: f64, till: f64) -> Result<f64, CheckError> {
    let time = &run.record.trace.time;
    let errors: Vec<f64> =
        run.record.points(("v_i", MM_PER_S), ("v_o", MM_PER_S))?.iter().map(|(v_i, v_o)| v_o - v_i).collect();
    let window = (Criterion::USUAL.window / (time[1] - time[0])).round() as usize;
    let first = time.partition_point(|time| *time < from);
    let last = time.partition_point(|time| *time <= till);
    let swing = |part: &[f64]| {
        let (min, max) = min_max(part.iter().copied());
        max - min
    };
    if first + window > last {
        return Err(CheckError::Run(format!("the time from {from} to {till} s is shorter than a window")));
    }
    Ok(errors[first..last].windows(window).map(swing).fold(0.0, f64::max))
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
            end_of_oscillation(&ramp(Recipe::new("fig-8-16").set_all(&set), RATE, MAX_COMMAND)?)
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
    let holds = swings.len() > 1 && is_falling(&swings) && is_falling(&ends);
    let [swings, ends] = [swings, ends].map(|numbers| format_list(&numbers, 2, "mm/s"));
    Ok(Finding::shape(holds, format!("swings of {swings}, up to {ends}")))
}

/// The final circuit with the friction and the time constant of an oil by chapter 9.
///
/// Arguments are viscosity in Pa s, KLP in Pa and stiffness in N/m. The weight is 450 kgf.
fn with_oil(viscosity: f64, polar: f64, stiffness: f64) -> Result<Recipe, CheckError> {
    let interface = Interface { polar, ..Interface::MODEL };
    let design = Design { interface, ..Design::model(viscosity, stiffness) };
    // The thinnest oils have a VcL above the range of the patch.
    let recipe = Recipe::new("fig-8-16").edit("parameters/VcL/range", [0.0, 0.06]);
    Ok(recipe.set_all(&Parameters::of_design(&design)?.named()))
}
