//! The velocity profile as pictures, with the critical velocities marked.

use super::Chain;
use super::predictions::Prediction;
use super::simulation::{COMMAND, Simulation, VELOCITY};
use crate::instruments::{Display, NoCriticalVelocity};
use crate::plot::{Axis, Channel, Mark, Picture};

/// Two pictures, one to stand below the other: output velocity against the command while it rises and while it falls, with the critical
/// velocities read off the run, and those of the equations. Each has a line of small print.
pub fn pictures(chain: &Chain, notes: [&str; 2]) -> [Picture; 2] {
    let Simulation { trace, ramp, critical, .. } = &chain.simulation;
    let shown = Display::new("m/s", ramp.top());
    let [commands, velocities] = [COMMAND, VELOCITY].map(|name| trace.values(name).unwrap_or_default());
    let points = commands.iter().zip(&velocities).map(|(x, y)| (shown.value(*x), shown.value(*y)));
    let points: Vec<_> = points.collect();
    let (rising, falling) = points.split_at(trace.time.partition_point(|time| *time <= ramp.turn));
    let horizontal = Axis::snug(COMMAND, &shown.unit, points.iter().map(|at| at.0), Axis::ACROSS);
    let vertical = Axis::snug(VELOCITY, &shown.unit, points.iter().map(|at| at.1), Axis::UP);
    let picture = |title: String, points: &[(f64, f64)], marks, note: &str| Picture {
        channels: vec![Channel::line(VELOCITY, points.to_vec())],
        note: Some(note.to_owned()),
        marks,
        ..Picture::new(title, horizontal.clone(), vertical.clone())
    };
    let ends = title("rises", "ends at", critical.rising, &shown);
    let begins = title("falls", "begins at", critical.falling, &shown);
    [
        picture(ends, rising, marks(critical.rising, &equations(chain), &shown), notes[0]),
        picture(begins, falling, marks(critical.falling, &[], &shown), notes[1]),
    ]
}

/// "System velocity profile: the command rises, oscillation ends at 4.54 mm/s".
fn title(way: &str, turns: &str, read: Result<f64, NoCriticalVelocity>, shown: &Display) -> String {
    let told = match read {
        Ok(velocity) => format!("oscillation {turns} {}", shown.text(velocity)),
        Err(error) => error.to_string(),
    };
    format!("System velocity profile: the command {way}, {told}")
}

/// What was read off the run, and what equations say.
fn marks(
    read: Result<f64, NoCriticalVelocity>,
    equations: &[(&str, &Prediction)],
    shown: &Display,
) -> Vec<Mark> {
    let run = read.into_iter().map(|velocity| (velocity, "run"));
    let others = equations.iter().filter_map(|(label, said)| Some((*said.as_ref().ok()?, *label)));
    run.chain(others).map(|(at, label)| Mark { at: shown.value(at), label: label.to_owned() }).collect()
}

/// The critical velocities by equations.
fn equations(chain: &Chain) -> [(&'static str, &Prediction); 2] {
    [("eq 93-9", &chain.predictions.printed), ("Routh-Hurwitz", &chain.predictions.stability)]
}
