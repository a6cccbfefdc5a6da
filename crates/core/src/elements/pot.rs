//! Potentiometer with one end grounded.

use super::{Input, Kind, Measure, Setting, Takes, Transfer};
use crate::ir::{Builder, Register};
use crate::machines::Part;

pub(super) static KIND: Kind = Kind {
    name: "pot",
    summary: "potentiometer with one end grounded: passes on a share of its input",
    law: "out = setting x in",
    modes: "computes in every mode; can be turned while the machine runs",
    source: "thesis 8.1 (fixed potentiometer)",
    symbol: "potentiometer",
    inputs: &[Input::jack("in", "top of the track")],
    settings: &[Setting::required(
        "setting",
        Measure::Fraction,
        "position of the wiper, 0 at ground, loading taken out",
    )],
    parts: &[Takes::always(Part::FixedPot, 1)],
    transfer: Transfer::Share,
    output_law,
    ..Kind::NETWORK
};

fn output_law(builder: &mut dyn Builder) -> Register {
    let setting = builder.get("setting");
    let input = builder.input("in");
    builder.multiply(setting, input)
}
