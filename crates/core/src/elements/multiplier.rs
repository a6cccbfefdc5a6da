//! Quarter-squares multiplier.
//!
//! The machine has squaring networks of diodes. Both connections divide by the reference of 100 V, so the product of
//! two full-scale voltages is a full-scale voltage.

use super::{Input, Kind, PartUse, Setting, SettingQuantity};
use crate::ir::{Builder, Register};
use crate::machines::{Part, REFERENCE};

/// The networks are connected to square one input each. Negative voltages count as 0.
const SUM_OF_SQUARES: &str = "sum-of-squares";
/// The networks square the sum and the difference of the inputs.
const PRODUCT: &str = "product";

/// The row of the multiplier. Both connections use the same part, so every multiplier of a patch has to choose one.
pub(super) static KIND: Kind = Kind {
    name: "multiplier",
    summary: "quarter-squares multiplier: the product of two voltages, or the sum of the squares of positive \
              voltages",
    law: "product: out = ((a + b)^2 - (a - b)^2) / 400 V = a b / 100 V, in all four quadrants; sum-of-squares: out = \
          (max(a, 0)^2 + max(b, 0)^2) / 100 V",
    source: "sum-of-squares: thesis eq. 32-8; product: quarter-squares identity of the electronic multipliers",
    symbol: "multiplier",
    inputs: &[
        Input::jack("a", "first voltage (or \"ground\")"),
        Input::jack("b", "second voltage (or \"ground\")"),
    ],
    settings: &[Setting::required(
        "mode",
        SettingQuantity::Choice(&[SUM_OF_SQUARES, PRODUCT]),
        "connection of the squaring networks",
    )],
    parts: &[PartUse::always(Part::Multiplier, 1)],
    output_law,
    ..Kind::AMPLIFIER
};

/// out = a b / 100 V, or (max(a, 0)^2 + max(b, 0)^2) / 100 V, in volts. The setting `mode` selects the connection.
fn output_law(builder: &mut dyn Builder) -> Register {
    let volts_squared = match builder.choice("mode") {
        // The difference of squares equals the product. A product is linear in a loop if one factor comes from
        // outside; two squares would be curved.
        PRODUCT => product(builder),
        _ => sum_of_squares(builder),
    };
    let per_unit = builder.constant(1.0 / REFERENCE);
    builder.multiply(volts_squared, per_unit)
}

/// a x b, in square volts.
fn product(builder: &mut dyn Builder) -> Register {
    let (a, b) = (builder.input("a"), builder.input("b"));
    builder.multiply(a, b)
}

/// max(a, 0)^2 + max(b, 0)^2, in square volts (thesis eq. 32-8).
fn sum_of_squares(builder: &mut dyn Builder) -> Register {
    let squares = [square(builder, "a"), square(builder, "b")];
    builder.add(squares[0], squares[1])
}

/// The square of a positive input, in square volts; 0 for a negative one. The curve has no corner at 0 V, but
/// its slope has one.
fn square(builder: &mut dyn Builder, input: &str) -> Register {
    let zero = builder.constant(0.0);
    let signal = builder.input(input);
    let positive = builder.maximum(signal, zero);
    builder.multiply(positive, positive)
}
