//! Inverting amplifier.

use crate::machines::Part;
use crate::program::{Lowering, Register};

use super::{Input, Kind, Takes, Transfer};

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

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let input = lowering.input("in");
    lowering.negate(input)
}
