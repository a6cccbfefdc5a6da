//! Chapter 8: oscillation without rest (8.5), by itself, near the critical velocity, and just after stick-slip.

use super::chapter_8_recordings::rising;
use super::graph::Graph;
use super::{Drawn, Figure, Recipe, told};
use crate::replay::boundary::RATE;
use crate::replay::frequency::{self, Swing};
use crate::replay::recipe::{Problem, Replayed, velocity_told};
use crate::slideway::stability::DrivenTable;
use crate::slideway::units::MM_PER_S;
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
        draw: just_after,
    },
];

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
        velocity_told(runs[0].critical()?.rising),
        velocity_told(runs[1].critical()?.rising)
    );
    let settings = runs[0].settings();
    Drawn::of_runs(&runs.iter().collect::<Vec<_>>(), pictures, settings, reading)
}

fn near_critical(figure: &Figure) -> Result<Drawn, Problem> {
    let commands = [4e-3, 6.8e-3];
    let (mut runs, mut readings) = (Vec::new(), Vec::new());
    for ((limit, command), which) in TWO.into_iter().zip(commands).zip(["a", "b"]) {
        let title = format!("({which}) VcL = {}, at {}", told(limit, "m/s"), told(command, "m/s"));
        let recipe = Recipe::of("fig-8-16").set("VcL", limit).steady(command).lasting(4.0).every(2e-4);
        let run = figure.run(&recipe.picture(&title, "t", &["v_o"]), which)?;
        let frequency = run.measure("frequency:v_o,last=1")?;
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
/// The frequency of the caption.
const CAPTION_HERTZ: f64 = 33.0;
/// Values of VcL that the caption may mean, and one that gives the frequency, in m/s.
const CAPTION_LIMITS: [f64; 3] = [2.54e-3, 25.4e-3, 23e-3];

/// "VcL = 23.0 mm/s (1.66 ... 2.63 mm/s)".
fn swing_told((limit, swing): &(f64, Swing)) -> String {
    format!(
        "VcL = {} ({:.2} ... {:.2} mm/s)",
        told(*limit, "m/s"),
        swing.least / MM_PER_S,
        swing.most / MM_PER_S
    )
}

fn just_after(figure: &Figure) -> Result<Drawn, Problem> {
    let recipe = |limit| frequency::at_command(CAPTION_COMMANDS[0]).set("VcL", limit);
    let (mut runs, mut read) = (Vec::new(), Vec::new());
    let mut velocities = Graph::new("velocity", ("t", "s"), ("v_o", "mm/s"));
    for (limit, which) in CAPTION_LIMITS.into_iter().zip(["a", "b", "c"]) {
        let run = figure.run(&recipe(limit).picture("", "t", &["v_o"]), which)?;
        let points = run.points(("t", 1.0), ("v_o", MM_PER_S))?.into_iter();
        let cycles = points.filter(|(time, _)| *time >= 3.85).collect();
        velocities = velocities.line(format!("VcL = {}", told(limit, "m/s")), cycles);
        let swing = frequency::swing(&run)?;
        read.push(
            swing.frequency.map_or_else(|| "none".to_owned(), |frequency| format!("{frequency:.1} Hz")),
        );
        runs.push(run);
    }
    let mut frequencies =
        Graph::new("frequency by what the caption may mean", ("VcL", "mm/s"), ("frequency", "Hz"))
            .across(0.0, 30.0)
            .up(0.0, 60.0);
    let mut solved = Vec::new();
    for command in CAPTION_COMMANDS {
        let swings = frequency::by_limit(command)?;
        let points = swings.iter().filter_map(|(limit, swing)| Some((limit / MM_PER_S, swing.frequency?)));
        let command_told = told(command, "m/s");
        frequencies = frequencies.line(format!("at {command_told}"), points.collect());
        let found = frequency::limits_at(command, &swings, CAPTION_HERTZ)?;
        let found = found.iter().map(swing_told).collect::<Vec<_>>().join(", ");
        solved.push(format!("at {command_told} with {found}"));
    }
    let frequencies = frequencies.line("caption: 33 Hz", vec![(0.0, CAPTION_HERTZ), (30.0, CAPTION_HERTZ)]);
    let reading = format!(
        "the caption says 33 Hz at 2.13 mm/s with a VcL of 2.54 mm/s: we get {}, and with 25.4 mm/s {}; 33 Hz comes out {}",
        read[0],
        read[1],
        solved.join(", ")
    );
    let runs: Vec<_> = runs.iter().collect();
    let settings = runs[0].settings();
    Drawn::of_runs(&runs, vec![velocities.picture(), frequencies.picture()], settings, reading)
}
