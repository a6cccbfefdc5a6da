//! Amplifier without feedback of its own: what is patched back to it decides what it computes.

use super::{Input, Kind, Measure, Output, Setting, Takes};
use crate::ir::{Builder, Register};
use crate::machines::Part;

pub(super) static KIND: Kind = Kind {
    name: "open-amplifier",
    summary: "amplifier without feedback of its own: divides, takes roots, inverts functions by what is patched back to it",
    law: "out = -amplification x (sum of gain x input); with something that rises with out plugged back into it, \
          out is where the sum is -out / amplification: nearly 0. What is fed back has to rise with out: a divisor has \
          to be above 0. The error at the sum, out / amplification, counts for more where little is fed back: of a quotient it is the \
          share 100 V / (d x amplification)",
    overload: "stops at ±100 V; the lamp lights when more is asked for, as where there is no such voltage (a divisor \
               of 0, the root of a negative number)",
    source: "operational amplifier with its own feedback resistor pulled out; division: out = -100 V x n / d from \
             inputs n and out x d / 100 V",
    symbol: "open-amplifier",
    inputs: &[Input::gains("x", "summing inputs, the gain in the name; one of them carries the feedback")],
    settings: &[Setting::preset(
        "amplification",
        Measure::Ratio,
        1e6,
        "gain of the amplifier itself: chopper-stabilised valve amplifiers had 1e5 ... 1e8 for slow signals",
    )
    .within(1e2, 1e9)],
    parts: &[Takes::always(Part::Summer, 1)],
    output: Output::OpenAmplifier,
    output_law,
    ..Kind::AMPLIFIER
};

fn output_law(builder: &mut dyn Builder) -> Register {
    let (sum, amplification) = (builder.sum("x"), builder.get("amplification"));
    let amplified = builder.multiply(amplification, sum);
    builder.negate(amplified)
}
