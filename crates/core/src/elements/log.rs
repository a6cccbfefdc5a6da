//! Logarithm of a voltage.

use super::{Input, Kind, Measure, Setting, Takes};
use crate::ir::{Builder, Register};
use crate::machines::{Part, REFERENCE};
use patchcord_expr::Function;

pub(super) static KIND: Kind = Kind {
    name: "log",
    summary: "fixed function generator: the logarithm of its input to base 10",
    law: "out = per_decade x log10(max(in, least) / reference): at and below least it gives the value at least",
    source: "logarithmic function generators of the general-purpose machines",
    symbol: "log",
    inputs: &[Input::jack("in", "what the logarithm is taken of")],
    settings: &[
        LEVEL,
        PER_DECADE,
        Setting::preset(
            "least",
            Measure::Volts,
            1e-3,
            "input at and below which the output stays the same; 10 mV keeps it from overload at 0 V",
        )
        .within(SMALLEST, REFERENCE),
    ],
    parts: &[Takes::always(Part::FunctionGenerator, 1)],
    output_law,
    ..Kind::AMPLIFIER
};

/// The smallest voltage, in volts, that a logarithm is taken of.
const SMALLEST: f64 = 1e-6;

/// What logarithm and exponential have in common.
pub(super) const LEVEL: Setting =
    Setting::preset("reference", Measure::Volts, 1.0, "voltage whose logarithm is 0")
        .within(SMALLEST, REFERENCE);
pub(super) const PER_DECADE: Setting =
    Setting::preset("per_decade", Measure::Volts, 50.0, "volts that stand for a factor of 10")
        .within(1.0, REFERENCE);

fn output_law(builder: &mut dyn Builder) -> Register {
    let (input, least) = (builder.input("in"), builder.get("least"));
    let kept = builder.maximum(input, least);
    let level = builder.get("reference");
    let ratio = builder.divide(kept, level);
    let decades = builder.call(Function::Log10, ratio);
    let per_decade = builder.get("per_decade");
    builder.multiply(per_decade, decades)
}
