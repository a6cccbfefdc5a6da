//! Claims on breakaway, on the position of rest, and on the balance of forces during the motion.
//!
//! Friction acts here in two forms. A dead zone subtracts from the spring force what friction cancels, so a table at
//! rest stays at rest. Friction as a constant force would push the table. `x_o`, `v_o` and `a_o` are position, velocity
//! and acceleration of the table, `x_i` is the commanded position.

use super::super::check_arguments::CheckArguments;
use super::super::finding::Finding;
use super::super::recipe::Recipe;
use super::super::run_record::ReplayedRun;
use super::shipped::{ACCURACY, shipped};
use super::{Check, CheckError};
use crate::slideway::falling::SIMULATED_STATIC;
use crate::slideway::scaling::Scales;
use crate::slideway::units::{MM, MM_PER_S, UM};
use patchcord_core::patch::ElementBuilder;

/// The checks of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[
    Check { name: "friction-pushes-back", run: friction_pushes_back },
    Check { name: "coasts", run: coasts },
    Check { name: "rings-about-the-input", run: rings_about_the_input },
    Check { name: "settles-at", run: settles_at },
    Check { name: "stops-off-the-input", run: stops_off_the_input },
    Check { name: "breaks-away-at", run: breaks_away_at },
    Check { name: "forces-balance", run: forces_balance },
    Check { name: "climbs-in-steps", run: climbs_in_steps },
    Check { name: "position-is-restricted", run: position_is_restricted },
];

/// The last value of a signal, in SI units.
fn last(run: &ReplayedRun, signal: &str) -> Result<f64, CheckError> {
    let values = run.record.values(signal)?;
    values.last().copied().ok_or_else(|| CheckError::Run(format!("{signal} is not recorded")))
}

/// Checks whether static friction as a force (eq 13-8) moves a table back that is at rest without a command, and the
/// dead zone does not.
///
/// The circuit of Fig 8.4 gets a pot for Fs = 771 N at the input of its force amplifier. After 1 s without a command it
/// must have moved by more than 1 um in the negative direction. The circuit of Fig 8.7 must not have moved at all.
/// Claim 8-029 (eq 13-8, 14-8).
fn friction_pushes_back(_: &CheckArguments) -> Result<Finding, CheckError> {
    let setting = SIMULATED_STATIC / Scales::A.force / 100.0;
    let literal = Recipe::new("fig-8-04")
        .element("PF", ElementBuilder::new("pot").cord("in", "+100").set("setting", setting))
        .edit("elements/A4/in/x1", ["A5", "PA4", "PF"]);
    let position = |recipe: Recipe| {
        let run = recipe.set("x_step", 0.0).run_time(1.0).record(&["x_o"]).run("rest", "")?;
        last(&run, "x_o")
    };
    let (pushed, unmoved) = (position(literal)? / UM, position(Recipe::new("fig-8-07"))? / UM);
    let found = format!("{pushed:.1} um with friction as a force, {unmoved:.1} um with the dead zone");
    Ok(Finding::truth(pushed < -1.0 && unmoved == 0.0, found))
}

/// Checks whether a table whose spring force is inside the dead zone is slowed only by viscous friction, with the
/// time constant M / f.
///
/// Arguments: `M` in kg, `f` in N s/m and the initial velocity `v` in m/s. The run lasts three time constants. The
/// velocity must follow v exp(-t f / M) to 2 %, while the spring force is between 0.1 and 1 times Fs. Claim 8-031 (eq
/// 15-8, 16-8).
fn coasts(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (mass, damping, start) = (given.number("M")?, given.number("f")?, given.number("v")?);
    let recipe = Recipe::new("fig-8-07").set("M", mass).set("f", damping).set("x_step", 0.0);
    let recipe = recipe.edit("elements/A3/initial", -start / Scales::B.velocity);
    let time_constant = mass / damping;
    let run = recipe.run_time(3.0 * time_constant).sample_interval(1e-4).record(&["v_o", "spring_force"]);
    let run = run.run("coasting", "")?;
    let (mut largest, mut pull) = (0.0_f64, 0.0_f64);
    for ((velocity, force), time) in run
        .record
        .points(("v_o", start), ("spring_force", SIMULATED_STATIC))?
        .into_iter()
        .zip(&run.record.trace.time)
    {
        largest = largest.max((velocity - (-time / time_constant).exp()).abs());
        pull = pull.max(force.abs());
    }
    let found = format!(
        "velocity decays with {:.1} ms to an accuracy of {:.1e}, while the spring pulls with up to {pull:.2} Fs",
        time_constant * 1e3,
        largest
    );
    Ok(Finding::truth(largest < ACCURACY && pull > 0.1 && pull < 1.0, found))
}

/// The response to a step of position, for one second.
///
/// The height is that of the shipped patch, 0.127 mm. Signals: commanded position, position and their difference.
fn step(given: &CheckArguments) -> Result<ReplayedRun, CheckError> {
    let run = shipped(given)?.run_time(1.0).record(&["x_i", "x_o", "x_error"]);
    Ok(run.run("step", "")?)
}

/// Checks whether position passes the input more than twice, upward and downward together.
///
/// Fig 8.8 (a), claim 8-058.a.
fn rings_about_the_input(given: &CheckArguments) -> Result<Finding, CheckError> {
    let run = step(given)?;
    let points = run.record.points(("x_i", MM), ("x_o", MM))?;
    let above: Vec<_> = points.iter().skip(1).map(|(input, output)| output > input).collect();
    let passes = above.windows(2).filter(|pair| pair[0] != pair[1]).count();
    let peak = points.iter().map(|(_, output)| *output).fold(0.0, f64::max);
    Ok(Finding::truth(passes > 2, format!("passes the input {passes} times, and reaches {peak:.3} mm")))
}

/// The final position, in mm.
///
/// Fig 8.8 (a), claim 8-058.b.
fn settles_at(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(last(&step(given)?, "x_o")? / MM))
}

/// Checks whether the table stops away from the input, by at most Fs / K.
///
/// Argument `K` in N/m must be the stiffness of the circuit. The error must also exceed 1 % of Fs / K: the table does
/// not reach the input. Fig 8.8 (b), claim 8-059.
fn stops_off_the_input(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (run, limit) = (step(given)?, SIMULATED_STATIC / given.number("K")?);
    let error = (last(&run, "x_o")? - last(&run, "x_i")?).abs();
    let found = format!("{:.1} um from the input; friction holds up to {:.1} um", error / UM, limit / UM);
    Ok(Finding::truth(error > 0.01 * limit && error <= limit, found))
}

/// The spring force at which a table at rest first moves under a slow command, in N or in units of `by` N.
///
/// The command is 0.01 mm/s, so that the spring force rises slowly. Motion is a velocity above 1e-9 mm/s. Claim 4-122:
/// 771 N; claim 8-116: 17 V with `by=45.36` N/V.
fn breaks_away_at(given: &CheckArguments) -> Result<Finding, CheckError> {
    let recipe = shipped(given)?.set("v_start", 1e-5).set("v_rate", 0.0).run_time(3.0);
    let run = recipe.record(&["v_o", "spring_force"]).run("rest", "")?;
    let points = run.record.points(("v_o", MM_PER_S), ("spring_force", given.number_or("by", 1.0)?))?;
    let moves = points.into_iter().find(|(velocity, _)| velocity.abs() > 1e-9);
    let moves = moves.ok_or_else(|| CheckError::Run("the table does not move".to_owned()))?;
    Ok(Finding::Number(moves.1))
}

/// Checks whether mass times acceleration equals the sum of spring force, solid friction and viscous friction at
/// every sample (eq 13-8 or 12-4).
///
/// Arguments: the circuit, and `for`, the duration in s. The useful force is the spring force outside the dead zone of
/// the recorded friction level. The residual must be below 1e-9 of the largest useful force. Claims 3-003, 4-114, 4-115
/// and 4-121.
fn forces_balance(given: &CheckArguments) -> Result<Finding, CheckError> {
    let recipe = shipped(given)?.run_time(given.number("for")?).sample_interval(1e-3);
    let run = recipe.record(&["a_o", "v_o", "spring_force", "friction_level"]).run("balance", "")?;
    let parameter = |name: &str| {
        let found = run.patch().parameters.get(name).map(|parameter| parameter.value);
        found.ok_or_else(|| CheckError::Run(format!("there is no parameter {name}")))
    };
    let (mass, damping) = (parameter("M")?, parameter("f")?);
    let [accelerations, velocities] = [run.record.values("a_o")?, run.record.values("v_o")?];
    let forces = run.record.points(("spring_force", 1.0), ("friction_level", 1.0))?;
    let (mut residual, mut most) = (0.0_f64, 0.0_f64);
    for ((acceleration, velocity), (spring, level)) in accelerations.iter().zip(&velocities).zip(forces) {
        let useful = spring - spring.clamp(-level, level);
        residual = residual.max((mass * acceleration - useful + damping * velocity).abs());
        most = most.max(useful.abs());
    }
    let found = format!("residual {residual:.1e} N of up to {most:.0} N");
    Ok(Finding::truth(residual < 1e-9 * most, found))
}

/// Checks whether position rises in steps while velocity shows pulses. The table must be slower than the command for
/// four fifths of the time, and its pulses must be five times as fast as the command.
///
/// Argument `at`: the command in m/s. The run lasts 4 s and must show more than four pulses; a pulse begins where
/// velocity passes half of its maximum upward. Fig 3.4, claim 3-007.
fn climbs_in_steps(given: &CheckArguments) -> Result<Finding, CheckError> {
    let command = given.number("at")?;
    let recipe =
        shipped(given)?.set("v_start", command).set("v_rate", 0.0).run_time(4.0).sample_interval(2e-4);
    let run = recipe.record(&["v_o"]).run("steps", "")?;
    let shares: Vec<f64> = run.record.values("v_o")?.iter().map(|velocity| velocity / command).collect();
    let slower = shares.iter().filter(|share| **share < 1.0).count() as f64 / shares.len() as f64;
    let peak = shares.iter().copied().fold(0.0, f64::max);
    let pulses = shares.windows(2).filter(|pair| pair[0] < 0.5 * peak && pair[1] >= 0.5 * peak).count();
    let found = format!(
        "{:.1} pulses a second, of up to {:.2} mm/s; slower than the command for {:.0} % of the time",
        pulses as f64 / 4.0,
        peak * command / MM_PER_S,
        100.0 * slower
    );
    Ok(Finding::shape(pulses > 4 && peak > 5.0 && slower > 0.8, found))
}

/// Checks whether a step of position overloads the final circuit at a height that is within the scale, `x` m. A
/// velocity command must move the table ten times as far without an overload.
///
/// Bisection finds the largest step without an overload, to 0.1 % of `x`. It must be below `x`, the 0.254 mm that the
/// text allows. Claim 8-107 (8.2, 8.3).
fn position_is_restricted(given: &CheckArguments) -> Result<Finding, CheckError> {
    let allowed = given.number("x")?;
    let (mut within, mut beyond) = (0.0, 2.0 * allowed);
    while beyond - within > 1e-3 * allowed {
        let middle = 0.5 * (within + beyond);
        if overloads(middle)? { beyond = middle } else { within = middle }
    }
    let moving = Recipe::new("fig-8-16").record(&["v_o"]).run("velocity", "")?;
    let (velocities, time) = (moving.record.values("v_o")?, &moving.record.trace.time);
    let steps = time.windows(2).zip(&velocities).map(|(pair, velocity)| (pair[1] - pair[0]) * velocity);
    let travel = steps.sum::<f64>();
    let holds = within < allowed && moving.record.trace.overloads().count() == 0 && travel > 10.0 * allowed;
    let found = format!(
        "steps above {:.3} mm overload it; a velocity command moves the table by {:.0} mm",
        within / MM,
        travel / MM
    );
    Ok(Finding::truth(holds, found))
}

/// Checks whether a step of position in m overloads the final circuit.
///
/// The run lasts 0.1 s. The range of the step in the patch is widened, because it would refuse such heights.
fn overloads(height: f64) -> Result<bool, CheckError> {
    let recipe = Recipe::new("fig-8-16").set("v_rate", 0.0).set("x_step", height).run_time(0.1);
    let run = recipe.edit("parameters/x_step/range", [0.0, 1.0]).run("position", "")?;
    Ok(run.record.trace.overloads().next().is_some())
}
