//! Absolute value: a precision rectifier for both signs.

use super::{Input, Kind, Takes};
use crate::ir::{Builder, Register};
use crate::machines::Part;

pub(super) static KIND: Kind = Kind {
    name: "absolute",
    summary: "absolute value: two amplifiers that rectify both signs, the drop of their diodes taken out",
    law: "out = |in|",
    source: "precision rectifier of the general-purpose machines",
    symbol: "absolute",
    inputs: &[Input::jack("in", "what is rectified")],
    parts: &[Takes::always(Part::Summer, 2), Takes::always(Part::DiodePair, 1)],
    output_law,
    ..Kind::AMPLIFIER
};

fn output_law(builder: &mut dyn Builder) -> Register {
    let input = builder.input("in");
    builder.absolute(input)
}
