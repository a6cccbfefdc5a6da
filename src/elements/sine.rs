//! Drive: a sine wave.

use std::f64::consts::TAU;

use crate::patch::Function;
use crate::program::{Lowering, Register};

use super::{Default, Family, Kind, Measure, Output, Setting};

pub(super) static KIND: Kind = Kind {
    name: "sine",
    family: Family::Drive,
    summary: "a sine wave about an offset",
    law: "out = offset + amplitude x sin(2 pi frequency t + phase)",
    overload: "its output amplifier stops at ±100 V; the lamp lights when more is asked for",
    modes: "stands at its value of t = 0 in initial condition; its time stops in hold",
    source: "oscillator of the period; thesis 8.3 (10 V on -50 V at 1/Tc)",
    symbol: "drive-sine",
    inputs: &[],
    settings: &[
        Setting {
            name: "amplitude",
            measure: Measure::Signal,
            default: Default::Required,
            range: (f64::MIN, f64::MAX),
            description: "height above and below the offset",
        },
        Setting {
            name: "frequency",
            measure: Measure::Hertz,
            default: Default::Required,
            range: (0.0, f64::MAX),
            description: "periods per second",
        },
        Setting {
            name: "phase",
            measure: Measure::Radians,
            default: Default::Number(0.0),
            range: (f64::MIN, f64::MAX),
            description: "lead at t = 0",
        },
        Setting {
            name: "offset",
            measure: Measure::Signal,
            default: Default::Number(0.0),
            range: (f64::MIN, f64::MAX),
            description: "mean value",
        },
    ],
    ordered: &[],
    parts: &[],
    output: Output::Amplifier,
    output_law,
    memory_law: None,
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
