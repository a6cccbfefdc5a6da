//! Reads the machine at the present instant: its state for an event, and its voltages for a frame.

use patchcord_core::solve::Overload;

use super::Session;
use super::bench::Probes;
use crate::command::Mode;
use crate::event::{MachineState, NullMeter, OverloadView};
use crate::frame::{self, FrameHeader};
use crate::view;

/// Voltage at the top of a pot in pot set, in volts.
const POT_SET_VOLTS: f64 = 100.0;

/// The overloads since the last initial condition, in the order in which the lamps lit.
pub(super) fn overloads(session: &mut Session) -> Vec<Overload> {
    session.bench.read(|machine| machine.overloads()).unwrap_or_default()
}

/// The state of the machine and of the clock. A meter whose output is missing from the patch is disconnected until the
/// output is there again.
pub(super) fn machine_state(session: &mut Session, overloads: Vec<Overload>) -> MachineState {
    let Session { bench, probes, meter, null_meter, .. } = session;
    let view = |overload: Overload| OverloadView {
        element: overload.element,
        time: overload.time,
        caused_by: overload.caused_by,
    };
    let (time, oldest, latest) = (bench.clock(), bench.oldest(), bench.latest());
    MachineState {
        mode: bench.controls.mode,
        time,
        speed: bench.controls.speed,
        paused: bench.controls.paused,
        sweep: bench.sweep(),
        rate: bench.controls.rate,
        overloads: overloads.into_iter().map(view).collect(),
        stopped: bench.stopped.clone(),
        oldest,
        latest,
        meter: connected(meter.as_deref(), probes),
        null_meter: NullMeter { output: connected(null_meter.output.as_deref(), probes), ..*null_meter },
    }
}

/// The output at a meter; `None` if the meter is free, or if the patch has no such output.
fn connected(output: Option<&str>, probes: &Probes) -> Option<String> {
    output.filter(|output| probes.element(output).is_some()).map(str::to_owned)
}

/// The present frame.
pub(super) fn frame(session: &mut Session, overloads: &[Overload]) -> Vec<u8> {
    let volts = voltages(session);
    let header = header(session, overloads, &volts);
    let is_lit = |element: &str| overloads.iter().any(|overload| overload.element == element);
    let lamps: Vec<bool> = session.probes.0.iter().map(|output| is_lit(&output.element)).collect();
    frame::encode(&header, &volts, &lamps, &mut session.scopes)
}

/// The voltages of all outputs; in pot set those at the wipers with the reference at the top of every pot. A voltage that
/// the machine does not have is not a number.
fn voltages(session: &mut Session) -> Vec<f64> {
    let Session { bench, probes, compiled, .. } = session;
    let outputs = probes.0.iter().map(|output| output.element.as_str());
    if bench.controls.mode == Mode::PotSet {
        let settings = compiled.as_ref().map(|compiled| view::pot_settings(&compiled.circuit));
        let settings = settings.unwrap_or_default();
        return outputs.map(|element| POT_SET_VOLTS * settings.get(element).unwrap_or(&0.0)).collect();
    }
    let count = outputs.len();
    let read =
        bench.read(|machine| outputs.map(|element| machine.voltage(element).unwrap_or(f64::NAN)).collect());
    read.unwrap_or_else(|| vec![f64::NAN; count])
}

/// The header of a frame with these voltages.
fn header(session: &mut Session, overloads: &[Overload], volts: &[f64]) -> FrameHeader {
    let Session { bench, document, probes, meter, null_meter, .. } = session;
    let outputs = &probes.0;
    let first_lamp = overloads
        .first()
        .and_then(|overload| outputs.iter().position(|output| output.element == overload.element));
    let at = |name: &String| outputs.iter().position(|output| output.name == *name).map(|index| volts[index]);
    let difference = |volts: f64| volts - POT_SET_VOLTS * null_meter.divider;
    FrameHeader {
        revision: document.revision() as u32,
        time: bench.clock(),
        factor: bench.factor,
        mode: bench.controls.mode as u8,
        moves: bench.is_moving(),
        paused: bench.controls.paused,
        stopped: bench.stopped.is_some(),
        first_lamp,
        repetitions: bench.repetitions,
        meter: meter.as_ref().and_then(at),
        null_meter: null_meter.output.as_ref().and_then(at).map(difference),
    }
}
