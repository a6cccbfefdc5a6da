//! Exponential of a voltage.
//!
//! With equal settings it is the inverse of `log`, for inputs above the smallest argument of the logarithm.

use super::log::{LEVEL, PER_DECADE};
use super::{Input, Kind, PartUse};
use crate::ir::{Builder, Register};
use crate::machines::Part;
use patchcord_expr::Function;

/// The row of the exponential. An input of 0 V gives `reference`.
pub(super) static KIND: Kind = Kind {
    name: "exp",
    summary: "fixed function generator: a power of 10, the inverse of log",
    law: "out = reference x 10^(in / per_decade)",
    source: "logarithmic function generators of the general-purpose machines, patched as their inverse",
    symbol: "exp",
    inputs: &[Input::jack("in", "exponent")],
    settings: &[LEVEL, PER_DECADE],
    parts: &[PartUse::always(Part::FunctionGenerator, 1)],
    output_law,
    ..Kind::AMPLIFIER
};

/// out = reference x 10^(in / per_decade), in volts. With the defaults, 50 V give 10 V and 100 V give 100 V.
fn output_law(builder: &mut dyn Builder) -> Register {
    let (input, per_decade) = (builder.input("in"), builder.get("per_decade"));
    let decades = builder.divide(input, per_decade);
    let ratio = builder.call(Function::Exp10, decades);
    let level = builder.get("reference");
    builder.multiply(level, ratio)
}
