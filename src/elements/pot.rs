//! Potentiometer with one end grounded.

use crate::machines::Part;
use crate::program::{Lowering, Register};

use super::{Default, Family, Input, Jacks, Kind, Measure, Output, Setting, Takes};

pub(super) static KIND: Kind = Kind {
    name: "pot",
    family: Family::Computing,
    summary: "potentiometer with one end grounded: passes on a share of its input",
    law: "out = setting x in",
    overload: "has no amplifier: cannot overload",
    modes: "computes in every mode; can be turned while the machine runs",
    source: "thesis 8.1 (fixed potentiometer)",
    symbol: "potentiometer",
    inputs: &[Input {
        name: "in",
        jacks: Jacks::One,
        required: true,
        direct: true,
        description: "top of the track",
    }],
    settings: &[Setting {
        name: "setting",
        measure: Measure::Fraction,
        default: Default::Required,
        range: (0.0, 1.0),
        description: "position of the wiper, 0 at ground, loading taken out",
    }],
    ordered: &[],
    parts: &[Takes::always(Part::FixedPot, 1)],
    output: Output::Passive,
    output_law,
    memory_law: None,
};

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let setting = lowering.get("setting");
    let input = lowering.input("in");
    lowering.multiply(setting, input)
}
