//! Cosine of a voltage.
//!
//! Settings, input and parts are those of the sine, which has the law of both.

use super::Kind;
use super::sin::{self, INPUTS, OVERLOAD, PARTS, SETTINGS};
use crate::ir::{Builder, Register};
use patchcord_expr::Function;

/// The row of the cosine. An angle of 0 V gives the amplitude.
pub(super) static KIND: Kind = Kind {
    name: "cos",
    summary: "fixed function generator: the cosine of its input",
    law: "out = amplitude x cos(angle_per_volt x in); by default 100 V correspond to 180 degrees",
    overload: OVERLOAD,
    source: "sine-cosine function generators of the general-purpose machines",
    symbol: "cos",
    inputs: INPUTS,
    settings: SETTINGS,
    parts: PARTS,
    output_law,
    ..Kind::AMPLIFIER
};

/// out = amplitude x cos(angle_per_volt x in), in volts. The argument is in radians.
fn output_law(builder: &mut dyn Builder) -> Register {
    sin::wave(builder, Function::Cos)
}
