//! Logarithm of a voltage.
//!
//! A logarithm has no value at 0 V. So inputs below `least` count as `least`, and the curve has a kink there.

use super::{Input, Kind, PartUse, Setting, SettingQuantity};
use crate::ir::{Builder, Register};
use crate::machines::{Part, REFERENCE};
use patchcord_expr::Function;

/// The row of the logarithm. With the default settings an input of 0 V demands -150 V, which is an overload.
pub(super) static KIND: Kind = Kind {
    name: "log",
    summary: "fixed function generator: the logarithm of its input to base 10",
    law: "out = per_decade x log10(max(in, least) / reference): at and below least, out has its value at least",
    source: "logarithmic function generators of the general-purpose machines",
    symbol: "log",
    inputs: &[Input::jack("in", "input voltage")],
    settings: &[
        LEVEL,
        PER_DECADE,
        Setting::preset(
            "least",
            SettingQuantity::Volts,
            1e-3,
            "input at and below which the output is constant; with 10 mV there is no overload at 0 V",
        )
        .within(SMALLEST, REFERENCE),
    ],
    parts: &[PartUse::always(Part::FunctionGenerator, 1)],
    output_law,
    ..Kind::AMPLIFIER
};

/// The smallest permitted argument of the logarithm, in volts.
const SMALLEST: f64 = 1e-6;

/// The setting `reference`, which logarithm and exponential share.
pub(super) const LEVEL: Setting =
    Setting::preset("reference", SettingQuantity::Volts, 1.0, "voltage whose logarithm is 0")
        .within(SMALLEST, REFERENCE);
/// The setting `per_decade`, which logarithm and exponential share.
pub(super) const PER_DECADE: Setting =
    Setting::preset("per_decade", SettingQuantity::Volts, 50.0, "output per factor of 10 of the input")
        .within(1.0, REFERENCE);

/// out = per_decade x log10(max(in, least) / reference), in volts. With the defaults, 10 V give 50 V and 100 V give 100
/// V.
fn output_law(builder: &mut dyn Builder) -> Register {
    let (input, least) = (builder.input("in"), builder.get("least"));
    let limited = builder.maximum(input, least);
    let level = builder.get("reference");
    let ratio = builder.divide(limited, level);
    let decades = builder.call(Function::Log10, ratio);
    let per_decade = builder.get("per_decade");
    builder.multiply(per_decade, decades)
}
