//! Chapter 8, second part: recordings of the final circuit at steady commands (8.4).
//!
//! The text of 8.4 states the settings of the machine. VcL, Tc and command of each recording are lost. They are chosen
//! here within the ranges of 8.4, so that a recording shows what the text says about it.

use super::graph::linspace;
use super::{DrawnFigure, Figure, Graph, Recipe, with_title};
use crate::replay::recipe::BoxError;
use crate::replay::run_record::ReplayedRun;
use crate::slideway::falling::{FallingFriction, SIMULATED_STATIC};
use crate::slideway::stability::SIMULATED_DAMPING;
use crate::slideway::units::{MM_PER_S, UM};
use patchcord_analysis::format::format_quantity;
use patchcord_analysis::instruments::{FrictionLoop, friction_loop};
use patchcord_draw::plot::Picture;

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
];

/// VcL of most recordings, in m/s. Of the printed values up to 40 V it is the one at which oscillation ends while
/// solid friction still falls.
pub(super) const LIMIT: f64 = 10.16e-3;

/// Returns velocity in mm/s and spring force in N of steady sliding by theory, up to a velocity in m/s.
pub(super) fn steady_friction(limit: f64, to: f64) -> Result<Vec<(f64, f64)>, BoxError> {
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
        let points = run.record.curve(("v_o", MM_PER_S), ("spring_force", 1.0))?;
        graph = graph.line(format!("VcL = {}", format_quantity(limit, "m/s")), points);
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
const STICK_SLIP: (f64, f64) = (3.81e-3, 0.3e-3);

/// Runs the stick-slip of the next three recordings, with one picture per list of signals.
fn stick_slip(figure: &Figure, y: &[&[&str]]) -> Result<ReplayedRun, BoxError> {
    let (limit, command) = STICK_SLIP;
    let recipe =
        Recipe::new("fig-8-16").set("VcL", limit).steady_command(command).run_time(1.0).sample_interval(2e-4);
    figure.run(&y.iter().fold(recipe, |recipe, y| recipe.add_picture("", "t", y)), "")
}

/// Fig 8.19: position and velocity under stick-slip.
fn position_and_velocity(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let run = stick_slip(figure, &[&["v_i", "v_o"]])?;
    let command_position = |time: f64| STICK_SLIP.1 * time;
    let output = run.record.trace.time.iter().zip(run.record.values("x_error")?);
    let output = output.map(|(time, error)| (*time, (command_position(*time) - error) / UM)).collect();
    let command = run.record.trace.time.iter().map(|time| (*time, command_position(*time) / UM)).collect();
    let position = Graph::new("position", ("t", "s"), ("x", "um")).line("x_i", command).line("x_o", output);
    let mut pictures = vec![position.note(run.settings()).picture()];
    pictures.extend(run.pictures()?.into_iter().map(|picture| with_title(picture, "velocity")));
    let slips = run.record.measure("frequency:v_o,last=0.8")?;
    let command = format_quantity(STICK_SLIP.1, "m/s");
    let reading = format!(
        "the table alternates between rest and slip {slips:.1} times a second at a constant command of {command}"
    );
    DrawnFigure::from_runs(&[&run], pictures, run.settings(), reading)
}

/// Fig 8.20: velocity and acceleration under stick-slip.
fn velocity_and_acceleration(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let run = stick_slip(figure, &[&["v_o"], &["a_o"]])?;
    let max = |signal| Ok::<_, BoxError>(run.record.values(signal)?.into_iter().fold(0.0, f64::max));
    let reading = format!(
        "slips reach {} and {}",
        format_quantity(max("v_o")?, "m/s"),
        format_quantity(max("a_o")?, "m/s2")
    );
    DrawnFigure::from_run(&run, reading)
}

/// Fig 8.21: position error under stick-slip.
fn position_error(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let run = stick_slip(figure, &[&["x_error"]])?;
    let swing = run.record.measure("amplitude:x_error,last=0.8")?;
    let reading = format!(
        "a saw tooth of {}: the drive is strained while the table is at rest",
        format_quantity(2.0 * swing, "m")
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
        .line(format!("at {}", format_quantity(command, "m/s")), points)
        .line("steady friction", steady_friction(limit, 1.2 * limit)?)
        .note(run.settings());
    Ok((run, cycle, graph.picture()))
}

/// Formats a loop: its ranges of velocity and force, its frequency, and its work per cycle.
fn format_loop(cycle: &FrictionLoop) -> String {
    let ([min, max], [min_force, max_force]) = (cycle.velocity, cycle.force);
    format!(
        "{} ... {} and {min_force:.0} ... {max_force:.0} N, {:.1} times a second; the work per cycle is {}",
        format_quantity(min, "m/s"),
        format_quantity(max, "m/s"),
        cycle.frequency,
        format_quantity(cycle.work, "J")
    )
}

/// Fig 8.22: the friction loop under stick-slip.
fn stick_slip_loop(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let (run, cycle, picture) = dynamic_loop(figure, STICK_SLIP)?;
    let reading = format!("force rises at rest and drops during the slip: {}", format_loop(&cycle));
    DrawnFigure::from_runs(&[&run], vec![picture], run.settings(), reading)
}

/// Fig 8.23: the friction loop under quasi-harmonic motion.
fn quasi_harmonic_loop(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let (run, cycle, picture) = dynamic_loop(figure, (LIMIT, 6.8e-3))?;
    let reading = format!("a small loop around the steady curve: {}", format_loop(&cycle));
    DrawnFigure::from_runs(&[&run], vec![picture], run.settings(), reading)
}
