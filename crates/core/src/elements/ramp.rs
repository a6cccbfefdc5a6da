//! Drive: a ramp that may turn back.

use super::{Kind, Measure, Setting};
use crate::ir::{Builder, Guard, Register, Transition};

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

fn output_law(builder: &mut dyn Builder) -> Register {
    let (start, rate, time) = (builder.get("start"), builder.get("rate"), builder.time());
    let run = match builder.optional("turn") {
        None => time,
        Some(turn) => turned(builder, time, turn),
    };
    let change = builder.multiply(rate, run);
    builder.add(start, change)
}

const FORTH: f64 = 0.0;
const BACK: f64 = 1.0;

/// Time up to the turn, and as much less after it. The corner is a change of mode, so that no step of the
/// solver reaches across it.
fn turned(builder: &mut dyn Builder, time: Register, turn: Register) -> Register {
    let (since, until) = (builder.subtract(time, turn), builder.subtract(turn, time));
    let way = builder.new_mode(FORTH);
    builder.transition(way, Transition::new(FORTH, BACK, Guard::reached(since)));
    builder.transition(way, Transition::new(BACK, FORTH, Guard::passed(until)));
    let (back, half) = (builder.add(turn, until), builder.constant(0.5));
    builder.select(way.value, half, back, time)
}
