//! Drive: a square wave.
//!
//! The edges are known before the run, so the solver ends a step at each of them.

use super::{Kind, Setting, SettingQuantity};
use crate::ir::{Builder, Register};

/// The row of the square wave. Amplitude and offset are in the unit of the drive's scale.
pub(super) static KIND: Kind = Kind {
    name: "square",
    summary: "a square wave about an offset, with a high part of any width",
    law: "out = offset + amplitude while the fraction of frequency t + phase / (2 pi) is below duty, offset - \
          amplitude otherwise; at an edge, the value after it",
    source: "function generator of the period",
    symbol: "drive-square",
    settings: &[
        Setting::required("amplitude", SettingQuantity::Signal, "amplitude about the offset"),
        Setting::required(
            "frequency",
            SettingQuantity::Hertz,
            "periods per second; a step ends at each edge",
        )
        .within(1e-9, 1e9),
        Setting::preset("duty", SettingQuantity::Ratio, 0.5, "share of a period during which it is high")
            .within(0.0, 1.0),
        Setting::preset("phase", SettingQuantity::Radians, 0.0, "phase at t = 0; it rises at the phase 0"),
        Setting::preset("offset", SettingQuantity::Signal, 0.0, "middle between the two values"),
    ],
    output_law,
    ..Kind::DRIVE
};

/// out = offset + amplitude x (2 w - 1), in volts; the wave w is 1 while high and 0 while low.
fn output_law(builder: &mut dyn Builder) -> Register {
    let wave = builder.pulse_wave("frequency", "duty", "phase");
    let (one, two) = (builder.constant(1.0), builder.constant(2.0));
    let doubled = builder.multiply(two, wave);
    let sign = builder.subtract(doubled, one);
    let (amplitude, offset) = (builder.get("amplitude"), builder.get("offset"));
    let swing = builder.multiply(amplitude, sign);
    builder.add(offset, swing)
}
