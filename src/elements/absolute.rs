//! Absolute value: a precision rectifier for both signs.

use crate::machines::Part;
use crate::program::{Lowering, Register};

use super::{Input, Kind, Takes};

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

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let input = lowering.input("in");
    lowering.absolute(input)
}
