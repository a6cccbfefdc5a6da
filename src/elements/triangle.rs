//! Drive: a triangular wave.

use crate::program::{Lowering, Register};

use super::{Default, Family, Kind, Measure, Output, Setting};

pub(super) static KIND: Kind = Kind {
    name: "triangle",
    family: Family::Drive,
    summary: "a triangular wave about an offset, starting upward from it",
    law: "out = offset + amplitude x tri(frequency t), tri rising from 0 to 1, falling to -1, back to 0 in one period",
    overload: "its output amplifier stops at ±100 V; the lamp lights when more is asked for",
    modes: "stands at its value of t = 0 in initial condition; its time stops in hold",
    source: "function generator of the period",
    symbol: "drive-triangle",
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

// With s = frequency t + 1/4 and its fraction p: tri = 1 - |4 p - 2|, which is 0 and rising at t = 0.
fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let (time, frequency) = (lowering.time(), lowering.get("frequency"));
    let periods = lowering.multiply(frequency, time);
    let [quarter, one, two, four] = [0.25, 1.0, 2.0, 4.0].map(|number| lowering.constant(number));
    let shifted = lowering.add(periods, quarter);
    let whole = lowering.floor(shifted);
    let fraction = lowering.subtract(shifted, whole);
    let quadrupled = lowering.multiply(four, fraction);
    let centred = lowering.subtract(quadrupled, two);
    let distance = lowering.absolute(centred);
    let wave = lowering.subtract(one, distance);
    let (amplitude, offset) = (lowering.get("amplitude"), lowering.get("offset"));
    let swing = lowering.multiply(amplitude, wave);
    lowering.add(offset, swing)
}
