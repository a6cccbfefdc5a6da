//! Potentiometer with both ends free.

use crate::machines::Part;
use crate::program::{Lowering, Register};

use super::{Input, Kind, Measure, Setting, Takes};

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

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let setting = lowering.get("setting");
    let (top, end) = (lowering.input("in"), lowering.input("end"));
    let across = lowering.subtract(top, end);
    let share = lowering.multiply(setting, across);
    lowering.add(end, share)
}
