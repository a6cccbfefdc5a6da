//! The diode network of the dead zone: two free potentiometers and a diode pair.

use crate::machines::Part;
use crate::program::{Lowering, Register};

use super::{Input, Kind, Measure, Setting, Takes};

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

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let zero = lowering.constant(0.0);
    let drop = lowering.get("drop");
    let upper_wiper = wiper(lowering, "bias_minus");
    let upper = lowering.subtract(upper_wiper, drop);
    let positive = lowering.maximum(upper, zero);
    let lower_wiper = wiper(lowering, "bias_plus");
    let lower = lowering.add(lower_wiper, drop);
    let negative = lowering.minimum(lower, zero);
    lowering.add(positive, negative)
}

/// Voltage on the wiper of the track that ends at a bias.
fn wiper(lowering: &mut Lowering<'_>, bias: &str) -> Register {
    let setting = lowering.get("setting");
    let (signal, end) = (lowering.input("in"), lowering.input(bias));
    let across = lowering.subtract(signal, end);
    let dropped = lowering.multiply(setting, across);
    lowering.subtract(signal, dropped)
}
