//! Drive: a step.

use crate::program::{Guard, Lowering, Register, Transition};

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

const BEFORE: f64 = 0.0;
const AFTER: f64 = 1.0;

// The jump is a change of mode, so that no step of the solver reaches across it.
fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let (time, at) = (lowering.time(), lowering.get("at"));
    let (height, zero, half) = (lowering.get("height"), lowering.constant(0.0), lowering.constant(0.5));
    let position = lowering.new_mode(BEFORE);
    let (since, until) = (lowering.subtract(time, at), lowering.subtract(at, time));
    lowering.transition(position, Transition::new(BEFORE, AFTER, Guard::reached(since)));
    lowering.transition(position, Transition::new(AFTER, BEFORE, Guard::passed(until)));
    lowering.select(position.value, half, height, zero)
}
