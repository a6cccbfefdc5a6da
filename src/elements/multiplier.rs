//! Quarter-squares multiplier.

use crate::machines::{Part, REFERENCE};
use crate::program::{Lowering, Register};

use super::{Input, Kind, Measure, Setting, Takes};

const SUM_OF_SQUARES: &str = "sum-of-squares";
const PRODUCT: &str = "product";

pub(super) static KIND: Kind = Kind {
    name: "multiplier",
    summary: "quarter-squares multiplier: the product of two voltages, or the sum of squares of positive ones",
    law: "product: out = ((a + b)^2 - (a - b)^2) / 400 V = a b / 100 V, in all four quadrants; \
          sum-of-squares: out = (max(a, 0)^2 + max(b, 0)^2) / 100 V",
    source: "sum-of-squares: thesis eq. 32-8; product: quarter-squares identity of the electronic multipliers",
    symbol: "multiplier",
    inputs: &[
        Input::jack("a", "first voltage (or \"ground\")"),
        Input::jack("b", "second voltage (or \"ground\")"),
    ],
    settings: &[Setting::required(
        "mode",
        Measure::Choice(&[SUM_OF_SQUARES, PRODUCT]),
        "how the squaring networks are patched",
    )],
    parts: &[Takes::always(Part::Multiplier, 1)],
    output_law,
    ..Kind::AMPLIFIER
};

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let volts_squared = match lowering.choice("mode") {
        // The difference of squares is the product itself. Said so, it stays straight in a loop where one factor
        // comes from outside.
        PRODUCT => product(lowering),
        _ => sum_of_squares(lowering),
    };
    let per_unit = lowering.constant(1.0 / REFERENCE);
    lowering.multiply(volts_squared, per_unit)
}

fn product(lowering: &mut Lowering<'_>) -> Register {
    let (a, b) = (lowering.input("a"), lowering.input("b"));
    lowering.multiply(a, b)
}

fn sum_of_squares(lowering: &mut Lowering<'_>) -> Register {
    let squares = [square(lowering, "a"), square(lowering, "b")];
    lowering.add(squares[0], squares[1])
}

/// Square of an input where it is positive, 0 where it is not.
fn square(lowering: &mut Lowering<'_>, input: &str) -> Register {
    let zero = lowering.constant(0.0);
    let signal = lowering.input(input);
    let positive = lowering.maximum(signal, zero);
    lowering.multiply(positive, positive)
}
