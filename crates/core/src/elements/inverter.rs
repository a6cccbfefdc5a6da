//! Inverting amplifier.
//!
//! It is a summer with one input of gain 1 and without a limiter, which patches often need.

use super::{Input, Kind, PartUse, Transfer};
use crate::ir::{Builder, Register};
use crate::machines::Part;

/// The row of the inverter. It uses a summing amplifier of the machine.
pub(super) static KIND: Kind = Kind {
    name: "inverter",
    summary: "inverting amplifier: changes the sign of its input",
    law: "out = -in",
    source: "thesis 8.1 (summing amplifier with one input of gain 1)",
    symbol: "amplifier",
    inputs: &[Input::jack("in", "input voltage")],
    parts: &[PartUse::always(Part::Summer, 1)],
    transfer: Transfer::Inverting,
    output_law,
    ..Kind::AMPLIFIER
};

/// out = -in, in volts.
fn output_law(builder: &mut dyn Builder) -> Register {
    let input = builder.input("in");
    builder.negate(input)
}
