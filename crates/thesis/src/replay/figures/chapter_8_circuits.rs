//! Chapter 8, first half: the circuits, and what they do on the way to the final one.

use super::{Drawn, Figure, Graph, Recipe, Sheet, titled, told};
use crate::replay::recipe::{Problem, Replayed, apart, velocity_told};
use crate::slideway::falling::SIMULATED_STATIC;
use crate::slideway::stability::SIMULATED_DAMPING;
use crate::slideway::units::{MM, MM_PER_S};
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

/// A circuit as it is drawn.
fn circuit(figure: &Figure, name: &'static str) -> Result<Drawn, Problem> {
    let circuit = Recipe::of(name).circuit(figure.id, &figure.heading())?;
    let schematic = Schematic::new(&circuit, &parameter_line(&circuit), "", &|_| None)?;
    Ok(Drawn {
        sheet: Sheet::Drawing(Box::new(schematic.drawing())),
        settings: circuit.patch().source.clone(),
        reading: inventory(&circuit),
        patches: vec![circuit.patch().clone()],
        commands: vec![format!("patchcord draw {} --plot {}.svg", circuit.patch().file(), figure.id)],
        table: None,
    })
}

/// What a circuit takes of its machine: "3 of 16 summers, 2 of 8 integrators".
fn inventory(circuit: &Circuit) -> String {
    let machine = circuit.machine();
    let told = circuit.parts().iter().map(|(part, count)| match machine.count(*part) {
        Some(stock) => format!("{count} of {}", part.counted(stock)),
        None => part.counted(*count),
    });
    told.collect::<Vec<_>>().join(", ")
}

fn blocks(figure: &Figure) -> Result<Drawn, Problem> {
    let drawn = circuit(figure, "fig-8-17")?;
    let apart = apart(["fig-8-17", "fig-8-16"].map(Recipe::of), "v_o")?;
    let reading = format!("its velocity is never further than {apart:.1e} m/s from that of Fig 8.16");
    Ok(Drawn { reading, ..drawn })
}

fn steps(figure: &Figure) -> Result<Drawn, Problem> {
    let recipe = |circuit| Recipe::of(circuit).lasting(0.25).picture("", "t", &["x_i", "x_o"]);
    let linear = figure.run(&recipe("fig-8-04"), "a")?;
    let with_friction = figure.run(&recipe("fig-8-07"), "b")?;
    let titles = ["(a) linear, Fig 8.4", "(b) with the dead zone, Fig 8.7"];
    let pictures = linear.pictures()?.into_iter().chain(with_friction.pictures()?).zip(titles);
    let pictures = pictures.map(|(picture, title)| titled(picture, title)).collect();
    let end = |run: &Replayed| Ok::<_, Problem>(run.values("x_o")?.last().copied().unwrap_or_default());
    let reading = format!(
        "the linear table rings and ends at {}; with friction it stops at {}, within Fs/K = {} of the command",
        told(end(&linear)?, "m"),
        told(end(&with_friction)?, "m"),
        told(SIMULATED_STATIC / 17.86e6, "m"),
    );
    Drawn::of_runs(&[&linear, &with_friction], pictures, with_friction.settings(), reading)
}

/// Three values of VcL, in m/s (8.2, Fig 8.10).
const THREE_LIMITS: [f64; 3] = [1.27e-3, 2.54e-3, 3.81e-3];

/// A run of the straight-line circuit in which velocity passes through the whole of the characteristic.
fn straight(figure: &Figure, limit: f64, which: &str) -> Result<Replayed, Problem> {
    let recipe = Recipe::of("fig-8-11").set("VcL", limit).set("v_rate", 6e-3).lasting(1.2).every(2e-4);
    figure.run(&recipe.picture(&figure.heading(), "v_o", &["friction_level"]), which)
}

fn level(figure: &Figure) -> Result<Drawn, Problem> {
    let run = figure.run(&Recipe::of("fig-8-09"), "")?;
    let (velocity, level) = (run.values("v_o")?, run.values("VB")?);
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
    Drawn::of_run(&run, reading)
}

/// Where a dead zone ends, and how steeply it goes on, from the last two of its samples.
fn end_and_slope(points: &[(f64, f64)]) -> (f64, f64) {
    let [(x, y), (end, out)] = [points[points.len() - 2], points[points.len() - 1]];
    let slope = (out - y) / (end - x);
    (end - out / slope, slope)
}

fn dead_zone(figure: &Figure) -> Result<Drawn, Problem> {
    let run = figure.run(&Recipe::of("fig-8-05"), "")?;
    let points = run.points(("V_1", 1.0), ("V_o", 1.0))?;
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
            .map(|picture| titled(picture, "(b) output of the dead zone against its input")),
    );
    let reading = format!("nothing comes through up to {end:.2} V, from there on {slope:.3} of the input");
    Drawn::of_runs(&[&run], pictures, run.settings(), reading)
}

fn three_biases(figure: &Figure) -> Result<Drawn, Problem> {
    let run = figure.run(&Recipe::of("fig-8-06"), "")?;
    let mut told = Vec::new();
    for (signal, bias) in [("VB.25", 25.0), ("VB.50", 50.0), ("VB.75", 75.0)] {
        let (end, slope) = end_and_slope(&run.points(("V_1", 1.0), (signal, 1.0))?);
        told.push(format!("{end:.2} V at {bias} V ({:.3} VB, slope {slope:.3})", end / bias));
    }
    Drawn::of_run(&run, format!("the zone ends at {}", told.join(", ")))
}

fn lag(figure: &Figure) -> Result<Drawn, Problem> {
    let run = figure.run(&Recipe::of("fig-8-15"), "")?;
    let swing = |signal: &str| run.measure(&format!("amplitude:{signal},last=0.2"));
    let reading = format!("{:.2} V come out as {:.2} V", swing("in")?, swing("out")?);
    Drawn::of_run(&run, reading)
}

fn straight_lines(figure: &Figure) -> Result<Drawn, Problem> {
    let mut graph =
        Graph::new(&figure.heading(), ("v_o", "mm/s"), ("friction", "N")).across(0.0, 6.0).up(0.0, 800.0);
    let (mut runs, mut furthest) = (Vec::new(), 0.0_f64);
    for (limit, which) in THREE_LIMITS.into_iter().zip(["a", "b", "c"]) {
        let run = straight(figure, limit, which)?;
        let (velocity, level) = (run.values("v_o")?, run.values("friction_level")?);
        let friction = velocity.iter().zip(&level).filter(|(velocity, _)| **velocity > 0.0);
        let line = |velocity: f64| (SIMULATED_STATIC * (1.0 - velocity / limit)).max(0.0);
        furthest = friction.clone().fold(furthest, |most, (v, level)| most.max((level - line(*v)).abs()));
        let mut points: Vec<_> = friction
            .map(|(velocity, level)| (velocity / MM_PER_S, level + SIMULATED_DAMPING * velocity))
            .collect();
        points.sort_by(|one, other| one.0.total_cmp(&other.0));
        graph = graph.line(format!("VcL = {}", told(limit, "m/s")), points);
        runs.push(run);
    }
    let reading = format!(
        "dead-zone level and viscous part at every velocity that the run passes through: never further than {furthest:.1} N from \
         Fs (1 - v / VcL) + f v"
    );
    let runs: Vec<_> = runs.iter().collect();
    Drawn::of_runs(&runs, vec![graph.picture()], runs[1].settings(), reading)
}

fn position_ramp(figure: &Figure) -> Result<Drawn, Problem> {
    // A position that rises evenly is a velocity command that stands still.
    let rate = 0.12e-3;
    let recipe = Recipe::of("fig-8-11").set("v_start", rate).set("v_rate", 0.0).lasting(1.0).every(5e-4);
    let recipe = recipe.picture("velocity", "t", &["v_o"]).picture("acceleration", "t", &["a_o"]);
    let run = figure.run(&recipe, "")?;
    let error = run.values("x_error")?;
    let output =
        run.trace.time.iter().zip(error).map(|(time, error)| (*time, (rate * time - error) / MM)).collect();
    let position = Graph::new("position", ("t", "s"), ("x", "mm"))
        .line("x_i", run.trace.time.iter().map(|time| (*time, rate * time / MM)).collect())
        .line("x_o", output)
        .note(run.settings());
    let mut pictures = vec![position.picture()];
    pictures.extend(run.pictures()?);
    let velocity = run.values("v_o")?;
    let most = velocity.iter().copied().fold(0.0, f64::max);
    let reading = format!(
        "it sticks and slips: slips reach {}, {:.0} times the command",
        told(most, "m/s"),
        most / rate
    );
    Drawn::of_runs(&[&run], pictures, run.settings(), reading)
}

fn straight_profile(figure: &Figure) -> Result<Drawn, Problem> {
    let there = Recipe::of("fig-8-11").set("v_turn", 8.4667).lasting(16.5).picture("", "v_i", &["v_o"]);
    let profile = figure.run(&there, "a")?;
    let steady = Recipe::of("fig-8-11").set("v_start", 1e-3).set("v_rate", 0.0).lasting(0.5).every(2e-4);
    let stick_slip = figure.run(&steady.picture("", "t", &["x_error", "v_o"]), "b")?;
    let critical = profile.critical()?;
    let reading = format!(
        "the text ends oscillation at VcL itself, 2.54 mm/s; the ideal circuit ends it at {} rising, and begins it at {} \
         falling (swings above 0.25 mm/s within 0.04 s, no noise)",
        velocity_told(critical.rising),
        velocity_told(critical.falling),
    );
    let titles = ["(a) system velocity profile, command rising and falling", "(b) stick-slip at 1 mm/s"];
    let pictures = profile.pictures()?.into_iter().chain(stick_slip.pictures()?);
    let pictures = pictures.zip(titles).map(|(picture, title)| titled(picture, title)).collect();
    Drawn::of_runs(&[&profile, &stick_slip], pictures, profile.settings(), reading)
}
