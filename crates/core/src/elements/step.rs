//! Drive: a step.

use super::{Kind, Setting, SettingQuantity};
use crate::ir::{Builder, Guard, ModeNames, Register, Transition};

/// The row of the step. The height is in the unit of the drive's scale.
pub(super) static KIND: Kind = Kind {
    name: "step",
    summary: "a step: 0 before its time, its height from then on",
    law: "out = 0 for t < at, height for t >= at",
    source: "thesis 8.2 (step of 0.127 mm)",
    symbol: "drive-step",
    settings: &[
        Setting::required("height", SettingQuantity::Signal, "value after the step"),
        Setting::preset("at", SettingQuantity::Seconds, 0.0, "time of the step"),
    ],
    output_law,
    ..Kind::DRIVE
};

/// Mode before the step.
const BEFORE: f64 = 0.0;
/// Mode at the step and after it.
const AFTER: f64 = 1.0;

/// The mode of the step.
const POSITION: ModeNames =
    ModeNames { mode: "position", values: &[(BEFORE, "before the step"), (AFTER, "after the step")] };

/// out = 0 for t < at, height for t >= at; t is in problem seconds.
///
/// The jump is a change of mode, so no step of the solver reaches across it.
fn output_law(builder: &mut dyn Builder) -> Register {
    let (time, at) = (builder.time(), builder.get("at"));
    let (height, zero, half) = (builder.get("height"), builder.constant(0.0), builder.constant(0.5));
    let position = builder.new_mode(POSITION, BEFORE);
    let (since, until) = (builder.subtract(time, at), builder.subtract(at, time));
    builder.transition(position, Transition::new(BEFORE, AFTER, Guard::reached(since)));
    builder.transition(position, Transition::new(AFTER, BEFORE, Guard::passed(until)));
    builder.select(position.value, half, height, zero)
}
