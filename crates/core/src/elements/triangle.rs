//! Drive: a triangular wave.

use super::{Kind, Setting, SettingQuantity};
use crate::ir::{Builder, Guard, ModeNames, Register, Transition};

/// The row of the triangular wave. Amplitude and offset are in the unit of the drive's scale.
pub(super) static KIND: Kind = Kind {
    name: "triangle",
    summary: "a triangular wave about an offset, rising at t = 0",
    law: "out = offset + amplitude x tri(frequency t), with tri rising from 0 to 1, falling to -1 and back to 0 in \
          one period",
    source: "function generator of the period",
    symbol: "drive-triangle",
    settings: &[
        Setting::required("amplitude", SettingQuantity::Signal, "amplitude about the offset"),
        Setting::required("frequency", SettingQuantity::Hertz, "periods per second"),
        Setting::preset("offset", SettingQuantity::Signal, 0.0, "mean value"),
    ],
    output_law,
    ..Kind::DRIVE
};

/// Mode on the rising flank.
const RISING: f64 = 0.0;
/// Mode on the falling flank.
const FALLING: f64 = 1.0;

/// The mode of the wave.
const SLOPE: ModeNames = ModeNames { mode: "slope", values: &[(RISING, "rising"), (FALLING, "falling")] };

/// out = offset + amplitude x tri, in volts. The frequency is in periods per problem second.
///
/// tri = 1 - |4 p - 2|, where p is the fractional part of frequency t + 1/4. The corners are changes of mode, so no
/// step of the solver reaches across them.
fn output_law(builder: &mut dyn Builder) -> Register {
    let (time, frequency) = (builder.time(), builder.get("frequency"));
    let periods = builder.multiply(frequency, time);
    let [quarter, one, two, four] = [0.25, 1.0, 2.0, 4.0].map(|number| builder.constant(number));
    let shifted = builder.add(periods, quarter);
    let whole = builder.floor(shifted);
    let fraction = builder.subtract(shifted, whole);
    let quadrupled = builder.multiply(four, fraction);
    let centred = builder.subtract(quadrupled, two);
    let distance = builder.absolute(centred);
    let before = builder.negate(centred);
    let direction = builder.new_mode(SLOPE, RISING);
    builder.transition(direction, Transition::new(RISING, FALLING, Guard::reached(centred)));
    builder.transition(direction, Transition::new(FALLING, RISING, Guard::passed(before)));
    let wave = builder.subtract(one, distance);
    let (amplitude, offset) = (builder.get("amplitude"), builder.get("offset"));
    let swing = builder.multiply(amplitude, wave);
    builder.add(offset, swing)
}
