//! How a table leaves rest, where it comes to rest, and whether all forces on it balance meanwhile.

use serde_json::json;

use super::super::finding::Finding;
use super::super::given::Given;
use super::super::recipe::{Recipe, Replayed};
use super::shipped::{ACCURACY, shipped};
use super::{Check, CheckError};
use crate::slideway::falling::SIMULATED_STATIC;
use crate::slideway::scaling::Scales;
use crate::slideway::units::{MM, MM_PER_S, UM};

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

/// The last value of a signal.
fn end(run: &Replayed, signal: &str) -> Result<f64, CheckError> {
    let values = run.values(signal)?;
    values.last().copied().ok_or_else(|| CheckError::Run(format!("{signal} is not recorded")))
}

/// Whether static friction, taken as a force as in eq 13-8, moves a table back that no command moves, and the dead zone leaves it.
fn friction_pushes_back(_: &Given) -> Result<Finding, CheckError> {
    let setting = SIMULATED_STATIC / Scales::A.force / 100.0;
    let literal = Recipe::of("fig-8-04")
        .edit("elements/PF", json!({"kind": "pot", "in": "+100", "setting": setting}))
        .edit("elements/A4/in/x1", json!(["A5", "PA4", "PF"]));
    let rests = |recipe: Recipe| {
        let run = recipe.set("x_step", 0.0).lasting(1.0).recording(&["x_o"]).run("rest", "")?;
        end(&run, "x_o")
    };
    let (pushed, left) = (rests(literal)? / UM, rests(Recipe::of("fig-8-07"))? / UM);
    let found = format!("to {pushed:.1} um as a force, {left:.1} um with the dead zone");
    Ok(Finding::truth(pushed < -1.0 && left == 0.0, found))
}

/// Whether a table whose spring force is inside the dead zone slows by viscous friction alone, with M / f.
fn coasts(given: &Given) -> Result<Finding, CheckError> {
    let (mass, damping, start) = (given.number("M")?, given.number("f")?, given.number("v")?);
    let recipe = Recipe::of("fig-8-07").set("M", mass).set("f", damping).set("x_step", 0.0);
    let recipe = recipe.edit("elements/A3/initial", -start / Scales::B.velocity);
    let time_constant = mass / damping;
    let run = recipe.lasting(3.0 * time_constant).every(1e-4).recording(&["v_o", "spring_force"]);
    let run = run.run("coasting", "")?;
    let (mut furthest, mut pull) = (0.0_f64, 0.0_f64);
    for ((velocity, force), time) in
        run.points(("v_o", start), ("spring_force", SIMULATED_STATIC))?.into_iter().zip(&run.trace.time)
    {
        furthest = furthest.max((velocity - (-time / time_constant).exp()).abs());
        pull = pull.max(force.abs());
    }
    let found = format!(
        "velocity falls with {:.1} ms, to {:.1e} of it, while the spring pulls with up to {pull:.2} Fs",
        time_constant * 1e3,
        furthest
    );
    Ok(Finding::truth(furthest < ACCURACY && pull > 0.1 && pull < 1.0, found))
}

/// A step of position, answered for a second.
fn step(given: &Given) -> Result<Replayed, CheckError> {
    let run = shipped(given)?.lasting(1.0).recording(&["x_i", "x_o", "x_error"]);
    Ok(run.run("step", "")?)
}

/// Whether position passes the input more than twice, up and down.
fn rings_about_the_input(given: &Given) -> Result<Finding, CheckError> {
    let run = step(given)?;
    let points = run.points(("x_i", MM), ("x_o", MM))?;
    let above: Vec<_> = points.iter().skip(1).map(|(input, output)| output > input).collect();
    let passes = above.windows(2).filter(|pair| pair[0] != pair[1]).count();
    let peak = points.iter().map(|(_, output)| *output).fold(0.0, f64::max);
    Ok(Finding::truth(passes > 2, format!("passes it {passes} times, and reaches {peak:.3} mm")))
}

/// Where it settles, in mm.
fn settles_at(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(end(&step(given)?, "x_o")? / MM))
}

/// Whether it stops off the input, by no more than Fs / K.
fn stops_off_the_input(given: &Given) -> Result<Finding, CheckError> {
    let (run, most) = (step(given)?, SIMULATED_STATIC / given.number("K")?);
    let off = (end(&run, "x_o")? - end(&run, "x_i")?).abs();
    let found = format!("{:.1} um off it, of {:.1} um that friction holds", off / UM, most / UM);
    Ok(Finding::truth(off > 0.01 * most && off <= most, found))
}

/// The spring force at which a table at rest first moves, by `by` N, as the command creeps on.
fn breaks_away_at(given: &Given) -> Result<Finding, CheckError> {
    let recipe = shipped(given)?.set("v_start", 1e-5).set("v_rate", 0.0).lasting(3.0);
    let run = recipe.recording(&["v_o", "spring_force"]).run("rest", "")?;
    let points = run.points(("v_o", MM_PER_S), ("spring_force", given.number_or("by", 1.0)?))?;
    let moves = points.into_iter().find(|(velocity, _)| velocity.abs() > 1e-9);
    let moves = moves.ok_or_else(|| CheckError::Run("the table does not move".to_owned()))?;
    Ok(Finding::Number(moves.1))
}

/// Whether mass times acceleration is what spring, friction level and viscous friction leave, at every sample: eq 13-8, or 12-4.
fn forces_balance(given: &Given) -> Result<Finding, CheckError> {
    let recipe = shipped(given)?.lasting(given.number("for")?).every(1e-3);
    let run = recipe.recording(&["a_o", "v_o", "spring_force", "friction_level"]).run("balance", "")?;
    let parameter = |name: &str| {
        let found = run.patch().parameters.get(name).map(|parameter| parameter.value);
        found.ok_or_else(|| CheckError::Run(format!("there is no parameter {name}")))
    };
    let (mass, damping) = (parameter("M")?, parameter("f")?);
    let [accelerations, velocities] = [run.values("a_o")?, run.values("v_o")?];
    let forces = run.points(("spring_force", 1.0), ("friction_level", 1.0))?;
    let (mut left, mut most) = (0.0_f64, 0.0_f64);
    for ((acceleration, velocity), (spring, level)) in accelerations.iter().zip(&velocities).zip(forces) {
        let useful = spring - spring.clamp(-level, level);
        left = left.max((mass * acceleration - useful + damping * velocity).abs());
        most = most.max(useful.abs());
    }
    let found = format!("{left:.1e} N are left of up to {most:.0} N");
    Ok(Finding::truth(left < 1e-9 * most, found))
}

/// Whether position goes up in steps while velocity shows pulses: for four fifths of the time the table is slower than the command, and
/// its pulses are five times as fast.
fn climbs_in_steps(given: &Given) -> Result<Finding, CheckError> {
    let command = given.number("at")?;
    let recipe = shipped(given)?.set("v_start", command).set("v_rate", 0.0).lasting(4.0).every(2e-4);
    let run = recipe.recording(&["v_o"]).run("steps", "")?;
    let shares: Vec<f64> = run.values("v_o")?.iter().map(|velocity| velocity / command).collect();
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

/// Whether position commands overload the final circuit from a step on that is no larger than the scale allows, `x` m, while a velocity
/// command moves the table ten times as far without an overload.
fn position_is_restricted(given: &Given) -> Result<Finding, CheckError> {
    let allowed = given.number("x")?;
    let (mut within, mut beyond) = (0.0, 2.0 * allowed);
    while beyond - within > 1e-3 * allowed {
        let middle = 0.5 * (within + beyond);
        if overloads(middle)? { beyond = middle } else { within = middle }
    }
    let moving = Recipe::of("fig-8-16").recording(&["v_o"]).run("velocity", "")?;
    let (velocities, time) = (moving.values("v_o")?, &moving.trace.time);
    let steps = time.windows(2).zip(&velocities).map(|(pair, velocity)| (pair[1] - pair[0]) * velocity);
    let travel = steps.sum::<f64>();
    let holds = within < allowed && moving.trace.overloads().count() == 0 && travel > 10.0 * allowed;
    let found = format!(
        "steps overload it beyond {:.3} mm; a velocity command moves it by {:.0} mm",
        within / MM,
        travel / MM
    );
    Ok(Finding::truth(holds, found))
}

/// Whether a step of position in m overloads the final circuit.
fn overloads(height: f64) -> Result<bool, CheckError> {
    let recipe = Recipe::of("fig-8-16").set("v_rate", 0.0).set("x_step", height).lasting(0.1);
    let run = recipe.edit("parameters/x_step/range", json!([0, 1])).run("position", "")?;
    Ok(run.trace.overloads().next().is_some())
}
