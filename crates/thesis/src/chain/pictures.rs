//! Pictures of the velocity profile with markers at the critical velocities.

use super::Chain;
use super::predictions::Prediction;
use super::simulation::{COMMAND, Simulation, VELOCITY};
use patchcord_analysis::format::QuantityFormat;
use patchcord_analysis::instruments::CriticalVelocityError;
use patchcord_draw::ProfilePlane;
use patchcord_draw::plot::{Axis, Picture};

/// Two pictures of output velocity against command: the first while the command rises, the second while it falls.
///
/// Both have a marker at the critical velocity that was read from the run. The first also has markers at those of the
/// equations. `notes` are the lines of small print, one for each picture.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::chain::{Chain, Inputs, Settings, pictures};
/// use patchcord_thesis::slideway::units::{KGF, POISE};
///
/// let inputs = Inputs::of_thesis(0.34 * POISE, 450.0 * KGF, 20e6);
/// let chain = Chain::new(&inputs, &Settings::default())?;
/// let [rising, falling] = pictures(&chain, ["", ""]);
/// assert!(rising.title.contains("the command rises, oscillation ends at"), "{}", rising.title);
/// assert!(falling.title.contains("the command falls, oscillation begins at"), "{}", falling.title);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
    let picture = |title: String, points: &[(f64, f64)], markers, note: &str| {
        let line = plane.line(VELOCITY, points.iter().copied());
        plane.picture(title, vec![line], markers, Some(note))
    };
    let end = if chain.simulation.is_ringing_only() { "ringing ends at" } else { "oscillation ends at" };
    let ends = title("rises", end, critical.rising, &shown);
    let begins = title("falls", "oscillation begins at", critical.falling, &shown);
    [
        picture(ends, rising, markers(critical.rising, &equations(chain)), notes[0]),
        picture(begins, falling, markers(critical.falling, &[]), notes[1]),
    ]
}

/// A title such as "System velocity profile: the command rises, oscillation ends at 4.54 mm/s".
fn title(
    direction: &str,
    event: &str,
    read: Result<f64, CriticalVelocityError>,
    shown: &QuantityFormat,
) -> String {
    let result = match read {
        Ok(velocity) => format!("{event} {}", shown.text(velocity)),
        Err(error) => error.message_in("m/s"),
    };
    format!("System velocity profile: the command {direction}, {result}")
}

/// The markers of a picture in m/s: the velocity read from the run, then those of the equations that give one.
fn markers(
    read: Result<f64, CriticalVelocityError>,
    equations: &[(&str, &Prediction)],
) -> Vec<(f64, String)> {
    let run = read.into_iter().map(|velocity| (velocity, "run"));
    let others = equations.iter().filter_map(|(label, predicted)| Some((*predicted.as_ref().ok()?, *label)));
    run.chain(others).map(|(at, label)| (at, label.to_owned())).collect()
}

/// The labels and critical velocities of the equations that have a marker.
fn equations(chain: &Chain) -> [(&'static str, &Prediction); 2] {
    [("eq 93-9", &chain.predictions.printed), ("Routh-Hurwitz", &chain.predictions.stability)]
}
