//! A diode pair that passes on the lower of two voltages.

use super::{Input, Jacks, Kind, Setting, Takes};
use crate::ir::{Builder, Register};
use crate::machines::Part;

pub(super) static KIND: Kind = Kind {
    name: "diode-lower-of",
    summary: "diode pair that passes on the lower of two voltages",
    law: "out = min(in, in) + drop",
    source: "thesis 8.2, point (U) of Fig 8.9",
    symbol: "diode-lower-of",
    inputs: &[Input::jack("in", "the two voltages").jacks(Jacks::Exactly(2))],
    settings: &[Setting::DIODE_DROP],
    parts: &[Takes::always(Part::DiodePair, 1)],
    output_law,
    ..Kind::NETWORK
};

fn output_law(builder: &mut dyn Builder) -> Register {
    let drop = builder.get("drop");
    let inputs = builder.inputs("in");
    let lower = inputs.iter().copied().reduce(|a, b| builder.minimum(a, b));
    let lower = lower.unwrap_or_else(|| builder.constant(0.0));
    builder.add(lower, drop)
}
