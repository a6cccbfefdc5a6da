//! A diode pair whose output is the lower of two voltages.
//!
//! The diode of the lower voltage conducts, and its drop makes the output higher than that voltage. Where the inputs
//! are equal, the output has a kink.

use super::{Input, Jacks, Kind, PartUse, Setting};
use crate::ir::{Builder, Register};
use crate::machines::Part;

/// The row of the diode pair. It has no amplifier, so no lamp can light.
pub(super) static KIND: Kind = Kind {
    name: "diode-lower-of",
    summary: "diode pair whose output is the lower of two voltages",
    law: "out = min(in, in) + drop",
    source: "thesis 8.2, point (U) of Fig 8.9",
    symbol: "diode-lower-of",
    inputs: &[Input::jack("in", "the two voltages").jacks(Jacks::Exactly(2))],
    settings: &[Setting::DIODE_DROP],
    parts: &[PartUse::always(Part::DiodePair, 1)],
    output_law,
    ..Kind::NETWORK
};

/// out = min(in, in) + drop, in volts (thesis 8.2, Fig 8.9).
fn output_law(builder: &mut dyn Builder) -> Register {
    let drop = builder.get("drop");
    let inputs = builder.inputs("in");
    let lower = inputs.iter().copied().reduce(|a, b| builder.minimum(a, b));
    let lower = lower.unwrap_or_else(|| builder.constant(0.0));
    builder.add(lower, drop)
}
