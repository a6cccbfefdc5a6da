//! Ideal dead zone: amplifiers with diodes in their feedback.
//!
//! The characteristic has no drop and exact corners. `diode_dead_zone` is the passive network of the thesis, with the
//! drop of its diodes.

use super::{Input, Kind, PartUse, Setting, SettingQuantity};
use crate::ir::{Builder, Register};
use crate::machines::Part;

/// Each half needs a biased rectifier with a diode pair and a pot for its corner. The third summer adds the halves.
pub(super) static KIND: Kind = Kind {
    name: "dead-zone",
    summary: "ideal dead zone: 0 V between two input voltages, a straight line from 0 V beyond them",
    law: "out = slope x (in - upper) for in > upper, slope x (in - lower) for in < lower, 0 between",
    source: "two biased precision rectifiers and a summer, of the general-purpose machines",
    symbol: "dead-zone",
    inputs: &[Input::jack("in", "input voltage")],
    settings: &[
        Setting::required("lower", SettingQuantity::Volts, "input below which the output is not 0"),
        Setting::required("upper", SettingQuantity::Volts, "input above which the output is not 0"),
        Setting::preset("slope", SettingQuantity::Ratio, 1.0, "slope on both sides of the zone")
            .within(0.0, f64::MAX),
    ],
    ordered: &[("lower", "upper")],
    parts: &[
        PartUse::always(Part::Summer, 3),
        PartUse::always(Part::DiodePair, 2),
        PartUse::always(Part::FixedPot, 2),
    ],
    output_law,
    ..Kind::AMPLIFIER
};

/// out = slope x (max(in - upper, 0) + min(in - lower, 0)), in volts.
///
/// The two terms are never different from 0 at the same time, because `lower` is below `upper`.
fn output_law(builder: &mut dyn Builder) -> Register {
    let (input, zero) = (builder.input("in"), builder.constant(0.0));
    let (lower, upper) = (builder.get("lower"), builder.get("upper"));
    let (above, below) = (builder.subtract(input, upper), builder.subtract(input, lower));
    let (positive, negative) = (builder.maximum(above, zero), builder.minimum(below, zero));
    let beyond = builder.add(positive, negative);
    let slope = builder.get("slope");
    builder.multiply(slope, beyond)
}
