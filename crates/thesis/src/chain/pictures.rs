//! The velocity profile as pictures, with the critical velocities marked.

use super::Chain;
use super::predictions::Prediction;
use super::simulation::{COMMAND, Simulation, VELOCITY};
use patchcord_analysis::instruments::{Display, NoCriticalVelocity};
use patchcord_draw::Plane;
use patchcord_draw::plot::{Axis, Picture};

/// Two pictures, one to stand below the other: output velocity against the command while it rises and while it falls, with the critical
/// velocities read off the run, and those of the equations. Each has a line of small print.
pub fn pictures(chain: &Chain, notes: [&str; 2]) -> [Picture; 2] {
    let Simulation { trace, ramp, critical, .. } = &chain.simulation;
    let shown = Display::new("m/s", ramp.top());
    let [commands, velocities] = [COMMAND, VELOCITY].map(|name| trace.values(name).unwrap_or_default());
    let axis = |name: &str, values: &[f64], divisions| {
        let scaled = values.iter().map(|value| shown.value(*value));
        (Axis::snug(name, &shown.unit, scaled, divisions), shown.clone())
    };
    let plane = Plane {
        across: axis(COMMAND, &commands, Axis::ACROSS),
        upward: axis(VELOCITY, &velocities, Axis::UP),
    };
    let points: Vec<_> = commands.into_iter().zip(velocities).collect();
    let (rising, falling) = points.split_at(trace.time.partition_point(|time| *time <= ramp.turn));
    let picture = |title: String, points: &[(f64, f64)], marks, note: &str| {
        let line = plane.line(VELOCITY, points.iter().copied());
        plane.picture(title, vec![line], marks, Some(note.to_owned()))
    };
    let what = if chain.simulation.only_rings() { "ringing ends at" } else { "oscillation ends at" };
    let ends = title("rises", what, critical.rising, &shown);
    let begins = title("falls", "oscillation begins at", critical.falling, &shown);
    [
        picture(ends, rising, marks(critical.rising, &equations(chain)), notes[0]),
        picture(begins, falling, marks(critical.falling, &[]), notes[1]),
    ]
}

/// "System velocity profile: the command rises, oscillation ends at 4.54 mm/s".
fn title(way: &str, turns: &str, read: Result<f64, NoCriticalVelocity>, shown: &Display) -> String {
    let told = match read {
        Ok(velocity) => format!("{turns} {}", shown.text(velocity)),
        Err(error) => error.told_in("m/s"),
    };
    format!("System velocity profile: the command {way}, {told}")
}

/// What was read off the run, and what equations say.
fn marks(read: Result<f64, NoCriticalVelocity>, equations: &[(&str, &Prediction)]) -> Vec<(f64, String)> {
    let run = read.into_iter().map(|velocity| (velocity, "run"));
    let others = equations.iter().filter_map(|(label, said)| Some((*said.as_ref().ok()?, *label)));
    run.chain(others).map(|(at, label)| (at, label.to_owned())).collect()
}

/// The critical velocities by equations.
fn equations(chain: &Chain) -> [(&'static str, &Prediction); 2] {
    [("eq 93-9", &chain.predictions.printed), ("Routh-Hurwitz", &chain.predictions.stability)]
}
