//! Chapter 8, first part: the circuits, from the linear table to the final circuit (8.2, 8.3).
//!
//! Circuits are drawn from the shipped patches. Their characteristics and responses are recorded from runs of the
//! same patches.

use super::{DrawnFigure, Figure, Graph, Recipe, Sheet, with_title};
use crate::replay::recipe::{BoxError, max_run_difference};
use crate::replay::run_record::{ReplayedRun, format_critical_velocity};
use crate::slideway::falling::SIMULATED_STATIC;
use crate::slideway::stability::SIMULATED_DAMPING;
use crate::slideway::units::{MM, MM_PER_S};
use patchcord_analysis::format::format_quantity;
use patchcord_analysis::instruments::parameter_line;
use patchcord_core::circuit::Circuit;
use patchcord_draw::schematic::Schematic;

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "fig-8-04",
        place: "8.2, eq 3-8 ... 12-8",
        title: "computer diagram of the linear slideway",
        claims: &[],
        draw: |figure| circuit(figure, "fig-8-04"),
    },
    Figure {
        id: "fig-8-05",
        place: "8.2, eq 13-8 ... 18-8",
        title: "friction as a dead zone: what the spring force must overcome",
        claims: &["8-045", "8-047", "8-048", "8-049", "8-050", "8-051", "8-052"],
        draw: dead_zone,
    },
    Figure {
        id: "fig-8-06",
        place: "8.2, eq 26-8, 27-8",
        title: "the dead zone at three biases",
        claims: &["8-053"],
        draw: three_biases,
    },
    Figure {
        id: "fig-8-07",
        place: "8.2",
        title: "circuit with constant friction",
        claims: &["8-055", "8-055.b"],
        draw: |figure| circuit(figure, "fig-8-07"),
    },
    Figure {
        id: "fig-8-08",
        place: "8.2",
        title: "responses to a step of 0.127 mm",
        claims: &["8-056"],
        draw: steps,
    },
    Figure {
        id: "fig-8-09",
        place: "8.2, eq 28-8",
        title: "level of the dead zone against velocity",
        claims: &["8-064", "8-069", "8-070", "8-072", "8-073", "8-074", "8-075"],
        draw: level,
    },
    Figure {
        id: "fig-8-10",
        place: "8.2",
        title: "friction along straight lines",
        claims: &["8-083"],
        draw: straight_lines,
    },
    Figure {
        id: "fig-8-11",
        place: "8.2",
        title: "circuit with friction that falls along a straight line",
        claims: &["8-061", "8-062"],
        draw: |figure| circuit(figure, "fig-8-11"),
    },
    Figure {
        id: "fig-8-12",
        place: "8.2",
        title: "stick-slip under a position ramp of 0.12 mm/s",
        claims: &["8-077"],
        draw: position_ramp,
    },
    Figure {
        id: "fig-8-13",
        place: "8.2",
        title: "velocity profile, and stick-slip in time, with straight-line friction",
        claims: &["8-080"],
        draw: straight_profile,
    },
    Figure {
        id: "fig-8-14",
        place: "8.3, eq 32-8",
        title: "dead zone controlled by the square of velocity",
        claims: &["8-086", "8-087", "8-088", "8-089", "8-090", "8-091"],
        draw: |figure| circuit(figure, "fig-8-14"),
    },
    Figure {
        id: "fig-8-15",
        place: "8.3, eq 33-8 ... 35-8",
        title: "the first-order lag at its corner",
        claims: &["8-096", "8-103", "8-103.b", "8-104"],
        draw: lag,
    },
    Figure {
        id: "fig-8-16",
        place: "8.3",
        title: "final simulation circuit",
        claims: &["8-098", "8-099", "8-101", "8-102"],
        draw: |figure| circuit(figure, "fig-8-16"),
    },
    Figure { id: "fig-8-17", place: "8.3", title: "the final circuit as blocks", claims: &[], draw: blocks },
];

/// Draws the diagram of a shipped circuit. The reading is a list of the parts that it uses.
fn circuit(figure: &Figure, name: &'static str) -> Result<DrawnFigure, BoxError> {
    let circuit = Recipe::new(name).circuit(figure.id, &figure.heading())?;
    let schematic = Schematic::new(&circuit, &parameter_line(&circuit), "", &|_| None)?;
    Ok(DrawnFigure {
        sheet: Sheet::Drawing(Box::new(schematic.drawing())),
        settings: circuit.patch().source.clone(),
        reading: inventory(&circuit),
        patches: vec![circuit.patch().clone()],
        commands: vec![format!("patchcord draw {} --plot {}.svg", circuit.patch().file(), figure.id)],
        table: None,
    })
}

/// Lists the parts that a circuit uses, with the stock of its machine: "3 of 16 summers, 2 of 8 integrators".
fn inventory(circuit: &Circuit) -> String {
    let machine = circuit.machine();
    let counts = circuit.parts().iter().map(|(part, count)| match machine.count(*part) {
        Some(stock) => format!("{count} of {}", part.counted(stock)),
        None => part.counted(*count),
    });
    counts.collect::<Vec<_>>().join(", ")
}

/// Fig 8.17: the final circuit as blocks, compared with the circuit of Fig 8.16.
fn blocks(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let drawn = circuit(figure, "fig-8-17")?;
    let difference = max_run_difference(["fig-8-17", "fig-8-16"].map(Recipe::new), "v_o")?;
    let reading = format!("its velocity differs from that of Fig 8.16 by at most {difference:.1e} m/s");
    Ok(DrawnFigure { reading, ..drawn })
}

/// Fig 8.8: responses of the linear circuit and of the circuit with constant friction to the same step of position.
///
/// The step is that of the shipped patches. Claims 8-058.a, 8-058.b and 8-059.
fn steps(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let recipe = |circuit| Recipe::new(circuit).run_time(0.25).add_picture("", "t", &["x_i", "x_o"]);
    let linear = figure.run(&recipe("fig-8-04"), "a")?;
    let with_friction = figure.run(&recipe("fig-8-07"), "b")?;
    let titles = ["(a) linear, Fig 8.4", "(b) with the dead zone, Fig 8.7"];
    let pictures = linear.pictures()?.into_iter().chain(with_friction.pictures()?).zip(titles);
    let pictures = pictures.map(|(picture, title)| with_title(picture, title)).collect();
    let end =
        |run: &ReplayedRun| Ok::<_, BoxError>(run.record.values("x_o")?.last().copied().unwrap_or_default());
    let reading = format!(
        "the linear table rings and settles at {}; with friction the table stops at {}, within Fs/K = {} of the \
         command",
        format_quantity(end(&linear)?, "m"),
        format_quantity(end(&with_friction)?, "m"),
        format_quantity(SIMULATED_STATIC / 17.86e6, "m"),
    );
    DrawnFigure::from_runs(&[&linear, &with_friction], pictures, with_friction.settings(), reading)
}

/// Three values of VcL, in m/s (8.2, Fig 8.10).
const THREE_LIMITS: [f64; 3] = [1.27e-3, 2.54e-3, 3.81e-3];

/// Runs the straight-line circuit with a command that passes through the whole characteristic. `limit` is VcL in m/s.
fn straight(figure: &Figure, limit: f64, which: &str) -> Result<ReplayedRun, BoxError> {
    let recipe =
        Recipe::new("fig-8-11").set("VcL", limit).set("v_rate", 6e-3).run_time(1.2).sample_interval(2e-4);
    figure.run(&recipe.add_picture(&figure.heading(), "v_o", &["friction_level"]), which)
}

/// Fig 8.9: the level of the dead zone against velocity, from a run of the patch.
///
/// VB falls linearly with the modulus of velocity up to VcL (eq 28-8).
fn level(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let run = figure.run(&Recipe::new("fig-8-09"), "")?;
    let (velocity, level) = (run.record.values("v_o")?, run.record.values("VB")?);
    let at = |wanted: f64| {
        let nearest = velocity
            .iter()
            .zip(&level)
            .min_by(|one, other| (one.0 - wanted).abs().total_cmp(&(other.0 - wanted).abs()));
        nearest.map_or(0.0, |(_, level)| *level)
    };
    let reading = format!(
        "VB is {:.1} V at rest, {:.1} V at VcL = 2.54 mm/s and {:.2} V at 7.62 mm/s, in both directions",
        at(0.0),
        at(2.54e-3),
        at(7.62e-3)
    );
    DrawnFigure::from_run(&run, reading)
}

/// Returns the input at which a dead zone ends, and the slope above it, from the last two samples.
fn end_and_slope(points: &[(f64, f64)]) -> (f64, f64) {
    let [(x, y), (end, out)] = [points[points.len() - 2], points[points.len() - 1]];
    let slope = (out - y) / (end - x);
    (end - out / slope, slope)
}

/// Fig 8.5: static friction, and the output of the dead zone against its input.
fn dead_zone(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let run = figure.run(&Recipe::new("fig-8-05"), "")?;
    let points = run.record.points(("V_1", 1.0), ("V_o", 1.0))?;
    let (end, slope) = end_and_slope(&points);
    let friction = Graph::new("(a) static friction against velocity", ("v", "mm/s"), ("F", "N")).line(
        "Fs",
        vec![
            (-2.0, -SIMULATED_STATIC),
            (0.0, -SIMULATED_STATIC),
            (0.0, SIMULATED_STATIC),
            (2.0, SIMULATED_STATIC),
        ],
    );
    let mut pictures = vec![friction.picture()];
    pictures.extend(
        run.pictures()?
            .into_iter()
            .map(|picture| with_title(picture, "(b) output of the dead zone against its input")),
    );
    let reading = format!("the output is 0 up to {end:.2} V; above that its slope is {slope:.3}");
    DrawnFigure::from_runs(&[&run], pictures, run.settings(), reading)
}

/// Fig 8.6: the dead zone with biases of 25, 50 and 75 V.
fn three_biases(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let run = figure.run(&Recipe::new("fig-8-06"), "")?;
    let mut texts = Vec::new();
    for (signal, bias) in [("VB.25", 25.0), ("VB.50", 50.0), ("VB.75", 75.0)] {
        let (end, slope) = end_and_slope(&run.record.points(("V_1", 1.0), (signal, 1.0))?);
        texts.push(format!("{end:.2} V at {bias} V ({:.3} VB, slope {slope:.3})", end / bias));
    }
    DrawnFigure::from_run(&run, format!("the zone ends at {}", texts.join(", ")))
}

/// Fig 8.15: the first-order lag, driven at its corner frequency.
fn lag(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let run = figure.run(&Recipe::new("fig-8-15"), "")?;
    let swing = |signal: &str| run.record.measure(&format!("amplitude:{signal},last=0.2"));
    let reading = format!(
        "an amplitude of {:.2} V at the input gives {:.2} V at the output",
        swing("in")?,
        swing("out")?
    );
    DrawnFigure::from_run(&run, reading)
}

/// Fig 8.10: friction along straight lines for three values of VcL, compared with Fs (1 - v / VcL) + f v.
///
/// The command rises at 6 mm/s2 for 1.2 s, up to 7.2 mm/s. Only forward velocities are plotted.
fn straight_lines(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut graph = Graph::new(&figure.heading(), ("v_o", "mm/s"), ("friction", "N"))
        .x_range(0.0, 6.0)
        .y_range(0.0, 800.0);
    let (mut runs, mut max_error) = (Vec::new(), 0.0_f64);
    for (limit, which) in THREE_LIMITS.into_iter().zip(["a", "b", "c"]) {
        let run = straight(figure, limit, which)?;
        let (velocity, level) = (run.record.values("v_o")?, run.record.values("friction_level")?);
        let friction = velocity.iter().zip(&level).filter(|(velocity, _)| **velocity > 0.0);
        let line = |velocity: f64| (SIMULATED_STATIC * (1.0 - velocity / limit)).max(0.0);
        max_error = friction.clone().fold(max_error, |max, (v, level)| max.max((level - line(*v)).abs()));
        let mut points: Vec<_> = friction
            .map(|(velocity, level)| (velocity / MM_PER_S, level + SIMULATED_DAMPING * velocity))
            .collect();
        points.sort_by(|one, other| one.0.total_cmp(&other.0));
        graph = graph.line(format!("VcL = {}", format_quantity(limit, "m/s")), points);
        runs.push(run);
    }
    let reading = format!(
        "dead-zone level and viscous friction differ from Fs (1 - v / VcL) + f v by at most {max_error:.1} N, at \
         every velocity of the run"
    );
    let runs: Vec<_> = runs.iter().collect();
    DrawnFigure::from_runs(&runs, vec![graph.picture()], runs[1].settings(), reading)
}

/// Fig 8.12: stick-slip of the straight-line circuit under a constant velocity command of 0.12 mm/s.
fn position_ramp(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    // A position that rises linearly is a constant velocity command.
    let rate = 0.12e-3;
    let recipe =
        Recipe::new("fig-8-11").set("v_start", rate).set("v_rate", 0.0).run_time(1.0).sample_interval(5e-4);
    let recipe = recipe.add_picture("velocity", "t", &["v_o"]).add_picture("acceleration", "t", &["a_o"]);
    let run = figure.run(&recipe, "")?;
    let error = run.record.values("x_error")?;
    let output = run
        .record
        .trace
        .time
        .iter()
        .zip(error)
        .map(|(time, error)| (*time, (rate * time - error) / MM))
        .collect();
    let position = Graph::new("position", ("t", "s"), ("x", "mm"))
        .line("x_i", run.record.trace.time.iter().map(|time| (*time, rate * time / MM)).collect())
        .line("x_o", output)
        .note(run.settings());
    let mut pictures = vec![position.picture()];
    pictures.extend(run.pictures()?);
    let velocity = run.record.values("v_o")?;
    let max = velocity.iter().copied().fold(0.0, f64::max);
    let reading = format!(
        "the motion is stick-slip: slips reach {}, {:.0} times the command",
        format_quantity(max, "m/s"),
        max / rate
    );
    DrawnFigure::from_runs(&[&run], pictures, run.settings(), reading)
}

/// Fig 8.13: the profile of the straight-line circuit up and down, and its stick-slip at 1 mm/s.
///
/// The profile is the subject of claims 8-079.a and b, and of figure D1.
fn straight_profile(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let profile_recipe =
        Recipe::new("fig-8-11").set("v_turn", 8.4667).run_time(16.5).add_picture("", "v_i", &["v_o"]);
    let profile = figure.run(&profile_recipe, "a")?;
    let steady =
        Recipe::new("fig-8-11").set("v_start", 1e-3).set("v_rate", 0.0).run_time(0.5).sample_interval(2e-4);
    let stick_slip = figure.run(&steady.add_picture("", "t", &["x_error", "v_o"]), "b")?;
    let critical = profile.record.critical_velocity()?;
    let reading = format!(
        "in the text oscillation ends at VcL itself, 2.54 mm/s; in the ideal circuit it ends at {} with a rising \
         command, and begins at {} with a falling one (swings above 0.25 mm/s within 0.04 s, no noise)",
        format_critical_velocity(critical.rising),
        format_critical_velocity(critical.falling),
    );
    let titles = ["(a) system velocity profile, command rising and falling", "(b) stick-slip at 1 mm/s"];
    let pictures = profile.pictures()?.into_iter().chain(stick_slip.pictures()?);
    let pictures = pictures.zip(titles).map(|(picture, title)| with_title(picture, title)).collect();
    DrawnFigure::from_runs(&[&profile, &stick_slip], pictures, profile.settings(), reading)
}
