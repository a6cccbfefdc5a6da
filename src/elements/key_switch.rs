//! Key switch.

use crate::program::{Lowering, Register};

use super::{Input, Kind, Measure, Setting};

pub(super) static KIND: Kind = Kind {
    name: "key-switch",
    summary: "switch that an operator sets by hand",
    law: "closed: out = in; open: out = 0",
    source: "thesis 8.3, Fig 8.15",
    symbol: "switch",
    inputs: &[Input::jack("in", "what it lets through")],
    settings: &[Setting::preset("closed", Measure::Flag, 1.0, "whether it lets its input through")],
    output_law,
    ..Kind::NETWORK
};

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    if lowering.flag("closed") { lowering.input("in") } else { lowering.constant(0.0) }
}
