//! Chapter 8, second half: recordings of the final circuit.
//!
//! The settings of 8.4 stand in the text; which VcL, Tc and command each recording was made with is lost, but for Fig 8.34. They are
//! chosen here, within the ranges of 8.4, so that what the text says of a recording can be seen.

use super::graph::evenly;
use super::{Drawn, Figure, Graph, Recipe, listed, titled, told};
use crate::replay::boundary::RATE;
use crate::replay::recipe::{Problem, Replayed, velocity_told};
use crate::slideway::falling::{FallingFriction, SIMULATED_STATIC};
use crate::slideway::stability::{DrivenTable, SIMULATED_DAMPING};
use crate::slideway::units::{MM_PER_S, UM};
use patchcord_analysis::instruments::{Criterion, FrictionLoop, cycles, friction_loop};
use patchcord_draw::plot::{Channel, Picture};

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "fig-8-18",
        place: "8.4",
        title: "steady friction, for three values of VcL",
        claims: &[],
        draw: characteristic,
    },
    Figure {
        id: "fig-8-19",
        place: "8.4",
        title: "stick-slip: position and velocity",
        claims: &[],
        draw: position_and_velocity,
    },
    Figure {
        id: "fig-8-20",
        place: "8.4",
        title: "stick-slip: velocity and acceleration",
        claims: &[],
        draw: velocity_and_acceleration,
    },
    Figure {
        id: "fig-8-21",
        place: "8.4",
        title: "stick-slip: position error",
        claims: &[],
        draw: position_error,
    },
    Figure {
        id: "fig-8-22",
        place: "8.4",
        title: "friction loop under stick-slip",
        claims: &[],
        draw: stick_slip_loop,
    },
    Figure {
        id: "fig-8-23",
        place: "8.4",
        title: "friction loop under quasi-harmonic motion",
        claims: &[],
        draw: quasi_harmonic_loop,
    },
    Figure { id: "fig-8-24", place: "8.4", title: "system velocity profile", claims: &[], draw: profile },
    Figure {
        id: "fig-8-25",
        place: "8.4",
        title: "error force against output velocity",
        claims: &["8-144", "8-145"],
        draw: error_force,
    },
    Figure {
        id: "fig-8-26",
        place: "8.4",
        title: "frequency of oscillation against the velocity command",
        claims: &[],
        draw: frequency,
    },
    Figure {
        id: "fig-8-27",
        place: "8.4",
        title: "profiles for a rising and a falling command",
        claims: &["8-125", "8-125.b", "8-125.c", "8-126.a", "8-126.b", "8-126.c"],
        draw: there_and_back,
    },
    Figure {
        id: "fig-8-28",
        place: "8.5",
        title: "the same at twice the rate",
        claims: &[],
        draw: twice_as_fast,
    },
    Figure {
        id: "fig-8-29",
        place: "8.5",
        title: "a faster command makes more oscillation",
        claims: &[],
        draw: faster,
    },
];

/// Of the printed values of VcL up to 40 V the one at which oscillation ends while solid friction still falls, in m/s.
const LIMIT: f64 = 10.16e-3;
/// The command ends at 40 V (8.2).
const HIGHEST: f64 = 10.16e-3;

/// The final circuit at that VcL.
fn final_circuit() -> Recipe {
    Recipe::of("fig-8-16").set("VcL", LIMIT)
}

/// The command rises from 0 to its highest.
pub(super) fn rising(recipe: Recipe, rate: f64) -> Recipe {
    recipe.set("v_rate", rate).lasting(HIGHEST / rate)
}

/// Velocity and spring force of sliding steadily, as theory has it.
fn steady_friction(limit: f64, to: f64) -> Result<Vec<(f64, f64)>, Problem> {
    let friction = FallingFriction::simulated(limit);
    // At rest it is anything up to Fs: the curve begins just beside.
    evenly(1e-9, to, 200).map(|v| Ok((v / MM_PER_S, friction.total(v, SIMULATED_DAMPING)?))).collect()
}

fn characteristic(figure: &Figure) -> Result<Drawn, Problem> {
    let mut graph = Graph::new(&figure.heading(), ("v_o", "mm/s"), ("spring force", "N"));
    let (mut runs, mut furthest) = (Vec::new(), 0.0_f64);
    for (limit, which) in [2.54e-3, 5.08e-3, 10.16e-3].into_iter().zip(["a", "b", "c"]) {
        let recipe = Recipe::of("fig-8-16").set("VcL", limit).set("Tc", 0.5).set("v_rate", limit / 60.0);
        let recipe = recipe.lasting(66.0).every(2e-3).picture(&figure.heading(), "v_o", &["spring_force"]);
        let run = figure.run(&recipe, which)?;
        let friction = FallingFriction::simulated(limit);
        let points = run.points(("v_o", 1.0), ("spring_force", 1.0))?;
        // After five time constants the lag has forgotten that the table stood.
        let settled = run.trace.time.iter().zip(&points).filter(|(time, _)| **time > 2.5);
        for (_, (velocity, force)) in settled {
            furthest = furthest.max((force - friction.total(*velocity, SIMULATED_DAMPING)?).abs());
        }
        let points = points.into_iter().map(|(velocity, force)| (velocity / MM_PER_S, force)).collect();
        graph = graph.line(format!("VcL = {}", told(limit, "m/s")), points);
        runs.push(run);
    }
    let reading = format!(
        "with Tc = 0.5 s and a minute to VcL the run follows N (VcL - v)^2 + f v to {furthest:.1} N, {:.1} % of Fs",
        100.0 * furthest / SIMULATED_STATIC
    );
    let settings = runs[1].settings();
    Drawn::of_runs(&runs.iter().collect::<Vec<_>>(), vec![graph.picture()], settings, reading)
}

/// VcL and command of the stick-slip recordings, in m/s: the table rests for two thirds of the time, and does not turn back.
const STICKING: (f64, f64) = (3.81e-3, 0.3e-3);

/// Stick-slip as the next three recordings show it.
fn stick_slip(figure: &Figure, y: &[&[&str]]) -> Result<Replayed, Problem> {
    let (limit, command) = STICKING;
    let recipe = Recipe::of("fig-8-16").set("VcL", limit).steady(command).lasting(1.0).every(2e-4);
    figure.run(&y.iter().fold(recipe, |recipe, y| recipe.picture("", "t", y)), "")
}

fn position_and_velocity(figure: &Figure) -> Result<Drawn, Problem> {
    let run = stick_slip(figure, &[&["v_i", "v_o"]])?;
    let along = |time: f64| STICKING.1 * time;
    let output = run.trace.time.iter().zip(run.values("x_error")?);
    let output = output.map(|(time, error)| (*time, (along(*time) - error) / UM)).collect();
    let command = run.trace.time.iter().map(|time| (*time, along(*time) / UM)).collect();
    let position = Graph::new("position", ("t", "s"), ("x", "um")).line("x_i", command).line("x_o", output);
    let mut pictures = vec![position.note(run.settings()).picture()];
    pictures.extend(run.pictures()?.into_iter().map(|picture| titled(picture, "velocity")));
    let slips = run.measure("frequency:v_o,last=0.8")?;
    let command = told(STICKING.1, "m/s");
    let reading = format!(
        "the table rests and jumps, {slips:.1} times a second, while the command goes on at {command}"
    );
    Drawn::of_runs(&[&run], pictures, run.settings(), reading)
}

fn velocity_and_acceleration(figure: &Figure) -> Result<Drawn, Problem> {
    let run = stick_slip(figure, &[&["v_o"], &["a_o"]])?;
    let most = |signal| Ok::<_, Problem>(run.values(signal)?.into_iter().fold(0.0, f64::max));
    let reading = format!("slips reach {} and {}", told(most("v_o")?, "m/s"), told(most("a_o")?, "m/s2"));
    Drawn::of_run(&run, reading)
}

fn position_error(figure: &Figure) -> Result<Drawn, Problem> {
    let run = stick_slip(figure, &[&["x_error"]])?;
    let swing = run.measure("amplitude:x_error,last=0.8")?;
    let reading =
        format!("a saw tooth of {}: the drive is wound up while the table rests", told(2.0 * swing, "m"));
    Drawn::of_run(&run, reading)
}

/// Spring force against velocity at a steady command, over the last cycles, with the steady curve.
fn dynamic_loop(
    figure: &Figure,
    (limit, command): (f64, f64),
) -> Result<(Replayed, FrictionLoop, Picture), Problem> {
    let recipe = Recipe::of("fig-8-16").set("VcL", limit).steady(command).lasting(2.0).every(1e-4);
    let run = figure.run(&recipe.picture(&figure.heading(), "v_o", &["spring_force"]), "")?;
    let (velocity, force) = (run.values("v_o")?, run.values("spring_force")?);
    let cycle = friction_loop(&run.trace.time, &velocity, &force, 3, 0.05e-3)?;
    let points = cycle.points.iter().map(|(velocity, force)| (velocity / MM_PER_S, *force)).collect();
    let graph = Graph::new(&figure.heading(), ("v_o", "mm/s"), ("spring force", "N"))
        .line(format!("at {}", told(command, "m/s")), points)
        .line("steady friction", steady_friction(limit, 1.2 * limit)?)
        .note(run.settings());
    Ok((run, cycle, graph.picture()))
}

fn loop_told(cycle: &FrictionLoop) -> String {
    let ([slow, fast], [least, most]) = (cycle.velocity, cycle.force);
    format!(
        "{} ... {} and {least:.0} ... {most:.0} N, {:.1} times a second; a cycle takes {}",
        told(slow, "m/s"),
        told(fast, "m/s"),
        cycle.frequency,
        told(cycle.work, "J")
    )
}

fn stick_slip_loop(figure: &Figure) -> Result<Drawn, Problem> {
    let (run, cycle, picture) = dynamic_loop(figure, STICKING)?;
    let reading = format!("force builds up at rest and is let go in the slip: {}", loop_told(&cycle));
    Drawn::of_runs(&[&run], vec![picture], run.settings(), reading)
}

fn quasi_harmonic_loop(figure: &Figure) -> Result<Drawn, Problem> {
    let (run, cycle, picture) = dynamic_loop(figure, (LIMIT, 6.8e-3))?;
    let reading = format!("a small loop about the steady curve: {}", loop_told(&cycle));
    Drawn::of_runs(&[&run], vec![picture], run.settings(), reading)
}

/// Where all friction is least: its slope is 0 there (eq 48-8).
fn least_friction() -> Result<f64, Problem> {
    Ok(FallingFriction::simulated(LIMIT).velocity_of_least(SIMULATED_DAMPING)?)
}

fn profile(figure: &Figure) -> Result<Drawn, Problem> {
    let run = figure.run(&rising(final_circuit(), RATE).picture(&figure.heading(), "v_i", &["v_o"]), "")?;
    let reading = format!(
        "oscillation ends at {} (swings above 0.25 mm/s within 0.04 s); all friction is least at {}",
        velocity_told(run.critical()?.rising),
        told(least_friction()?, "m/s")
    );
    Drawn::of_run(&run, reading)
}

fn error_force(figure: &Figure) -> Result<Drawn, Problem> {
    let recipe = rising(final_circuit(), RATE);
    let run = figure.run(&recipe.picture(&figure.heading(), "v_o", &["spring_force"]), "")?;
    let mut pictures = run.pictures()?;
    pictures[0].channels[0].name = "spring force".to_owned();
    pictures[0].channels.push(Channel::line("steady friction", steady_friction(LIMIT, HIGHEST)?));
    let critical = run.critical()?.rising?;
    let slope = SIMULATED_DAMPING - FallingFriction::simulated(LIMIT).slope(critical)?;
    let reading = format!(
        "oscillation ends at {}, where steady friction still falls by {:.1} N s/mm",
        told(critical, "m/s"),
        -slope / 1e3
    );
    Drawn::of_runs(&[&run], pictures, run.settings(), reading)
}

/// Commands at which the frequency is read, in m/s.
const COMMANDS: [f64; 14] =
    [0.2e-3, 0.4e-3, 0.7e-3, 1e-3, 1.4e-3, 2e-3, 2.5e-3, 3e-3, 3.5e-3, 4e-3, 5e-3, 6e-3, 6.5e-3, 6.8e-3];

fn frequency(figure: &Figure) -> Result<Drawn, Problem> {
    let recipe = final_circuit().steady(1e-3).lasting(4.0).every(5e-4).recording(&["spring_force"]);
    let read = recipe.along("v_start", &COMMANDS, |run| run.measure("frequency:spring_force,last=1.5"))?;
    let points: Vec<_> =
        read.into_iter().map(|(command, frequency)| (command / MM_PER_S, frequency)).collect();
    let natural = DrivenTable::simulated(0.0065).natural_frequency()? / std::f64::consts::TAU;
    let reading = format!(
        "it rises from {:.1} Hz at {} mm/s to {:.1} Hz at {} mm/s; the table's natural frequency is {natural:.1} Hz",
        points[0].1,
        points[0].0,
        points[points.len() - 1].1,
        points[points.len() - 1].0,
    );
    let run = figure.run(&rising(final_circuit(), RATE).picture("", "v_i", &["spring_force"]), "")?;
    let (command, velocity) = (run.values("v_i")?, run.values("v_o")?);
    let found = cycles(&run.trace.time, &command, &velocity, Criterion::USUAL)?;
    let along = found.iter().map(|cycle| (cycle.command / MM_PER_S, cycle.frequency)).collect();
    let graph = Graph::new(&figure.heading(), ("v_i", "mm/s"), ("frequency", "Hz"))
        .up(0.0, 60.0)
        .line("cycle by cycle, command rising at 1.2 mm/s2", along)
        .dots("at steady commands", points)
        .line("natural frequency", vec![(0.0, natural), (8.0, natural)]);
    let mut drawn = Drawn::of_runs(&[&run], vec![graph.picture()], run.settings(), reading)?;
    let steady = recipe.patch(&figure.file("steady"), &figure.heading())?;
    drawn.commands.push(format!(
        "patchcord sweep {} --vary v_start={} --measure frequency:spring_force,last=1.5",
        steady.file(),
        listed(&COMMANDS)
    ));
    drawn.patches.push(steady);
    Ok(drawn)
}

/// A profile of a command that comes back, each direction a channel.
fn both_ways(run: &Replayed, title: &str) -> Result<Picture, Problem> {
    let points = run.points(("v_i", MM_PER_S), ("v_o", MM_PER_S))?;
    let turn = points.iter().enumerate().max_by(|one, other| one.1.0.total_cmp(&other.1.0));
    let (up, down) = points.split_at(turn.map_or(0, |(index, _)| index));
    let graph = Graph::new(title, ("v_i", "mm/s"), ("v_o", "mm/s"));
    Ok(graph.line("rising", up.to_vec()).line("falling", down.to_vec()).note(run.settings()).picture())
}

fn there_and_back(figure: &Figure) -> Result<Drawn, Problem> {
    let recipe = final_circuit().there_and_back(HIGHEST, RATE);
    let run = figure.run(&recipe.picture(&figure.heading(), "v_i", &["v_o"]), "")?;
    let critical = run.critical()?;
    let reading = format!(
        "oscillation ends at {} while the command rises, and begins at {} while it falls (nothing disturbs it but the run itself)",
        velocity_told(critical.rising),
        velocity_told(critical.falling)
    );
    Drawn::of_runs(&[&run], vec![both_ways(&run, &figure.heading())?], run.settings(), reading)
}

fn twice_as_fast(figure: &Figure) -> Result<Drawn, Problem> {
    let runs = [RATE, 2.0 * RATE].map(|rate| {
        final_circuit().there_and_back(HIGHEST, rate).picture(&figure.heading(), "v_i", &["v_o"])
    });
    let [slow, fast] = [figure.run(&runs[0], "slow")?, figure.run(&runs[1], "fast")?];
    let pictures = vec![both_ways(&slow, "(a) 1.2 mm/s2")?, both_ways(&fast, "(b) 2.4 mm/s2")?];
    let (before, after) = (slow.critical()?, fast.critical()?);
    let reading = format!(
        "rising from {} to {}, falling from {} to {}",
        velocity_told(before.rising),
        velocity_told(after.rising),
        velocity_told(before.falling),
        velocity_told(after.falling)
    );
    Drawn::of_runs(&[&slow, &fast], pictures, slow.settings(), reading)
}

fn faster(figure: &Figure) -> Result<Drawn, Problem> {
    let recipe = || Recipe::of("fig-8-16").set("VcL", 25.4e-3).set("Tc", 0.0075);
    let [slow, fast] = [
        figure.run(&rising(recipe(), RATE).picture("(a) 1.2 mm/s2", "v_i", &["v_o"]), "slow")?,
        figure.run(&rising(recipe(), 2.0 * RATE).picture("(b) 2.4 mm/s2", "v_i", &["v_o"]), "fast")?,
    ];
    let pictures = slow.pictures()?.into_iter().chain(fast.pictures()?).collect();
    let reading = format!(
        "swings above 0.25 mm/s end at {}; at twice the rate, at {}",
        velocity_told(slow.critical()?.rising),
        velocity_told(fast.critical()?.rising)
    );
    Drawn::of_runs(&[&slow, &fast], pictures, slow.settings(), reading)
}
