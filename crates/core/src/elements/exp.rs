//! Exponential of a voltage.

use super::log::{LEVEL, PER_DECADE};
use super::{Input, Kind, Takes};
use crate::ir::{Builder, Register};
use crate::machines::Part;
use patchcord_expr::Function;

pub(super) static KIND: Kind = Kind {
    name: "exp",
    summary: "fixed function generator: the power of 10 that its input says, the inverse of log",
    law: "out = reference x 10^(in / per_decade)",
    source: "logarithmic function generators of the general-purpose machines, patched as inverse",
    symbol: "exp",
    inputs: &[Input::jack("in", "the exponent")],
    settings: &[LEVEL, PER_DECADE],
    parts: &[Takes::always(Part::FunctionGenerator, 1)],
    output_law,
    ..Kind::AMPLIFIER
};

fn output_law(builder: &mut dyn Builder) -> Register {
    let (input, per_decade) = (builder.input("in"), builder.get("per_decade"));
    let decades = builder.divide(input, per_decade);
    let ratio = builder.call(Function::Exp10, decades);
    let level = builder.get("reference");
    builder.multiply(level, ratio)
}
