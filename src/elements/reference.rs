//! The fixed voltages of the machine: +100 V, -100 V and signal ground.

use crate::machines::REFERENCE as VOLTS;
use crate::program::{Lowering, Register};

use super::{Default, Family, Kind, Measure, Output, Setting};

/// Names under which cords reach the references, and their voltages.
pub(crate) const REFERENCES: &[(&str, f64)] = &[("+100", VOLTS), ("-100", -VOLTS), ("ground", 0.0)];

pub(crate) static REFERENCE: Kind = Kind {
    name: "reference",
    family: Family::Reference,
    summary: "fixed voltage of the machine",
    law: "out = volts",
    overload: "cannot overload",
    modes: "the same in every mode",
    source: "thesis 8.1",
    symbol: "reference",
    inputs: &[],
    settings: &[Setting {
        name: "volts",
        measure: Measure::Volts,
        default: Default::Required,
        range: (-VOLTS, VOLTS),
        description: "its voltage",
    }],
    ordered: &[],
    parts: &[],
    output: Output::Passive,
    output_law,
    memory_law: None,
};

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    lowering.get("volts")
}
