//! Summing amplifier, with or without a soft limiter.
//!
//! The limiter is optional. Without it the output is linear up to the limit of the amplifier at ±100 V.

use super::soft_limit::{self, LIMIT_SETTINGS};
use super::{Input, Kind, PartUse, Transfer};
use crate::ir::{Builder, Register};
use crate::machines::Part;

/// The row of the summer. Names of jacks give the gains, which the machine may restrict.
pub(super) static KIND: Kind = Kind {
    name: "summer",
    summary: "summing amplifier: adds its inputs, each times its gain, and inverts",
    law: "out = -(sum of gain x input); beyond K, which is a limit plus the drop: K + slope x (out - K)",
    source: "thesis 8.1; soft limiter 8.2, Fig 8.9",
    symbol: "amplifier",
    inputs: &[Input::gains("x", "summing inputs, the gain in the name")],
    settings: LIMIT_SETTINGS,
    ordered: &[("limit.lower", "limit.upper")],
    parts: &[
        PartUse::always(Part::Summer, 1),
        soft_limit::LIMIT_PARTS[0],
        soft_limit::LIMIT_PARTS[1],
        soft_limit::LIMIT_PARTS[2],
    ],
    transfer: Transfer::Inverting,
    output_law,
    ..Kind::AMPLIFIER
};

/// out = -(sum of gain x input), in volts, then the limiter. The gains are pure numbers.
fn output_law(builder: &mut dyn Builder) -> Register {
    let sum = builder.sum("x");
    let inverted = builder.negate(sum);
    soft_limit::apply(builder, inverted)
}
