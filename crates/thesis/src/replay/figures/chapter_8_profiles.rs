//! Chapter 8, third part: recordings of the final circuit while the command rises and falls (8.4, 8.5).
//!
//! VcL, Tc and the rate of each recording are chosen within the ranges of 8.4, as in
//! [`chapter_8_recordings`](super::chapter_8_recordings).

use super::chapter_8_recordings::{LIMIT, steady_friction};
use super::{DrawnFigure, Figure, Graph, Recipe, comma_separated};
use crate::replay::boundary::RATE;
use crate::replay::recipe::BoxError;
use crate::replay::run_record::{ReplayedRun, format_critical_velocity};
use crate::slideway::falling::FallingFriction;
use crate::slideway::stability::{DrivenTable, SIMULATED_DAMPING};
use crate::slideway::units::MM_PER_S;
use patchcord_analysis::format::format_quantity;
use patchcord_analysis::instruments::{Criterion, cycles};
use patchcord_draw::plot::{Channel, Picture};

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[
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
        draw: rising_and_falling,
    },
    Figure {
        id: "fig-8-28",
        place: "8.5",
        title: "the same at twice the rate",
        claims: &[],
        draw: at_twice_the_rate,
    },
    Figure {
        id: "fig-8-29",
        place: "8.5",
        title: "a faster command makes more oscillation",
        claims: &[],
        draw: at_two_rates,
    },
];

/// The command at the end of a run, in m/s: 40 V (8.2).
const MAX_COMMAND: f64 = 10.16e-3;

/// The final circuit with that VcL.
fn final_circuit() -> Recipe {
    Recipe::new("fig-8-16").set("VcL", LIMIT)
}

/// Raises the command from 0 to its highest value, at a rate in m/s2.
pub(super) fn rising(recipe: Recipe, rate: f64) -> Recipe {
    recipe.set("v_rate", rate).run_time(MAX_COMMAND / rate)
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
        format_quantity(least_friction()?, "m/s")
    );
    DrawnFigure::from_run(&run, reading)
}

/// Fig 8.25: spring force against output velocity, with the steady curve.
fn error_force(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let recipe = rising(final_circuit(), RATE);
    let run = figure.run(&recipe.add_picture(&figure.heading(), "v_o", &["spring_force"]), "")?;
    let mut pictures = run.pictures()?;
    pictures[0].channels[0].name = "spring force".to_owned();
    pictures[0].channels.push(Channel::line("steady friction", steady_friction(LIMIT, MAX_COMMAND)?));
    let critical = run.record.critical_velocity()?.rising?;
    let slope = SIMULATED_DAMPING - FallingFriction::simulated(LIMIT).slope(critical)?;
    let reading = format!(
        "oscillation ends at {}, where steady friction still falls by {:.1} N s/mm",
        format_quantity(critical, "m/s"),
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
    let cycle_frequencies = found.iter().map(|cycle| (cycle.command / MM_PER_S, cycle.frequency)).collect();
    let graph = Graph::new(&figure.heading(), ("v_i", "mm/s"), ("frequency", "Hz"))
        .y_range(0.0, 60.0)
        .line("cycle by cycle, command rising at 1.2 mm/s2", cycle_frequencies)
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
fn both_directions(run: &ReplayedRun, title: &str) -> Result<Picture, BoxError> {
    let points = run.record.curve(("v_i", MM_PER_S), ("v_o", MM_PER_S))?;
    let turn = points.iter().enumerate().max_by(|one, other| one.1.0.total_cmp(&other.1.0));
    let (up, down) = points.split_at(turn.map_or(0, |(index, _)| index));
    let graph = Graph::new(title, ("v_i", "mm/s"), ("v_o", "mm/s"));
    Ok(graph.line("rising", up.to_vec()).line("falling", down.to_vec()).note(run.settings()).picture())
}

/// Fig 8.27: the profile for a rising and a falling command.
fn rising_and_falling(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let recipe = final_circuit().triangle_command(MAX_COMMAND, RATE);
    let run = figure.run(&recipe.add_picture(&figure.heading(), "v_i", &["v_o"]), "")?;
    let critical = run.record.critical_velocity()?;
    let reading = format!(
        "oscillation ends at {} while the command rises, and begins at {} while it falls (without noise, so it grows \
         from what remains of the run)",
        format_critical_velocity(critical.rising),
        format_critical_velocity(critical.falling)
    );
    DrawnFigure::from_runs(&[&run], vec![both_directions(&run, &figure.heading())?], run.settings(), reading)
}

/// Fig 8.28: the same profile at twice the rate.
fn at_twice_the_rate(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let runs = [RATE, 2.0 * RATE].map(|rate| {
        final_circuit().triangle_command(MAX_COMMAND, rate).add_picture(&figure.heading(), "v_i", &["v_o"])
    });
    let [slow, fast] = [figure.run(&runs[0], "slow")?, figure.run(&runs[1], "fast")?];
    let pictures = vec![both_directions(&slow, "(a) 1.2 mm/s2")?, both_directions(&fast, "(b) 2.4 mm/s2")?];
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
fn at_two_rates(figure: &Figure) -> Result<DrawnFigure, BoxError> {
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
