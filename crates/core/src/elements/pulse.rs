//! Drive: a rectangular pulse, once or repeated.
//!
//! The edges are known before the run, so the solver ends a step at each of them.

use super::{Kind, Setting, SettingQuantity};
use crate::ir::{Builder, Register};

/// The row of the pulse. The height is in the unit of the drive's scale.
pub(super) static KIND: Kind = Kind {
    name: "pulse",
    summary: "a rectangular pulse: 0, its height for a given time, and 0 again; once or repeated",
    law: "out = height for begin <= t < begin + width, and with a period also for begin + k period <= t < begin + k \
          period + width, k = 1, 2, ...; 0 otherwise",
    source: "pulse generators of the period",
    symbol: "drive-pulse",
    settings: &[
        Setting::required("height", SettingQuantity::Signal, "value within a pulse"),
        Setting::preset("begin", SettingQuantity::Seconds, 0.0, "time at which the first pulse begins")
            .within(0.0, 1e9),
        Setting::required("width", SettingQuantity::Seconds, "length of a pulse; a step ends at each edge")
            .within(1e-9, 1e9),
        Setting::optional(
            "period",
            SettingQuantity::Seconds,
            "time from one rise to the next, above width (absent: one pulse)",
        )
        .within(1e-9, 1e9),
    ],
    ordered: &[("width", "period")],
    output_law,
    ..Kind::DRIVE
};

/// out = height x p, in volts; p is 1 within a pulse and 0 outside.
fn output_law(builder: &mut dyn Builder) -> Register {
    let pulse = builder.pulse_train("begin", "width", "period");
    let height = builder.get("height");
    builder.multiply(height, pulse)
}
