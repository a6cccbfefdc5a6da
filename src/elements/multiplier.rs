//! Quarter-squares multiplier.

use crate::machines::{Part, REFERENCE};
use crate::program::{Lowering, Register};

use super::{Input, Kind, Measure, Setting, Takes};

pub(super) static KIND: Kind = Kind {
    name: "multiplier",
    summary: "quarter-squares multiplier, patched as sum of squares of positive voltages",
    law: "sum-of-squares: out = (max(a, 0)^2 + max(b, 0)^2) / 100 V",
    source: "thesis eq. 32-8",
    symbol: "multiplier",
    inputs: &[
        Input::jack("a", "first voltage (or \"ground\")"),
        Input::jack("b", "second voltage (or \"ground\")"),
    ],
    settings: &[Setting::required(
        "mode",
        Measure::Choice(&["sum-of-squares"]),
        "how the squaring networks are patched",
    )],
    parts: &[Takes::always(Part::Multiplier, 1)],
    output_law,
    ..Kind::AMPLIFIER
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
