//! Potentiometer with both ends free.

use super::{Input, Kind, Measure, Setting, Takes};
use crate::ir::{Builder, Register};
use crate::machines::Part;

pub(super) static KIND: Kind = Kind {
    name: "free-pot",
    summary: "potentiometer with both ends free: stands between two voltages",
    law: "out = end + setting x (in - end)",
    modes: "computes in every mode; can be turned while the machine runs",
    source: "thesis 8.1 (free potentiometer)",
    symbol: "free-potentiometer",
    inputs: &[Input::jack("in", "top of the track"), Input::jack("end", "other end of the track")],
    settings: &[Setting::required(
        "setting",
        Measure::Fraction,
        "position of the wiper, 0 at \"end\", loading taken out",
    )],
    parts: &[Takes::always(Part::FreePot, 1)],
    output_law,
    ..Kind::NETWORK
};

fn output_law(builder: &mut dyn Builder) -> Register {
    let setting = builder.get("setting");
    let (top, end) = (builder.input("in"), builder.input("end"));
    let across = builder.subtract(top, end);
    let share = builder.multiply(setting, across);
    builder.add(end, share)
}
