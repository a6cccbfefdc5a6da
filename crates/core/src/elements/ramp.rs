//! Drive: a ramp that may reverse.

use super::{Kind, Setting, SettingQuantity};
use crate::ir::{Builder, Guard, ModeNames, Register, Transition};

/// The row of the ramp. Without `turn` it has no mode and no corner.
pub(super) static KIND: Kind = Kind {
    name: "ramp",
    summary: "a ramp from a start value, which may reverse at a given time",
    law: "out = start + rate t for t <= turn, start + rate (2 turn - t) after it",
    source: "thesis 8.2 (velocity ramp of 1.2 mm/s2)",
    symbol: "drive-ramp",
    settings: &[
        Setting::preset("start", SettingQuantity::Signal, 0.0, "value at t = 0"),
        Setting::required("rate", SettingQuantity::SignalRate, "change per second until the reversal"),
        Setting::optional(
            "turn",
            SettingQuantity::Seconds,
            "time at which the rate changes its sign (absent: never)",
        ),
    ],
    output_law,
    ..Kind::DRIVE
};

/// out = start + rate x run, with `run` the time t, mirrored at `turn` if that is set. Times are in problem seconds.
fn output_law(builder: &mut dyn Builder) -> Register {
    let (start, rate, time) = (builder.get("start"), builder.get("rate"), builder.time());
    let run = match builder.optional("turn") {
        None => time,
        Some(turn) => turned(builder, time, turn),
    };
    let change = builder.multiply(rate, run);
    builder.add(start, change)
}

/// Mode before the turn.
const FORTH: f64 = 0.0;
/// Mode after the turn.
const BACK: f64 = 1.0;

/// The mode of a ramp that reverses.
const DIRECTION: ModeNames = ModeNames { mode: "direction", values: &[(FORTH, "forth"), (BACK, "back")] };

/// The time t until the turn, and 2 turn - t after it. The corner is a change of mode, so no step of the solver reaches
/// across it.
fn turned(builder: &mut dyn Builder, time: Register, turn: Register) -> Register {
    let (since, until) = (builder.subtract(time, turn), builder.subtract(turn, time));
    let direction = builder.new_mode(DIRECTION, FORTH);
    builder.transition(direction, Transition::new(FORTH, BACK, Guard::reached(since)));
    builder.transition(direction, Transition::new(BACK, FORTH, Guard::passed(until)));
    let (back, half) = (builder.add(turn, until), builder.constant(0.5));
    builder.select(direction.value, half, back, time)
}
