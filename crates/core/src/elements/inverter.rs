//! Inverting amplifier.

use super::{Input, Kind, Takes, Transfer};
use crate::ir::{Builder, Register};
use crate::machines::Part;

pub(super) static KIND: Kind = Kind {
    name: "inverter",
    summary: "inverting amplifier: changes the sign of its one input",
    law: "out = -in",
    source: "thesis 8.1 (summing amplifier with one input of gain 1)",
    symbol: "amplifier",
    inputs: &[Input::jack("in", "what is inverted")],
    parts: &[Takes::always(Part::Summer, 1)],
    transfer: Transfer::Inverting,
    output_law,
    ..Kind::AMPLIFIER
};

fn output_law(builder: &mut dyn Builder) -> Register {
    let input = builder.input("in");
    builder.negate(input)
}
