//! Pictures of the velocity profile with the critical velocities marked.

use super::Chain;
use super::predictions::Prediction;
use super::simulation::{COMMAND, Simulation, VELOCITY};
use patchcord_analysis::format::QuantityFormat;
use patchcord_analysis::instruments::NoCriticalVelocity;
use patchcord_draw::ProfilePlane;
use patchcord_draw::plot::{Axis, Picture};

/// Two pictures of output velocity against command: the first while the command rises, the second while it falls.
///
/// Both mark the critical velocity that was read from the run. The first also marks those of the equations. `notes`
/// are the lines of small print, one for each picture.
pub fn pictures(chain: &Chain, notes: [&str; 2]) -> [Picture; 2] {
    let Simulation { trace, ramp, critical, .. } = &chain.simulation;
    let shown = QuantityFormat::new("m/s", ramp.top());
    let [commands, velocities] = [COMMAND, VELOCITY].map(|name| trace.values(name).unwrap_or_default());
    let axis = |name: &str, values: &[f64], divisions| {
        let scaled = values.iter().map(|value| shown.value(*value));
        (Axis::fit_tight(name, &shown.unit, scaled, divisions), shown.clone())
    };
    let plane = ProfilePlane {
        command_axis: axis(COMMAND, &commands, Axis::HORIZONTAL_DIVISIONS),
        velocity_axis: axis(VELOCITY, &velocities, Axis::VERTICAL_DIVISIONS),
    };
    let points: Vec<_> = commands.into_iter().zip(velocities).collect();
    let (rising, falling) = points.split_at(trace.time.partition_point(|time| *time <= ramp.turn));
    let picture = |title: String, points: &[(f64, f64)], marks, note: &str| {
        let line = plane.line(VELOCITY, points.iter().copied());
        plane.picture(title, vec![line], marks, Some(note.to_owned()))
    };
    let end = if chain.simulation.is_ringing_only() { "ringing ends at" } else { "oscillation ends at" };
    let ends = title("rises", end, critical.rising, &shown);
    let begins = title("falls", "oscillation begins at", critical.falling, &shown);
    [
        picture(ends, rising, marks(critical.rising, &equations(chain)), notes[0]),
        picture(begins, falling, marks(critical.falling, &[]), notes[1]),
    ]
}

/// A title such as "System velocity profile: the command rises, oscillation ends at 4.54 mm/s".
fn title(way: &str, event: &str, read: Result<f64, NoCriticalVelocity>, shown: &QuantityFormat) -> String {
    let result = match read {
        Ok(velocity) => format!("{event} {}", shown.text(velocity)),
        Err(error) => error.message_in("m/s"),
    };
    format!("System velocity profile: the command {way}, {result}")
}

/// The marks of a picture in m/s: the velocity read from the run, then those of the equations that give one.
fn marks(read: Result<f64, NoCriticalVelocity>, equations: &[(&str, &Prediction)]) -> Vec<(f64, String)> {
    let run = read.into_iter().map(|velocity| (velocity, "run"));
    let others = equations.iter().filter_map(|(label, predicted)| Some((*predicted.as_ref().ok()?, *label)));
    run.chain(others).map(|(at, label)| (at, label.to_owned())).collect()
}

/// The labels and critical velocities of the equations that are marked.
fn equations(chain: &Chain) -> [(&'static str, &Prediction); 2] {
    [("eq 93-9", &chain.predictions.printed), ("Routh-Hurwitz", &chain.predictions.stability)]
}
