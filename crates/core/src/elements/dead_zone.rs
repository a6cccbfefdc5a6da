//! Ideal dead zone: amplifiers with diodes in their feedback.

use super::{Input, Kind, Measure, Setting, Takes};
use crate::ir::{Builder, Register};
use crate::machines::Part;

pub(super) static KIND: Kind = Kind {
    name: "dead-zone",
    summary: "ideal dead zone: nothing between two voltages, straight on from 0 V beyond them",
    law: "out = slope x (in - upper) for in > upper, slope x (in - lower) for in < lower, 0 between",
    source: "two biased precision rectifiers and a summer, of the general-purpose machines",
    symbol: "dead-zone",
    inputs: &[Input::jack("in", "signal")],
    settings: &[
        Setting::required("lower", Measure::Volts, "input below which it gives a voltage"),
        Setting::required("upper", Measure::Volts, "input above which it gives a voltage"),
        Setting::preset("slope", Measure::Ratio, 1.0, "slope on either side of the zone")
            .within(0.0, f64::MAX),
    ],
    ordered: &[("lower", "upper")],
    parts: &[
        Takes::always(Part::Summer, 3),
        Takes::always(Part::DiodePair, 2),
        Takes::always(Part::FixedPot, 2),
    ],
    output_law,
    ..Kind::AMPLIFIER
};

fn output_law(builder: &mut dyn Builder) -> Register {
    let (input, zero) = (builder.input("in"), builder.constant(0.0));
    let (lower, upper) = (builder.get("lower"), builder.get("upper"));
    let (above, below) = (builder.subtract(input, upper), builder.subtract(input, lower));
    let (positive, negative) = (builder.maximum(above, zero), builder.minimum(below, zero));
    let beyond = builder.add(positive, negative);
    let slope = builder.get("slope");
    builder.multiply(slope, beyond)
}
