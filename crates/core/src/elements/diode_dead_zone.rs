//! The diode network of the dead zone: two free potentiometers and a diode pair.
//!
//! Each pot is connected between the signal and one bias voltage. A diode at each wiper passes only one sign, and the
//! output is the sum of both. So each half has its own corner and the slope 1 - r.

use super::{Input, Kind, PartUse, Setting, SettingQuantity};
use crate::ir::{Builder, Register};
use crate::machines::Part;

/// The row of the network. It has no amplifier, so no lamp can light.
pub(super) static KIND: Kind = Kind {
    name: "diode-dead-zone",
    summary: "dead zone of two free pots and a diode pair, its width set by two bias voltages",
    law: "out = max(0, in - r (in - bias_minus) - drop) + min(0, in - r (in - bias_plus) + drop) with r the setting; \
          the corners are at bias r / (1 - r), the slope beyond is 1 - r",
    source: "thesis Fig 8.5 (c), eq. 17-8 to 27-8",
    symbol: "diode-dead-zone",
    inputs: &[
        Input::jack("in", "signal, at one end of both tracks"),
        Input::jack("bias_plus", "+VB, at the other end of the track for negative signals"),
        Input::jack("bias_minus", "-VB, at the other end of the track for positive signals"),
    ],
    settings: &[
        Setting::required(
            "setting",
            SettingQuantity::Fraction,
            "position r of both wipers, 0 at the end with the signal",
        ),
        Setting::DIODE_DROP,
    ],
    parts: &[PartUse::always(Part::FreePot, 2), PartUse::always(Part::DiodePair, 1)],
    output_law,
    ..Kind::NETWORK
};

/// out = max(0, upper - drop) + min(0, lower + drop), in volts, with the voltages of the two wipers (thesis eq. 17-8 to
/// 27-8).
///
/// The negative bias sets the corner of the positive half, and the positive bias that of the negative half.
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

/// The voltage of the wiper whose track leads from the signal to a bias: in - r (in - bias), in volts.
fn wiper(builder: &mut dyn Builder, bias: &str) -> Register {
    let setting = builder.get("setting");
    let (signal, end) = (builder.input("in"), builder.input(bias));
    let across = builder.subtract(signal, end);
    let dropped = builder.multiply(setting, across);
    builder.subtract(signal, dropped)
}
