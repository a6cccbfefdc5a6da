//! Drive: a ramp that may turn back.

use crate::program::{Lowering, Register};

use super::{Default, Family, Kind, Measure, Output, Setting};

pub(super) static KIND: Kind = Kind {
    name: "ramp",
    family: Family::Drive,
    summary: "a ramp from a start value, which may turn back at a given time",
    law: "out = start + rate t for t <= turn, start + rate (2 turn - t) after it",
    overload: "its output amplifier stops at ±100 V; the lamp lights when more is asked for",
    modes: "stands at its value of t = 0 in initial condition; its time stops in hold",
    source: "thesis 8.2 (velocity ramp of 1.2 mm/s2)",
    symbol: "drive-ramp",
    inputs: &[],
    settings: &[
        Setting {
            name: "start",
            measure: Measure::Signal,
            default: Default::Number(0.0),
            range: (f64::MIN, f64::MAX),
            description: "value at t = 0",
        },
        Setting {
            name: "rate",
            measure: Measure::SignalRate,
            default: Default::Required,
            range: (f64::MIN, f64::MAX),
            description: "change per second up to the turn",
        },
        Setting {
            name: "turn",
            measure: Measure::Seconds,
            default: Default::Absent,
            range: (0.0, f64::MAX),
            description: "time at which the ramp turns back with the same rate (absent: never)",
        },
    ],
    ordered: &[],
    parts: &[],
    output: Output::Amplifier,
    output_law,
    memory_law: None,
};

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let (start, rate, time) = (lowering.get("start"), lowering.get("rate"), lowering.time());
    let run = match lowering.set("turn") {
        None => time,
        Some(turn) => turned(lowering, time, turn),
    };
    let change = lowering.multiply(rate, run);
    lowering.add(start, change)
}

/// Time up to the turn, and as much less after it.
fn turned(lowering: &mut Lowering<'_>, time: Register, turn: Register) -> Register {
    let twice = lowering.add(turn, turn);
    let back = lowering.subtract(twice, time);
    lowering.minimum(time, back)
}
