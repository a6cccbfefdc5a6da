//! Drive: a ramp that may turn back.

use crate::program::{Guard, Lowering, Register, Transition};

use super::{Kind, Measure, Setting};

pub(super) static KIND: Kind = Kind {
    name: "ramp",
    summary: "a ramp from a start value, which may turn back at a given time",
    law: "out = start + rate t for t <= turn, start + rate (2 turn - t) after it",
    source: "thesis 8.2 (velocity ramp of 1.2 mm/s2)",
    symbol: "drive-ramp",
    settings: &[
        Setting::preset("start", Measure::Signal, 0.0, "value at t = 0"),
        Setting::required("rate", Measure::SignalRate, "change per second up to the turn"),
        Setting::optional(
            "turn",
            Measure::Seconds,
            "time at which it turns back with the same rate (absent: never)",
        ),
    ],
    output_law,
    ..Kind::DRIVE
};

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let (start, rate, time) = (lowering.get("start"), lowering.get("rate"), lowering.time());
    let run = match lowering.optional("turn") {
        None => time,
        Some(turn) => turned(lowering, time, turn),
    };
    let change = lowering.multiply(rate, run);
    lowering.add(start, change)
}

const FORTH: f64 = 0.0;
const BACK: f64 = 1.0;

/// Time up to the turn, and as much less after it. The corner is a change of mode, so that no step of the
/// solver reaches across it.
fn turned(lowering: &mut Lowering<'_>, time: Register, turn: Register) -> Register {
    let (since, until) = (lowering.subtract(time, turn), lowering.subtract(turn, time));
    let way = lowering.new_mode(FORTH);
    lowering.transition(way, Transition::new(FORTH, BACK, Guard::reached(since)));
    lowering.transition(way, Transition::new(BACK, FORTH, Guard::passed(until)));
    let (back, half) = (lowering.add(turn, until), lowering.constant(0.5));
    lowering.select(way.value, half, back, time)
}
