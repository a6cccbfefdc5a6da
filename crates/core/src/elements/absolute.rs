//! Absolute value: a full-wave precision rectifier.
//!
//! The corner at 0 V is a kink: if a rate depends on the output, the solver ends a step there.

use super::{Input, Kind, PartUse};
use crate::ir::{Builder, Register};
use crate::machines::Part;

/// One amplifier with two diodes passes one half of the wave, and the other adds the halves with the same sign.
pub(super) static KIND: Kind = Kind {
    name: "absolute",
    summary: "absolute value: a full-wave precision rectifier without the drop of its diodes",
    law: "out = |in|",
    source: "precision rectifier of the general-purpose machines",
    symbol: "absolute",
    inputs: &[Input::jack("in", "input voltage")],
    parts: &[PartUse::always(Part::Summer, 2), PartUse::always(Part::DiodePair, 1)],
    output_law,
    ..Kind::AMPLIFIER
};

/// out = |in|, in volts. The lowering limits it to ±100 V, as for every amplifier.
fn output_law(builder: &mut dyn Builder) -> Register {
    let input = builder.input("in");
    builder.absolute(input)
}
