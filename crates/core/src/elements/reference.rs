//! The fixed voltages of the machine: +100 V, -100 V and signal ground.

use super::{Family, Kind, Measure, Setting};
use crate::ir::{Builder, Register};
use crate::machines::REFERENCE as VOLTS;

/// Names under which cords reach the references, and their voltages.
pub const REFERENCES: &[(&str, f64)] = &[("+100", VOLTS), ("-100", -VOLTS), ("ground", 0.0)];

/// The fixed references as a kind of element.
pub static REFERENCE: Kind = Kind {
    name: "reference",
    family: Family::Reference,
    summary: "fixed voltage of the machine",
    law: "out = volts",
    source: "thesis 8.1",
    symbol: "reference",
    settings: &[Setting::required("volts", Measure::Volts, "its voltage")],
    output_law,
    ..Kind::NETWORK
};

fn output_law(builder: &mut dyn Builder) -> Register {
    builder.get("volts")
}
