//! Key switch: set by hand before a run.
//!
//! Its position cannot change during a run, so it costs no operation: the lowering connects the output to the input or
//! to 0 V.

use super::{Input, Kind, Setting, SettingQuantity};
use crate::ir::{Builder, Register};

/// The row of the key switch. It needs no part of the machine.
pub(super) static KIND: Kind = Kind {
    name: "key-switch",
    summary: "switch that the operator sets by hand",
    law: "closed: out = in; open: out = 0",
    source: "thesis 8.3, Fig 8.15",
    symbol: "switch",
    inputs: &[Input::jack("in", "input voltage")],
    settings: &[Setting::preset("closed", SettingQuantity::Flag, 1.0, "whether the switch is closed")],
    output_law,
    ..Kind::NETWORK
};

/// out = in if the switch is closed, otherwise 0 V.
fn output_law(builder: &mut dyn Builder) -> Register {
    if builder.flag("closed") { builder.input("in") } else { builder.constant(0.0) }
}
