//! Drive: a sine wave.
//!
//! The phase advances with problem time, so the frequency is in cycles per problem second.

use std::f64::consts::TAU;

use super::{Kind, Setting, SettingQuantity};
use crate::ir::{Builder, Register};
use patchcord_expr::Function;

/// The row of the sine wave. Amplitude and offset are in the unit of the drive's scale.
pub(super) static KIND: Kind = Kind {
    name: "sine",
    summary: "a sine wave about an offset",
    law: "out = offset + amplitude x sin(2 pi frequency t + phase)",
    source: "oscillator of the period; thesis 8.3 (10 V on -50 V at 1/Tc)",
    symbol: "drive-sine",
    settings: &[
        Setting::required("amplitude", SettingQuantity::Signal, "amplitude about the offset"),
        Setting::required("frequency", SettingQuantity::Hertz, "periods per second"),
        Setting::preset("phase", SettingQuantity::Radians, 0.0, "phase at t = 0"),
        Setting::preset("offset", SettingQuantity::Signal, 0.0, "mean value"),
    ],
    output_law,
    ..Kind::DRIVE
};

/// out = offset + amplitude x sin(2 pi frequency t + phase), in volts; t is in problem seconds.
///
/// The lowering has converted amplitude and offset from the unit of the scale to volts.
fn output_law(builder: &mut dyn Builder) -> Register {
    let (time, frequency) = (builder.time(), builder.get("frequency"));
    let periods = builder.multiply(frequency, time);
    sine_of(builder, periods)
}

/// offset + amplitude x sin(2 pi cycles + phase), in volts. The cycles are a number of periods since t = 0.
pub(super) fn sine_of(builder: &mut dyn Builder, cycles: Register) -> Register {
    let turn = builder.constant(TAU);
    let turned = builder.multiply(turn, cycles);
    let phase = builder.get("phase");
    let angle = builder.add(turned, phase);
    let wave = builder.call(Function::Sin, angle);
    let (amplitude, offset) = (builder.get("amplitude"), builder.get("offset"));
    let swing = builder.multiply(amplitude, wave);
    builder.add(offset, swing)
}
