//! A diode pair that passes on the upper of two voltages.

use super::{Input, Jacks, Kind, Setting, Takes};
use crate::ir::{Builder, Register};
use crate::machines::Part;

pub(super) static KIND: Kind = Kind {
    name: "diode-upper-of",
    summary: "diode pair that passes on the upper of two voltages",
    law: "out = max(in, in) - drop",
    source: "thesis 8.2, point (U) of Fig 8.9",
    symbol: "diode-upper-of",
    inputs: &[Input::jack("in", "the two voltages").jacks(Jacks::Exactly(2))],
    settings: &[Setting::DIODE_DROP],
    parts: &[Takes::always(Part::DiodePair, 1)],
    output_law,
    ..Kind::NETWORK
};

fn output_law(builder: &mut dyn Builder) -> Register {
    let drop = builder.get("drop");
    let inputs = builder.inputs("in");
    let upper = inputs.iter().copied().reduce(|a, b| builder.maximum(a, b));
    let upper = upper.unwrap_or_else(|| builder.constant(0.0));
    builder.subtract(upper, drop)
}
