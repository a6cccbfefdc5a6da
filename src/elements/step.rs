//! Drive: a step.

use crate::program::{Lowering, Register};

use super::{Default, Family, Kind, Measure, Output, Setting};

pub(super) static KIND: Kind = Kind {
    name: "step",
    family: Family::Drive,
    summary: "a step: nothing before its time, its height from then on",
    law: "out = 0 for t < at, height for t >= at",
    overload: "its output amplifier stops at ±100 V; the lamp lights when more is asked for",
    modes: "stands at its value of t = 0 in initial condition; its time stops in hold",
    source: "thesis 8.2 (step of 0.127 mm)",
    symbol: "drive-step",
    inputs: &[],
    settings: &[
        Setting {
            name: "height",
            measure: Measure::Signal,
            default: Default::Required,
            range: (f64::MIN, f64::MAX),
            description: "value after the step",
        },
        Setting {
            name: "at",
            measure: Measure::Seconds,
            default: Default::Number(0.0),
            range: (0.0, f64::MAX),
            description: "time of the step",
        },
    ],
    ordered: &[],
    parts: &[],
    output: Output::Amplifier,
    output_law,
    memory_law: None,
};

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let (time, at) = (lowering.time(), lowering.get("at"));
    let (height, zero) = (lowering.get("height"), lowering.constant(0.0));
    lowering.select(time, at, height, zero)
}
