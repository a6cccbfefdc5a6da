//! Quarter-squares multiplier.

use super::{Input, Kind, Measure, Setting, Takes};
use crate::ir::{Builder, Register};
use crate::machines::{Part, REFERENCE};

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

fn output_law(builder: &mut dyn Builder) -> Register {
    let volts_squared = match builder.choice("mode") {
        // The difference of squares is the product itself. Said so, it stays straight in a loop where one factor
        // comes from outside.
        PRODUCT => product(builder),
        _ => sum_of_squares(builder),
    };
    let per_unit = builder.constant(1.0 / REFERENCE);
    builder.multiply(volts_squared, per_unit)
}

fn product(builder: &mut dyn Builder) -> Register {
    let (a, b) = (builder.input("a"), builder.input("b"));
    builder.multiply(a, b)
}

fn sum_of_squares(builder: &mut dyn Builder) -> Register {
    let squares = [square(builder, "a"), square(builder, "b")];
    builder.add(squares[0], squares[1])
}

/// Square of an input where it is positive, 0 where it is not.
fn square(builder: &mut dyn Builder, input: &str) -> Register {
    let zero = builder.constant(0.0);
    let signal = builder.input(input);
    let positive = builder.maximum(signal, zero);
    builder.multiply(positive, positive)
}
