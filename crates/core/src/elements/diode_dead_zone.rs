//! The diode network of the dead zone: two free potentiometers and a diode pair.

use super::{Input, Kind, Measure, Setting, Takes};
use crate::ir::{Builder, Register};
use crate::machines::Part;

pub(super) static KIND: Kind = Kind {
    name: "diode-dead-zone",
    summary: "dead zone of two free pots and a diode pair, its width set by two bias voltages",
    law: "out = max(0, in - r (in - bias_minus) - drop) + min(0, in - r (in - bias_plus) + drop), r the setting: \
          breaks at bias r / (1 - r), slope 1 - r beyond",
    source: "thesis Fig 8.5 (c), eq. 17-8 to 27-8",
    symbol: "diode-dead-zone",
    inputs: &[
        Input::jack("in", "signal, at one end of both tracks"),
        Input::jack("bias_plus", "+VB, at the other end of the track for negative signals"),
        Input::jack("bias_minus", "-VB, at the other end of the track for positive signals"),
    ],
    settings: &[
        Setting::required("setting", Measure::Fraction, "position r of both wipers, 0 at the signal's end"),
        Setting::DIODE_DROP,
    ],
    parts: &[Takes::always(Part::FreePot, 2), Takes::always(Part::DiodePair, 1)],
    output_law,
    ..Kind::NETWORK
};

fn output_law(builder: &mut dyn Builder) -> Register {
    let zero = builder.constant(0.0);
    let drop = builder.get("drop");
    let upper_wiper = wiper(builder, "bias_minus");
    let upper = builder.subtract(upper_wiper, drop);
    let positive = builder.maximum(upper, zero);
    let lower_wiper = wiper(builder, "bias_plus");
    let lower = builder.add(lower_wiper, drop);
    let negative = builder.minimum(lower, zero);
    builder.add(positive, negative)
}

/// Voltage on the wiper of the track that ends at a bias.
fn wiper(builder: &mut dyn Builder, bias: &str) -> Register {
    let setting = builder.get("setting");
    let (signal, end) = (builder.input("in"), builder.input(bias));
    let across = builder.subtract(signal, end);
    let dropped = builder.multiply(setting, across);
    builder.subtract(signal, dropped)
}
