//! Chapter 8: quasi-harmonic motion, which is oscillation without periods of rest (8.5).
//!
//! The figures show it alone, near the critical velocity, and just after stick-slip.

use super::chapter_8_profiles::rising;
use super::graph::Graph;
use super::{DrawnFigure, Figure, Recipe};
use crate::replay::boundary::RATE;
use crate::replay::frequency::{self, VelocitySwing};
use crate::replay::recipe::BoxError;
use crate::replay::run_record::{ReplayedRun, format_critical_velocity};
use crate::slideway::stability::DrivenTable;
use crate::slideway::units::MM_PER_S;
use patchcord_analysis::format::format_quantity;
use patchcord_draw::plot::Picture;

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[
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
        draw: after_stick_slip,
    },
];

/// VcL of the two profiles, in m/s. The first is that of the caption of Fig 8.34. At the second only the first slip
/// ends at rest.
const LIMITS: [f64; 2] = [2.54e-3, 10.16e-3];

/// Fig 8.32: one profile with stick-slip followed by quasi-harmonic motion, and one with quasi-harmonic motion after
/// the first slip.
fn two_profiles(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let titles = ["(a) stick-slip, then quasi-harmonic", "(b) quasi-harmonic after the first jump"];
    let mut runs = Vec::new();
    for ((limit, title), which) in LIMITS.into_iter().zip(titles).zip(["a", "b"]) {
        let recipe = Recipe::new("fig-8-16").set("VcL", limit).add_picture(title, "v_i", &["v_o"]);
        runs.push(figure.run(&rising(recipe, RATE), which)?);
    }
    let pictures = runs[0].pictures()?.into_iter().chain(runs[1].pictures()?).collect();
    let reading = format!(
        "oscillation ends at {} and {}",
        format_critical_velocity(runs[0].record.critical_velocity()?.rising),
        format_critical_velocity(runs[1].record.critical_velocity()?.rising)
    );
    let settings = runs[0].settings();
    DrawnFigure::from_runs(&runs.iter().collect::<Vec<_>>(), pictures, settings, reading)
}

/// Fig 8.33: velocity in time at constant commands slightly below the critical velocity.
fn near_critical(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let commands = [4e-3, 6.8e-3];
    let (mut runs, mut readings) = (Vec::new(), Vec::new());
    for ((limit, command), which) in LIMITS.into_iter().zip(commands).zip(["a", "b"]) {
        let title = format!(
            "({which}) VcL = {}, at {}",
            format_quantity(limit, "m/s"),
            format_quantity(command, "m/s")
        );
        let recipe = Recipe::new("fig-8-16")
            .set("VcL", limit)
            .steady_command(command)
            .run_time(4.0)
            .sample_interval(2e-4);
        let run = figure.run(&recipe.add_picture(&title, "t", &["v_o"]), which)?;
        let frequency = run.record.measure("frequency:v_o,last=1")?;
        readings.push(format!("{frequency:.1} Hz at {}", format_quantity(command, "m/s")));
        runs.push(run);
    }
    let natural = DrivenTable::simulated(0.0065).natural_frequency()? / std::f64::consts::TAU;
    let cycle_pictures = |run: &ReplayedRun| -> Result<Vec<Picture>, BoxError> {
        // A few cycles from the end of the run, when the oscillation has settled.
        let points = run.record.points(("t", 1.0), ("v_o", MM_PER_S))?;
        let graph = Graph::new(&run.patch().pictures[0].title, ("t", "s"), ("v_o", "mm/s"));
        let cycles = points.into_iter().filter(|(time, _)| *time >= 3.8).collect();
        Ok(vec![graph.line("v_o", cycles).note(run.settings()).picture()])
    };
    let pictures = cycle_pictures(&runs[0])?.into_iter().chain(cycle_pictures(&runs[1])?).collect();
    let reading = format!("{}; the natural frequency is {natural:.1} Hz", readings.join(", "));
    let settings = runs[0].settings();
    DrawnFigure::from_runs(&runs.iter().collect::<Vec<_>>(), pictures, settings, reading)
}

/// The command of the caption of Fig 8.34, in m/s, and another value that it may mean, because the scan drops decimal
/// points. At ten times the first one nothing oscillates.
const CAPTION_COMMANDS: [f64; 2] = [2.13e-3, 0.213e-3];
/// The frequency of that caption, in Hz.
const CAPTION_HERTZ: f64 = 33.0;
/// Two values of VcL that the caption may mean, and one that gives its frequency, in m/s.
const CAPTION_LIMITS: [f64; 3] = [2.54e-3, 25.4e-3, 23e-3];

/// Formats a VcL with the range of its velocity: "VcL = 23.0 mm/s (1.66 ... 2.63 mm/s)".
fn format_swing((limit, swing): &(f64, VelocitySwing)) -> String {
    format!(
        "VcL = {} ({:.2} ... {:.2} mm/s)",
        format_quantity(*limit, "m/s"),
        swing.min / MM_PER_S,
        swing.max / MM_PER_S
    )
}

/// Fig 8.34: velocity in time with the values of the caption, and frequency by VcL for the commands that the caption
/// may mean.
fn after_stick_slip(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let recipe = |limit| frequency::steady_recipe(CAPTION_COMMANDS[0]).set("VcL", limit);
    let (mut runs, mut read) = (Vec::new(), Vec::new());
    let mut velocities = Graph::new("velocity", ("t", "s"), ("v_o", "mm/s"));
    for (limit, which) in CAPTION_LIMITS.into_iter().zip(["a", "b", "c"]) {
        let run = figure.run(&recipe(limit).add_picture("", "t", &["v_o"]), which)?;
        let points = run.record.points(("t", 1.0), ("v_o", MM_PER_S))?.into_iter();
        let cycles = points.filter(|(time, _)| *time >= 3.85).collect();
        velocities = velocities.line(format!("VcL = {}", format_quantity(limit, "m/s")), cycles);
        let swing = frequency::read_swing(&run.record)?;
        read.push(
            swing.frequency.map_or_else(|| "none".to_owned(), |frequency| format!("{frequency:.1} Hz")),
        );
        runs.push(run);
    }
    let mut frequencies =
        Graph::new("frequency by what the caption may mean", ("VcL", "mm/s"), ("frequency", "Hz"))
            .x_range(0.0, 30.0)
            .y_range(0.0, 60.0);
    let mut solved = Vec::new();
    for command in CAPTION_COMMANDS {
        let swings = frequency::swings_by_limit(command)?;
        let points = swings.iter().filter_map(|(limit, swing)| Some((limit / MM_PER_S, swing.frequency?)));
        let command_text = format_quantity(command, "m/s");
        frequencies = frequencies.line(format!("at {command_text}"), points.collect());
        let found = frequency::limits_at_frequency(command, &swings, CAPTION_HERTZ)?;
        let found = found.iter().map(format_swing).collect::<Vec<_>>().join(", ");
        solved.push(format!("at {command_text} with {found}"));
    }
    let frequencies = frequencies.line("caption: 33 Hz", vec![(0.0, CAPTION_HERTZ), (30.0, CAPTION_HERTZ)]);
    let reading = format!(
        "the caption says 33 Hz at 2.13 mm/s with a VcL of 2.54 mm/s; the run gives {}, and with 25.4 mm/s {}; the \
         frequency is 33 Hz {}",
        read[0],
        read[1],
        solved.join(", ")
    );
    let runs: Vec<_> = runs.iter().collect();
    let settings = runs[0].settings();
    DrawnFigure::from_runs(&runs, vec![velocities.picture(), frequencies.picture()], settings, reading)
}
