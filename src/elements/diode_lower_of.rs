//! A diode pair that passes on the lower of two voltages.

use crate::machines::Part;
use crate::program::{Lowering, Register};

use super::{Default, Family, Input, Jacks, Kind, Measure, Output, Setting, Takes};

pub(super) static KIND: Kind = Kind {
    name: "diode-lower-of",
    family: Family::Computing,
    summary: "diode pair that passes on the lower of two voltages",
    law: "out = min(in, in) + drop",
    overload: "has no amplifier: cannot overload",
    modes: "computes in every mode",
    source: "thesis 8.2, point (U) of Fig 8.9",
    symbol: "diode-lower-of",
    inputs: &[Input {
        name: "in",
        jacks: Jacks::Exactly(2),
        required: true,
        direct: true,
        description: "the two voltages",
    }],
    settings: &[Setting {
        name: "drop",
        measure: Measure::Volts,
        default: Default::Number(0.0),
        range: (0.0, 10.0),
        description: "forward drop of the diodes",
    }],
    ordered: &[],
    parts: &[Takes::always(Part::DiodePair, 1)],
    output: Output::Passive,
    output_law,
    memory_law: None,
};

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let drop = lowering.get("drop");
    let inputs = lowering.inputs("in");
    let lower = inputs.iter().copied().reduce(|a, b| lowering.minimum(a, b));
    let lower = lower.unwrap_or_else(|| lowering.constant(0.0));
    lowering.add(lower, drop)
}
