//! Chapter 8, second half: recordings of the final circuit.
//!
//! The settings of 8.4 stand in the text; which VcL, Tc and command each recording was made with is lost, but for Fig 8.34. They are
//! chosen here, within the ranges of 8.4, so that what the text says of a recording can be seen.

use super::graph::evenly;
use super::{Drawn, Figure, Graph, Recipe, titled, told};
use crate::instruments::{Criterion, FrictionLoop, cycles, friction_loop};
use crate::plot::{Channel, Picture};
use crate::replay::boundary::{RATE, axis};
use crate::replay::recipe::{Problem, Replayed, first_number};
use crate::slideway::falling::{FallingFriction, SIMULATED_STATIC};
use crate::slideway::stability::{DrivenTable, SIMULATED_DAMPING};
use crate::slideway::units::{MM_PER_S, UM};

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
        claims: &[],
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
    Figure {
        id: "fig-8-32",
        place: "8.5",
        title: "stick-slip then quasi-harmonic motion, and quasi-harmonic motion alone",
        claims: &[],
        draw: two_profiles,
    },
    Figure {
        id: "fig-8-33",
        place: "8.5",
        title: "quasi-harmonic motion near the critical velocity",
        claims: &[],
        draw: near_critical,
    },
    Figure {
        id: "fig-8-34",
        place: "8.5",
        title: "quasi-harmonic motion just following stick-slip",
        claims: &[],
        draw: just_after,
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

/// The command stands still.
fn steady(recipe: Recipe, velocity: f64) -> Recipe {
    recipe.set("v_start", velocity).set("v_rate", 0.0)
}

/// The command rises from 0 to its highest.
fn rising(recipe: Recipe, rate: f64) -> Recipe {
    recipe.set("v_rate", rate).lasting(HIGHEST / rate)
}

/// The command rises to its highest and comes back.
fn returning(recipe: Recipe, rate: f64) -> Recipe {
    recipe.set("v_rate", rate).set("v_turn", HIGHEST / rate).lasting(2.0 * HIGHEST / rate)
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
        let run = figure.run(&recipe.lasting(66.0).every(2e-3), which)?;
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
    let recipe = steady(Recipe::of("fig-8-16").set("VcL", limit), command).lasting(1.0).every(2e-4);
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
    let slips = run.measure("frequency:v_o,last=0.8")?[0].unwrap_or_default();
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
    let swing = run.measure("amplitude:x_error,last=0.8")?[0].unwrap_or_default();
    let reading =
        format!("a saw tooth of {}: the drive is wound up while the table rests", told(2.0 * swing, "m"));
    Drawn::of_run(&run, reading)
}

/// Spring force against velocity at a steady command, over the last cycles, with the steady curve.
fn dynamic_loop(
    figure: &Figure,
    (limit, command): (f64, f64),
) -> Result<(Replayed, FrictionLoop, Picture), Problem> {
    let recipe = steady(Recipe::of("fig-8-16").set("VcL", limit), command).lasting(2.0).every(1e-4);
    let run = figure.run(&recipe.picture("", "v_o", &["spring_force"]), "")?;
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
        run.critical()?.rising_told(),
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
    let critical = run.critical()?.rising.ok_or("oscillation does not end")?;
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
    let recipe = steady(final_circuit(), 1e-3).lasting(4.0).every(5e-4);
    let rows = recipe.sweep(&[axis("v_start", &COMMANDS)], &["frequency:spring_force,last=1.5"])?;
    let read = rows.into_iter().filter_map(|row| {
        let frequency = first_number(&row)?;
        Some((row.values[0] / MM_PER_S, frequency))
    });
    let points: Vec<_> = read.collect();
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
    Drawn::of_runs(&[&run], vec![graph.picture()], run.settings(), reading)
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
    let run = figure.run(&returning(final_circuit(), RATE), "")?;
    let critical = run.critical()?;
    let reading = format!(
        "oscillation ends at {} while the command rises, and begins at {} while it falls (nothing disturbs it but the run itself)",
        critical.rising_told(),
        critical.falling_told()
    );
    Drawn::of_runs(&[&run], vec![both_ways(&run, &figure.heading())?], run.settings(), reading)
}

fn twice_as_fast(figure: &Figure) -> Result<Drawn, Problem> {
    let runs = [RATE, 2.0 * RATE].map(|rate| returning(final_circuit(), rate));
    let [slow, fast] = [figure.run(&runs[0], "slow")?, figure.run(&runs[1], "fast")?];
    let pictures = vec![both_ways(&slow, "(a) 1.2 mm/s2")?, both_ways(&fast, "(b) 2.4 mm/s2")?];
    let (before, after) = (slow.critical()?, fast.critical()?);
    let reading = format!(
        "rising from {} to {}, falling from {} to {}",
        before.rising_told(),
        after.rising_told(),
        before.falling_told(),
        after.falling_told()
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
        slow.critical()?.rising_told(),
        fast.critical()?.rising_told()
    );
    Drawn::of_runs(&[&slow, &fast], pictures, slow.settings(), reading)
}

/// VcL of the two profiles: of Fig 8.34's caption, and one at which only the first jump comes to rest, in m/s.
const TWO: [f64; 2] = [2.54e-3, 10.16e-3];

fn two_profiles(figure: &Figure) -> Result<Drawn, Problem> {
    let titles = ["(a) stick-slip, then quasi-harmonic", "(b) quasi-harmonic after the first jump"];
    let mut runs = Vec::new();
    for ((limit, title), which) in TWO.into_iter().zip(titles).zip(["a", "b"]) {
        let recipe = Recipe::of("fig-8-16").set("VcL", limit).picture(title, "v_i", &["v_o"]);
        runs.push(figure.run(&rising(recipe, RATE), which)?);
    }
    let pictures = runs[0].pictures()?.into_iter().chain(runs[1].pictures()?).collect();
    let reading = format!(
        "they end at {} and {}",
        runs[0].critical()?.rising_told(),
        runs[1].critical()?.rising_told()
    );
    let settings = runs[0].settings();
    Drawn::of_runs(&runs.iter().collect::<Vec<_>>(), pictures, settings, reading)
}

fn near_critical(figure: &Figure) -> Result<Drawn, Problem> {
    let commands = [4e-3, 6.8e-3];
    let (mut runs, mut readings) = (Vec::new(), Vec::new());
    for ((limit, command), which) in TWO.into_iter().zip(commands).zip(["a", "b"]) {
        let title = format!("({which}) VcL = {}, at {}", told(limit, "m/s"), told(command, "m/s"));
        let recipe = steady(Recipe::of("fig-8-16").set("VcL", limit), command).lasting(4.0).every(2e-4);
        let run = figure.run(&recipe.picture(&title, "t", &["v_o"]), which)?;
        let frequency = run.measure("frequency:v_o,last=1")?[0].ok_or("no frequency is read")?;
        readings.push(format!("{frequency:.1} Hz at {}", told(command, "m/s")));
        runs.push(run);
    }
    let natural = DrivenTable::simulated(0.0065).natural_frequency()? / std::f64::consts::TAU;
    let shown = |run: &Replayed| -> Result<Vec<Picture>, Problem> {
        // Long settled, a few cycles of it.
        let points = run.points(("t", 1.0), ("v_o", MM_PER_S))?;
        let graph = Graph::new(&run.patch().pictures[0].title, ("t", "s"), ("v_o", "mm/s"));
        let cycles = points.into_iter().filter(|(time, _)| *time >= 3.8).collect();
        Ok(vec![graph.line("v_o", cycles).note(run.settings()).picture()])
    };
    let pictures = shown(&runs[0])?.into_iter().chain(shown(&runs[1])?).collect();
    let reading = format!("{}; the natural frequency is {natural:.1} Hz", readings.join(", "));
    let settings = runs[0].settings();
    Drawn::of_runs(&runs.iter().collect::<Vec<_>>(), pictures, settings, reading)
}

/// The command of Fig 8.34's caption, in m/s, and what it may mean as the scan drops decimal points. At ten times as much nothing
/// oscillates.
const CAPTION_COMMANDS: [f64; 2] = [2.13e-3, 0.213e-3];
/// Values of VcL that the caption may mean, and what lies between, in m/s.
const READINGS: [f64; 8] = [2.54e-3, 5.08e-3, 10.16e-3, 15.24e-3, 20.32e-3, 23e-3, 24e-3, 25.4e-3];

/// The final circuit at a steady command, for several values of VcL: frequencies in Hz by VcL in mm/s.
fn frequencies_by_limit(command: f64) -> Result<Vec<(f64, f64)>, Problem> {
    let recipe = steady(Recipe::of("fig-8-16"), command).lasting(4.0).every(2e-4);
    let rows = recipe.sweep(&[axis("VcL", &READINGS)], &["frequency:v_o,last=1"])?;
    let read = rows.into_iter().filter_map(|row| Some((row.values[0] / MM_PER_S, first_number(&row)?)));
    Ok(read.collect())
}

fn just_after(figure: &Figure) -> Result<Drawn, Problem> {
    let [command, _] = CAPTION_COMMANDS;
    let recipe = |limit| steady(Recipe::of("fig-8-16").set("VcL", limit), command).lasting(4.0).every(2e-4);
    let (frequencies, slower) = (frequencies_by_limit(command)?, frequencies_by_limit(CAPTION_COMMANDS[1])?);
    let mut graph = Graph::new("velocity", ("t", "s"), ("v_o", "mm/s"));
    let mut runs = Vec::new();
    for (limit, which) in [2.54e-3, 23e-3, 25.4e-3].into_iter().zip(["a", "b", "c"]) {
        let run = figure.run(&recipe(limit).picture("", "t", &["v_o"]), which)?;
        let points = run.points(("t", 1.0), ("v_o", MM_PER_S))?.into_iter();
        let cycles = points.filter(|(time, _)| *time >= 3.85).collect();
        graph = graph.line(format!("VcL = {}", told(limit, "m/s")), cycles);
        runs.push(run);
    }
    let at = |frequencies: &[(f64, f64)], limit: f64| {
        let found = frequencies.iter().find(|(x, _)| (x * MM_PER_S - limit).abs() < 1e-9);
        found.map_or_else(|| "no oscillation".to_owned(), |(_, frequency)| format!("{frequency:.1} Hz"))
    };
    let reading = format!(
        "the caption says 33 Hz at 2.13 mm/s with a VcL of 2.54 mm/s: we get {}, with 25.4 mm/s {}, and with 23.0 mm/s {}; at 0.213 mm/s \
         25.4 mm/s gives {}",
        at(&frequencies, 2.54e-3),
        at(&frequencies, 25.4e-3),
        at(&frequencies, 23e-3),
        at(&slower, 25.4e-3),
    );
    let readings = Graph::new("frequency by what the caption may mean", ("VcL", "mm/s"), ("frequency", "Hz"))
        .across(0.0, 30.0)
        .up(0.0, 60.0)
        .dots("at 2.13 mm/s", frequencies)
        .dots("at 0.213 mm/s", slower)
        .line("caption: 33 Hz", vec![(0.0, 33.0), (30.0, 33.0)]);
    let settings = runs[0].settings();
    Drawn::of_runs(
        &runs.iter().collect::<Vec<_>>(),
        vec![graph.picture(), readings.picture()],
        settings,
        reading,
    )
}
