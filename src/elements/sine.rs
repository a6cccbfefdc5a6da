//! Drive: a sine wave.

use std::f64::consts::TAU;

use crate::patch::Function;
use crate::program::{Lowering, Register};

use super::{Kind, Measure, Setting};

pub(super) static KIND: Kind = Kind {
    name: "sine",
    summary: "a sine wave about an offset",
    law: "out = offset + amplitude x sin(2 pi frequency t + phase)",
    source: "oscillator of the period; thesis 8.3 (10 V on -50 V at 1/Tc)",
    symbol: "drive-sine",
    settings: &[
        Setting::required("amplitude", Measure::Signal, "height above and below the offset"),
        Setting::required("frequency", Measure::Hertz, "periods per second"),
        Setting::preset("phase", Measure::Radians, 0.0, "lead at t = 0"),
        Setting::preset("offset", Measure::Signal, 0.0, "mean value"),
    ],
    output_law,
    ..Kind::DRIVE
};

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let (time, frequency) = (lowering.time(), lowering.get("frequency"));
    let periods = lowering.multiply(frequency, time);
    let turn = lowering.constant(TAU);
    let turned = lowering.multiply(turn, periods);
    let phase = lowering.get("phase");
    let angle = lowering.add(turned, phase);
    let wave = lowering.call(Function::Sin, angle);
    let (amplitude, offset) = (lowering.get("amplitude"), lowering.get("offset"));
    let swing = lowering.multiply(amplitude, wave);
    lowering.add(offset, swing)
}
