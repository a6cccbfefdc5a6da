//! A diode pair whose output is the higher of two voltages.
//!
//! The diode of the higher voltage conducts, and its drop makes the output lower than that voltage. Where the inputs
//! are equal, the output has a kink.

use super::{Input, Jacks, Kind, PartUse, Setting};
use crate::ir::{Builder, Register};
use crate::machines::Part;

/// The row of the diode pair. It has no amplifier, so no lamp can light.
pub(super) static KIND: Kind = Kind {
    name: "diode-upper-of",
    summary: "diode pair whose output is the higher of two voltages",
    law: "out = max(in, in) - drop",
    source: "thesis 8.2, point (U) of Fig 8.9",
    symbol: "diode-upper-of",
    inputs: &[Input::jack("in", "the two voltages").jacks(Jacks::Exactly(2))],
    settings: &[Setting::DIODE_DROP],
    parts: &[PartUse::always(Part::DiodePair, 1)],
    output_law,
    ..Kind::NETWORK
};

/// out = max(in, in) - drop, in volts (thesis 8.2, Fig 8.9).
fn output_law(builder: &mut dyn Builder) -> Register {
    let drop = builder.get("drop");
    let inputs = builder.inputs("in");
    let upper = inputs.iter().copied().reduce(|a, b| builder.maximum(a, b));
    let upper = upper.unwrap_or_else(|| builder.constant(0.0));
    builder.subtract(upper, drop)
}
