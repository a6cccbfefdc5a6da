//! Quarter-squares multiplier.

use crate::machines::{Part, REFERENCE};
use crate::program::{Lowering, Register};

use super::{Default, Family, Input, Jacks, Kind, Measure, Output, Setting, Takes};

const fn jack(name: &'static str) -> Input {
    Input { name, jacks: Jacks::One, required: true, direct: true, description: "factor (or \"ground\")" }
}

pub(super) static KIND: Kind = Kind {
    name: "multiplier",
    family: Family::Computing,
    summary: "quarter-squares multiplier, patched as sum of squares of positive voltages",
    law: "sum-of-squares: out = (max(a, 0)^2 + max(b, 0)^2) / 100 V",
    overload: "its output amplifier stops at ±100 V; the lamp lights when more is asked for",
    modes: "computes in every mode",
    source: "thesis eq. 32-8",
    symbol: "multiplier",
    inputs: &[jack("a"), jack("b")],
    settings: &[Setting {
        name: "mode",
        measure: Measure::Choice(&["sum-of-squares"]),
        default: Default::Required,
        range: (0.0, 0.0),
        description: "how the squaring networks are patched",
    }],
    ordered: &[],
    parts: &[Takes::always(Part::Multiplier, 1)],
    output: Output::Amplifier,
    output_law,
    memory_law: None,
};

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let squares = [square(lowering, "a"), square(lowering, "b")];
    let sum = lowering.add(squares[0], squares[1]);
    let per_unit = lowering.constant(1.0 / REFERENCE);
    lowering.multiply(sum, per_unit)
}

/// Square of an input where it is positive, 0 where it is not.
fn square(lowering: &mut Lowering<'_>, input: &str) -> Register {
    let zero = lowering.constant(0.0);
    let signal = lowering.input(input);
    let positive = lowering.maximum(signal, zero);
    lowering.multiply(positive, positive)
}
