//! Drive: a step.

use crate::program::{Lowering, Register};

use super::{Kind, Measure, Setting};

pub(super) static KIND: Kind = Kind {
    name: "step",
    summary: "a step: nothing before its time, its height from then on",
    law: "out = 0 for t < at, height for t >= at",
    source: "thesis 8.2 (step of 0.127 mm)",
    symbol: "drive-step",
    settings: &[
        Setting::required("height", Measure::Signal, "value after the step"),
        Setting::preset("at", Measure::Seconds, 0.0, "time of the step"),
    ],
    output_law,
    ..Kind::DRIVE
};

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let (time, at) = (lowering.time(), lowering.get("at"));
    let (height, zero) = (lowering.get("height"), lowering.constant(0.0));
    lowering.select(time, at, height, zero)
}
