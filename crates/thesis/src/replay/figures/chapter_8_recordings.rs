//! Chapter 8, second part: recordings of the final circuit (8.4, 8.5).
//!
//! The text of 8.4 states the settings of the machine. VcL, Tc and command of each recording are lost, except for Fig
//! 8.34. They are chosen here within the ranges of 8.4, so that a recording shows what the text says about it.

use super::graph::linspace;
use super::{DrawnFigure, Figure, Graph, Recipe, comma_separated, format_value, with_title};
use crate::replay::boundary::RATE;
use crate::replay::recipe::{BoxError, ReplayedRun, format_critical_velocity};
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

/// VcL of most recordings, in m/s. Of the printed values up to 40 V it is the one at which oscillation ends while
/// solid friction still falls.
const LIMIT: f64 = 10.16e-3;
/// The command at the end of a run, in m/s: 40 V (8.2).
const HIGHEST: f64 = 10.16e-3;

/// The final circuit with that VcL.
fn final_circuit() -> Recipe {
    Recipe::new("fig-8-16").set("VcL", LIMIT)
}

/// Raises the command from 0 to its highest value, at a rate in m/s2.
pub(super) fn rising(recipe: Recipe, rate: f64) -> Recipe {
    recipe.set("v_rate", rate).run_time(HIGHEST / rate)
}

/// Returns velocity in mm/s and spring force in N of steady sliding by theory, up to a velocity in m/s.
fn steady_friction(limit: f64, to: f64) -> Result<Vec<(f64, f64)>, BoxError> {
    let friction = FallingFriction::simulated(limit);
    // At rest the force may have any value up to Fs, so the curve begins just above 0.
    linspace(1e-9, to, 200).map(|v| Ok((v / MM_PER_S, friction.total(v, SIMULATED_DAMPING)?))).collect()
}

/// Fig 8.18: spring force against velocity for three values of VcL, with a slow command and a long lag.
///
/// The command rises to VcL in one minute, and Tc is 0.5 s. Claims 8-120 and 8-120.b.
fn characteristic(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut graph = Graph::new(&figure.heading(), ("v_o", "mm/s"), ("spring force", "N"));
    let (mut runs, mut max_error) = (Vec::new(), 0.0_f64);
    for (limit, which) in [2.54e-3, 5.08e-3, 10.16e-3].into_iter().zip(["a", "b", "c"]) {
        let recipe = Recipe::new("fig-8-16").set("VcL", limit).set("Tc", 0.5).set("v_rate", limit / 60.0);
        let recipe = recipe.run_time(66.0).sample_interval(2e-3).add_picture(
            &figure.heading(),
            "v_o",
            &["spring_force"],
        );
        let run = figure.run(&recipe, which)?;
        let friction = FallingFriction::simulated(limit);
        let points = run.record.points(("v_o", 1.0), ("spring_force", 1.0))?;
        // After five time constants the state of rest no longer affects the lag.
        let settled = run.record.trace.time.iter().zip(&points).filter(|(time, _)| **time > 2.5);
        for (_, (velocity, force)) in settled {
            max_error = max_error.max((force - friction.total(*velocity, SIMULATED_DAMPING)?).abs());
        }
        let points = points.into_iter().map(|(velocity, force)| (velocity / MM_PER_S, force)).collect();
        graph = graph.line(format!("VcL = {}", format_value(limit, "m/s")), points);
        runs.push(run);
    }
    let reading = format!(
        "with Tc = 0.5 s and a rise to VcL in one minute the run follows N (VcL - v)^2 + f v within {max_error:.1} \
         N, {:.1} % of Fs",
        100.0 * max_error / SIMULATED_STATIC
    );
    let settings = runs[1].settings();
    DrawnFigure::from_runs(&runs.iter().collect::<Vec<_>>(), vec![graph.picture()], settings, reading)
}

/// VcL and command of the stick-slip recordings, in m/s. With them the table is at rest for two thirds of the time,
/// and does not move backwards.
const STICKING: (f64, f64) = (3.81e-3, 0.3e-3);

/// Runs the stick-slip of the next three recordings, with one picture per list of signals.
fn stick_slip(figure: &Figure, y: &[&[&str]]) -> Result<ReplayedRun, BoxError> {
    let (limit, command) = STICKING;
    let recipe =
        Recipe::new("fig-8-16").set("VcL", limit).steady_command(command).run_time(1.0).sample_interval(2e-4);
    figure.run(&y.iter().fold(recipe, |recipe, y| recipe.add_picture("", "t", y)), "")
}

/// Fig 8.19: position and velocity under stick-slip.
fn position_and_velocity(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let run = stick_slip(figure, &[&["v_i", "v_o"]])?;
    let along = |time: f64| STICKING.1 * time;
    let output = run.record.trace.time.iter().zip(run.record.values("x_error")?);
    let output = output.map(|(time, error)| (*time, (along(*time) - error) / UM)).collect();
    let command = run.record.trace.time.iter().map(|time| (*time, along(*time) / UM)).collect();
    let position = Graph::new("position", ("t", "s"), ("x", "um")).line("x_i", command).line("x_o", output);
    let mut pictures = vec![position.note(run.settings()).picture()];
    pictures.extend(run.pictures()?.into_iter().map(|picture| with_title(picture, "velocity")));
    let slips = run.record.measure("frequency:v_o,last=0.8")?;
    let command = format_value(STICKING.1, "m/s");
    let reading = format!(
        "the table alternates between rest and slip {slips:.1} times a second at a constant command of {command}"
    );
    DrawnFigure::from_runs(&[&run], pictures, run.settings(), reading)
}

/// Fig 8.20: velocity and acceleration under stick-slip.
fn velocity_and_acceleration(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let run = stick_slip(figure, &[&["v_o"], &["a_o"]])?;
    let most = |signal| Ok::<_, BoxError>(run.record.values(signal)?.into_iter().fold(0.0, f64::max));
    let reading = format!(
        "slips reach {} and {}",
        format_value(most("v_o")?, "m/s"),
        format_value(most("a_o")?, "m/s2")
    );
    DrawnFigure::from_run(&run, reading)
}

/// Fig 8.21: position error under stick-slip.
fn position_error(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let run = stick_slip(figure, &[&["x_error"]])?;
    let swing = run.record.measure("amplitude:x_error,last=0.8")?;
    let reading = format!(
        "a saw tooth of {}: the drive is strained while the table is at rest",
        format_value(2.0 * swing, "m")
    );
    DrawnFigure::from_run(&run, reading)
}

/// Runs the circuit at a VcL and a command in m/s. Returns the run, the loop of spring force against velocity over
/// the last three cycles, and its picture with the steady curve.
fn dynamic_loop(
    figure: &Figure,
    (limit, command): (f64, f64),
) -> Result<(ReplayedRun, FrictionLoop, Picture), BoxError> {
    let recipe =
        Recipe::new("fig-8-16").set("VcL", limit).steady_command(command).run_time(2.0).sample_interval(1e-4);
    let run = figure.run(&recipe.add_picture(&figure.heading(), "v_o", &["spring_force"]), "")?;
    let (velocity, force) = (run.record.values("v_o")?, run.record.values("spring_force")?);
    let cycle = friction_loop(&run.record.trace.time, &velocity, &force, 3, 0.05e-3)?;
    let points = cycle.points.iter().map(|(velocity, force)| (velocity / MM_PER_S, *force)).collect();
    let graph = Graph::new(&figure.heading(), ("v_o", "mm/s"), ("spring force", "N"))
        .line(format!("at {}", format_value(command, "m/s")), points)
        .line("steady friction", steady_friction(limit, 1.2 * limit)?)
        .note(run.settings());
    Ok((run, cycle, graph.picture()))
}

/// Formats a loop: its ranges of velocity and force, its frequency, and its work per cycle.
fn format_loop(cycle: &FrictionLoop) -> String {
    let ([slow, fast], [least, most]) = (cycle.velocity, cycle.force);
    format!(
        "{} ... {} and {least:.0} ... {most:.0} N, {:.1} times a second; the work per cycle is {}",
        format_value(slow, "m/s"),
        format_value(fast, "m/s"),
        cycle.frequency,
        format_value(cycle.work, "J")
    )
}

/// Fig 8.22: the friction loop under stick-slip.
fn stick_slip_loop(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let (run, cycle, picture) = dynamic_loop(figure, STICKING)?;
    let reading = format!("force rises at rest and drops during the slip: {}", format_loop(&cycle));
    DrawnFigure::from_runs(&[&run], vec![picture], run.settings(), reading)
}

/// Fig 8.23: the friction loop under quasi-harmonic motion.
fn quasi_harmonic_loop(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let (run, cycle, picture) = dynamic_loop(figure, (LIMIT, 6.8e-3))?;
    let reading = format!("a small loop around the steady curve: {}", format_loop(&cycle));
    DrawnFigure::from_runs(&[&run], vec![picture], run.settings(), reading)
}

/// Returns the velocity in m/s at which total friction is smallest; its slope is 0 there (eq 48-8).
fn least_friction() -> Result<f64, BoxError> {
    Ok(FallingFriction::simulated(LIMIT).velocity_of_least(SIMULATED_DAMPING)?)
}

/// Fig 8.24: the profile of the final circuit.
fn profile(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let run =
        figure.run(&rising(final_circuit(), RATE).add_picture(&figure.heading(), "v_i", &["v_o"]), "")?;
    let reading = format!(
        "oscillation ends at {} (swings above 0.25 mm/s within 0.04 s); total friction is smallest at {}",
        format_critical_velocity(run.record.critical_velocity()?.rising),
        format_value(least_friction()?, "m/s")
    );
    DrawnFigure::from_run(&run, reading)
}

/// Fig 8.25: spring force against output velocity, with the steady curve.
fn error_force(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let recipe = rising(final_circuit(), RATE);
    let run = figure.run(&recipe.add_picture(&figure.heading(), "v_o", &["spring_force"]), "")?;
    let mut pictures = run.pictures()?;
    pictures[0].channels[0].name = "spring force".to_owned();
    pictures[0].channels.push(Channel::line("steady friction", steady_friction(LIMIT, HIGHEST)?));
    let critical = run.record.critical_velocity()?.rising?;
    let slope = SIMULATED_DAMPING - FallingFriction::simulated(LIMIT).slope(critical)?;
    let reading = format!(
        "oscillation ends at {}, where steady friction still falls by {:.1} N s/mm",
        format_value(critical, "m/s"),
        -slope / 1e3
    );
    DrawnFigure::from_runs(&[&run], pictures, run.settings(), reading)
}

/// Constant commands at which the frequency is read, in m/s.
const COMMANDS: [f64; 14] =
    [0.2e-3, 0.4e-3, 0.7e-3, 1e-3, 1.4e-3, 2e-3, 2.5e-3, 3e-3, 3.5e-3, 4e-3, 5e-3, 6e-3, 6.5e-3, 6.8e-3];

/// Fig 8.26: frequency against the command, cycle by cycle while it rises, and at constant commands.
///
/// The frequency ends near sqrt(K / (M + f Tc)) / (2 pi), 7 % below the natural frequency (claim 8-123).
fn frequency(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let recipe =
        final_circuit().steady_command(1e-3).run_time(4.0).sample_interval(5e-4).record(&["spring_force"]);
    let read =
        recipe.run_values("v_start", &COMMANDS, |run| run.measure("frequency:spring_force,last=1.5"))?;
    let points: Vec<_> =
        read.into_iter().map(|(command, frequency)| (command / MM_PER_S, frequency)).collect();
    let natural = DrivenTable::simulated(0.0065).natural_frequency()? / std::f64::consts::TAU;
    let reading = format!(
        "the frequency rises from {:.1} Hz at {} mm/s to {:.1} Hz at {} mm/s; the table's natural frequency is \
         {natural:.1} Hz",
        points[0].1,
        points[0].0,
        points[points.len() - 1].1,
        points[points.len() - 1].0,
    );
    let run = figure.run(&rising(final_circuit(), RATE).add_picture("", "v_i", &["spring_force"]), "")?;
    let (command, velocity) = (run.record.values("v_i")?, run.record.values("v_o")?);
    let found = cycles(&run.record.trace.time, &command, &velocity, Criterion::USUAL)?;
    let along = found.iter().map(|cycle| (cycle.command / MM_PER_S, cycle.frequency)).collect();
    let graph = Graph::new(&figure.heading(), ("v_i", "mm/s"), ("frequency", "Hz"))
        .y_range(0.0, 60.0)
        .line("cycle by cycle, command rising at 1.2 mm/s2", along)
        .dots("at steady commands", points)
        .line("natural frequency", vec![(0.0, natural), (8.0, natural)]);
    let mut drawn = DrawnFigure::from_runs(&[&run], vec![graph.picture()], run.settings(), reading)?;
    let steady = recipe.patch(&figure.file("steady"), &figure.heading())?;
    drawn.commands.push(format!(
        "patchcord sweep {} --vary v_start={} --measure frequency:spring_force,last=1.5",
        steady.file(),
        comma_separated(&COMMANDS)
    ));
    drawn.patches.push(steady);
    Ok(drawn)
}

/// Makes the picture of a profile up and down. Each direction is a channel.
fn both_ways(run: &ReplayedRun, title: &str) -> Result<Picture, BoxError> {
    let points = run.record.points(("v_i", MM_PER_S), ("v_o", MM_PER_S))?;
    let turn = points.iter().enumerate().max_by(|one, other| one.1.0.total_cmp(&other.1.0));
    let (up, down) = points.split_at(turn.map_or(0, |(index, _)| index));
    let graph = Graph::new(title, ("v_i", "mm/s"), ("v_o", "mm/s"));
    Ok(graph.line("rising", up.to_vec()).line("falling", down.to_vec()).note(run.settings()).picture())
}

/// Fig 8.27: the profile for a rising and a falling command.
fn there_and_back(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let recipe = final_circuit().triangle_command(HIGHEST, RATE);
    let run = figure.run(&recipe.add_picture(&figure.heading(), "v_i", &["v_o"]), "")?;
    let critical = run.record.critical_velocity()?;
    let reading = format!(
        "oscillation ends at {} while the command rises, and begins at {} while it falls (without noise, so it grows \
         from what remains of the run)",
        format_critical_velocity(critical.rising),
        format_critical_velocity(critical.falling)
    );
    DrawnFigure::from_runs(&[&run], vec![both_ways(&run, &figure.heading())?], run.settings(), reading)
}

/// Fig 8.28: the same profile at twice the rate.
fn twice_as_fast(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let runs = [RATE, 2.0 * RATE].map(|rate| {
        final_circuit().triangle_command(HIGHEST, rate).add_picture(&figure.heading(), "v_i", &["v_o"])
    });
    let [slow, fast] = [figure.run(&runs[0], "slow")?, figure.run(&runs[1], "fast")?];
    let pictures = vec![both_ways(&slow, "(a) 1.2 mm/s2")?, both_ways(&fast, "(b) 2.4 mm/s2")?];
    let (before, after) = (slow.record.critical_velocity()?, fast.record.critical_velocity()?);
    let reading = format!(
        "at twice the rate the critical velocity changes from {} to {} rising, and from {} to {} falling",
        format_critical_velocity(before.rising),
        format_critical_velocity(after.rising),
        format_critical_velocity(before.falling),
        format_critical_velocity(after.falling)
    );
    DrawnFigure::from_runs(&[&slow, &fast], pictures, slow.settings(), reading)
}

/// Fig 8.29: a profile with VcL = 25.4 mm/s and Tc = 7.5 ms at two rates.
///
/// At the higher rate the table still oscillates at commands at which it is quiet at the lower rate (claim 8-132).
fn faster(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let recipe = || Recipe::new("fig-8-16").set("VcL", 25.4e-3).set("Tc", 0.0075);
    let [slow, fast] = [
        figure.run(&rising(recipe(), RATE).add_picture("(a) 1.2 mm/s2", "v_i", &["v_o"]), "slow")?,
        figure.run(&rising(recipe(), 2.0 * RATE).add_picture("(b) 2.4 mm/s2", "v_i", &["v_o"]), "fast")?,
    ];
    let pictures = slow.pictures()?.into_iter().chain(fast.pictures()?).collect();
    let reading = format!(
        "swings above 0.25 mm/s end at {}; at twice the rate, at {}",
        format_critical_velocity(slow.record.critical_velocity()?.rising),
        format_critical_velocity(fast.record.critical_velocity()?.rising)
    );
    DrawnFigure::from_runs(&[&slow, &fast], pictures, slow.settings(), reading)
}
