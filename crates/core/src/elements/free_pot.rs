//! Potentiometer with both ends free.
//!
//! A pot with a grounded end is the special case with `end` at 0 V.

use super::{Input, Kind, PartUse, Setting, SettingQuantity};
use crate::ir::{Builder, Register};
use crate::machines::Part;

/// The row of the free pot. Loading is compensated, so the law contains no load resistance.
pub(super) static KIND: Kind = Kind {
    name: "free-pot",
    summary: "potentiometer with both ends free: a voltage between two others",
    law: "out = end + setting x (in - end)",
    modes: "computes in every mode; can be turned during a run",
    source: "thesis 8.1 (free potentiometer)",
    symbol: "free-potentiometer",
    inputs: &[Input::jack("in", "top of the track"), Input::jack("end", "other end of the track")],
    settings: &[Setting::required(
        "setting",
        SettingQuantity::Fraction,
        "position of the wiper, 0 at \"end\", with loading compensated",
    )],
    parts: &[PartUse::always(Part::FreePot, 1)],
    output_law,
    ..Kind::NETWORK
};

/// out = end + setting x (in - end), in volts. The setting is a pure number from 0 to 1.
fn output_law(builder: &mut dyn Builder) -> Register {
    let setting = builder.get("setting");
    let (top, end) = (builder.input("in"), builder.input("end"));
    let across = builder.subtract(top, end);
    let share = builder.multiply(setting, across);
    builder.add(end, share)
}
