//! How far the table swings, and how settings and rates move where it ceases to.
//!
//! Arguments are those of the profiles. Oscillation is a swing of velocity above 0.25 mm/s within 0.04 s.

use serde_json::json;

use super::super::boundary::{RATE, growth, undisturbed};
use super::super::finding::Finding;
use super::super::given::Given;
use super::super::recipe::{Recipe, Replayed};
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
    Absent, Criterion, CyclesError, ProfileCriterion, Way, cycles, velocity_profile,
};

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

/// A run in which the command rises steadily from rest.
fn ramp(recipe: Recipe, rate: f64, highest: f64) -> Result<Replayed, CheckError> {
    let recipe = recipe.set("v_rate", rate).lasting(highest / rate).recording(&["v_i", "v_o"]);
    Ok(recipe.run("ramp", "")?.within_range()?)
}

/// The largest swing in a ramp, peak to peak in mm/s; 0 where there is no whole cycle.
fn largest_swing(run: &Replayed) -> Result<f64, CheckError> {
    let found = cycles(&run.trace.time, &run.values("v_i")?, &run.values("v_o")?, Criterion::USUAL);
    match found {
        Ok(cycles) => Ok(cycles.iter().map(|cycle| 2.0 * cycle.amplitude).fold(0.0, f64::max) / MM_PER_S),
        Err(CyclesError::Quiet) => Ok(0.0),
        Err(error) => Err(CheckError::Run(error.to_string())),
    }
}

/// The command in m/s at which oscillation ends while it rises; nothing where there is none but the ringing as it breaks away.
fn ceases(run: &Replayed) -> Result<Option<f64>, CheckError> {
    let criterion = ProfileCriterion::usual(Criterion::USUAL);
    let (time, command, velocity) = (&run.trace.time, run.values("v_i")?, run.values("v_o")?);
    let profile = velocity_profile(time, &command, &velocity, criterion, Way::Rising);
    match profile.map_err(|error| CheckError::Run(error.to_string()))?.points[4] {
        Ok(end) => Ok(Some(end.command)),
        Err(Absent::Quiet | Absent::RingsOnly) => Ok(None),
        Err(error) => Err(CheckError::Run(error.to_string())),
    }
}

fn ceases_somewhere(run: &Replayed) -> Result<f64, CheckError> {
    ceases(run)?.ok_or_else(|| CheckError::Run("no oscillation is seen".to_owned()))
}

/// What ramps read, one for each value of the setting that varies.
fn over(given: &Given, read: impl Fn(&Replayed) -> Result<f64, CheckError>) -> Result<Vec<f64>, CheckError> {
    let (recipe, varied) = (recipe(given)?, given.need("vary")?);
    let (rate, highest) = (given.number_or("rate", RATE)?, given.number_or("to", HIGHEST)?);
    let at = |value: &f64| read(&ramp(recipe.clone().set(varied, *value), rate, highest)?);
    given.numbers("over")?.iter().map(at).collect()
}

/// Whether numbers rise, or fall, each to the next.
fn moves(given: &Given, numbers: &[f64], unit: &str) -> Result<Finding, CheckError> {
    let sign = given.word("it", &[("rises", 1.0), ("falls", -1.0)])?;
    let holds = numbers.len() > 1 && numbers.windows(2).all(|pair| sign * (pair[1] - pair[0]) > 0.0);
    Ok(Finding::shape(holds, told(numbers, unit)))
}

fn told(numbers: &[f64], unit: &str) -> String {
    let told: Vec<_> = numbers.iter().map(|number| format!("{number:.2}")).collect();
    format!("{} {unit}", told.join(", "))
}

/// Whether the swing at steady commands rises to a largest one between the ends, and falls from there on.
fn swing_rises_and_falls(given: &Given) -> Result<Finding, CheckError> {
    let swing = |command: &f64| {
        let (least, most) = range(&steady(recipe(given)?, *command)?)?;
        Ok(most - least)
    };
    let swings = given.numbers("at")?.iter().map(swing).collect::<Result<Vec<_>, CheckError>>()?;
    let rising = swings.windows(2).take_while(|pair| pair[1] > pair[0]).count();
    let falls = swings[rising..].windows(2).all(|pair| pair[1] < pair[0]);
    Ok(Finding::shape(rising > 0 && rising + 1 < swings.len() && falls, told(&swings, "mm/s peak to peak")))
}

/// Whether the largest swing of ramps rises or falls with a setting.
fn largest_swing_moves(given: &Given) -> Result<Finding, CheckError> {
    moves(given, &over(given, largest_swing)?, "mm/s peak to peak")
}

/// Whether the command at which ramps cease to oscillate rises or falls with a setting.
fn critical_velocities_move(given: &Given) -> Result<Finding, CheckError> {
    moves(given, &over(given, |run| Ok(ceases_somewhere(run)? / MM_PER_S))?, "mm/s")
}

/// Whether the slope of solid friction at that command does.
fn critical_slopes_move(given: &Given) -> Result<Finding, CheckError> {
    let friction = FallingFriction::simulated(given.number("VcL")?);
    let slopes = over(given, |run| Ok(friction.slope(ceases_somewhere(run)?)? / N_S_PER_MM))?;
    moves(given, &slopes, "N s/mm")
}

/// Whether the critical velocity changes from each rate to the next, by less at the slower ones.
fn slower_ramps_move_less(given: &Given) -> Result<Finding, CheckError> {
    let at = |rate: &f64| Ok(ceases_somewhere(&ramp(recipe(given)?, *rate, HIGHEST)?)? / MM_PER_S);
    let velocities = given.numbers("rates")?.iter().map(at).collect::<Result<Vec<f64>, CheckError>>()?;
    let changes: Vec<_> = velocities.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let holds = changes.len() > 1 && changes[0] > 0.0 && changes.windows(2).all(|pair| pair[1] > pair[0]);
    Ok(Finding::shape(holds, format!("{}, by {}", told(&velocities, "mm/s"), told(&changes, "mm/s"))))
}

/// Whether a ramp at the slower of two rates does not oscillate at all, and one at the faster does.
fn quiet_at_one_rate(given: &Given) -> Result<Finding, CheckError> {
    let end = |rate: f64| ceases(&ramp(recipe(given)?, rate, HIGHEST)?);
    let (slow, fast) = (end(given.number("rate")?)?, end(given.number("faster")?)?);
    let told = |end: Option<f64>| match end {
        Some(velocity) => format!("oscillates up to {:.2} mm/s", velocity / MM_PER_S),
        None => "is quiet".to_owned(),
    };
    let found = format!("it {}; the faster one {}", told(slow), told(fast));
    Ok(Finding::truth(slow.is_none() && fast.is_some(), found))
}

/// Whether the slower of two ramps has ceased to oscillate at a command, from there on, where the faster one still does.
fn quiet_at_one_command(given: &Given) -> Result<Finding, CheckError> {
    let command = given.number("at")?;
    let swing =
        |rate: f64| swing_within(&ramp(recipe(given)?, rate, HIGHEST)?, command / rate, HIGHEST / rate);
    let (slow, fast) = (swing(given.number("rate")?)?, swing(given.number("faster")?)?);
    let found = format!("swings of {slow:.2} mm/s, and of {fast:.2} mm/s by the faster one");
    Ok(Finding::truth(slow < OSCILLATES && fast > OSCILLATES, found))
}

/// The largest swing of velocity less command within 0.04 s, in mm/s, from one time on to another.
fn swing_within(run: &Replayed, from: f64, till: f64) -> Result<f64, CheckError> {
    let time = &run.trace.time;
    let off: Vec<f64> =
        run.points(("v_i", MM_PER_S), ("v_o", MM_PER_S))?.iter().map(|(v_i, v_o)| v_o - v_i).collect();
    let window = (Criterion::USUAL.window / (time[1] - time[0])).round() as usize;
    let first = time.partition_point(|time| *time < from);
    let last = time.partition_point(|time| *time <= till);
    let swing = |part: &[f64]| {
        let least = part.iter().copied().fold(f64::INFINITY, f64::min);
        part.iter().copied().fold(f64::NEG_INFINITY, f64::max) - least
    };
    if first + window > last {
        return Err(CheckError::Run(format!("from {from} to {till} s is less than a window")));
    }
    Ok(off[first..last].windows(window).map(swing).fold(0.0, f64::max))
}

/// Whether a command that falls at a rate to a slow one suppresses oscillation meanwhile, which comes back there, and one that falls at
/// a `slower` rate does not.
fn fast_fall_is_quiet(given: &Given) -> Result<Finding, CheckError> {
    let (falling, after) = fall(given, given.number("rate")?)?;
    let (slowly, _) = fall(given, given.number("slower")?)?;
    let found = format!(
        "swings of {falling:.2} mm/s while it falls, {after:.2} mm/s three seconds later; of {slowly:.2} mm/s while it falls slowly"
    );
    Ok(Finding::truth(falling < OSCILLATES && after > OSCILLATES && slowly > OSCILLATES, found))
}

/// Swings in mm/s while the command falls at a rate, and three seconds later.
fn fall(given: &Given, rate: f64) -> Result<(f64, f64), CheckError> {
    let (from, to) = (given.number("from")?, given.number("to")?);
    let (begin, ends) = (2.0, 2.0 + (from - to) / rate);
    let points = json!([[0, 0], [1, from], [begin, from], [ends, to]]);
    let drive = json!({"kind": "table", "scale": "velocity", "points": points});
    let recipe = recipe(given)?.edit("drives/v_i", drive).lasting(ends + 4.0).every(1e-3);
    let run = recipe.recording(&["v_i", "v_o"]).run("fall", "")?;
    Ok((swing_within(&run, begin, ends)?, swing_within(&run, ends + 3.0, ends + 4.0)?))
}

/// Whether a small disturbance of steady sliding grows without lag at shares of the velocity of least friction below 1, and dies away
/// above.
fn grows_where_friction_falls(given: &Given) -> Result<Finding, CheckError> {
    let (limit, damping) = (given.number("VcL")?, DrivenTable::simulated(0.0).damping);
    let least = FallingFriction::simulated(limit).velocity_of_least(damping)?;
    let (mut holds, mut told) = (true, Vec::new());
    for share in given.numbers("shares")? {
        let grown = growth(Recipe::of("fig-8-14").set("VcL", limit), share * least)?;
        holds &= (grown > 1.0) == (share < 1.0);
        told.push(format!("x {grown:.2} at {share} of it"));
    }
    Ok(Finding::truth(
        holds,
        format!("friction is least at {:.2} mm/s: {}", least / MM_PER_S, told.join(", ")),
    ))
}

/// Whether oscillation begins at a velocity well above rest where friction rises a little, from 90 % of Fs, up to `crest` of VcL before
/// it falls. Breaking away is over by a third of that.
fn begins_at_speed(given: &Given) -> Result<Finding, CheckError> {
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

/// Whether the circuit oscillates a share below the VcL of eq 3-9, and is quiet that much above it: by ramps, or by small disturbances.
fn printed_boundary_divides(given: &Given) -> Result<Finding, CheckError> {
    let (memory, share) = (given.number("Tc")?, given.number("within")?);
    let boundary = stable_limit(SIMULATED_STATIC, SLOPE_BY_MEMORY.at(memory) * N_S_PER_MM)?;
    let by_ramp = given.word("by", &[("ramp", true), ("disturbance", false)])?;
    let at = |share: f64| {
        let set = [("Tc", memory), ("VcL", share * boundary)];
        if by_ramp {
            ceases(&ramp(Recipe::of("fig-8-16").with(&set), RATE, HIGHEST)?)
        } else {
            Ok(undisturbed(&set, share * boundary)?)
        }
    };
    let (below, above) = (at(1.0 - share)?, at(1.0 + share)?);
    let told =
        |end: Option<f64>| end.map_or("quiet".to_owned(), |end| format!("up to {:.2} mm/s", end / MM_PER_S));
    let found =
        format!("VcL = {:.1} mm/s; below it {}, above it {}", boundary / MM_PER_S, told(below), told(above));
    Ok(Finding::truth(below.is_some() && above.is_none(), found))
}

/// Whether the table of 450 kgf swings less, and ceases to at a lower command, from each oil to the next: `eta` in P, and
/// KLP in kgf/mm2.
fn oils_quieten(given: &Given) -> Result<Finding, CheckError> {
    let (stiffness, viscosities, strengths) =
        (given.number("K")?, given.numbers("eta")?, given.numbers("KLP")?);
    if viscosities.len() != strengths.len() {
        return Err(CheckError::Run("each eta wants its KLP".to_owned()));
    }
    let (mut swings, mut ends) = (Vec::new(), Vec::new());
    for (viscosity, polar) in viscosities.into_iter().zip(strengths) {
        let run =
            ramp(with_oil(viscosity * POISE, polar * KGF_PER_MM2, stiffness)?, RATE, given.number("to")?)?;
        swings.push(largest_swing(&run)?);
        ends.push(ceases(&run)?.unwrap_or(0.0) / MM_PER_S);
    }
    let falls = |numbers: &[f64]| numbers.len() > 1 && numbers.windows(2).all(|pair| pair[1] < pair[0]);
    let found = format!("swings of {}, up to {}", told(&swings, "mm/s"), told(&ends, "mm/s"));
    Ok(Finding::shape(falls(&swings) && falls(&ends), found))
}

/// The final circuit with friction and memory of an oil, as chapter 9 has them.
fn with_oil(viscosity: f64, polar: f64, stiffness: f64) -> Result<Recipe, CheckError> {
    let interface = Interface { polar, ..Interface::MODEL };
    let design = Design { interface, ..Design::model(viscosity, stiffness) };
    // The thinnest oils have a VcL beyond what the patch is made for.
    let recipe = Recipe::of("fig-8-16").edit("parameters/VcL/range", json!([0, 0.06]));
    Ok(recipe.with(&Parameters::of_design(&design)?.named()))
}

/// The largest steady command, to 1 % of the ramp's critical velocity, at which the table still swings after three seconds, and the run.
fn near_the_end(given: &Given) -> Result<(f64, Replayed), CheckError> {
    let highest = ceases_somewhere(&ramp(recipe(given)?, RATE, HIGHEST)?)?;
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

/// Whether the swings there are as far above it as below, to 5 %.
fn even_halves_near_the_end(given: &Given) -> Result<Finding, CheckError> {
    let (command, run) = near_the_end(given)?;
    let (least, most) = range(&run)?;
    let (below, above) = (command / MM_PER_S - least, most - command / MM_PER_S);
    let found = format!("{above:.2} mm/s above and {below:.2} mm/s below {:.2} mm/s", command / MM_PER_S);
    Ok(Finding::truth((above - below).abs() <= 0.05 * (above + below), found))
}

/// The frequency of the spring force there, in Hz.
fn frequency_near_the_end(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(hertz(&near_the_end(given)?.1)?))
}

/// By how many percent potentiometers that are each 1 % off move the frequency of oscillation: the root of the sum of squares.
fn pots_move_frequency(given: &Given) -> Result<Finding, CheckError> {
    const OFF: f64 = 0.99;
    let (command, pots) = (given.number("at")?, ["PC5", "PA5", "PA4", "PA3", "PC2", "PA2", "PA1", "PC1"]);
    let plain = frequency_of(recipe(given)?, command)?;
    let circuit = recipe(given)?.circuit("pots", "")?;
    let mut squares = 0.0;
    for pot in pots {
        let off = OFF * setting(&circuit, pot)?;
        let moved = frequency_of(recipe(given)?.edit(&format!("elements/{pot}/setting"), off), command)?;
        squares += (100.0 * (moved / plain - 1.0)).powi(2);
    }
    Ok(Finding::Number(squares.sqrt()))
}

fn frequency_of(recipe: Recipe, command: f64) -> Result<f64, CheckError> {
    hertz(&steady(recipe, command)?)
}
