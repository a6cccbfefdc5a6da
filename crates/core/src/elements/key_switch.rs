//! Key switch.

use super::{Input, Kind, Measure, Setting};
use crate::ir::{Builder, Register};

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

fn output_law(builder: &mut dyn Builder) -> Register {
    if builder.flag("closed") { builder.input("in") } else { builder.constant(0.0) }
}
