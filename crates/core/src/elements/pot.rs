//! Potentiometer with one end grounded.
//!
//! Its setting can be a formula of parameters, and so it is the usual place of a coefficient of the problem.

use super::{Input, Kind, PartUse, Setting, SettingQuantity, Transfer};
use crate::ir::{Builder, Register};
use crate::machines::Part;

/// The row of the pot. Loading is compensated, so the law contains no load resistance.
pub(super) static KIND: Kind = Kind {
    name: "pot",
    summary: "potentiometer with one end grounded: a fraction of its input",
    law: "out = setting x in",
    modes: "computes in every mode; can be turned during a run",
    source: "thesis 8.1 (fixed potentiometer)",
    symbol: "potentiometer",
    inputs: &[Input::jack("in", "top of the track")],
    settings: &[Setting::required(
        "setting",
        SettingQuantity::Fraction,
        "position of the wiper, 0 at ground, with loading compensated",
    )],
    parts: &[PartUse::always(Part::FixedPot, 1)],
    transfer: Transfer::Share,
    output_law,
    ..Kind::NETWORK
};

/// out = setting x in, in volts. The setting is a pure number from 0 to 1.
fn output_law(builder: &mut dyn Builder) -> Register {
    let setting = builder.get("setting");
    let input = builder.input("in");
    builder.multiply(setting, input)
}
