//! Cosine of a voltage.

use super::Kind;
use super::sin::{self, INPUTS, OVERLOAD, PARTS, SETTINGS};
use crate::ir::{Builder, Register};
use patchcord_expr::Function;

pub(super) static KIND: Kind = Kind {
    name: "cos",
    summary: "fixed function generator: the cosine of its input",
    law: "out = amplitude x cos(angle_per_volt x in); as preset 100 V stand for 180 degrees",
    overload: OVERLOAD,
    source: "sine-cosine function generators of the general-purpose machines",
    symbol: "cos",
    inputs: INPUTS,
    settings: SETTINGS,
    parts: PARTS,
    output_law,
    ..Kind::AMPLIFIER
};

fn output_law(builder: &mut dyn Builder) -> Register {
    sin::wave(builder, Function::Cos)
}
