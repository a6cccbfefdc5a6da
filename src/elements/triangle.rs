//! Drive: a triangular wave.

use crate::program::{Guard, Lowering, Register, Transition};

use super::{Kind, Measure, Setting};

pub(super) static KIND: Kind = Kind {
    name: "triangle",
    summary: "a triangular wave about an offset, starting upward from it",
    law: "out = offset + amplitude x tri(frequency t), tri rising from 0 to 1, falling to -1, back to 0 in one period",
    source: "function generator of the period",
    symbol: "drive-triangle",
    settings: &[
        Setting::required("amplitude", Measure::Signal, "height above and below the offset"),
        Setting::required("frequency", Measure::Hertz, "periods per second"),
        Setting::preset("offset", Measure::Signal, 0.0, "mean value"),
    ],
    output_law,
    ..Kind::DRIVE
};

const RISING: f64 = 0.0;
const FALLING: f64 = 1.0;

// With s = frequency t + 1/4 and its fraction p: tri = 1 - |4 p - 2|, which is 0 and rising at t = 0. The
// corners are changes of mode, so that no step of the solver reaches across them.
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
    let before = lowering.negate(centred);
    let way = lowering.new_mode(RISING);
    lowering.transition(way, Transition::new(RISING, FALLING, Guard::reached(centred)));
    lowering.transition(way, Transition::new(FALLING, RISING, Guard::passed(before)));
    let wave = lowering.subtract(one, distance);
    let (amplitude, offset) = (lowering.get("amplitude"), lowering.get("offset"));
    let swing = lowering.multiply(amplitude, wave);
    lowering.add(offset, swing)
}
