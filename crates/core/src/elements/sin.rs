//! Sine of a voltage.
//!
//! Sine and cosine share everything except the function. No adaptive step is longer than one eighth of a period
//! (docs/solver.md).

use std::f64::consts::PI;

use super::{Input, Kind, PartUse, Setting, SettingQuantity};
use crate::ir::{Builder, Register};
use crate::machines::{Part, REFERENCE};
use patchcord_expr::Function;

/// The row of the sine. An angle of 0 V gives 0 V.
pub(super) static KIND: Kind = Kind {
    name: "sin",
    summary: "fixed function generator: the sine of its input",
    law: "out = amplitude x sin(angle_per_volt x in); by default 100 V correspond to 180 degrees",
    overload: OVERLOAD,
    source: "sine-cosine function generators of the general-purpose machines",
    symbol: "sin",
    inputs: INPUTS,
    settings: SETTINGS,
    parts: PARTS,
    output_law,
    ..Kind::AMPLIFIER
};

/// The input of sine and cosine.
pub(super) const INPUTS: &[Input] = &[Input::jack("in", "angle, as a voltage")];
/// The parts that sine and cosine need.
pub(super) const PARTS: &[PartUse] = &[PartUse::always(Part::FunctionGenerator, 1)];
/// The behaviour of sine and cosine at overload.
pub(super) const OVERLOAD: &str = "its output is at most amplitude, so it cannot overload";
/// The settings of sine and cosine.
pub(super) const SETTINGS: &[Setting] = &[
    Setting::preset("amplitude", SettingQuantity::Volts, REFERENCE, "largest output"),
    Setting::preset(
        "angle_per_volt",
        SettingQuantity::RadiansPerVolt,
        PI / REFERENCE,
        "angle per volt of input",
    ),
];

/// out = amplitude x sin(angle_per_volt x in), in volts.
fn output_law(builder: &mut dyn Builder) -> Register {
    wave(builder, Function::Sin)
}

/// The amplitude times sine or cosine of the angle, in volts. The angle is angle_per_volt x in, in radians.
pub(super) fn wave(builder: &mut dyn Builder, function: Function) -> Register {
    let (scale, input) = (builder.get("angle_per_volt"), builder.input("in"));
    let angle = builder.multiply(scale, input);
    let wave = builder.call(function, angle);
    let amplitude = builder.get("amplitude");
    builder.multiply(amplitude, wave)
}
