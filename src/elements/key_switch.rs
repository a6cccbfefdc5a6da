//! Key switch.

use crate::program::{Lowering, Register};

use super::{Default, Family, Input, Jacks, Kind, Measure, Output, Setting};

pub(super) static KIND: Kind = Kind {
    name: "key-switch",
    family: Family::Computing,
    summary: "switch that an operator sets by hand",
    law: "closed: out = in; open: out = 0",
    overload: "has no amplifier: cannot overload",
    modes: "computes in every mode",
    source: "thesis 8.3, Fig 8.15",
    symbol: "switch",
    inputs: &[Input {
        name: "in",
        jacks: Jacks::One,
        required: true,
        direct: true,
        description: "what it lets through",
    }],
    settings: &[Setting {
        name: "closed",
        measure: Measure::Flag,
        default: Default::Number(1.0),
        range: (0.0, 1.0),
        description: "whether it lets its input through",
    }],
    ordered: &[],
    parts: &[],
    output: Output::Passive,
    output_law,
    memory_law: None,
};

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    if lowering.flag("closed") { lowering.input("in") } else { lowering.constant(0.0) }
}
