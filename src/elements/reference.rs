//! The fixed voltages of the machine: +100 V, -100 V and signal ground.

use crate::machines::REFERENCE as VOLTS;
use crate::program::{Lowering, Register};

use super::{Family, Kind, Measure, Setting};

/// Names under which cords reach the references, and their voltages.
pub(crate) const REFERENCES: &[(&str, f64)] = &[("+100", VOLTS), ("-100", -VOLTS), ("ground", 0.0)];

pub(crate) static REFERENCE: Kind = Kind {
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

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    lowering.get("volts")
}
