//! A diode pair that passes on the lower of two voltages.

use crate::machines::Part;
use crate::program::{Lowering, Register};

use super::{Input, Jacks, Kind, Setting, Takes};

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

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let drop = lowering.get("drop");
    let inputs = lowering.inputs("in");
    let lower = inputs.iter().copied().reduce(|a, b| lowering.minimum(a, b));
    let lower = lower.unwrap_or_else(|| lowering.constant(0.0));
    lowering.add(lower, drop)
}
