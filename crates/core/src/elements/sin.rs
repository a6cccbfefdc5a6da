//! Sine of a voltage.

use std::f64::consts::PI;

use super::{Input, Kind, Measure, Setting, Takes};
use crate::ir::{Builder, Register};
use crate::machines::{Part, REFERENCE};
use patchcord_expr::Function;

pub(super) static KIND: Kind = Kind {
    name: "sin",
    summary: "fixed function generator: the sine of its input",
    law: "out = amplitude x sin(angle_per_volt x in); as preset 100 V stand for 180 degrees",
    overload: OVERLOAD,
    source: "sine-cosine function generators of the general-purpose machines",
    symbol: "sin",
    inputs: INPUTS,
    settings: SETTINGS,
    parts: PARTS,
    output_law,
    ..Kind::AMPLIFIER
};

/// What sine and cosine have in common.
pub(super) const INPUTS: &[Input] = &[Input::jack("in", "the angle")];
pub(super) const PARTS: &[Takes] = &[Takes::always(Part::FunctionGenerator, 1)];
pub(super) const OVERLOAD: &str = "gives its amplitude at most: cannot overload";
pub(super) const SETTINGS: &[Setting] = &[
    Setting::preset("amplitude", Measure::Volts, REFERENCE, "output at the sine's or cosine's 1"),
    Setting::preset(
        "angle_per_volt",
        Measure::RadiansPerVolt,
        PI / REFERENCE,
        "angle that one volt stands for",
    ),
];

fn output_law(builder: &mut dyn Builder) -> Register {
    wave(builder, Function::Sin)
}

/// The amplitude times a function of the angle.
pub(super) fn wave(builder: &mut dyn Builder, function: Function) -> Register {
    let (scale, input) = (builder.get("angle_per_volt"), builder.input("in"));
    let angle = builder.multiply(scale, input);
    let wave = builder.call(function, angle);
    let amplitude = builder.get("amplitude");
    builder.multiply(amplitude, wave)
}
