//! Exponential of a voltage.

use crate::machines::Part;
use crate::patch::Function;
use crate::program::{Lowering, Register};

use super::log::{LEVEL, PER_DECADE};
use super::{Input, Kind, Takes};

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

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let (input, per_decade) = (lowering.input("in"), lowering.get("per_decade"));
    let decades = lowering.divide(input, per_decade);
    let ratio = lowering.call(Function::Exp10, decades);
    let level = lowering.get("reference");
    lowering.multiply(level, ratio)
}
